/* How far a run can be trusted: a few numbers that it knows at its end, each with the range in
 * which errors stay below 1 % (docs/accuracy.md says where it comes from), as a group of run.json,
 * a line of the log, and a warning that names the key to change. */
#ifndef DEMOCLES_TRUST_H
#define DEMOCLES_TRUST_H

#include "results/report.h"
#include "sim.h"

/* The same on any number of ranks; NaN: not known, or the method has no such thing. */
struct trust {
    double energy_error;  /* [1] |balance error| over the energy that was supplied */
    double step;          /* [1] time step over the smallest critical one; by trust_report */
    double contact_steps; /* [1] time steps in the shortest contact that the scene allows */
    double overlap;       /* [1] largest overlap over the smaller radius */
    double slipping;      /* [1] share of the pairs with friction that slip, at the end */
    double list_room;     /* [1] largest displacement over the room that the lists gave */
};

extern const struct trust trust_unknown;

/* |balance| over what was supplied; spare: what rounding may add [J]. */
double trust_energy(double balance, double supplied, double spare);
/* The entry "trust", the line and the warning. Collective. */
void trust_report(const struct sim *s, struct report *r, struct trust trust);

#endif
