#include "lists_fixture.h"

#include "comm/fail.h"

void lists_open(struct lists *l)
{
    static const char *const sources[] = {
        "scan.cl", "cells.cl", "rows.cl", "pairs.cl", "records.cl", "select.cl", NULL};
    static const char *const force[] = {"layout.cl", NULL};
    double period[3], domain[6] = {0, 0, 0, LISTS_PERIOD, LISTS_PERIOD, LISTS_PERIOD};
    l->features = fixture_features();
    for (int a = 0; a < 3; a++) period[a] = l->features.periodic[a] ? LISTS_PERIOD : 0;
    l->dev = fixture_device();
    l->program = fixture_program(l->dev, &l->features, FEATURES_LISTS, sources);
    l->force = fixture_program(l->dev, &l->features, FEATURES_PAIR, force);
    l->scan = scan_create(l->dev, l->program);
    l->cells = cells_create(l->dev, &l->features, l->program, period, domain);
    l->particles = particles_create(l->dev, &l->features, l->program);
    l->pairs = pairs_create(l->dev, &l->features, l->program, l->force);
}

void lists_close(struct lists *l)
{
    pairs_free(l->pairs);
    particles_free(l->particles);
    cells_free(l->cells);
    scan_free(l->scan);
    program_free(l->force);
    program_free(l->program);
    device_free(l->dev);
}

struct crowd crowd_create(int n_owned, int n_all)
{
    struct crowd c = {n_owned, n_all, fail_alloc((size_t)n_all * sizeof *c.element),
        fail_alloc((size_t)n_all * sizeof *c.gid), fail_alloc((size_t)n_all * sizeof *c.reach)};
    return c;
}

void crowd_free(struct crowd *c)
{
    free(c->element);
    free(c->gid);
    free(c->reach);
}

bool crowd_meet(const struct crowd *c, int a, int b)
{
    const preal *x = c->element[a].x, *y = c->element[b].x, r = c->reach[a] + c->reach[b];
    pvec3 d = nearest_images(p3(y[0] - x[0], y[1] - x[1], y[2] - x[2]), (preal)LISTS_PERIOD,
        (preal)LISTS_PERIOD, (preal)LISTS_PERIOD);
    return p3_dot(d, d) < r * r;
}

void lists_build(struct lists *l, const struct crowd *c)
{
    struct particles *p = l->particles;
    size_t n = (size_t)c->n_all;
    p->n_owned = c->n_owned;
    p->n_ghost = c->n_all - c->n_owned;
    particles_reserve(p, &l->features, c->n_all, 0);
    buffer_write(&p->field[FIELD_STATE].now, 0, n * sizeof *c->element, c->element);
    buffer_write(&p->field[FIELD_GID].now, 0, n * sizeof *c->gid, c->gid);
    buffer_write(&p->reach, 0, n * sizeof *c->reach, c->reach);
    struct cells_bounds bounds = cells_bounds(l->cells, p, c->n_all);
    cells_sort(l->cells, l->scan, p, c->n_all, &bounds);
    pairs_build(l->pairs, l->cells, l->scan, p);
}

int *lists_ints(const struct buffer *buffer, int64_t n)
{
    int *value = fail_alloc((size_t)n * sizeof *value);
    buffer_read(buffer, 0, (size_t)n * sizeof *value, value);
    return value;
}
