/* Scene -> initial elements: fills regions, reads CSV files, checks the result. A function of the
 * scene alone: every rank gets the same elements, to the bit, and takes those that it owns. Knows
 * no device and no MPI. */
#ifndef DEMOCLES_GENERATE_H
#define DEMOCLES_GENERATE_H

#include "scene/scene.h"

#include <stdint.h>

struct wall_pose;
struct walls;

/* Pairs of elements that overlap, periodic images included, and the one that does so most; elements
 * that coincide with another, and the first of these with their partners, lower index first. */
enum { GENERATE_NAMED = 3 };
struct generate_overlaps {
    int64_t n;
    double share, depth; /* [1] of the smaller radius, [m] */
    int64_t element[2];  /* -1: none */
    int64_t n_same, same[GENERATE_NAMED][2];
};

/* All elements in the order of groups; the global id is the index. */
struct elements_host {
    int64_t n;
    double *x;                         /* [n][3] [m] */
    double *v, *w;                     /* [n][3] [m/s], [rad/s] */
    double *radius;                    /* [n] [m] */
    int *material;                     /* [n] index into scene.material */
    int *group;                        /* [n] index into scene.group */
    struct generate_overlaps overlaps; /* as generate_elements finds them */
};

/* Makes the elements of all groups.
 *   Fill: on a cubic lattice of spacing (1 + jitter) times the largest diameter, the sites whose
 *     whole sphere lies in the region and overlaps no element of a group before, `count` of them
 *     from the lowest up (against gravity; without gravity along z), layer by layer. Diameter and
 *       displacement of a site are random numbers of
 *     (seed, site): they do not depend on count. Displacements of up to jitter/2 diameters per axis
 *       keep neighbours apart.
 *   File: CSV, first line names the columns.
 * Then checks that no two centres coincide (nearer than 1e-3 of the smaller radius, periodic images
 * included), that all centres are in the domain's box and that no two elements overlap by more than
 * domain.start_overlap. NULL with messages in `errors`, each with the file and line that it is
 * about, if anything is wrong. Not collective. */
struct elements_host *generate_elements(const struct scene *scene, struct scene_errors *errors);
void generate_free(struct elements_host *elements);

struct generate_overlaps generate_overlaps(
    const struct scene *scene, const struct elements_host *elements);
/* From here on [1] an overlap at the start is worth a warning. */
#define GENERATE_DEEP 0.05

/* [m]; infinity if there are none. */
double generate_smallest_radius(const struct elements_host *elements);

/* How many of n spheres, x [n][3] [m], are inside wall w at its pose: behind a plane or within a
 * rod, or deeper than half their radius in any other wall; is_in [n]: which. */
int64_t generate_in_wall(const struct walls *walls, int w, const struct wall_pose *pose, int64_t n,
    const double *x, const double *radius, bool *is_in);
/* Checks the start against the walls that are there at t = 0: no element may be inside one,
 * and walls that can be touched across periodic faces repeat there. Names the first three and
 * counts the rest. */
void generate_check_walls(const struct scene *scene, const struct walls *walls,
    const struct elements_host *elements, struct scene_errors *errors);

#endif
