/* The account of energy and momentum of a run.
 *
 * Kernels note per contact what each step took (ledger.h); here it is added up, with what elements
 * have by their places and velocities, in integers (sums.h), so that every number has the same bits
 * on any number of ranks. Needs double precision on the device. Knows no law.
 *
 * Gravity's potential is zero at the low corner of the domain. An element that goes round a period
 * against or along gravity keeps its account: the jump of its place is taken out. A wall that
 * appears where an element already is brings energy that is not accounted for. */
#ifndef DEMOCLES_ENERGY_H
#define DEMOCLES_ENERGY_H

#include <stdint.h>

#include "kernels/contact/ledger.h"
#include "kernels/common/sums.h"
#include "run/energy_terms.h"

struct device;
struct sim;
struct energy; /* totals since the start, on this rank */

/* All ranks together; losses, wall_work and removed since the start of the run. NaN: not known,
 * because nothing measures the energy (elastic, losses, wall_work, removed), because the device has
 * no double precision (all), or because some term was NaN or beyond measure. */
struct energy_sums {
    double kinetic, rotational, gravity, elastic; /* [J] */
    /* [J] taken by contacts */
    double dashpot_normal, dashpot_tangential, sliding, rolling, bonds;
    double wall_work; /* [J] given by moving walls */
    /* [J] that left with elements, and springs whose element or wall went */
    double removed;
    /* [kg m/s]; [J s] about the origin of coordinates */
    double momentum[3], angular[3];
};

/* Collective. Before or after the lists; needs s->dev, features, scene, domain, wall_contacts. */
struct energy *energy_create(struct sim *s);
void energy_free(struct energy *e); /* NULL is fine */

/* The three below are for runs with features.energy. Before lists are rebuilt and before elements
 * change owners: moves the losses in both ledgers to this rank's totals. Not collective. */
void energy_collect(struct sim *s);
/* After owners_move, while the lists are still the old ones: elements in s->owners->removed,
 * n_removed on all ranks together, and walls that end at s->step, leave with what they have. An
 * element's velocity is taken half a step on, by gravity alone. Collective. */
void energy_moved(struct sim *s, int64_t n_removed);

/* Totals since the start, of all ranks together, as whole numbers: for a frame, and back from
 * one. */
enum { ENERGY_TOTALS = LEDGER_WIDTH + 2 };
void energy_totals(const struct sim *s, int64_t total[ENERGY_TOTALS][SUMS_WIDTH]); /* collective */
/* on rank 0 these, on the others none */
void energy_restore(struct sim *s, const int64_t total[ENERGY_TOTALS][SUMS_WIDTH]);

/* The state on the device is an observed one. Collective. */
void energy_now(struct sim *s, struct energy_sums *out);

/* The terms in the order of columns and of the record: energy_terms.h, over struct energy_sums. */
extern const struct energy_term energy_table[];

/* E_kin + E_rot + E_el + E_g + losses + removed - wall_work, now minus start [J]: zero in exact
 * arithmetic and with an infinitely small step. */
double energy_balance(const struct energy_sums *start, const struct energy_sums *now);
/* What was there at the start, and came since [J]: what a balance error is measured by. */
double energy_supplied(const struct energy_sums *start, const struct energy_sums *now);

#endif
