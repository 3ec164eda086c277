#include "lattice_places.h"

#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"

static int32_t floor_div(int32_t a, int32_t b)
{
    return a >= 0 ? a / b : -1 - (-1 - a) / b;
}

/* The lower and the higher of the other axes. */
static int near_axis(int axis)
{
    return axis == 0 ? 1 : 0;
}
static int far_axis(int axis)
{
    return axis == 2 ? 1 : 2;
}

static int grid_of(const struct lattice_cells *c, int64_t i)
{
    return c->kind[c->kind_of[i]].grid;
}

static struct lattice_place place_of(
    const struct lattice_cells *c, int64_t i, struct lattice_lay run)
{
    const int32_t *at = c->at[i];
    return (struct lattice_place){grid_of(c, i), at[far_axis(run.axis)], at[near_axis(run.axis)],
        floor_div(at[run.axis], run.length)};
}

static int compare(const struct lattice_place *a, const struct lattice_place *b)
{
    if (a->grid != b->grid) return a->grid < b->grid ? -1 : 1;
    if (a->far != b->far) return a->far < b->far ? -1 : 1;
    if (a->near != b->near) return a->near < b->near ? -1 : 1;
    return a->along == b->along ? 0 : a->along < b->along ? -1 : 1;
}

/* One pass of a sort by counting: by where cells are along an axis, or by grid (axis 3). Cells with
 * the same keep their order. */
static int32_t *sorted(const struct lattice_cells *c, int32_t *order, int axis)
{
    int32_t most = 0, *next = fail_alloc((size_t)c->n * sizeof *next);
    for (int64_t i = 0; i < c->n; i++) {
        int32_t key = axis < 3 ? c->at[i][axis] : grid_of(c, i);
        if (key > most) most = key;
    }
    int64_t *begin = fail_alloc(((size_t)most + 2) * sizeof *begin);
    for (int64_t i = 0; i < c->n; i++) begin[(axis < 3 ? c->at[i][axis] : grid_of(c, i)) + 1]++;
    for (int32_t k = 0; k < most; k++) begin[k + 1] += begin[k];
    for (int64_t k = 0; k < c->n; k++) {
        int32_t i = order[k];
        next[begin[axis < 3 ? c->at[i][axis] : grid_of(c, i)]++] = i;
    }
    free(begin);
    free(order);
    return next;
}

int32_t *lattice_places_order(const struct lattice_cells *cells, int axis)
{
    int32_t *order = fail_alloc((size_t)cells->n * sizeof *order);
    const int by[] = {axis, near_axis(axis), far_axis(axis), 3};
    for (int64_t i = 0; i < cells->n; i++) order[i] = (int32_t)i;
    /* along x they are sorted so */
    for (int k = 0; k < 4 && axis > 0; k++) order = sorted(cells, order, by[k]);
    return order;
}

int64_t lattice_places_count(const struct lattice_cells *cells, struct lattice_lay run,
    const int32_t *order, int64_t *n_mixed)
{
    struct lattice_place last = {-1, 0, 0, 0};
    int64_t n = 0, mixed = 0;
    int kind = 0, is_mixed = 0;
    for (int64_t k = 0; k < cells->n; k++) {
        int32_t i = order[k];
        struct lattice_place p = place_of(cells, i, run);
        if (compare(&p, &last) != 0) {
            n++;
            mixed += is_mixed;
            is_mixed = 0;
            kind = cells->kind_of[i];
        }
        is_mixed |= cells->kind_of[i] != kind || cells->bits[i] & CELL_FIXED ||
                    (cells->row && cells->row[i]);
        last = p;
    }
    if (n_mixed) *n_mixed = mixed + is_mixed;
    return n;
}

struct lattice_places *lattice_places_create(
    const struct lattice_cells *cells, struct lattice_lay run)
{
    struct lattice_places *p = fail_alloc(sizeof *p);
    int32_t *order = lattice_places_order(cells, run.axis);
    p->run = run;
    p->n_run = (int)lattice_places_count(cells, run, order, NULL);
    size_t n_cell = (size_t)p->n_run * (size_t)run.length;
    p->place = fail_alloc((size_t)p->n_run * sizeof *p->place);
    p->cell = fail_alloc(n_cell * sizeof *p->cell);
    p->run_of = fail_alloc((size_t)cells->n * sizeof *p->run_of);
    memset(p->cell, 0xff, n_cell * sizeof *p->cell);
    int r = -1;
    for (int64_t k = 0; k < cells->n; k++) {
        int32_t i = order[k];
        struct lattice_place here = place_of(cells, i, run);
        if (r < 0 || compare(&here, &p->place[r]) != 0) p->place[++r] = here;
        p->run_of[i] = r;
        p->cell[(int64_t)r * run.length + lattice_places_lane(p, cells, i)] = i;
    }
    free(order);
    return p;
}

int lattice_places_lane(
    const struct lattice_places *p, const struct lattice_cells *cells, int64_t gid)
{
    return cells->at[gid][p->run.axis] - p->place[p->run_of[gid]].along * p->run.length;
}

void lattice_places_free(struct lattice_places *p)
{
    if (!p) return;
    free(p->place);
    free(p->cell);
    free(p->run_of);
    free(p);
}

int lattice_places_beside(const struct lattice_places *p, int run, int axis, int step)
{
    struct lattice_place wanted = p->place[run];
    int low = 0, high = p->n_run - 1;
    if (axis == p->run.axis) wanted.along += step;
    if (axis == near_axis(p->run.axis)) wanted.near += step;
    if (axis == far_axis(p->run.axis)) wanted.far += step;
    while (low <= high) {
        int middle = low + (high - low) / 2, order = compare(&p->place[middle], &wanted);
        if (order == 0) return middle;
        if (order < 0) low = middle + 1;
        else high = middle - 1;
    }
    return -1;
}

int64_t lattice_places_neighbour(
    const struct lattice_places *p, const struct lattice_cells *cells, int64_t gid, int face)
{
    int run = p->run_of[gid], axis = face / 2, step = face % 2 ? 1 : -1;
    int lane = lattice_places_lane(p, cells, gid), n = p->run.length;
    if (axis == p->run.axis) {
        lane += step;
        if (lane < 0 || lane == n) run = lattice_places_beside(p, run, axis, step);
        lane = (lane + n) % n;
    } else {
        run = lattice_places_beside(p, run, axis, step);
    }
    return run < 0 ? -1 : p->cell[(int64_t)run * n + lane];
}
