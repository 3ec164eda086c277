/* The highest natural frequency w_max of the cells of a scene, and the critical time step. */
#ifndef DEMOCLES_LATTICE_FREQUENCY_H
#define DEMOCLES_LATTICE_FREQUENCY_H

#include "lattice_cells.h"
#include "laws/lattice_limit.h"

struct link_material lattice_frequency_material(const struct material *material);
/* An upper bound of the largest frequency of the cells [rad/s], see lattice_limit.h; closed form on
 * grids of one material. */
double lattice_frequency_largest(const struct scene *scene, const struct lattice_cells *cells);
/* zeta = eta w_max/2 [1] with the largest eta of the cells. */
double lattice_frequency_damping(
    const struct scene *scene, const struct lattice_cells *cells, double largest);
/* Largest stable time step [s]. */
double lattice_frequency_step(const struct scene *scene, const struct lattice_cells *cells);

#endif
