/* The list of elements while they are collected. */
#include "generate_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"

static void reserve(struct generate_list *list, int64_t room)
{
    struct elements_host *e = list->elements;
    size_t n = (size_t)room;
    list->room = room;
    e->x = fail_realloc(e->x, 3 * n * sizeof *e->x);
    e->v = fail_realloc(e->v, 3 * n * sizeof *e->v);
    e->w = fail_realloc(e->w, 3 * n * sizeof *e->w);
    e->radius = fail_realloc(e->radius, n * sizeof *e->radius);
    e->material = fail_realloc(e->material, n * sizeof *e->material);
    e->group = fail_realloc(e->group, n * sizeof *e->group);
}

int64_t generate_add(struct generate_list *list, const struct scene *scene, int group,
    const double x[3], double radius)
{
    struct elements_host *e = list->elements;
    const struct element_group *of = scene->group + group;
    if (e->n == list->room) reserve(list, list->room ? 2 * list->room : 1024);
    int64_t i = e->n++;
    memcpy(e->x + 3 * i, x, 3 * sizeof(double));
    memcpy(e->v + 3 * i, of->velocity, 3 * sizeof(double));
    memcpy(e->w + 3 * i, of->angular_velocity, 3 * sizeof(double));
    e->radius[i] = radius;
    e->material[i] = of->material;
    e->group[i] = group;
    return i;
}

void generate_free(struct elements_host *elements)
{
    if (!elements) return;
    free(elements->x);
    free(elements->v);
    free(elements->w);
    free(elements->radius);
    free(elements->material);
    free(elements->group);
    free(elements);
}

double generate_smallest_radius(const struct elements_host *elements)
{
    double r = INFINITY;
    for (int64_t i = 0; i < elements->n; i++) r = fmin(r, elements->radius[i]);
    return r;
}
