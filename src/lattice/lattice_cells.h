/* Bodies of a scene cut into cells, with links, what holds and what loads each. A function of the
 * scene alone: every rank gets the same cells, to the bit. Knows no device and no MPI.
 *
 * A body is cut on a grid of edge `cell` whose origin is the low corner of the body's own bounding
 * box. Bodies whose grids agree (same edge, offset a whole number of cells to 1e-9 of it) share
 * one, and there neighbouring cells are linked, of whichever body they are. A cell is there if its
 * centre is inside the shape, or on it to 1e-9 of the edge, and not so in `minus`; of two bodies
 * the later one has it. Where a surface is curved, a cell is there too if the bodies of its grid
 * cover some of it, with that share of its volume, faces and links (lattice_cover.c,
 * lattice_shares.c). A link is there unless its middle is in a crack of one of its two bodies.
 * Centre of a cell: origin + (at + 1/2) h. */
#ifndef DEMOCLES_LATTICE_CELLS_H
#define DEMOCLES_LATTICE_CELLS_H

#include "kernels/lattice/loads.h"
#include "laws/lattice_limit.h"
#include "scene/scene.h"

#include <stdint.h>

struct lattice_loads;

/* Bits of a cell: six links as LINK_BIT of kernels/lattice/lattice_words.h, then fixed DOF x, y, z,
 * rx, ry, rz. */
enum { CELL_LINKS = 63, CELL_FIXED = 63 << 6 };
#define CELL_LINK(face) (1 << (face))
#define CELL_FIX(dof) (64 << (dof))

/* Centres on a surface belong to it, to this share of the edge. */
#define LATTICE_SLACK 1e-9

struct lattice_grid {
    double h, origin[3]; /* edge [m]; corner of the cell (0, 0, 0) [m] */
};

/* What the constants of a cell depend on. */
struct lattice_kind {
    int material, grid;
};

/* How well the cells that a body has cut, before later bodies took some, fill its shape. */
struct lattice_fit {
    double cells[3], shape[3]; /* extents of the cells and of the shape [m] */
    double volume;             /* of the cells over that of the shape without its holes' [1] */
    double radius; /* smallest radius of the shape and its holes [m]; infinite: none is round */
    bool is_box;   /* the shape, apart from holes */
};

struct lattice_cells {
    int64_t n; /* the global id is the index; sorted by grid, z, y, x */
    struct lattice_grid *grid;
    int n_grid;
    struct lattice_kind *kind;
    int n_kind;                  /* at most 255 */
    int32_t (*at)[3];            /* [n] place on its grid, from 0 */
    uint8_t *kind_of;            /* [n] */
    int16_t *body;               /* [n] index into scene.body */
    uint16_t *bits;              /* [n] links and fixed DOF */
    int32_t *row;                /* [n] row of loads; 0: no load */
    int32_t *share_of;           /* [n] row of `share`, 0: a whole cell; NULL: all are */
    struct lattice_share *share; /* [n_share]; NULL together with share_of */
    int n_share;
    /* [n] velocity at time 0 [m/s]: 0 of a fixed DOF, as prescribed of a prescribed one; NULL: all
     * zero */
    double (*v)[3];
    double (*w)[3];          /* [n] likewise, angular [rad/s]; NULL together with v */
    int64_t *n_of_body;      /* [scene.n_body] cells of each */
    struct lattice_fit *fit; /* [scene.n_body] */
    struct lattice_loads *loads;
};

/* NULL with messages in `errors`, each with the place in the scene file, where a body or boundary
 * cannot be. Not collective. */
struct lattice_cells *lattice_cells_create(const struct scene *scene, struct scene_errors *errors);
void lattice_cells_free(struct lattice_cells *cells);

/* A warning for each body whose volume, or extent where it is a box, the cells miss by more than
 * 1 %, with the nearest sizes of cells that fit a box so well, if there are any; where it moves
 * too far for single precision; and where a relaxation ignores its velocity. */
void lattice_fit_warnings(
    const struct scene *scene, const struct lattice_cells *cells, struct scene_errors *warnings);

/* Shares of cell i; never NULL. */
const struct lattice_share *lattice_cells_share(const struct lattice_cells *cells, int64_t i);
/* Centre of cell i [m]. */
void lattice_cells_centre(const struct lattice_cells *cells, int64_t i, double x[3]);
/* For every cell the one beyond its upper face along the axis, linked or not, or -1. upper [n]. */
void lattice_cells_upper(const struct lattice_cells *cells, int axis, int32_t *upper);

#endif
