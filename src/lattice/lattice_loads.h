/* What acts on cells besides links and gravity, and what moves them. Every combination of
 * boundaries that occurs is a row (kernels/lattice/loads.h); cells name their row, and a row's
 * values at a time are the sum of its terms, each times the history of its boundary.
 *
 * force         equal parts on the free faces (without link) whose centres are in the region, as a
 *               traction that keeps its direction: LOAD_FORCE, LOAD_LEVER, and its part along the
 *               normals at the start in LOAD_TRACTION; without such a face, equal parts on the
 *               centres of cells
 * pressure      -p h^2 n on these faces, turning with the cell: LOAD_BODY, LOAD_TRACTION
 * acceleration  of cells with their centre in the region
 * velocity      of these cells, where a component is not free; their CELL_FIX bit is set. fix is
 *               the same with 0 and has no row. */
#ifndef DEMOCLES_LATTICE_LOADS_H
#define DEMOCLES_LATTICE_LOADS_H

#include "kernels/lattice/loads.h"
#include "scene/scene.h"

struct lattice_loads {
    int n_row;                   /* row 0 has no term */
    int *begin;                  /* [n_row + 1] terms of each row */
    int *boundary;               /* [n_term] index into scene.boundary */
    double (*value)[LOAD_WIDTH]; /* [n_term] at history 1 */
    double *at, *rate, *mean;    /* [scene.n_boundary] histories, as asked for last */
};

/* rows [n_row][LOAD_WIDTH]: forces and accelerations at time t; velocities as means over the drift
 * [from, to], values where from is to. LOAD_NOW and LOAD_RATE: at t. */
void lattice_loads_at(struct lattice_loads *loads, const struct scene *scene, double t, double from,
    double to, double *rows);

#endif
