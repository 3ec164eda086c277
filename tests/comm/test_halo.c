/* Every ghost is a function of its global id after each exchange: blocking and persistent, with
 * self-neighbours, empty ranks, large and small messages, two halos at once, and ranks that
 * dawdle. */
#include <sched.h>
#include <stdlib.h>
#include <unistd.h>

#include "../mpi_check.h"
#include "comm/halo.h"

struct record {
    int64_t gid;
    double value[2];
};

static int64_t gid_of(int from, int to, int64_t i)
{
    return ((int64_t)from << 40) + ((int64_t)to << 32) + i;
}

static double value_of(int64_t gid, int round)
{
    return (double)(mpi_check_random((uint64_t)gid) >> 12) + 0.25 * round;
}

/* Who sends how much: the same on every rank. `kind` 0: nobody anything; 1: each to itself only; 2:
 * pseudo-random, about half of the pairs, the last rank of several neither sends nor receives, one
 * message far above the eager limit; 3: all to all. */
static int64_t count_of(int kind, int from, int to, int n_rank)
{
    uint64_t h = mpi_check_random((uint64_t)(from * 1000 + to));
    if (kind == 0) return 0;
    if (kind == 1) return from == to ? 5 : 0;
    if (kind == 3) return 1 + (int64_t)(h % 7);
    if (n_rank > 2 && (from == n_rank - 1 || to == n_rank - 1)) return 0;
    if (from == 0 && to == (n_rank > 1)) return 20000;
    return h % 2 ? (int64_t)(h % 50) : 0;
}

static struct halo *make(const struct comm *comm, int kind)
{
    int n = comm->n_rank, n_send = 0, n_recv = 0;
    int64_t *to = calloc((size_t)n, sizeof *to);
    for (int r = 0; r < n; r++) to[r] = count_of(kind, comm->rank, r, n);
    struct halo *halo = halo_create(comm, to);
    for (int r = 0; r < n; r++) {
        int64_t from = count_of(kind, r, comm->rank, n);
        if (to[r] > 0)
            CHECK(halo->send_rank[n_send] == r &&
                  halo->send_begin[n_send + 1] - halo->send_begin[n_send] == to[r]);
        if (from > 0)
            CHECK(halo->recv_rank[n_recv] == r &&
                  halo->recv_begin[n_recv + 1] - halo->recv_begin[n_recv] == from);
        n_send += to[r] > 0;
        n_recv += from > 0;
    }
    CHECK(halo->n_send == n_send && halo->n_recv == n_recv && halo->send_begin[0] == 0 &&
          halo->recv_begin[0] == 0);
    free(to);
    return halo;
}

static void fill(const struct halo *halo, struct record *send, int round)
{
    for (int k = 0; k < halo->n_send; k++)
        for (int64_t i = halo->send_begin[k]; i < halo->send_begin[k + 1]; i++) {
            int64_t gid = gid_of(halo->comm->rank, halo->send_rank[k], i - halo->send_begin[k]);
            send[i] = (struct record){gid, {value_of(gid, round), -value_of(gid, round)}};
        }
}

static void check(const struct halo *halo, const struct record *recv, int round)
{
    for (int k = 0; k < halo->n_recv; k++)
        for (int64_t i = halo->recv_begin[k]; i < halo->recv_begin[k + 1]; i++) {
            int64_t gid = gid_of(halo->recv_rank[k], halo->comm->rank, i - halo->recv_begin[k]);
            CHECK(recv[i].gid == gid && recv[i].value[0] == value_of(gid, round) &&
                  recv[i].value[1] == -value_of(gid, round));
        }
}

static void dawdle(const struct comm *comm, int round)
{
    uint64_t h = mpi_check_random((uint64_t)(comm->rank * 7919 + round));
    if (h % 4 == 0) usleep((useconds_t)(h >> 8) % 2000);
}

static void wait_for(struct halo *halo)
{
    while (!halo_poll(halo)) sched_yield();
}

static void one_kind(const struct comm *comm, int kind, int n_round)
{
    struct halo *halo = make(comm, kind);
    int64_t n_send = halo->send_begin[halo->n_send], n_recv = halo->recv_begin[halo->n_recv],
            sent = 0;
    struct record *send = calloc((size_t)n_send + 1, sizeof *send),
                  *recv = calloc((size_t)n_recv + 1, sizeof *recv);
    struct record *once = calloc((size_t)n_recv + 1, sizeof *once),
                  *aside = calloc((size_t)n_send + 1, sizeof *aside);

    CHECK(halo_is_valid(halo));
    if (halo->n_recv > 0) {
        int *last = &halo->recv_rank[halo->n_recv - 1], rank = *last;
        *last = comm->n_rank; /* a rank that is not there */
        CHECK(!halo_is_valid(halo));
        *last = rank;
    }
    fill(halo, send, -1);
    halo_exchange(halo, send, recv, sizeof *send);
    check(halo, recv, -1);

    halo_bind(halo, send, recv, sizeof *send);
    CHECK(halo_poll(halo)); /* nothing is open: true, and no harm */
    for (int round = 0; round < n_round; round++) {
        halo_begin_recv(halo);
        CHECK(halo->n_open == halo->n_recv);
        dawdle(comm, round);
        if (round % 3 == 0) { /* one out of step, while the receives of the step wait */
            fill(halo, aside, 1000 + round);
            halo_exchange(halo, aside, once, sizeof *aside);
            check(halo, once, 1000 + round);
        }
        fill(halo, send, round);
        halo_begin_send(halo);
        dawdle(comm, round + 500);
        wait_for(halo);
        check(halo, recv, round);
        halo_end(halo);
        sent += n_send * (int64_t)sizeof *send;
    }
    CHECK(halo->sent.bytes == sent && halo->sent.messages == (int64_t)n_round * halo->n_send);

    halo_bind(halo, send, recv, sizeof(int64_t)); /* other size over the same buffers */
    for (int64_t i = 0; i < n_send; i++) ((int64_t *)send)[i] = gid_of(comm->rank, 0, i);
    halo_begin_recv(halo);
    halo_begin_send(halo);
    wait_for(halo);
    halo_end(halo);
    for (int k = 0; k < halo->n_recv; k++) /* first number of each segment: from which rank */
        CHECK(((int64_t *)recv)[halo->recv_begin[k]] >> 40 == halo->recv_rank[k]);

    halo_free(halo);
    free(send);
    free(recv);
    free(once);
    free(aside);
}

/* Two halos under way together, begun in opposite order on odd ranks. */
static void two_at_once(const struct comm *comm)
{
    struct halo *halo[2] = {make(comm, 3), make(comm, 2)};
    struct record *send[2], *recv[2];
    for (int h = 0; h < 2; h++) {
        send[h] = calloc((size_t)halo[h]->send_begin[halo[h]->n_send] + 1, sizeof **send);
        recv[h] = calloc((size_t)halo[h]->recv_begin[halo[h]->n_recv] + 1, sizeof **recv);
        halo_bind(halo[h], send[h], recv[h], sizeof **send);
    }
    for (int round = 0; round < 20; round++) {
        for (int k = 0; k < 2; k++) {
            int h = k ^ (comm->rank & 1);
            fill(halo[h], send[h], 10 * round + h);
            halo_begin_recv(halo[h]);
            halo_begin_send(halo[h]);
        }
        for (int h = 0; h < 2; h++) {
            wait_for(halo[h]);
            check(halo[h], recv[h], 10 * round + h);
            halo_end(halo[h]);
        }
    }
    for (int h = 0; h < 2; h++) {
        halo_free(halo[h]);
        free(send[h]);
        free(recv[h]);
    }
}

int main(int argc, char **argv)
{
    struct comm *comm = comm_create(&argc, &argv);
    for (int kind = 0; kind < 4; kind++) one_kind(comm, kind, kind == 2 ? 40 : 10);
    two_at_once(comm);
    halo_free(NULL);
    comm_free(comm);
    return 0;
}
