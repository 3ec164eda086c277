/* Time integrators of the lattice as tables. Coefficients in parts of the step; sources in
 * lattice_schemes.c. */
#ifndef DEMOCLES_LATTICE_SCHEMES_H
#define DEMOCLES_LATTICE_SCHEMES_H

#include <stdbool.h>

#include "lattice_limit.h"

enum { LATTICE_STAGES = 4 };

/* One evaluation of the forces and what follows: kick, kick, drift. */
struct lattice_op {
    double end, begin; /* kicks: the one that ends a step, the one of this step */
    double drift;
};

/* A stage of a Runge-Kutta scheme; as struct lattice_stage of kernels/lattice/lattice_state.h,
 * without the powers of dt. */
struct lattice_rk {
    double at; /* time of the stage */
    double sum_v, sum_a, next_v, next_a, sum_k, next_k;
    double next_turn, sum_turn; /* intervals of commutators */
    /* what the balance of energy adds to v: struct lattice_speed of
     * kernels/lattice/lattice_work.h */
    double before, own;
};

struct lattice_table {
    const char *name;
    bool is_rk, is_nystrom;
    /* the last kick of a step has the forces of the next step's first: one evaluation */
    bool ends_with_kick;
    double first; /* drift before the first evaluation */
    int n;        /* evaluations per step */
    struct lattice_op op[LATTICE_STAGES];
    struct lattice_rk rk[LATTICE_STAGES];
};

const struct lattice_table *lattice_schemes_table(enum lattice_scheme scheme);

#endif
