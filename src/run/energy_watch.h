/* Energy from nowhere ends a run: whatever the method. */
#ifndef DEMOCLES_ENERGY_WATCH_H
#define DEMOCLES_ENERGY_WATCH_H

#include "sim.h"

/* Round-off of a potential [J]. */
#define ENERGY_WATCH_SPARE(gravity) (1e-9 * fabs(gravity))

/* Ends the run (exit code 5) where the balance error of the measured energy is not a number, or,
 * unless the scene allows an unstable step, more than ten times what was there at the start and
 * has been supplied since, plus `spare` for round-off; all in J and the same on every rank.
 * (Coarse steps, still stable, may be off by about once while a contact lasts.) Collective. */
void energy_watch(struct sim *s, double balance, double supplied, double spare);

#endif
