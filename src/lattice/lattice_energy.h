/* Energies and momenta of a lattice in its observed state (lattice.h), over all ranks, with the
 * same bits on any number of them. Needs double precision on the device. */
#ifndef DEMOCLES_LATTICE_ENERGY_H
#define DEMOCLES_LATTICE_ENERGY_H

#include "lattice.h"
#include "run/energy_terms.h"

/* NaN: not known, because nothing asks for it (work, link_damping, mass_damping, released:
 * features.energy), because the device has no double precision (all), or because some term was NaN
 * or beyond measure (kernels/common/sums.h). */
struct lattice_energy {
    double kinetic, rotational; /* [J] */
    double gravity;             /* [J], 0 where cells began */
    /* [J]: links, volumes, and the stretched halves at faces with a traction */
    double elastic;
    /* [J] of loads and of prescribed motion, since the account was opened */
    double work;
    double link_damping, mass_damping; /* [J] taken since then */
    double released;                   /* [J] by links that broke, since the start */
    double momentum[3];                /* [kg m/s] */
    double angular[3];                 /* [J s] about the origin of coordinates */
    double n_strained; /* links beyond a strain of 0.1 or a relative turn of 0.5 rad */
};

struct lattice_account;

/* Opens the account: at the start or at an observed step. `cells`, those of the lattice, are
 * borrowed during the call only; the lattice is for life. Collective. */
struct lattice_account *lattice_energy_create(struct lattice *l, const struct lattice_cells *cells);
void lattice_energy_free(struct lattice_account *a); /* NULL is fine */
/* What was in the ledgers when the account was opened: work, and what damping of links and of
 * masses took [J]; and the other way. */
enum { LATTICE_ENERGY_OPENED = 3 };
void lattice_energy_opened(const struct lattice_account *a, double with[LATTICE_ENERGY_OPENED]);
void lattice_energy_reopen(struct lattice_account *a, const double with[LATTICE_ENERGY_OPENED]);
/* Collective. */
void lattice_energy_now(struct lattice_account *a, struct lattice_energy *out);

/* The terms in the order of columns and of the record: energy_terms.h, over struct
 * lattice_energy. */
extern const struct energy_term lattice_energy_table[];

/* Kinetic, rotational, elastic energy, gravity's, what damping took and breakage released, less the
 * work; now minus start [J]: zero in exact arithmetic and with an infinitely small step, else it
 * vanishes with the scheme's order (what is released: with the second, by splittings that begin
 * with a kick). */
double lattice_energy_balance(const struct lattice_energy *start, const struct lattice_energy *now);
/* What was there at the start, and came since [J]: what a balance error is measured by. */
double lattice_energy_supplied(
    const struct lattice_energy *start, const struct lattice_energy *now);

#endif
