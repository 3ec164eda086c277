/* An exchange within a step, the same for all that travels between ranks: the host's part (when it
 * sleeps, sends and looks for what has arrived), how long that takes (timer.h) and where it stands
 * in the timeline (trace.h), and the buffers and commands that records pass through. What a record
 * means, and how it gets from the device's state into `packed` and from the arrivals into the
 * state, is the caller's business.
 *
 * Order of calls: begin, (kernels that need no arrivals enqueued), swap, (kernels on arrivals). */
#ifndef DEMOCLES_EXCHANGE_H
#define DEMOCLES_EXCHANGE_H

#include "comm/halo.h"
#include "launch.h"
#include "base/timer.h"

struct exchange {
    struct device *dev; /* borrowed */
    struct halo *halo;  /* of the present plan; NULL before the first */
    int64_t n_send, n_recv;
    size_t record; /* [byte] */
    /* [n_send], [n_recv] records; arrived: only where exchange_bind was asked for it */
    struct buffer packed, arrived;
    struct buffer send_staging, recv_staging; /* the same on the host */
    struct halo_traffic before;               /* sent under earlier plans */
    cl_event packed_event, read_event, written_event;
};

/* name: of packed, arrived, and the staging buffers. */
void exchange_init(struct exchange *x, struct device *dev, const char *const name[4]);
void exchange_free(struct exchange *x);

/* A new plan: count_to [n_rank] records to each rank. Nothing may be under way. Collective. */
void exchange_plan(struct exchange *x, const struct comm *comm, const int64_t *count_to);
/* Records of so many bytes from now on, and room for them. has_arrived: also on the device, else
 * arrivals go to where exchange_swap is told. */
void exchange_bind(struct exchange *x, size_t record, bool has_arrived);

/* Completes the sends of the exchange before, enqueues `pack`, which fills x->packed with n_send
 * records, and its read-back, and posts receives. */
void exchange_begin(struct exchange *x, struct launch *pack, struct timers *timers);
/* Sends, waits for arrivals, enqueues their copy to `to` at `offset` bytes. Returns the event that
 * kernels on arrivals have to wait for (borrowed). `nearly_done`: of the kernels that run
 * meanwhile, an event shortly before their end, released here: a host that shares cores with the
 * device sleeps until then, instead of taking time from it by looking. Pack kernel and all before
 * it are done when this returns: what is enqueued then, on whichever queue, cannot overtake
 * kernels that read the arrivals before. */
const cl_event *exchange_swap(struct exchange *x, struct buffer *to, size_t offset,
    cl_event *nearly_done, struct timers *timers);

/* Before the plan or the staging buffers change: nothing is under way afterwards. */
void exchange_settle(struct exchange *x);
/* By this rank within steps since the start. */
struct halo_traffic exchange_sent(const struct exchange *x);

#endif
