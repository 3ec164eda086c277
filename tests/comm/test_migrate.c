/* Every byte arrives where it should, for random sizes with many zeros. Built twice: as it is, and
 * with messages cut at 1000 bytes. */
#include <stdlib.h>

#include "../mpi_check.h"
#include "comm/migrate.h"

static int64_t size_of(int round, int from, int to)
{
    uint64_t h = mpi_check_random((uint64_t)(round * 10000 + from * 100 + to));
    if (round == 0 || h % 3 == 0) return 0;
    if (round == 1) return 1000; /* exactly one message */
    return (int64_t)(h >> 8) % (round % 2 ? 100 : 5000);
}

static unsigned char byte_of(int round, int from, int to, int64_t i)
{
    return (unsigned char)mpi_check_random(
        (uint64_t)((((int64_t)round * 64 + from) * 64 + to) * 100000 + i));
}

static void one_round(const struct comm *comm, int round)
{
    int n = comm->n_rank, self = comm->rank;
    int64_t *to = calloc((size_t)n, sizeof *to), *from = calloc((size_t)n, sizeof *from), sum = 0,
            at = 0;
    for (int r = 0; r < n; r++) sum += to[r] = size_of(round, self, r);
    unsigned char *send = malloc((size_t)sum + 1);
    for (int r = 0; r < n; r++)
        for (int64_t i = 0; i < to[r]; i++) send[at++] = byte_of(round, self, r, i);

    unsigned char *recv = migrate_bytes(comm, send, to, from);
    CHECK(recv);
    at = 0;
    for (int r = 0; r < n; r++) {
        CHECK(from[r] == size_of(round, r, self));
        for (int64_t i = 0; i < from[r]; i++) CHECK(recv[at++] == byte_of(round, r, self, i));
    }
    free(recv);
    free(send);
    free(to);
    free(from);
}

int main(int argc, char **argv)
{
    struct comm *comm = comm_create(&argc, &argv);
    for (int round = 0; round < 30; round++) one_round(comm, round);
    comm_free(comm);
    return 0;
}
