/* The halo: bytes of owned elements to the ranks that need them as ghosts, by persistent
 * nonblocking messages.
 *
 * Two CSR tables describe it completely: what I send to each neighbour and what I receive from
 * each. The halo knows ranks and bytes; what a record means, and how it gets from the device into
 * `send` and from `recv` to the device, is the caller's business. Segments lie neighbour after
 * neighbour without gaps, so that the receive buffer is one contiguous block of ghosts in arrival
 * order. */
#ifndef DEMOCLES_HALO_H
#define DEMOCLES_HALO_H

#include "comm.h"

/* What a rank has sent within steps: halo_begin_send, not halo_exchange. */
struct halo_traffic {
    int64_t bytes, messages;
};

struct halo {
    const struct comm *comm;
    /* neighbours that I send to, receive from (this rank may be its own neighbour) */
    int n_send, n_recv;
    int *send_rank, *recv_rank;       /* [n_send], [n_recv], ascending */
    int64_t *send_begin, *recv_begin; /* [n_send + 1], [n_recv + 1], in records */
    size_t record;                    /* bytes per record of the persistent exchange */
    MPI_Request *request;             /* [n_recv + n_send], receives first */
    int n_open;                       /* receives not yet arrived */
    struct halo_traffic sent;         /* by this rank since creation */
    void *internal;
};

/* Collective. `count_to` [n_rank]: records that I send to each rank (0: none). Finds out who sends
 * to me. */
struct halo *halo_create(const struct comm *comm, const int64_t *count_to);
/* Whether both tables are what halo_create makes them: ranks ascending, no segment empty. */
bool halo_is_valid(const struct halo *halo);
void halo_free(struct halo *halo); /* NULL is fine. Collective: completes what is under way. */

/* One exchange of records of any size outside the step (static data of new ghosts): blocking,
 * collective over neighbours. */
void halo_exchange(struct halo *halo, const void *send, void *recv, size_t record);

/* Persistent requests over fixed buffers for the exchange within a step. The buffers are borrowed
 * until the next bind or free. */
void halo_bind(struct halo *halo, const void *send, void *recv, size_t record);
/* Order of calls in a step: begin_recv, (send buffer filled), begin_send, poll until it returns
 * true, (recv buffer read), end. `poll` also drives MPI's progress and may be called at any time;
 * it never blocks, so who waits with it calls comm_pause in between (ranks and their device's
 * workers may share a core); `end` completes the sends, so that the send buffer may be refilled. */
void halo_begin_recv(struct halo *halo);
void halo_begin_send(struct halo *halo);
bool halo_poll(struct halo *halo);
void halo_end(struct halo *halo);

#endif
