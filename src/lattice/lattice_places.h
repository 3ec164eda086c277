/* All cells of the bodies, in runs along one of the axes, and the neighbours of each run. Host
 * only; see lattice_layout.h. */
#ifndef DEMOCLES_LATTICE_PLACES_H
#define DEMOCLES_LATTICE_PLACES_H

#include "lattice_cells.h"

/* How runs lie. */
struct lattice_lay {
    int axis, length; /* 0, 1, 2; cells */
};

/* A run's place: number of the run along its axis, and its rows along the lower (near) and the
 * higher (far) of the other two. Sorted by grid, far, near, along. */
struct lattice_place {
    int32_t grid, far, near, along;
};

struct lattice_places {
    struct lattice_lay run;
    int n_run;
    struct lattice_place *place; /* [n_run] */
    int32_t *cell;               /* [n_run][run.length] gid, or -1 */
    int32_t *run_of;             /* [n] */
};

struct lattice_places *lattice_places_create(
    const struct lattice_cells *cells, struct lattice_lay run);
void lattice_places_free(struct lattice_places *p);
/* The cells in the order of runs along an axis; the caller frees. [n] */
int32_t *lattice_places_order(const struct lattice_cells *cells, int axis);
/* How many such runs there are. order: along run.axis. n_mixed: of them those of several kinds, or
 * with loads or fixed DOF; NULL: not asked for. */
int64_t lattice_places_count(const struct lattice_cells *cells, struct lattice_lay run,
    const int32_t *order, int64_t *n_mixed);
/* Place of a cell in its run. */
int lattice_places_lane(
    const struct lattice_places *p, const struct lattice_cells *cells, int64_t gid);
/* Number of the run beside: axis 0, 1, 2; step -1 or 1; -1: there is none. */
int lattice_places_beside(const struct lattice_places *p, int run, int axis, int step);
/* The cell over a face (bit of the mask), linked or not; -1: there is none. */
int64_t lattice_places_neighbour(
    const struct lattice_places *p, const struct lattice_cells *cells, int64_t gid, int face);

#endif
