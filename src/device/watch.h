/* Votes between steps: lists that are used up, elements that are lost, a request to stop. All ranks
 * agree on them without stopping the pipeline.
 *
 * The flags of the drift that led to step n, a multiple of WATCH_EVERY, are read back and voted on
 * while the forces of step n are computed, and the result is known before those of step n + 1.
 * Lists are therefore declared stale before they are (margin of integrate.h), at the same step on
 * any number of ranks. */
#ifndef DEMOCLES_WATCH_H
#define DEMOCLES_WATCH_H

#include "buffer.h"
#include "kernels/common/flags.h"

enum { WATCH_STALE = 1, WATCH_LOST = 2, WATCH_STOP = 4 };
/* Each look costs a copy and a message. The margin, in steps' way: those until the host acts, and
 * as much again for speeds that change. */
enum { WATCH_EVERY = 4, WATCH_MARGIN = 2 * WATCH_EVERY };

/* Whether flags are looked at beside the forces of the step. */
static inline bool watch_due(int64_t step)
{
    return step % WATCH_EVERY == 0;
}

struct watch {
    cl_event read;        /* of the flags after the last drift */
    int32_t flag[FLAG_N]; /* where they go */
    struct comm_vote vote;
};

/* After a drift: begins to read the flags. */
void watch_read(struct watch *w, const struct buffer *flags);
/* Beside the next step: joins what was read with `own` (WATCH_STOP) and begins the vote.
 * Collective. */
void watch_vote(struct watch *w, const struct comm *comm, int32_t own);
/* What was agreed, WATCH_ bits; 0 if no vote is open. */
int32_t watch_agreed(struct watch *w, const struct comm *comm);
/* Forgets flags and votes under way; all ranks at the same step. */
void watch_reset(struct watch *w, const struct comm *comm, struct buffer *flags);

#endif
