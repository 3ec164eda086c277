/* The part of a curved surface in a cell that it cuts, and loads on it. */
#ifndef DEMOCLES_LATTICE_FACET_H
#define DEMOCLES_LATTICE_FACET_H

#include "lattice_cells.h"

/* Vector area outwards, what the covered parts of the six faces lack to a closed surface [whole
 * faces]; returns its size, 0 where there is none to speak of. */
double lattice_facet_area(const struct lattice_share *share, double area[3]);
/* Adds to the row `value` the traction of a force that is shared over `all` whole faces, or, force
 * NULL, a pressure. h: edge [m]. */
void lattice_facet_load(const struct lattice_share *share, double h, const double *force,
    double all, double pressure, double *value);

#endif
