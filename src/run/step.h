/* What a method offers the main loop, the record and the measures. */
#ifndef DEMOCLES_STEP_H
#define DEMOCLES_STEP_H

#include <stdbool.h>
#include <stdint.h>

#include "comm/halo.h"
#include "scene/scene.h"
#include "results/series.h"

enum { MEASURE_COLUMNS = 16 }; /* most, besides the time */

struct report;
struct sim;

/* Of one rank. */
struct step_counts {
    int64_t n_interaction;
    struct halo_traffic sent; /* within steps, since the start */
    int n_neighbour;          /* ranks that it sends to, now */
    int64_t n_boundary;       /* elements that it sends them, now; one that two need counts twice */
};

struct step_ops {
    const char *name;
    /* Set-up, in this order. */
    /* what the scene names, into elements; mistakes end all ranks. No device yet. Collective */
    void (*read)(struct sim *s);
    void (*plan)(struct sim *s); /* features, extent, time step */
    /* kernels, elements on their ranks, forces at step 0; state then observable. Says how many
     * elements there are */
    void (*setup)(struct sim *s);
    void (*warn)(struct sim *s); /* of what is allowed, but not wise */
    void (*free)(struct sim *s);

    /* The loop. */
    /* whether something the host knows of asks for a regroup before this step */
    bool (*stale)(struct sim *s);
    void (*regroup)(struct sim *s); /* owners, ghosts, lists: collective and rare */
    /* forces at the step; observe: state of this time left on the device, else on to the next */
    void (*advance)(struct sim *s, bool observe);
    void (*resume)(struct sim *s); /* after an observed step: on to the next */
    /* of an observed step, against its limit of now; over it, and not allowed:
     * output_stop_numerics */
    void (*check_limit)(struct sim *s);
    /* of an observed step, where sim.rest asks; may set the damping. NULL: the method never asks */
    bool (*is_at_rest)(struct sim *s);

    /* Output of an observed step; collective. */
    int64_t (*n_element)(const struct sim *s); /* of all ranks, now; not collective */
    void (*frame)(struct sim *s, int64_t index);
    /* how many */
    int (*measure_columns)(enum measure_kind kind, const struct series_column **column);
    /* of the scene's measures that are due */
    void (*measure)(struct sim *s, const bool *due, double (*value)[MEASURE_COLUMNS]);
    /* false: NaN in the state */
    bool (*digest)(struct sim *s, uint64_t *digest);

    /* The record. */
    int64_t (*n_owned)(const struct sim *s); /* elements of this rank, now */
    /* of this rank; not collective */
    void (*count)(const struct sim *s, struct step_counts *counts);
    void (*report_features)(const struct sim *s, struct report *r);
    /* observed: the state is that of a full step. Collective */
    void (*report_energy)(struct sim *s, struct report *r, bool observed);
    /* device time and number of launches, this rank's */
    void (*report_kernels)(const struct sim *s, struct report *r);
};

#endif
