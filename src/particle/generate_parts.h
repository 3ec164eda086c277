/* What the files of generate share. */
#ifndef DEMOCLES_GENERATE_PARTS_H
#define DEMOCLES_GENERATE_PARTS_H

#include "generate.h"

/* Elements while they are collected; `room` of them fit. */
struct generate_list {
    struct elements_host *elements;
    int64_t room;
};

/* One more element of a group, at rest relative to the group's velocities; returns its index. */
int64_t generate_add(struct generate_list *list, const struct scene *scene, int group,
    const double x[3], double radius);

/* Elements by place and size, to be asked whether a sphere overlaps none of them, periodic images
 * included. Scene and elements must outlive it. */
struct generate_grid;
struct generate_grid *generate_grid_create(
    const struct scene *scene, const struct elements_host *elements);
void generate_grid_free(struct generate_grid *grid); /* NULL is fine */
bool generate_grid_is_free(const struct generate_grid *grid, const double x[3], double radius);

void generate_fill(
    struct generate_list *list, const struct scene *scene, int group, struct scene_errors *errors);
void generate_read_csv(
    struct generate_list *list, const struct scene *scene, int group, struct scene_errors *errors);
/* Walls that elements can touch across a periodic face have to repeat there. */
void generate_check_periodic(const struct scene *scene, const struct walls *walls,
    const struct elements_host *elements, struct scene_errors *errors);
/* Sets elements->overlaps, too. */
void generate_check(
    const struct scene *scene, struct elements_host *elements, struct scene_errors *errors);

#endif
