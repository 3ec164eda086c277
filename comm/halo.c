/* Cost of a plan: one MPI_Alltoall of 8 bytes per pair of ranks and a duplicated communicator, that
 * is O(n_rank) memory and time per rank, once per regroup (some microseconds per rank against
 * milliseconds for the lists that are rebuilt with it). An exchange costs one message per neighbour
 * and nothing else.
 *
 * Own communicator per halo, so that messages of two halos, or of an old and a new plan, cannot
 * meet; a tag per kind of exchange, so that a step's messages and those of halo_exchange cannot
 * either. Between two ranks there is at most one message per kind and direction at a time, so one
 * tag each is enough, also where a rank is its own neighbour. Counts are records, not bytes, by a
 * contiguous type, so that more than 2 GiB per neighbour go through MPI's int. */
#include "halo.h"

#include <assert.h>
#include <limits.h>
#include <stdlib.h>

#include "fail.h"

enum { TAG_ONCE = 1, TAG_STEP = 2 };

struct internal {
    MPI_Comm world;      /* duplicate, owned */
    MPI_Datatype record; /* of the bound exchange */
    bool bound;
    bool sending; /* sends started and not yet completed */
    int *index;   /* [n_recv] scratch of MPI_Testsome */
};

/* The ranks with a count above 0, ascending, and their segments. Returns how many there are. */
static int neighbours(const int64_t *count, int n_rank, int **rank, int64_t **begin)
{
    int n = 0;
    for (int r = 0; r < n_rank; r++) {
        assert(count[r] >= 0);
        n += count[r] > 0;
    }
    *rank = fail_alloc((size_t)n * sizeof **rank);
    *begin = fail_alloc((size_t)(n + 1) * sizeof **begin);
    for (int r = 0, k = 0; r < n_rank; r++) {
        if (count[r] == 0) continue;
        (*rank)[k] = r;
        (*begin)[k + 1] = (*begin)[k] + count[r];
        k++;
    }
    return n;
}

struct halo *halo_create(const struct comm *comm, const int64_t *count_to)
{
    struct halo *halo = fail_alloc(sizeof *halo);
    struct internal *in = fail_alloc(sizeof *in);
    int64_t *count_from = fail_alloc((size_t)comm->n_rank * sizeof *count_from);

    halo->comm = comm;
    halo->internal = in;
    check_mpi(MPI_Comm_dup(comm->world, &in->world));
    check_mpi(MPI_Alltoall(count_to, 1, MPI_INT64_T, count_from, 1, MPI_INT64_T, in->world));
    halo->n_send = neighbours(count_to, comm->n_rank, &halo->send_rank, &halo->send_begin);
    halo->n_recv = neighbours(count_from, comm->n_rank, &halo->recv_rank, &halo->recv_begin);
    halo->request = fail_alloc((size_t)(halo->n_recv + halo->n_send) * sizeof *halo->request);
    for (int k = 0; k < halo->n_recv + halo->n_send; k++) halo->request[k] = MPI_REQUEST_NULL;
    in->index = fail_alloc((size_t)halo->n_recv * sizeof *in->index);
    free(count_from);
    assert(halo_is_valid(halo));
    return halo;
}

static bool is_table(const int *rank, const int64_t *begin, int n, int n_rank)
{
    bool is = begin[0] == 0;
    for (int k = 0; k < n; k++)
        is &= rank[k] >= 0 && rank[k] < n_rank && (k == 0 || rank[k - 1] < rank[k]) &&
              begin[k] < begin[k + 1];
    return is;
}

bool halo_is_valid(const struct halo *h)
{
    return is_table(h->send_rank, h->send_begin, h->n_send, h->comm->n_rank) &&
           is_table(h->recv_rank, h->recv_begin, h->n_recv, h->comm->n_rank) && h->n_open >= 0 &&
           h->n_open <= h->n_recv;
}

/* Completes and frees the persistent requests. An inactive request counts as complete. */
static void unbind(struct halo *halo)
{
    struct internal *in = halo->internal;
    if (!in->bound) return;
    int n = halo->n_recv + halo->n_send;
    check_mpi(MPI_Waitall(n, halo->request, MPI_STATUSES_IGNORE));
    for (int k = 0; k < n; k++) check_mpi(MPI_Request_free(&halo->request[k]));
    check_mpi(MPI_Type_free(&in->record));
    halo->n_open = 0;
    in->sending = in->bound = false;
}

void halo_free(struct halo *halo)
{
    if (!halo) return;
    struct internal *in = halo->internal;
    unbind(halo);
    check_mpi(MPI_Comm_free(&in->world));
    free(in->index);
    free(in);
    free(halo->send_rank);
    free(halo->recv_rank);
    free(halo->send_begin);
    free(halo->recv_begin);
    free(halo->request);
    free(halo);
}

/* Records of neighbour k, as MPI counts them. */
static int count(const int64_t *begin, int k)
{
    int64_t n = begin[k + 1] - begin[k];
    if (n > INT_MAX)
        fail_stop(
            EXIT_IO, "a message of %lld records: MPI takes at most %d", (long long)n, INT_MAX);
    return (int)n;
}

static MPI_Datatype record_type(size_t record)
{
    MPI_Datatype type;
    assert(record > 0 && record <= INT_MAX);
    check_mpi(MPI_Type_contiguous((int)record, MPI_BYTE, &type));
    check_mpi(MPI_Type_commit(&type));
    return type;
}

void halo_exchange(struct halo *halo, const void *send, void *recv, size_t record)
{
    struct internal *in = halo->internal;
    int n = halo->n_recv + halo->n_send;
    MPI_Request *request = fail_alloc((size_t)n * sizeof *request);
    MPI_Datatype type = record_type(record);

    for (int k = 0; k < halo->n_recv; k++) {
        char *at = (char *)recv + (size_t)halo->recv_begin[k] * record;
        check_mpi(MPI_Irecv(at, count(halo->recv_begin, k), type, halo->recv_rank[k], TAG_ONCE,
            in->world, &request[k]));
    }
    for (int k = 0; k < halo->n_send; k++) {
        const char *at = (const char *)send + (size_t)halo->send_begin[k] * record;
        check_mpi(MPI_Isend(at, count(halo->send_begin, k), type, halo->send_rank[k], TAG_ONCE,
            in->world, &request[halo->n_recv + k]));
    }
    check_mpi(MPI_Waitall(n, request, MPI_STATUSES_IGNORE));
    check_mpi(MPI_Type_free(&type));
    free(request);
}

void halo_bind(struct halo *halo, const void *send, void *recv, size_t record)
{
    struct internal *in = halo->internal;
    unbind(halo);
    in->record = record_type(record);
    halo->record = record;
    for (int k = 0; k < halo->n_recv; k++) {
        char *at = (char *)recv + (size_t)halo->recv_begin[k] * record;
        check_mpi(MPI_Recv_init(at, count(halo->recv_begin, k), in->record, halo->recv_rank[k],
            TAG_STEP, in->world, &halo->request[k]));
    }
    for (int k = 0; k < halo->n_send; k++) {
        const char *at = (const char *)send + (size_t)halo->send_begin[k] * record;
        MPI_Request *request = &halo->request[halo->n_recv + k];
        check_mpi(MPI_Send_init(at, count(halo->send_begin, k), in->record, halo->send_rank[k],
            TAG_STEP, in->world, request));
    }
    in->bound = true;
}

void halo_begin_recv(struct halo *halo)
{
    assert(((struct internal *)halo->internal)->bound && halo->n_open == 0);
    check_mpi(MPI_Startall(halo->n_recv, halo->request));
    halo->n_open = halo->n_recv;
}

void halo_begin_send(struct halo *halo)
{
    struct internal *in = halo->internal;
    assert(in->bound && !in->sending);
    check_mpi(MPI_Startall(halo->n_send, halo->request + halo->n_recv));
    in->sending = true;
    halo->sent.bytes += halo->send_begin[halo->n_send] * (int64_t)halo->record;
    halo->sent.messages += halo->n_send;
}

bool halo_poll(struct halo *halo)
{
    struct internal *in = halo->internal;
    int done = 0;
    if (halo->n_open == 0) return true;
    check_mpi(MPI_Testsome(halo->n_recv, halo->request, &done, in->index, MPI_STATUSES_IGNORE));
    if (done != MPI_UNDEFINED) halo->n_open -= done; /* MPI_UNDEFINED: no receive is active */
    return halo->n_open == 0;
}

void halo_end(struct halo *halo)
{
    struct internal *in = halo->internal;
    struct timespec began = {0};
    int done = 0;
    assert(halo->n_open == 0);
    for (;;) {
        check_mpi(
            MPI_Testall(halo->n_send, halo->request + halo->n_recv, &done, MPI_STATUSES_IGNORE));
        if (done) break;
        /* MPI_Waitall would spin, where the device's workers may need the core */
        comm_pause(halo->comm, &began);
    }
    in->sending = false;
}
