/* Ghosts: copies of other ranks' elements that may touch ours, fetched anew each step while the
 * device works on pairs that need none.
 *
 * Who is whose ghost is decided when lists are built, from the tree of cuts, the boxes of what each
 * rank owns and the listing reaches: any partition, any thinness of a subdomain, empty ranks. In a
 * step: begin packs on the device and reads back, swap moves the messages, and the arrived records
 * go behind the owned ones as they are. Knows records, trees, boxes and reaches; no pairs. */
#ifndef DEMOCLES_GHOSTS_H
#define DEMOCLES_GHOSTS_H

#include "device/exchange.h"
#include "owners.h"

struct ghosts {
    const struct comm *comm;
    const struct features *features;
    double period[3];
    struct exchange exchange;  /* of state records */
    struct buffer index, pick; /* [exchange.n_send] send order; scan scratch */
    struct launch *select, *compact, *gather;
    struct launch *pack; /* gathers the states of a step */
};

struct ghosts *ghosts_create(struct device *dev, const struct comm *comm,
    const struct features *features, const struct program *lists, const double period[3]);
void ghosts_free(struct ghosts *g);

/* New plan and all that is static of new ghosts (state, gid, reach) behind the owned elements,
 * which are where owners_move has brought them. `own`: bounds of owned elements. Collective. */
void ghosts_plan(struct ghosts *g, const struct owners *owners, struct scan *scan,
    struct particles *p, const struct cells_bounds *own);

/* All states anew, outside of a step: blocking, collective. */
void ghosts_refresh(struct ghosts *g, struct particles *p);

/* Enqueues packing of what others need and its read-back, posts receives. */
void ghosts_begin(struct ghosts *g, struct timers *timers);
/* Sends, waits for arrivals, enqueues their copy to the device. `nearly_done`: see exchange_swap.
 * Returns the event that kernels on ghosts have to wait for (borrowed), NULL if there is nothing
 * to wait for. */
const cl_event *ghosts_swap(
    struct ghosts *g, struct particles *p, cl_event *nearly_done, struct timers *timers);

#endif
