/* Fills a region with spheres on a jittered cubic lattice.
 *
 * Spacing s = (1 + jitter) d_max, displacement at most jitter d_max/2 per axis: a sphere never
 * leaves its cube of edge s, so spheres never overlap, whatever the random numbers are. Sites that
 * overlap an element of a group before are left out. Costs one test per site; with gravity along
 * an axis, only up to where `count` is reached. */
#include "base/vector.h"
#include "base/whole.h"
#include "comm/fail.h"
#include "generate_parts.h"
#include "results/digest.h"
#include "shape/region.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rounding that a sphere may stick out of its region by, in radii. */
static const double slack = 1e-9;

/* Sites that may be looked at: as many as there may be elements. */
static const double most_sites = INT32_MAX / 2;

/* Random number in [0, 1) as a function of its key: splitmix64's finaliser over seed, site and
 * stream (Steele, Lea, Flood 2014). */
static double random_at(uint64_t seed, uint64_t site, uint64_t stream)
{
    uint64_t of_site = digest_mix(digest_mix(seed + DIGEST_G) + site * DIGEST_G + DIGEST_G),
             h = digest_mix(of_site ^ (stream + 1) * DIGEST_G);
    return (double)(h >> 11) * 0x1p-53;
}

struct fill {
    const struct element_group *group;
    struct region_shape shape;
    double spacing, origin[3]; /* first site [m] */
    int64_t sites[3];
    double up[3];                      /* unit vector against gravity */
    int layers_along;                  /* axis nearest to it */
    bool is_straight;                  /* gravity is along that axis */
    const struct generate_grid *there; /* elements of the groups before; NULL: none */
};

static void find_up(struct fill *fill, const double gravity[3])
{
    fill->up[2] = 1;
    if (vector_is_direction(gravity)) {
        for (int a = 0; a < 3; a++) fill->up[a] = -gravity[a];
        vector_normalise(fill->up);
    }
    fill->layers_along = 2;
    for (int a = 1; a >= 0; a--)
        if (fabs(fill->up[a]) > fabs(fill->up[fill->layers_along])) fill->layers_along = a;
    fill->is_straight = fabs(fill->up[fill->layers_along]) >= 1;
}

/* The lattice stands on the lowest end of the bounds where gravity is straight, and is centred
 * otherwise. */
static void place_lattice(struct fill *fill)
{
    fill->spacing = (1 + fill->group->jitter) * fill->group->diameter[1];
    for (int a = 0; a < 3; a++) {
        double length = fill->shape.high[a] - fill->shape.low[a];
        fill->sites[a] = whole_floor(fmax(0, length / fill->spacing + slack));
        double rest = length - (double)fill->sites[a] * fill->spacing, share = 0.5;
        if (a == fill->layers_along && fill->is_straight) share = fill->up[a] > 0 ? 0 : 1;
        fill->origin[a] = fill->shape.low[a] + share * rest + 0.5 * fill->spacing;
    }
}

struct site {
    double height; /* of the lattice point, against gravity [m] */
    uint64_t number;
    double x[3], radius;
};

/* The sphere at lattice point ijk: displaced, of its own size; false if it is not all within the
 * region, or where an element of a group before is. */
static bool make_site(const struct fill *fill, const int64_t ijk[3], struct site *site)
{
    const struct element_group *group = fill->group;
    /* modulo 2^64, where there are more sites than that */
    uint64_t column = (uint64_t)ijk[2] * (uint64_t)fill->sites[1] + (uint64_t)ijk[1],
             number = column * (uint64_t)fill->sites[0] + (uint64_t)ijk[0], seed = group->seed;
    site->number = number;
    site->radius = 0.5 * (group->diameter[0] + (group->diameter[1] - group->diameter[0]) *
                                                   random_at(seed, number, 3));
    site->height = 0;
    for (int a = 0; a < 3; a++) {
        double point = fill->origin[a] + (double)ijk[a] * fill->spacing;
        site->x[a] = point + (2 * random_at(seed, number, (uint64_t)a) - 1) * 0.5 * group->jitter *
                                 group->diameter[1];
        site->height += point * fill->up[a];
    }
    return region_holds(&fill->shape, site->x, site->radius * (1 - slack)) &&
           (!fill->there || generate_grid_is_free(fill->there, site->x, site->radius));
}

struct sites {
    struct site *site;
    size_t n, room;
    double seen;
};

static void look_at(const struct fill *fill, const int64_t ijk[3], struct sites *sites)
{
    if (sites->n == sites->room) {
        sites->room = sites->room ? 2 * sites->room : 1024;
        sites->site = fail_realloc(sites->site, sites->room * sizeof *sites->site);
    }
    sites->n += make_site(fill, ijk, sites->site + sites->n);
    sites->seen++;
}

/* Whether gravity is along an axis to the last digit: the sites of a layer are then all as high,
 * and come in the order of their numbers. */
static bool is_level(const struct fill *fill)
{
    int n_zero = 0;
    for (int a = 0; a < 3; a++) n_zero += !(fabs(fill->up[a]) > 0);
    return fill->is_straight && n_zero == 2;
}

/* All sites that fit, or with straight gravity at least `enough` of the lowest ones (0: all).
 * False where there are too many to look at: of all, or with `enough` in a layer. */
static bool collect(const struct fill *fill, size_t enough, struct sites *sites)
{
    int up = fill->layers_along, b = up == 0 ? 1 : 0, c = up == 2 ? 1 : 2;
    bool few = fill->is_straight && enough, stops = is_level(fill) && enough;
    sites->seen = (double)fill->sites[b] * (double)fill->sites[c] *
                  (few ? fmin((double)fill->sites[up], 1) : (double)fill->sites[up]);
    if (sites->seen > most_sites) return false;
    sites->seen = 0;
    for (int64_t layer = 0; layer < fill->sites[up]; layer++) {
        int64_t ijk[3];
        ijk[up] = fill->up[up] > 0 ? layer : fill->sites[up] - 1 - layer;
        for (ijk[c] = 0; ijk[c] < fill->sites[c]; ijk[c]++) {
            if (sites->seen > most_sites) return false;
            for (ijk[b] = 0; ijk[b] < fill->sites[b]; ijk[b]++) {
                look_at(fill, ijk, sites);
                if (stops && sites->n >= enough) return true;
            }
        }
        if (few && sites->n >= enough) return true;
    }
    return true;
}

static int compare_sites(const void *a, const void *b)
{
    const struct site *p = a, *q = b;
    if (p->height < q->height || p->height > q->height) return p->height < q->height ? -1 : 1;
    return (p->number > q->number) - (p->number < q->number);
}

void generate_fill(
    struct generate_list *list, const struct scene *scene, int group, struct scene_errors *errors)
{
    const struct element_group *of = scene->group + group;
    struct generate_grid *there =
        list->elements->n > 0 ? generate_grid_create(scene, list->elements) : NULL;
    struct fill fill = {.group = of, .there = there};
    struct sites sites = {0};
    size_t count = (size_t)of->count;
    char *text = region_open(&fill.shape, &of->region);
    if (!text) {
        find_up(&fill, scene->gravity);
        place_lattice(&fill);
        if (!collect(&fill, count, &sites))
            text =
                fail_format("elements of %g m have %.3g sites or more in the bounding box of the "
                            "region%s: too many, at most %.4g",
                    of->diameter[1], sites.seen, count ? ", or in a layer of it" : "", most_sites);
        else if (sites.n == 0)
            text = fail_format("no element of %g m fits into the region%s", of->diameter[1],
                there ? " beside those of the groups before" : "");
        else if (sites.n < count)
            text = fail_format("%zu elements were asked for, %zu fit into the region%s", count,
                sites.n, there ? " beside those of the groups before" : "");
    }
    if (text)
        scene_errors_add(errors, "%s:%d: elements '%s': %s", scene->path, of->line, of->name, text);
    else {
        qsort(sites.site, sites.n, sizeof *sites.site, compare_sites);
        for (size_t k = 0; k < (count ? count : sites.n); k++)
            generate_add(list, scene, group, sites.site[k].x, sites.site[k].radius);
    }
    free(text);
    free(sites.site);
    generate_grid_free(there);
    region_close(&fill.shape);
}
