/* Cells made by hand: grids in which a function says what is solid, of which kind, and what is
 * fixed or loaded. */
#ifndef LATTICE_BODIES_H
#define LATTICE_BODIES_H

#include "lattice/lattice.h"

struct bodies_cell {
    int kind, fixed, row; /* fixed: bits of DOF */
};
/* Whether there is a cell at a place of a grid, and what it is like (zero before). */
typedef bool bodies_solid(int grid, const int at[3], struct bodies_cell *cell);

bool bodies_block(int grid, const int at[3], struct bodies_cell *cell);
/* About two thirds of the places, at random. */
bool bodies_voxels(int grid, const int at[3], struct bodies_cell *cell);
/* The same with two materials in layers and at random, some DOF fixed, some cells loaded in rows 1
 * to 4. */
bool bodies_mixed(int grid, const int at[3], struct bodies_cell *cell);

/* n_grid grids of that size (odd ones smaller by one each way, and with half the h), all links
 * between neighbours, n_material kinds per grid. */
struct lattice_cells *bodies_create(
    int n_grid, const int size[3], double h, int n_material, bodies_solid *solid);
void bodies_free(struct lattice_cells *c);
/* Random velocities of that size; fixed DOF 0. */
/* Gives some cells shares of their faces, the same at both ends of a link, of volume and mass. */
void bodies_cut(struct lattice_cells *c);
void bodies_shake(struct lattice_cells *c, double v, double w);

/* Room for the motion of n cells: at rest in place. */
struct lattice_motion bodies_motion(int64_t n);
void bodies_motion_free(struct lattice_motion *m);

#endif
