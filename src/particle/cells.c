#include "cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "device/buffers.h"
#include "kernels/particle/particle_words.h"

enum { BOUNDS_GROUPS = 64 };

static const struct buffer_spec buffers[] = {{"grid", offsetof(struct cells, grid_real)},
    {"grid, integers", offsetof(struct cells, grid_int)},
    {"cell of element", offsetof(struct cells, key)}, {"cell begin", offsetof(struct cells, begin)},
    {"cell cursor", offsetof(struct cells, cursor)},
    {"cell member", offsetof(struct cells, member)}, {"bounds", offsetof(struct cells, partial)},
    {0}};

struct cells *cells_create(struct device *dev, const struct features *features,
    const struct program *lists, const double period[3], const double domain[6])
{
    struct cells *c = fail_alloc(sizeof *c);
    buffers_create(dev, c, buffers);
    c->features = features;
    memcpy(c->period, period, sizeof c->period);
    memcpy(c->domain, domain, sizeof c->domain);
    buffer_reserve(&c->grid_real, CELLS_LEVELS * GRID_REALS * sizeof(double));
    buffer_reserve(&c->grid_int, CELLS_LEVELS * GRID_INTS * sizeof(cl_int));
    buffer_reserve(&c->partial, BOUNDS_GROUPS * BOUNDS_WIDTH * sizeof(double));
    c->bounds = launch_create(lists, "select_bounds");
    c->count = launch_create(lists, "cell_count");
    c->fill = launch_create(lists, "cell_fill");
    c->order = launch_create(lists, "order_count");
    c->copy = launch_create(lists, "record_copy");
    launch_set_int(c->bounds, "n_group", BOUNDS_GROUPS);
    launch_bind_buffer(c->bounds, "partial", &c->partial);
    struct launch *keyed[] = {c->count, c->order};
    for (int i = 0; i < 2; i++) {
        launch_bind_all(
            keyed[i], (const struct launch_binding[]){{"grid_real", &c->grid_real},
                          {"grid_int", &c->grid_int}, {"key", &c->key}, {"count", &c->begin}, {0}});
    }
    launch_bind_all(c->fill, (const struct launch_binding[]){{"key", &c->key},
                                 {"cursor", &c->cursor}, {"member", &c->member}, {0}});
    launch_bind_buffer(c->copy, "from", &c->begin);
    launch_bind_buffer(c->copy, "to", &c->cursor);
    return c;
}

void cells_free(struct cells *c)
{
    if (!c) return;
    buffers_free(c, buffers);
    struct launch *launch[] = {c->bounds, c->count, c->fill, c->order, c->copy};
    for (int i = 0; i < 5; i++) launch_free(launch[i]);
    free(c);
}

struct cells_bounds cells_bounds(struct cells *c, const struct particles *p, int64_t n)
{
    struct cells_bounds b = {
        {INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, INFINITY, 0, 0, false};
    if (n == 0) return b;
    launch_set_count(c->bounds, "n", n);
    launch_bind_all(
        c->bounds, (const struct launch_binding[]){{"position", &p->field[FIELD_STATE].now},
                       {"motion", &p->field[FIELD_STATE].now}, {"reach", &p->reach}, {0}});
    launch_run(c->bounds, BOUNDS_GROUPS * SELECT_GROUP);
    double *part =
        reals_read(&c->partial, c->features->position_is_float, 0, BOUNDS_GROUPS * BOUNDS_WIDTH);
    for (int g = 0; g < BOUNDS_GROUPS; g++) {
        const double *x = part + g * BOUNDS_WIDTH;
        if (x[7] < -1e29) continue; /* a group without elements */
        for (int a = 0; a < 3; a++) {
            b.low[a] = fmin(b.low[a], -x[a]);
            b.high[a] = fmax(b.high[a], x[3 + a]);
        }
        b.reach_min = fmin(b.reach_min, -x[6]);
        b.reach_max = fmax(b.reach_max, x[7]);
        b.has_nan |= isnan(x[8]) || !(fabs(x[0]) < 1e29 && fabs(x[1]) < 1e29 && fabs(x[2]) < 1e29);
        b.speed = fmax(b.speed, sqrt(x[8]));
    }
    free(part);
    return b;
}

/* One level of cells of edge >= h over the bounds, at most `most` of them. */
static void set_level(const struct cells *c, const struct cells_bounds *b, double h, double reach,
    int64_t most, double *real, cl_int *integer, int64_t *n_cell)
{
    double low[3], size[3];
    for (int a = 0; a < 3; a++) {
        bool periodic = c->period[a] > 0;
        low[a] = periodic ? c->domain[a] : b->low[a];
        size[a] = periodic ? c->period[a] : fmax(b->high[a] - b->low[a], 0);
    }
    for (;; h *= 1.26) {
        double cells = 1;
        for (int a = 0; a < 3; a++) cells *= fmax(floor(size[a] / h), 1);
        if (cells <= (double)most) break;
    }
    int64_t cells = 1;
    for (int a = 0; a < 3; a++) {
        int n = (int)fmax(floor(size[a] / h), 1);
        real[a] = low[a];
        real[3 + a] = size[a] > 0 ? n / size[a] : 0;
        integer[a] = n;
        cells *= n;
    }
    real[6] = reach;
    integer[3] = (cl_int)*n_cell;
    *n_cell += cells;
}

static void write_grid(struct cells *c, const double *real, const cl_int *integer)
{
    reals_write(
        &c->grid_real, c->features->position_is_float, 0, (size_t)c->n_level * GRID_REALS, real);
    buffer_write(&c->grid_int, 0, (size_t)c->n_level * GRID_INTS * sizeof(cl_int), integer);
    buffer_reserve(&c->begin, ((size_t)c->n_cell + 2) * sizeof(cl_int));
    buffer_reserve(&c->cursor, ((size_t)c->n_cell + 2) * sizeof(cl_int));
    buffer_zero(&c->begin);
}

static void fill(struct cells *c, struct scan *scan, int64_t n, int64_t n_cell)
{
    scan_run(scan, &c->begin, n_cell);
    launch_set_count(c->copy, "n", n_cell);
    launch_run(c->copy, n_cell);
    launch_set_count(c->fill, "n", n);
    launch_run(c->fill, n);
}

static void reserve(struct cells *c, int64_t n)
{
    buffer_reserve(&c->key, (size_t)n * sizeof(cl_int));
    buffer_reserve(&c->member, (size_t)n * sizeof(cl_int));
}

/* Levels halve the reach from the largest down, as long as there may be elements; an element
 * searches its own and all other levels. */
void cells_sort(struct cells *c, struct scan *scan, const struct particles *p, int64_t n,
    const struct cells_bounds *b)
{
    double real[CELLS_LEVELS * GRID_REALS];
    cl_int integer[CELLS_LEVELS * GRID_INTS];
    c->n_level = 0;
    c->n_cell = 0;
    if (n == 0) return;
    for (double reach = b->reach_max * (1 + 1e-6); c->n_level < CELLS_LEVELS;
         reach *= 0.5, c->n_level++) {
        if (c->n_level > 0 && reach < b->reach_min) break;
        set_level(c, b, 2 * reach, reach, 2 * n + 1000, real + c->n_level * GRID_REALS,
            integer + c->n_level * GRID_INTS, &c->n_cell);
    }
    write_grid(c, real, integer);
    reserve(c, n);
    launch_set_count(c->count, "n", n);
    launch_set_int(c->count, "n_level", c->n_level);
    launch_bind_buffer(c->count, "position", &p->field[FIELD_STATE].now);
    launch_bind_buffer(c->count, "reach", &p->reach);
    launch_run(c->count, n);
    fill(c, scan, n, c->n_cell);
}

void cells_order(struct cells *c, struct scan *scan, const struct particles *p, int64_t n,
    const struct cells_bounds *b, const struct buffer *keep)
{
    double real[GRID_REALS];
    cl_int integer[GRID_INTS];
    if (n == 0) return;
    c->n_level = 1;
    c->n_cell = 0;
    set_level(c, b, 2 * b->reach_min, b->reach_max, n + 1000, real, integer, &c->n_cell);
    c->n_cell++; /* for those that leave */
    write_grid(c, real, integer);
    reserve(c, n);
    launch_set_count(c->order, "n", n);
    launch_set_count(c->order, "n_cell", c->n_cell - 1);
    launch_bind_buffer(c->order, "position", &p->field[FIELD_STATE].now);
    launch_bind_buffer(c->order, "keep", keep);
    launch_run(c->order, n);
    fill(c, scan, n, c->n_cell);
}
