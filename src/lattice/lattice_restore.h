/* The lattice's state in frames, beyond the fields that a user sees, and its restart from a frame:
 * on any owners, cell by cell. */
#ifndef DEMOCLES_LATTICE_RESTORE_H
#define DEMOCLES_LATTICE_RESTORE_H

#include "lattice_method.h"

enum {
    LATTICE_RESTORE_TOTALS = sizeof(struct lattice_energy) / sizeof(double) +
                             LATTICE_ENERGY_OPENED + LATTICE_RELAX_NOTES + 4
};

/* Adds what the next step depends on, besides the motion and the links, to the cells of now. */
void lattice_restore_take(const struct sim *s, struct lattice_state *state);
/* [LATTICE_RESTORE_TOTALS] of the run as a whole, the same on all ranks; the caller frees. */
double *lattice_restore_totals(const struct sim *s);

/* Checksum of cells and loads, as the scene makes them. */
int64_t lattice_restore_inputs(const struct sim *s);
/* Whether the frame s->from has an account of energy, which then goes on; one that is asked for and
 * is not there ends the run. Collective. */
bool lattice_restore_energy(const struct sim *s, bool asked);
/* Cells from the frame, once the lattice is there; then the rest, once the account and what leads
 * to rest are. Collective. */
void lattice_restore_cells(struct sim *s);
void lattice_restore_run(struct sim *s);

#endif
