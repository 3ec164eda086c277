/* Which particles of a start overlap or coincide, in O(n) for any mixture of sizes.
 *
 * Particles are dealt to levels, r in [2^(l-1), 2^l), each with a grid of cells as wide as its
 * largest diameter. They are added from the highest level down, and each looks for those that are
 * there: r_i + r_j is at most a cell's width on a level that is not below its own, so 27 cells are
 * enough, and particles that do not overlap much are few in each. What coincides with another is
 * not added: many in one place stay O(n). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "generate_parts.h"

/* beyond, the next cell has no number of its own */
static const double most_cells = 0x1p52;
/* of the smaller radius: no contact law knows a normal there */
static const double coincidence = 1e-3;

struct generate_grid {
    const struct scene *scene;
    const struct elements_host *e;
    struct level {
        int exponent;
        double largest; /* radius on it [m] */
    } * level;          /* [n_level] those that occur */
    int n_level;
    double largest; /* radius [m] */
    uint64_t mask;
    int64_t *head, *next; /* next: NOT_THERE of an element that has not been added */
};
enum { LAST = -1, NOT_THERE = -2 };

/* A sphere that looks for partners: element i, or -1 where it is none; where it is, or an image. */
struct look {
    int64_t i, same; /* the first that coincides with it, or -1 */
    double x[3], radius;
    struct generate_overlaps found;
};

static int level_of(double radius)
{
    int level;
    frexp(radius, &level);
    return level;
}

static uint64_t hash(const struct generate_grid *grid, int level, const double cell[3])
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

static void cell_of(const struct level *level, const double x[3], double cell[3])
{
    for (int a = 0; a < 3; a++) cell[a] = floor(x[a] / (2 * level->largest));
}

static double distance_squared(const double x[3], const double y[3])
{
    return (x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
           (x[2] - y[2]) * (x[2] - y[2]);
}

static void meet(struct look *look, const struct elements_host *e, int64_t j)
{
    double r = e->radius[j], sum = look->radius + r, least = fmin(look->radius, r),
           distance = sqrt(distance_squared(look->x, e->x + 3 * j)), depth = sum - distance;
    struct generate_overlaps *found = &look->found;
    if (!(depth > 1e-12 * sum)) return; /* they touch at most */
    if (distance < coincidence * least && (look->same < 0 || j < look->same)) look->same = j;
    found->n++;
    if (!(depth / least > found->share)) return;
    found->share = depth / least;
    found->depth = depth;
    found->element[0] = look->i < j ? look->i : j;
    found->element[1] = look->i < j ? j : look->i;
}

/* Those in a cell of a level; at its place in the table others may be, too. */
static void look_in_cell(const struct generate_grid *grid, struct look *look,
    const struct level *level, const double cell[3])
{
    const struct elements_host *e = grid->e;
    for (int64_t j = grid->head[hash(grid, level->exponent, cell)]; j >= 0; j = grid->next[j]) {
        double sum = look->radius + e->radius[j], at[3];
        if (!(distance_squared(look->x, e->x + 3 * j) < sum * sum)) continue;
        cell_of(level, e->x + 3 * j, at);
        if (level_of(e->radius[j]) == level->exponent && !memcmp(at, cell, sizeof at))
            meet(look, e, j);
    }
}

static void look_on_level(
    const struct generate_grid *grid, struct look *look, const struct level *level)
{
    double reach = look->radius + level->largest, low[3], high[3], cell[3], n = 1;
    bool is_near = true;
    for (int a = 0; a < 3; a++) {
        low[a] = floor((look->x[a] - reach) / (2 * level->largest));
        high[a] = floor((look->x[a] + reach) / (2 * level->largest));
        n *= high[a] - low[a] + 1;
        is_near = is_near && fabs(low[a]) < most_cells && fabs(high[a]) < most_cells;
    }
    /* a large sphere among small ones, few, or so far away that cells cannot be counted */
    if (!is_near || !(n <= (double)grid->e->n)) {
        for (int64_t j = 0; j < grid->e->n; j++)
            if (grid->next[j] != NOT_THERE && level_of(grid->e->radius[j]) == level->exponent)
                meet(look, grid->e, j);
        return;
    }
    for (cell[2] = low[2]; cell[2] <= high[2]; cell[2]++)
        for (cell[1] = low[1]; cell[1] <= high[1]; cell[1]++)
            for (cell[0] = low[0]; cell[0] <= high[0]; cell[0]++)
                look_in_cell(grid, look, level, cell);
}

static void look_around(const struct generate_grid *grid, struct look *look)
{
    for (int l = 0; l < grid->n_level; l++)
        if (look->i < 0 || grid->level[l].exponent >= level_of(look->radius))
            look_on_level(grid, look, &grid->level[l]);
}

/* At x and at an image across each periodic face within reach, and across edges and corners. */
static void look_with_images(const struct generate_grid *grid, struct look *look, const double x[3])
{
    const struct domain *domain = &grid->scene->domain;
    double shift[3] = {0}, reach = look->radius + grid->largest;
    for (int a = 0; a < 3; a++) {
        double length = domain->max[a] - domain->min[a];
        if (!domain->periodic[a]) continue;
        if (x[a] - domain->min[a] <= reach) shift[a] = length;
        else if (domain->max[a] - x[a] <= reach) shift[a] = -length;
    }
    for (int k = 0; k < 8; k++) {
        bool is_image = true; /* of a direction without a shift there is none */
        for (int a = 0; a < 3; a++) {
            bool shifted = k >> a & 1;
            look->x[a] = x[a] + (shifted ? shift[a] : 0);
            is_image = is_image && (!shifted || shift[a] < 0 || shift[a] > 0);
        }
        if (is_image) look_around(grid, look);
    }
}

/* The level of a radius; made where it is the first there. */
static struct level *level_for(struct generate_grid *grid, double radius)
{
    int exponent = level_of(radius), l = 0;
    while (l < grid->n_level && grid->level[l].exponent != exponent) l++;
    if (l == grid->n_level) {
        grid->level = fail_realloc(grid->level, (size_t)++grid->n_level * sizeof *grid->level);
        grid->level[l] = (struct level){exponent, 0};
    }
    grid->level[l].largest = fmax(grid->level[l].largest, radius);
    return &grid->level[l];
}

static int descending(const void *a, const void *b)
{
    return ((const struct level *)b)->exponent - ((const struct level *)a)->exponent;
}

/* For these elements, none of which is there yet. */
static struct generate_grid *create(const struct scene *scene, const struct elements_host *e)
{
    struct generate_grid *grid = fail_alloc(sizeof *grid);
    *grid = (struct generate_grid){.scene = scene, .e = e, .mask = 1};
    while (grid->mask < (uint64_t)e->n) grid->mask *= 2;
    grid->head = fail_alloc(grid->mask * sizeof *grid->head);
    grid->next = fail_alloc((size_t)e->n * sizeof *grid->next);
    for (uint64_t h = 0; h < grid->mask; h++) grid->head[h] = LAST;
    grid->mask--;
    for (int64_t i = 0; i < e->n; i++) {
        grid->largest = fmax(grid->largest, level_for(grid, e->radius[i])->largest);
        grid->next[i] = NOT_THERE;
    }
    if (e->n > 0) qsort(grid->level, (size_t)grid->n_level, sizeof *grid->level, descending);
    return grid;
}

static void add(struct generate_grid *grid, const struct level *level, int64_t i)
{
    double cell[3];
    cell_of(level, grid->e->x + 3 * i, cell);
    uint64_t h = hash(grid, level->exponent, cell);
    grid->next[i] = grid->head[h];
    grid->head[h] = i;
}

struct generate_grid *generate_grid_create(const struct scene *scene, const struct elements_host *e)
{
    struct generate_grid *grid = create(scene, e);
    for (int64_t i = 0; i < e->n; i++) add(grid, level_for(grid, e->radius[i]), i);
    return grid;
}

void generate_grid_free(struct generate_grid *grid)
{
    if (!grid) return;
    free(grid->level);
    free(grid->head);
    free(grid->next);
    free(grid);
}

bool generate_grid_is_free(const struct generate_grid *grid, const double x[3], double radius)
{
    struct look look = {.i = -1, .same = -1, .radius = radius};
    look_with_images(grid, &look, x);
    return look.found.n == 0;
}

static void note_same(struct generate_overlaps *found, int64_t i, int64_t j)
{
    if (found->n_same < GENERATE_NAMED) {
        found->same[found->n_same][0] = i < j ? i : j;
        found->same[found->n_same][1] = i < j ? j : i;
    }
    found->n_same++;
}

struct generate_overlaps generate_overlaps(const struct scene *scene, const struct elements_host *e)
{
    struct generate_grid *grid = create(scene, e);
    struct look look = {.found = {.element = {-1, -1}}};
    for (int l = 0; l < grid->n_level; l++)
        for (look.i = 0; look.i < e->n; look.i++) {
            look.radius = e->radius[look.i];
            if (level_of(look.radius) != grid->level[l].exponent) continue;
            look.same = -1;
            look_with_images(grid, &look, e->x + 3 * look.i);
            if (look.same >= 0) note_same(&look.found, look.i, look.same);
            else add(grid, &grid->level[l], look.i);
        }
    generate_grid_free(grid);
    return look.found;
}
