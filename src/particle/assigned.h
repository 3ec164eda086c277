/* Pairs that a border cuts, computed on one of their two ranks (the rule:
 * kernels/particle/assign.cl), their results sent back to the other; in place of computing them on
 * both (partition.boundary).
 *
 * Boundary pairs computed here are then the first n_mine of a list; those of other ranks come
 * behind them, with places for results that arrive in each step, before the gather. What a pair
 * remembers is kept where it is computed, and so are its losses; the other rank knows it only right
 * after assigned_complete. Ghosts whose pairs are all computed elsewhere are as they were when
 * lists were built, until ghosts_refresh. Results are of one orientation whoever computes them, so
 * no bit depends on who does. */
#ifndef DEMOCLES_ASSIGNED_H
#define DEMOCLES_ASSIGNED_H

#include "device/exchange.h"
#include "ghosts.h"
#include "pairs.h"

struct assigned;

/* What travels in a step: states of elements to where pairs of theirs are computed, in place of all
 * ghosts; then results back. */
enum assigned_way { ASSIGNED_STATES, ASSIGNED_RESULTS, ASSIGNED_N };

/* assign: program of assign.cl; lists: that with records.cl. */
struct assigned *assigned_create(struct device *dev, const struct comm *comm,
    const struct program *assign, const struct program *lists, size_t real);
void assigned_free(struct assigned *a); /* NULL is fine */

/* Orders pairs->now, new from pairs_build, by who computes what, and plans what travels. Nothing
 * may be under way. Collective. */
void assigned_build(struct assigned *a, struct scan *scan, const struct particles *p,
    struct pairs *pairs, const struct ghosts *ghosts);

/* Within a step, each way in turn: enqueues packing and its read-back, posts receives. */
void assigned_begin(struct assigned *a, enum assigned_way way, struct timers *timers);
/* Sends, waits for arrivals, enqueues what puts them in place. `nearly_done`: see exchange_swap. */
void assigned_swap(
    struct assigned *a, enum assigned_way way, cl_event *nearly_done, struct timers *timers);

/* States and histories of all pairs of pairs->now to the ranks that do not compute them, before
 * lists are built anew: nothing is under way afterwards. Collective. */
void assigned_complete(struct assigned *a, struct pairs *pairs);

const struct exchange *assigned_exchange(const struct assigned *a, enum assigned_way way);

#endif
