/* What a method offers the main loop, the record and the measures.
 *
 * The protocol of a step. Between two steps the state on the device is either under way or
 * observed:
 *
 *     under way to t^n    positions x^n, velocities v^{n-1/2}
 *     observed at t^n     positions x^n, velocities v^n: what output, measures and digests see
 *
 *                    advance(observe: false)
 *     under way to t^n ----------------------> under way to t^{n+1}
 *            |          forces at t^n, kick,
 *            |          next kick and drift
 *            | advance(observe: true)
 *            |   forces at t^n, kick
 *            v                      begin_step
 *     observed at t^n ------------------------> under way to t^{n+1}
 *                          next kick and drift
 *
 * A run starts observed at t^0. Whether a step is observed changes no bit of the states that
 * follow.
 *
 * Schemes of the lattice that do not end a step with a kick (Runge-Kutta, and splittings that begin
 * with a drift) know no state under way: their advance takes the whole step from t^{n-1} to t^n,
 * and begin_step does nothing. */
#ifndef DEMOCLES_STEP_H
#define DEMOCLES_STEP_H

#include <stdbool.h>
#include <stdint.h>

#include "comm/halo.h"
#include "scene/scene.h"
#include "results/series.h"

enum {
    STEP_MEASURE_COLUMNS = 32, /* most columns of a measure besides the time */
    STEP_LAUNCHES = 16,        /* most kernels that a method names */
};

struct launch;
struct report;
struct sim;

/* Of one rank. */
struct step_counts {
    int64_t n_interaction;
    struct halo_traffic sent; /* within steps, since the start */
    int n_neighbour;          /* ranks that it sends to, now */
    int64_t n_boundary;       /* elements that it sends them, now; one that two need counts twice */
};

/* A kernel of the step, by the name that run.json gives it. */
struct step_launch {
    const char *name;
    struct launch *launch; /* NULL: this scene does without */
};

/* NULL stands for nothing to do, where it says so. */
struct step_ops {
    const char *name;
    /* Set-up, in this order. */
    /* what the scene names, into elements; mistakes end all ranks. No device yet. Collective */
    void (*read)(struct sim *s);
    void (*plan)(struct sim *s); /* features, extent, time step */
    /* kernels, elements on their ranks, forces at step 0; state then observed. Says how many
     * elements there are */
    void (*setup)(struct sim *s);
    void (*warn)(struct sim *s); /* of what is allowed, but not wise. May be NULL */
    void (*free)(struct sim *s);

    /* The loop. */
    /* whether something the host knows of asks for new lists before this step. May be NULL */
    bool (*stale)(struct sim *s);
    /* owners, ghosts, lists: collective and rare. May be NULL: nothing ever moves */
    void (*regroup)(struct sim *s);
    void (*advance)(struct sim *s, bool observe); /* see above */
    void (*begin_step)(struct sim *s);            /* see above */
    /* of an observed step, against its limit of now; over it, and not allowed:
     * output_stop_numerics */
    void (*check_limit)(struct sim *s);
    /* of an observed step, where sim.rest asks; may set the damping. May be NULL: the method never
     * asks */
    bool (*is_at_rest)(struct sim *s);

    /* Output of an observed step; collective. */
    int64_t (*n_element)(const struct sim *s); /* of all ranks, now; not collective */
    void (*frame)(struct sim *s, int64_t index);
    /* of the file of a measure, besides the time; returns how many */
    int (*measure_columns)(const struct sim *s, const struct measure *measure,
        struct series_column column[STEP_MEASURE_COLUMNS]);
    /* of the scene's measures that are due */
    void (*measure)(struct sim *s, const bool *due, double (*value)[STEP_MEASURE_COLUMNS]);
    bool (*digest)(struct sim *s, uint64_t *digest); /* false: NaN in the state */

    /* The record. */
    int64_t (*n_owned)(const struct sim *s); /* elements of this rank, now */
    /* of this rank; not collective */
    void (*count)(const struct sim *s, struct step_counts *counts);
    void (*report_features)(const struct sim *s, struct report *r);
    /* energies, and what contacts did; observed: the state is that of a full step. Collective */
    void (*report_state)(struct sim *s, struct report *r, bool observed);
    /* the kernels of a step, of this rank; returns how many */
    int (*launches)(const struct sim *s, struct step_launch launch[STEP_LAUNCHES]);
};

#endif
