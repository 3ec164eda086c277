/* The parts of the lattice method, by file: lattice_method.c, lattice_frame.c, lattice_measures.c.
 * What step.h describes is not described again. */
#ifndef DEMOCLES_LATTICE_METHOD_H
#define DEMOCLES_LATTICE_METHOD_H

#include "lattice_break.h"
#include "lattice_energy.h"
#include "lattice_input.h"
#include "lattice_relax.h"
#include "lattice_stress.h"
#include "run/sim.h"

extern const struct step_ops lattice_ops;

/* What a run of the lattice has besides what struct sim holds. */
struct lattice_run {
    struct lattice_cells *cells; /* of all ranks */
    struct lattice_input *input;
    struct lattice *lattice;
    struct lattice_stress *stress; /* NULL where nobody asks for it */
    struct lattice_relax *relax;   /* NULL: a motion, not a state of rest */
    struct lattice_account *account;
    struct lattice_energy energy_start;
};

/* The observed state of this rank's cells on the host, and where their centres were at the start;
 * [n] in ascending id. */
struct lattice_state {
    int64_t n;
    const int64_t *gid; /* borrowed */
    /* [m], [m], see below, [m/s], [rad/s] */
    double (*centre)[3], (*u)[3], (*turn)[4], (*v)[3], (*w)[3];
    /* [Pa]; NULL where the scene does not ask for them */
    double (*stress)[9], *von_mises;
    /* lattice_break.h, NULL where nothing breaks; how many links it has lost */
    int32_t *links, *fate, *broken;
    /* what lattice_restore_take adds for a frame: lattice_read_before, the rows of the ledger
     * [LATTICE_LEDGER] [J], lattice_break_read_release; NULL where the run does not have it */
    double (*v_before)[3], (*w_before)[3], *ledger;
    int32_t *fresh;
    double *released;
    /* 4: turn is a quaternion w, x, y, z; 3: a small rotation [rad], the fourth is 0 */
    int turn_width;
};
struct lattice_state *lattice_state_create(const struct sim *s); /* collective */
void lattice_state_free(struct lattice_state *state);            /* NULL is fine */
/* R r - r, or theta x r, of cell i for a vector r of the undeformed cell [m]. */
void lattice_state_turn(
    const struct lattice_state *state, int64_t i, const double r[3], double out[3]);

void lattice_method_frame(struct sim *s, int64_t index);
int lattice_method_measure_columns(const struct sim *s, const struct measure *measure,
    struct series_column column[STEP_MEASURE_COLUMNS]);
void lattice_method_measure(struct sim *s, const bool *due, double (*value)[STEP_MEASURE_COLUMNS]);

#endif
