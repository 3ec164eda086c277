/* Which rank has which cells: cut once, by the scene's method. Every rank has all cells and gets
 * all owners. Knows no device. */
#ifndef DEMOCLES_LATTICE_OWNERS_H
#define DEMOCLES_LATTICE_OWNERS_H

#include "partition/partition.h"
#include "lattice_features.h"

/* Rank of each cell [cells->n], by options->partition and options->share, in runs along run_axis;
 * the caller frees. Collective. */
int *lattice_owners(const struct comm *comm, const struct lattice_cells *cells,
    const struct lattice_options *options, int run_axis);
/* The part of `rank`: its work in cells and links, links between its cells and others; neighbours
 * as given. Not collective. */
struct partition_part lattice_owners_part(
    const struct lattice_cells *cells, const int *owner, int rank, int64_t neighbours);

#endif
