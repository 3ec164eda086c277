/* All cells of the body in runs along x, and who is whose neighbour. Host only; see lattice_layout.h. */
#ifndef DEMOCLES_LATTICE_PLACES_H
#define DEMOCLES_LATTICE_PLACES_H

#include "lattice_cells.h"

/* A run's place: sorted by grid, z, y, x. */
struct lattice_place {
    int32_t grid, z, y, x;
};

struct lattice_places {
    int run, n_run;
    struct lattice_place *place; /* [n_run] */
    int32_t *cell;               /* [n_run][run] gid, or -1 */
    int32_t *run_of;             /* [n] */
};

struct lattice_places *lattice_places_create(const struct lattice_cells *cells, int run);
void lattice_places_free(struct lattice_places *p);
/* How many runs of that length there are. */
int64_t lattice_places_count(const struct lattice_cells *cells, int run);
/* Number of the run beside: axis 0, 1, 2; step -1 or 1; -1: there is none. */
int lattice_places_beside(const struct lattice_places *p, int run, int axis, int step);
/* The cell over a face (bit of the mask), linked or not; -1: there is none. */
int64_t lattice_places_neighbour(const struct lattice_places *p, const struct lattice_cells *cells, int64_t gid, int face);

#endif
