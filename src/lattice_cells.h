/* The cells of a lattice, as cut from bodies: every rank has all of them. Knows no rank and no device. */
#ifndef DEMOCLES_LATTICE_CELLS_H
#define DEMOCLES_LATTICE_CELLS_H

#include <stdint.h>

#include "../kernels/loads.h"

/* Bits of a cell: links over the faces -x, +x, -y, +y, -z, +z, then fixed DOF x, y, z and rotation about them. */
#define CELL_LINK(face) (1 << (face))
#define CELL_FIX(dof) (1 << (6 + (dof)))

struct lattice_grid {
    double h, origin[3]; /* edge of a cell, corner of cell (0, 0, 0) [m] */
};

/* What constants depend on. */
struct lattice_kind {
    int material, grid;
};

struct lattice_loads;

struct lattice_cells {
    int64_t n; /* gid = index; sorted by grid, z, y, x */
    struct lattice_grid *grid;
    int n_grid;
    struct lattice_kind *kind;
    int n_kind;              /* at most 255 */
    int32_t (*at)[3];        /* [n] place on its grid */
    uint8_t *kind_of;        /* [n] */
    int16_t *body;           /* [n] index into the scene's bodies */
    uint16_t *bits;          /* [n] CELL_LINK, CELL_FIX */
    int32_t *row;            /* [n] row of loads; 0: no load */
    double (*v)[3], (*w)[3]; /* [n] at time 0, masked; NULL when all zero [m/s] [rad/s] */
    struct lattice_loads *loads;
};

#endif
