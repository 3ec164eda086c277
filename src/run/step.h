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
    void (*read)(struct sim *s);  /* what the scene names, into elements; mistakes end all ranks. No device yet. Collective */
    void (*plan)(struct sim *s);  /* features, extent, time step */
    void (*setup)(struct sim *s); /* kernels, elements on their ranks, forces at step 0; state then observable. Says how many elements there are */
    void (*warn)(struct sim *s);  /* of what is allowed, but not wise */
    void (*free)(struct sim *s);

    /* The loop. */
    bool (*stale)(struct sim *s);                 /* whether something the host knows of asks for a regroup before this step */
    void (*regroup)(struct sim *s);               /* owners, ghosts, lists: collective and rare */
    void (*advance)(struct sim *s, bool observe); /* forces at the step; observe: state of this time left on the device, else on to the next */
    void (*resume)(struct sim *s);                /* after an observed step: on to the next */
    void (*check_limit)(struct sim *s);           /* of an observed step, against its limit of now; over it, and not allowed: output_stop_numerics */
    bool (*is_at_rest)(struct sim *s);            /* of an observed step, where sim.rest asks; may set the damping. NULL: the method never asks */

    /* Output of an observed step; collective. */
    int64_t (*n_element)(const struct sim *s); /* of all ranks, now; not collective */
    void (*frame)(struct sim *s, int64_t index);
    int (*measure_columns)(enum measure_kind kind, const struct series_column **column); /* how many */
    void (*measure)(struct sim *s, const bool *due, double (*value)[MEASURE_COLUMNS]);   /* of the scene's measures that are due */
    bool (*digest)(struct sim *s, uint64_t *digest);                                     /* false: NaN in the state */

    /* The record. */
    int64_t (*n_owned)(const struct sim *s);                        /* elements of this rank, now */
    void (*count)(const struct sim *s, struct step_counts *counts); /* of this rank; not collective */
    void (*report_features)(const struct sim *s, struct report *r);
    void (*report_energy)(struct sim *s, struct report *r, bool observed); /* observed: the state is that of a full step. Collective */
    void (*report_kernels)(const struct sim *s, struct report *r);         /* device time and number of launches, this rank's */
};

#endif
