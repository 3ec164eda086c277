#include "lattice_places.h"

#include <stdlib.h>
#include <string.h>

#include "fail.h"

static int32_t floor_div(int32_t a, int32_t b)
{
    return a >= 0 ? a / b : -1 - (-1 - a) / b;
}

static struct lattice_place place_of(const struct lattice_cells *c, int64_t i, int run)
{
    return (struct lattice_place){c->kind[c->kind_of[i]].grid, c->at[i][2], c->at[i][1], floor_div(c->at[i][0], run)};
}

static int compare(const struct lattice_place *a, const struct lattice_place *b)
{
    if (a->grid != b->grid) return a->grid < b->grid ? -1 : 1;
    if (a->z != b->z) return a->z < b->z ? -1 : 1;
    if (a->y != b->y) return a->y < b->y ? -1 : 1;
    return a->x == b->x ? 0 : a->x < b->x ? -1 : 1;
}

int64_t lattice_places_count(const struct lattice_cells *cells, int run)
{
    struct lattice_place last = {-1, 0, 0, 0};
    int64_t n = 0;
    for (int64_t i = 0; i < cells->n; i++) {
        struct lattice_place p = place_of(cells, i, run);
        n += compare(&p, &last) != 0;
        last = p;
    }
    return n;
}

struct lattice_places *lattice_places_create(const struct lattice_cells *cells, int run)
{
    struct lattice_places *p = fail_alloc(sizeof *p);
    p->run = run;
    p->n_run = (int)lattice_places_count(cells, run);
    p->place = fail_alloc((size_t)p->n_run * sizeof *p->place);
    p->cell = fail_alloc((size_t)p->n_run * (size_t)run * sizeof *p->cell);
    p->run_of = fail_alloc((size_t)cells->n * sizeof *p->run_of);
    memset(p->cell, 0xff, (size_t)p->n_run * (size_t)run * sizeof *p->cell);
    int k = -1;
    for (int64_t i = 0; i < cells->n; i++) {
        struct lattice_place here = place_of(cells, i, run);
        if (k < 0 || compare(&here, &p->place[k]) != 0) p->place[++k] = here;
        p->run_of[i] = k;
        p->cell[(int64_t)k * run + cells->at[i][0] - here.x * run] = (int32_t)i;
    }
    return p;
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
    if (axis == 0) wanted.x += step;
    if (axis == 1) wanted.y += step;
    if (axis == 2) wanted.z += step;
    while (low <= high) {
        int middle = low + (high - low) / 2, order = compare(&p->place[middle], &wanted);
        if (order == 0) return middle;
        if (order < 0) low = middle + 1;
        else high = middle - 1;
    }
    return -1;
}

int64_t lattice_places_neighbour(const struct lattice_places *p, const struct lattice_cells *cells, int64_t gid, int face)
{
    int run = p->run_of[gid], axis = face / 2, step = face % 2 ? 1 : -1;
    int lane = cells->at[gid][0] - p->place[run].x * p->run;
    if (axis == 0) {
        lane += step;
        if (lane < 0 || lane == p->run) run = lattice_places_beside(p, run, 0, step);
        lane = (lane + p->run) % p->run;
    } else {
        run = lattice_places_beside(p, run, axis, step);
    }
    return run < 0 ? -1 : p->cell[(int64_t)run * p->run + lane];
}
