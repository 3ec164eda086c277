/* What the steps of a run amount to: elements times steps for the rate, and what the plain steps
 * have moved, allocated and launched, which shows that a step sends ghosts and flags alone and
 * allocates nothing. A plain step is one without list rebuild, observation, or observation in the
 * step before. */
#ifndef DEMOCLES_ACCOUNT_H
#define DEMOCLES_ACCOUNT_H

#include "device/device.h"

struct sim;

struct account {
    double element_steps; /* elements times steps so far */
    int64_t n_plain;
    struct device_counters plain; /* sums over the plain steps */
    /* of the step under way */
    bool may_be_plain;
    struct device_counters before;
    int64_t rebuilds_before;
};

/* Around everything that a step does. Not collective. */
void account_begin(struct account *account, const struct sim *s);
void account_end(struct account *account, const struct sim *s);

#endif
