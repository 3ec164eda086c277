/* The list of elements while they are collected. */
#include "generate_parts.h"

#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"

static void *grow(void *old, int64_t n, size_t bytes)
{
    return fail_realloc(old, (size_t)n * bytes);
}

static void reserve(struct generate_list *list, int64_t n)
{
    struct elements_host *e = list->elements;
    list->room = n;
    e->x = grow(e->x, n, 3 * sizeof(double));
    e->v = grow(e->v, n, 3 * sizeof(double));
    e->w = grow(e->w, n, 3 * sizeof(double));
    e->radius = grow(e->radius, n, sizeof(double));
    e->material = grow(e->material, n, sizeof(int));
    e->group = grow(e->group, n, sizeof(int));
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
