/* Cost: one MPI_Alltoall of 8 bytes per pair of ranks to learn who sends what, then one message per
 * pair that has something to say. */
#include "migrate.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "fail.h"

#ifndef MIGRATE_PIECE
/* [byte] largest message: MPI counts are int. A test takes less. */
#define MIGRATE_PIECE (1LL << 30)
#endif

enum { TAG = 3 };

/* Number of messages that carry `bytes`. */
static int64_t n_piece(int64_t bytes)
{
    return (bytes + MIGRATE_PIECE - 1) / MIGRATE_PIECE;
}

static int piece_size(int64_t bytes, int64_t at)
{
    return (int)(bytes - at < MIGRATE_PIECE ? bytes - at : MIGRATE_PIECE);
}

/* Start of each rank's segment; returns the total. */
static int64_t segments(const int64_t *bytes, int n_rank, int64_t *begin)
{
    int64_t sum = 0;
    for (int r = 0; r < n_rank; r++) {
        assert(bytes[r] >= 0);
        begin[r] = sum;
        sum += bytes[r];
    }
    return sum;
}

void *migrate_bytes(
    const struct comm *comm, const void *send, const int64_t *bytes_to, int64_t *bytes_from)
{
    int n = comm->n_rank, self = comm->rank, n_request = 0;
    int64_t *send_begin = fail_alloc((size_t)n * sizeof *send_begin);
    int64_t *recv_begin = fail_alloc((size_t)n * sizeof *recv_begin);
    const char *from = send;

    check_mpi(MPI_Alltoall(bytes_to, 1, MPI_INT64_T, bytes_from, 1, MPI_INT64_T, comm->world));
    segments(bytes_to, n, send_begin);
    char *recv = fail_alloc((size_t)segments(bytes_from, n, recv_begin));

    int64_t most = 0;
    for (int r = 0; r < n; r++) most += n_piece(bytes_from[r]) + n_piece(bytes_to[r]);
    MPI_Request *request = fail_alloc((size_t)most * sizeof *request);

    /* Pieces of one pair share a tag: MPI keeps their order. */
    for (int r = 0; r < n; r++)
        for (int64_t at = 0; r != self && at < bytes_from[r]; at += MIGRATE_PIECE)
            check_mpi(MPI_Irecv(recv + recv_begin[r] + at, piece_size(bytes_from[r], at), MPI_BYTE,
                r, TAG, comm->world, &request[n_request++]));
    for (int r = 0; r < n; r++)
        for (int64_t at = 0; r != self && at < bytes_to[r]; at += MIGRATE_PIECE)
            check_mpi(MPI_Isend(from + send_begin[r] + at, piece_size(bytes_to[r], at), MPI_BYTE, r,
                TAG, comm->world, &request[n_request++]));
    if (bytes_to[self] > 0)
        memcpy(recv + recv_begin[self], from + send_begin[self], (size_t)bytes_to[self]);
    check_mpi(MPI_Waitall(n_request, request, MPI_STATUSES_IGNORE));

    free(request);
    free(send_begin);
    free(recv_begin);
    return recv;
}
