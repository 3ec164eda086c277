/* How well the cells of a body fill its shape. Knows no device and no MPI. */
#ifndef DEMOCLES_LATTICE_FIT_H
#define DEMOCLES_LATTICE_FIT_H

#include "lattice_cells.h"
#include "scene/scene.h"

struct lattice_fit {
    double cells[3], shape[3]; /* extents of the cells and of the shape [m] */
    double volume;             /* of the cells over that of the shape without its holes' [1] */
    double radius; /* smallest radius of the shape and its holes [m]; infinite: none is round */
    bool is_box;   /* the shape, apart from holes */
};

/* The shape's volume is counted at the middles of 48^3 equal parts of its bounding box: exact for a
 * box, to some 0.1 % for round ones. Where the shape cannot be opened all is 0. */
struct lattice_fit lattice_fit_of(
    const struct scene *scene, const struct lattice_cells *cells, int body);

/* A warning for each body whose volume, or extent where it is a box, the cells miss by more than
 * 1 %, with the nearest sizes of cells that fit a box so well, if there are any. */
void lattice_fit_warnings(
    const struct scene *scene, const struct lattice_cells *cells, struct scene_errors *warnings);

#endif
