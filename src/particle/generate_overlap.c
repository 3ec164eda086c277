/* Overlaps of particles at the start, whatever their source, in O(n) for any mixture of sizes.
 *
 * Particles are dealt to levels, r in [2^(l-1), 2^l), each with a grid of cells 2^(l+1) wide. A
 * particle looks for partners on its own level (lower index, so that a pair is found once) and on
 * higher ones: r_i + r_j is below a cell's width there, so 27 cells are enough, and particles that
 * do not overlap much are few in each. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "generate_parts.h"

struct grid {
    const struct scene *scene;
    const struct elements_host *e;
    int *level; /* [n_level] those that occur */
    int n_level;
    uint64_t mask;
    int64_t *head, *next;
    struct generate_overlaps found;
};

static int level_of(double radius)
{
    int level;
    frexp(radius, &level);
    return level;
}

static uint64_t hash(const struct grid *grid, int level, const double cell[3])
{
    uint64_t h = (uint64_t)(level + 4096);
    for (int a = 0; a < 3; a++) {
        uint64_t bits;
        double whole = cell[a] + 0.0; /* -0 is 0 */
        memcpy(&bits, &whole, sizeof bits);
        h = (h ^ bits) * 0x9e3779b97f4a7c15u;
        h ^= h >> 29;
    }
    return h & grid->mask;
}

static void meet(struct grid *grid, int64_t i, const double x[3], int64_t j)
{
    const struct elements_host *e = grid->e;
    double d2 = 0, sum = e->radius[i] + e->radius[j], least = fmin(e->radius[i], e->radius[j]);
    for (int a = 0; a < 3; a++) d2 += (x[a] - e->x[3 * j + a]) * (x[a] - e->x[3 * j + a]);
    if (!(d2 < sum * sum)) return;
    struct generate_overlaps *found = &grid->found;
    double depth = sum - sqrt(d2), share = depth / least;
    if (!(depth > 1e-12 * sum)) return; /* they touch */
    found->n++;
    if (!(share > found->share)) return;
    found->share = share;
    found->depth = depth;
    found->element[0] = i < j ? i : j;
    found->element[1] = i < j ? j : i;
}

/* Partners of element i, seen at x: where it is, or an image of it. */
static void look(struct grid *grid, int64_t i, const double x[3])
{
    const struct elements_host *e = grid->e;
    int own = level_of(e->radius[i]);
    for (int l = 0; l < grid->n_level; l++) {
        int level = grid->level[l];
        if (level < own) continue;
        double width = ldexp(2, level), reach = e->radius[i] + ldexp(1, level), low[3], high[3],
               cell[3];
        for (int a = 0; a < 3; a++) {
            low[a] = floor((x[a] - reach) / width);
            high[a] = floor((x[a] + reach) / width);
        }
        for (cell[2] = low[2]; cell[2] <= high[2]; cell[2]++)
            for (cell[1] = low[1]; cell[1] <= high[1]; cell[1]++)
                for (cell[0] = low[0]; cell[0] <= high[0]; cell[0]++)
                    for (int64_t j = grid->head[hash(grid, level, cell)]; j >= 0;
                         j = grid->next[j]) {
                        bool is_here = level_of(e->radius[j]) == level && (level > own || j < i);
                        for (int a = 0; a < 3; a++)
                            is_here = is_here && floor(e->x[3 * j + a] / width) >= cell[a] &&
                                      floor(e->x[3 * j + a] / width) <= cell[a];
                        if (is_here) meet(grid, i, x, j);
                    }
    }
}

/* An image across each periodic face within reach, and across edges and corners. */
static void look_with_images(struct grid *grid, int64_t i, double largest)
{
    const struct domain *domain = &grid->scene->domain;
    const double *x = grid->e->x + 3 * i;
    double shift[3] = {0}, reach = grid->e->radius[i] + largest;
    for (int a = 0; a < 3; a++) {
        double length = domain->max[a] - domain->min[a];
        if (!domain->periodic[a]) continue;
        if (x[a] - domain->min[a] <= reach) shift[a] = length;
        else if (domain->max[a] - x[a] <= reach) shift[a] = -length;
    }
    for (int k = 0; k < 8; k++) {
        double image[3];
        bool is_image = true; /* of a direction without a shift there is none */
        for (int a = 0; a < 3; a++) {
            bool shifted = k >> a & 1;
            image[a] = x[a] + (shifted ? shift[a] : 0);
            is_image = is_image && (!shifted || shift[a] < 0 || shift[a] > 0);
        }
        if (is_image) look(grid, i, image);
    }
}

static void put_levels(struct grid *grid)
{
    for (int64_t i = 0; i < grid->e->n; i++) {
        int level = level_of(grid->e->radius[i]), l = 0;
        while (l < grid->n_level && grid->level[l] != level) l++;
        if (l < grid->n_level) continue;
        grid->level = fail_realloc(grid->level, (size_t)++grid->n_level * sizeof *grid->level);
        grid->level[l] = level;
    }
}

struct generate_overlaps generate_overlaps(const struct scene *scene, const struct elements_host *e)
{
    struct grid grid = {.scene = scene, .e = e, .mask = 1, .found = {0, 0, 0, {-1, -1}}};
    double largest = 0;
    put_levels(&grid);
    while (grid.mask < (uint64_t)e->n) grid.mask *= 2;
    grid.head = fail_alloc(grid.mask * sizeof *grid.head);
    grid.next = fail_alloc((size_t)e->n * sizeof *grid.next);
    for (uint64_t h = 0; h < grid.mask; h++) grid.head[h] = -1;
    grid.mask--;
    for (int64_t i = 0; i < e->n; i++) {
        int level = level_of(e->radius[i]);
        double cell[3];
        for (int a = 0; a < 3; a++) cell[a] = floor(e->x[3 * i + a] / ldexp(2, level));
        uint64_t h = hash(&grid, level, cell);
        grid.next[i] = grid.head[h];
        grid.head[h] = i;
        largest = fmax(largest, e->radius[i]);
    }
    for (int64_t i = 0; i < e->n; i++) look_with_images(&grid, i, largest);
    free(grid.level);
    free(grid.head);
    free(grid.next);
    return grid.found;
}
