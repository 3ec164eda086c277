/* How large the time step may be: a rigorous bound over the contacts of now (on the device), and
 * over the densest packing that the scene's elements can form (on the host, without a device). The
 * bound is that of kernels/contact/law_limit.h. */
#ifndef DEMOCLES_LIMIT_H
#define DEMOCLES_LIMIT_H

#include "generate.h"
#include "scene/scene.h"

struct device;
struct launch;
struct program;
struct sim;
struct walls;
struct limit;

struct limit_result {
    double dt;   /* [s]; infinity without any contact */
    int64_t gid; /* the element whose contacts set it; -1 without any */
};

/* Kernel and buffers; `s` has its elements, lists and walls. limit_free: NULL is fine.
 * Collective. */
struct limit *limit_create(struct sim *s);
void limit_free(struct limit *limit);

/* The bound of the contacts of now with dashpots centred as for the step dt [s], share s of
 * law_limit.h. A step up to the result is safe if it is not below dt. The same on any number of
 * ranks. Collective. */
struct limit_result limit_run(struct sim *s, double dt, double share);
/* For the rare kernels over contacts, this one's and those of overlap.cl: the program; contacts of
 * now, elements and the table of materials as arguments; a run over the owned elements in strides,
 * which returns how many groups have left a result, at most LIMIT_GROUPS. */
enum { LIMIT_GROUPS = 64 };
const struct program *limit_program(const struct limit *limit);
void limit_bind(struct sim *s, struct launch *launch);
int limit_run_groups(struct sim *s, struct launch *launch);
/* The share that suits the scene's beds; 1 without friction. */
double limit_best_share(const struct scene *scene);

/* Row [MATERIAL_WIDTH] of contact_table_material without what never acts: tangential
 * springs without friction. */
void limit_material(const struct scene *scene, int a, int b, double *row);

/* Fastest relative speed [m/s] that the scene's geometry allows: the fastest element at the start,
 * having fallen through the whole domain or until the end of time, against the fastest wall.
 * `walls` may be NULL. */
double limit_speed(
    const struct scene *scene, const struct walls *walls, const struct elements_host *elements);
/* Why there is no such bound: what a message about the scene says of it. */
const char *limit_missing(const struct scene *scene, const struct elements_host *elements);
/* Bound for the densest packing of these elements [s], Hertz contacts as deep as an impact at
 * `speed` [m/s] makes them; infinity if nothing can ever touch. */
double limit_dense(const struct scene *scene, const struct elements_host *elements, double speed);

/* The shortest contact [s] of any two elements, or of one with a wall, that meet at `speed`;
 * infinity if nothing can touch. */
double limit_shortest_contact(
    const struct scene *scene, const struct elements_host *elements, double speed);
/* What speaks against the step dt [s] besides stability, one text each: too few steps per contact,
 * per radius, per range of a bond; overlaps
 * that the scene's weights and speeds allow; single precision far from the origin. */
void limit_warnings(const struct scene *scene, const struct walls *walls,
    const struct elements_host *elements, double speed, double dt, struct scene_errors *warnings);

#endif
