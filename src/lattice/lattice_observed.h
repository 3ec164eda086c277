/* What the measures of a lattice need besides the rank's own cells, at the time of the observed
 * state: ghosts, loads and pressures. */
#ifndef DEMOCLES_LATTICE_OBSERVED_H
#define DEMOCLES_LATTICE_OBSERVED_H

#include "lattice.h"

/* Enqueues it; with_pressure: p of all cells too. Nothing that goes on from the step reads what
 * this changes. Collective. */
void lattice_observed_refresh(struct lattice *l, bool with_pressure);
/* Has a kernel read the observed state. */
void lattice_observed_bind(const struct lattice *l, struct launch *launch);

#endif
