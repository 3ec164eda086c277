/* Is the start possible? No two elements in one place, none outside the domain, none in a wall.
 * Each costs O(n). */
#include "shape/bvh.h"
#include "comm/fail.h"
#include "generate_parts.h"
#include "kernels/contact/law_wall.h"
#include "shape/walls.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NAMED = 3 };
/* of the smaller radius: no contact law knows a normal there */
static const double coincidence = 1e-3;

static const char *group_name(const struct scene *scene, const struct elements_host *e, int64_t i)
{
    return scene->group[e->group[i]].name;
}
static int group_line(const struct scene *scene, const struct elements_host *e, int64_t i)
{
    return scene->group[e->group[i]].line;
}

static void check_domain(
    const struct scene *scene, const struct elements_host *e, struct scene_errors *errors)
{
    int64_t n_out = 0, last = 0;
    if (!scene->domain.has_box) return;
    for (int64_t i = 0; i < e->n; i++) {
        const double *x = e->x + 3 * i;
        bool is_in = true;
        for (int a = 0; a < 3; a++)
            is_in = is_in && x[a] >= scene->domain.min[a] && x[a] <= scene->domain.max[a];
        if (is_in) continue;
        last = i;
        if (n_out++ < MOST_NAMED)
            scene_errors_add(errors,
                "%s:%d: element %lld of group '%s' at (%g, %g, %g) is outside the domain",
                scene->path, group_line(scene, e, i), (long long)i, group_name(scene, e, i), x[0],
                x[1], x[2]);
    }
    if (n_out > MOST_NAMED)
        scene_errors_add(errors, "%s:%d: and %lld more elements are outside the domain",
            scene->path, group_line(scene, e, last), (long long)(n_out - MOST_NAMED));
}

/* Elements in cells of a hash table, a cell as wide as twice the largest distance asked for: an
 * element has at most 8 cells within reach. */
struct grid {
    double reach; /* [m] */
    uint64_t mask;
    int64_t *head, *next;
};

/* Of the bits of a cell's numbers, which may be too large for integers: a millimetre in cells of
 * 1e-300 m. */
static uint64_t cell_hash(const struct grid *grid, const double cell[3])
{
    uint64_t h = 0;
    for (int a = 0; a < 3; a++) {
        double number = cell[a] + 0.0; /* -0 is 0 */
        uint64_t bits;
        memcpy(&bits, &number, sizeof bits);
        h = (h ^ bits) * 0x9e3779b97f4a7c15u;
        h ^= h >> 29;
    }
    return h & grid->mask;
}

/* Lowest element of the grid that coincides with one of radius r at x, or -1. */
static int64_t grid_find(
    const struct grid *grid, const struct elements_host *e, const double x[3], double r)
{
    int64_t found = -1;
    for (int corner = 0; corner < 8; corner++) {
        double cell[3];
        /* corners of the reach that fall into the cell of the corner before it are not looked at
         * again */
        bool is_new = true;
        for (int a = 0; a < 3; a++) {
            double low = floor((x[a] - grid->reach) / (2 * grid->reach)),
                   high = floor((x[a] + grid->reach) / (2 * grid->reach));
            cell[a] = corner >> a & 1 ? high : low;
            is_new = is_new && (!(corner >> a & 1) || high > low);
        }
        if (!is_new) continue;
        for (int64_t j = grid->head[cell_hash(grid, cell)]; j >= 0; j = grid->next[j]) {
            double dx = x[0] - e->x[3 * j], dy = x[1] - e->x[3 * j + 1],
                   dz = x[2] - e->x[3 * j + 2], near = coincidence * fmin(r, e->radius[j]);
            if (dx * dx + dy * dy + dz * dz < near * near && (found < 0 || j < found)) found = j;
        }
    }
    return found;
}

static void grid_add(struct grid *grid, const struct elements_host *e, int64_t i)
{
    double cell[3];
    for (int a = 0; a < 3; a++) cell[a] = floor(e->x[3 * i + a] / (2 * grid->reach));
    uint64_t h = cell_hash(grid, cell);
    grid->next[i] = grid->head[h];
    grid->head[h] = i;
}

/* The same at x and at its images across periodic faces that are within reach. */
static int64_t find_with_images(
    const struct grid *grid, const struct scene *scene, const struct elements_host *e, int64_t i)
{
    const struct domain *domain = &scene->domain;
    double shift[3] = {0};
    for (int a = 0; a < 3; a++) {
        double x = e->x[3 * i + a], length = domain->max[a] - domain->min[a];
        if (!domain->periodic[a]) continue;
        if (x - domain->min[a] <= grid->reach) shift[a] = length;
        else if (domain->max[a] - x <= grid->reach) shift[a] = -length;
    }
    int64_t found = -1;
    for (int k = 0; k < 8; k++) {
        double x[3];
        bool is_image = true; /* of a direction without a shift there is none */
        for (int a = 0; a < 3; a++) {
            bool shifted = k >> a & 1;
            x[a] = e->x[3 * i + a] + (shifted ? shift[a] : 0);
            is_image = is_image && (!shifted || shift[a] < 0 || shift[a] > 0);
        }
        int64_t j = is_image ? grid_find(grid, e, x, e->radius[i]) : -1;
        if (j >= 0 && (found < 0 || j < found)) found = j;
    }
    return found;
}

static void check_coincidence(
    const struct scene *scene, const struct elements_host *e, struct scene_errors *errors)
{
    struct grid grid = {.mask = 1};
    int64_t n_double = 0, last = 0;
    for (int64_t i = 0; i < e->n; i++) grid.reach = fmax(grid.reach, coincidence * e->radius[i]);
    while (grid.mask < (uint64_t)e->n) grid.mask *= 2;
    grid.head = fail_alloc(grid.mask * sizeof *grid.head);
    grid.next = fail_alloc((size_t)e->n * sizeof *grid.next);
    for (uint64_t h = 0; h < grid.mask; h++) grid.head[h] = -1;
    grid.mask--;
    for (int64_t i = 0; i < e->n; i++) {
        int64_t j = find_with_images(&grid, scene, e, i);
        if (j < 0) { /* one of each place is enough: many in one place stay O(n) */
            grid_add(&grid, e, i);
            continue;
        }
        const double *x = e->x + 3 * i;
        last = i;
        if (n_double++ < MOST_NAMED)
            scene_errors_add(errors,
                "%s:%d: element %lld of group '%s' and element %lld of group '%s' coincide at "
                "(%g, %g, %g)",
                scene->path, group_line(scene, e, i), (long long)j, group_name(scene, e, j),
                (long long)i, group_name(scene, e, i), x[0], x[1], x[2]);
    }
    if (n_double > MOST_NAMED)
        scene_errors_add(errors, "%s:%d: and %lld more elements coincide with others", scene->path,
            group_line(scene, e, last), (long long)(n_double - MOST_NAMED));
    free(grid.head);
    free(grid.next);
}

/* Of all images of a partner an element meets the nearest alone. Two of them can touch it, or it
 * itself, where the period is shorter than this. */
static void check_period(
    const struct scene *scene, const struct elements_host *e, struct scene_errors *errors)
{
    const struct domain *domain = &scene->domain;
    double largest = 0;
    for (int64_t i = 0; i < e->n; i++) largest = fmax(largest, 2 * e->radius[i]);
    for (int a = 0; a < 3; a++) {
        double length = domain->max[a] - domain->min[a];
        if (domain->periodic[a] && length < 2 * largest)
            scene_errors_add(errors,
                "%s: domain: periodic in %c over %g m, which has to be at least twice the largest "
                "diameter, %g m",
                scene->path, "xyz"[a], length, largest);
    }
}

static void check_overlaps(
    const struct scene *scene, const struct elements_host *e, struct scene_errors *errors)
{
    struct generate_overlaps all = e->overlaps;
    if (!(all.share > scene->domain.start_overlap)) return;
    int64_t i = all.element[0], j = all.element[1];
    const double *x = e->x + 3 * j;
    scene_errors_add(errors,
        "%s:%d: element %lld of group '%s' and element %lld of group '%s' at (%g, %g, %g) overlap "
        "by %.3g m, %.3g of the smaller radius, one of %lld pairs that overlap at the start; "
        "domain.start_overlap, the most that is accepted, is %g",
        scene->path, group_line(scene, e, j), (long long)i, group_name(scene, e, i), (long long)j,
        group_name(scene, e, j), x[0], x[1], x[2], all.depth, all.share, (long long)all.n,
        scene->domain.start_overlap);
}

void generate_check(
    const struct scene *scene, struct elements_host *elements, struct scene_errors *errors)
{
    int before = errors->n;
    check_domain(scene, elements, errors);
    check_period(scene, elements, errors);
    check_coincidence(scene, elements, errors);
    if (errors->n > before) return;
    elements->overlaps = generate_overlaps(scene, elements);
    check_overlaps(scene, elements, errors);
}

/* One sphere in one wall. */
struct probe {
    const struct walls *walls;
    int first; /* primitive of the wall's item 0 */
    pvec3 x;   /* in the wall's frame [m] */
    double radius;
    double depth;   /* deepest so far [m] */
    bool is_behind; /* of a one-sided surface */
};

static void visit_primitive(int item, void *context)
{
    struct probe *probe = context;
    struct wall_closest closest =
        wall_closest(WALL_PRIMITIVE(probe->walls->primitive, probe->first + item), probe->x);
    probe->depth = fmax(probe->depth, probe->radius - closest.distance);
    probe->is_behind = probe->is_behind || closest.distance < 0;
}

static bool is_in_wall(const struct walls *walls, const struct bvh *bvh, int w,
    const struct wall_pose *pose, const double x[3], double radius)
{
    const double *r = pose->rotation, *t = pose->translation;
    struct wall_frame frame = {
        p3(r[0], r[1], r[2]), p3(r[3], r[4], r[5]), p3(r[6], r[7], r[8]), p3(t[0], t[1], t[2])};
    struct probe probe = {.walls = walls,
        .first = walls->first[w],
        .x = wall_to_reference(frame, p3(x[0], x[1], x[2])),
        .radius = radius};
    double low[3] = {probe.x.x - radius, probe.x.y - radius, probe.x.z - radius},
           high[3] = {probe.x.x + radius, probe.x.y + radius, probe.x.z + radius};
    if (bvh) bvh_visit(bvh, low, high, visit_primitive, &probe);
    else
        for (int k = 0; k < walls->first[w + 1] - walls->first[w]; k++) visit_primitive(k, &probe);
    return probe.is_behind || probe.depth > 0.5 * radius;
}

void generate_check_walls(const struct scene *scene, const struct walls *walls,
    const struct elements_host *e, struct scene_errors *errors)
{
    struct wall_pose *pose = fail_alloc((size_t)walls->n_wall * sizeof *pose);
    int64_t n_in = 0;
    walls_poses(walls, 1e-9, 0, 1, pose); /* places at t = 0 do not depend on the step */
    for (int w = 0; w < walls->n_wall; w++) {
        if (!pose[w].active) continue;
        bool is_finite = walls->wall[w].kind != SURFACE_PLANE && walls->wall[w].kind != SURFACE_BOX;
        struct bvh *bvh = is_finite ? bvh_create(walls->low + 3 * walls->first[w],
                                          walls->high + 3 * walls->first[w],
                                          walls->first[w + 1] - walls->first[w])
                                    : NULL;
        for (int64_t i = 0; i < e->n; i++) {
            const double *x = e->x + 3 * i;
            if (!is_in_wall(walls, bvh, w, pose + w, x, e->radius[i])) continue;
            if (n_in++ < MOST_NAMED)
                scene_errors_add(errors,
                    "%s:%d: element %lld of group '%s' at (%g, %g, %g) is inside wall '%s'",
                    scene->path, walls->wall[w].line, (long long)i, group_name(scene, e, i), x[0],
                    x[1], x[2], walls->wall[w].name);
        }
        bvh_free(bvh);
    }
    if (n_in > MOST_NAMED)
        scene_errors_add(errors, "%s: and %lld more elements are inside walls", scene->path,
            (long long)(n_in - MOST_NAMED));
    free(pose);
}
