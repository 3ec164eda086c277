/* Where a rank has its cells: in runs along one of the axes, for kernels/lattice/lattice_view.h.
 *
 * A run is `run` places on the grid, aligned on it (lattice_places.h). A rank has all runs with a
 * cell that it owns or needs as a ghost, sorted, so that the neighbour along the run is the next in
 * memory; one empty run in front and one behind, the first also in place of every neighbouring run
 * that is not there.
 *
 * Index of a cell: run times length, plus lane. Host only; knows owners, no device and no MPI. */
#ifndef DEMOCLES_LATTICE_LAYOUT_H
#define DEMOCLES_LATTICE_LAYOUT_H

#include "lattice_places.h"

#include <stdbool.h>

struct lattice_layout {
    int axis, run; /* of runs: axis, and length, a multiple of 8 */
    int n_run;     /* with the empty ones */
    /* [cells] from one plane to the next: padded, for powers of two cost half the speed */
    int64_t plane;
    int *base; /* [4][n_run] first index of the runs beside: near -, +, far -, + */
    /* [n_run] kind of all cells in and around the run; + 256: kinds differ, or cells have loads or
     * fixed DOF */
    int *info;
    int *word;  /* [plane] kernels/lattice/lattice_state.h */
    int *row;   /* [plane] row of loads */
    int *share; /* [plane] row of shares */
    int64_t n_owned;
    int64_t *gid; /* [n_owned] ascending */
    int *index;   /* [n_owned] */
    /* runs with something to do; those that see no ghost first */
    int *force, n_force, n_force_interior; /* with an owned cell */
    /* with a cell whose p is needed; empty without the volumetric pass */
    int *volume, n_volume, n_volume_interior;
    /* by rank, then gid */
    int64_t n_send, n_recv, *count_to, *count_from; /* counts [n_rank] */
    int *send, *recv;                               /* [n_send], [n_recv] index */
};

/* Axis and length of runs that suit the rows of all cells best. */
struct lattice_lay lattice_layout_run(const struct lattice_cells *cells);
/* owner [n]: rank of each cell. depth: layers of ghosts, 1, or 2 with the volumetric pass. */
struct lattice_layout *lattice_layout_create(const struct lattice_cells *cells, const int *owner,
    int rank, int n_rank, struct lattice_lay run, int depth);
/* Whether ids ascend, each owned cell has a place of its own, and lists stay within the runs. */
bool lattice_layout_is_valid(const struct lattice_layout *layout, int n_rank);
void lattice_layout_free(struct lattice_layout *layout);

#endif
