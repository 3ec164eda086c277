#include "watch.h"

static void wait_read(struct watch *w)
{
    if (!w->read) return;
    check_cl(clWaitForEvents(1, &w->read));
    check_cl(clReleaseEvent(w->read));
    w->read = NULL;
}

void watch_read(struct watch *w, const struct buffer *flags)
{
    wait_read(w);
    buffer_read_begin(flags, flags->dev->compute, 0, sizeof w->flag, w->flag, NULL, &w->read);
    check_cl(clFlush(flags->dev->compute));
}

void watch_vote(struct watch *w, const struct comm *comm, int32_t own)
{
    if (w->read) {
        wait_read(w);
        own |= (w->flag[FLAG_STALE] ? WATCH_STALE : 0) | (w->flag[FLAG_LOST] ? WATCH_LOST : 0);
    }
    comm_vote_begin(comm, &w->vote, own);
}

int32_t watch_agreed(struct watch *w, const struct comm *comm)
{
    return comm_vote_end(comm, &w->vote);
}

void watch_reset(struct watch *w, const struct comm *comm, struct buffer *flags)
{
    wait_read(w);
    comm_vote_end(comm, &w->vote);
    buffer_zero(flags);
}
