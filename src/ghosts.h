/* Ghosts: copies of other ranks' elements that may touch ours, fetched anew each step while the device works on pairs that need none.
 *
 * Who is whose ghost is decided when lists are built, from the tree of cuts, the boxes of what each rank owns and the listing reaches: any partition,
 * any thinness of a subdomain, empty ranks. In a step: begin packs on the device and reads back, swap moves the messages, and the arrived records go
 * behind the owned ones as they are. Knows records, trees, boxes and reaches; no pairs. */
#ifndef DEMOCLES_GHOSTS_H
#define DEMOCLES_GHOSTS_H

#include "../comm/halo.h"
#include "exchange.h"
#include "owners.h"

struct ghosts {
    const struct comm *comm;
    const struct features *features;
    double period[3];
    struct halo *halo;
    int64_t n_send, n_recv;
    size_t record;             /* bytes of one state record */
    struct buffer index, pick; /* send order; scan scratch */
    struct buffer packed;      /* [n_send] records */
    struct buffer send_staging, recv_staging;
    struct launch *select, *compact, *gather;
    struct halo_traffic before; /* sent under earlier plans */
    cl_event packed_event, read_event, written_event;
};

struct ghosts *ghosts_create(
    struct device *dev, const struct comm *comm, const struct features *features, const struct program *lists, const double period[3]);
void ghosts_free(struct device *dev, struct ghosts *g);

/* New plan and all that is static of new ghosts (state, gid, reach) behind the owned elements, which are where owners_move has brought them. `own`:
 * bounds of owned elements. Collective. */
void ghosts_plan(
    struct device *dev, struct ghosts *g, const struct owners *owners, struct scan *scan, struct particles *p, const struct cells_bounds *own);

/* Enqueues packing of what others need and its read-back, posts receives. */
void ghosts_begin(struct device *dev, struct ghosts *g, const struct particles *p, struct timers *timers);
/* Sends, waits for arrivals, enqueues their copy to the device. `most`: see exchange_receive. Returns the event that kernels on ghosts have to wait
 * for (borrowed), NULL if there is nothing to wait for. */
const cl_event *ghosts_swap(struct device *dev, struct ghosts *g, struct particles *p, cl_event *most, struct timers *timers);
/* By this rank within steps since the start. */
struct halo_traffic ghosts_sent(const struct ghosts *g);
/* Before the plan or the staging buffers change: nothing is under way afterwards. */
void ghosts_settle(struct device *dev, struct ghosts *g);

#endif
