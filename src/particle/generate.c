/* The list of elements and the order of work; filling, files and checks are in generate_*.c. */
#include "generate.h"

#include "comm/fail.h"
#include "generate_parts.h"

#include <stdlib.h>
#include <string.h>

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
    if (e->n == list->room) reserve(list, 2 * list->room);
    int64_t i = e->n++;
    memcpy(e->x + 3 * i, x, 3 * sizeof(double));
    memcpy(e->v + 3 * i, of->velocity, 3 * sizeof(double));
    memcpy(e->w + 3 * i, of->angular_velocity, 3 * sizeof(double));
    e->radius[i] = radius;
    e->material[i] = of->material;
    e->group[i] = group;
    return i;
}

struct elements_host *generate_elements(const struct scene *scene, struct scene_errors *errors)
{
    int n_error = errors->n;
    struct generate_list list = {.elements = fail_alloc(sizeof *list.elements)};
    reserve(&list, 1024);
    for (int g = 0; g < scene->n_group; g++) {
        if (scene->group[g].from_file) generate_read_csv(&list, scene, g, errors);
        else generate_fill(&list, scene, g, errors);
    }
    if (errors->n == n_error) generate_check(scene, list.elements, errors);
    if (errors->n == n_error) return list.elements;
    generate_free(list.elements);
    return NULL;
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
