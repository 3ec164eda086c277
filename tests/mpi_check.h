/* Checks for tests that run on several ranks, where cmocka's report per process would be a jumble:
 * the first failure on any rank ends the job. */
#ifndef DEMOCLES_TESTS_MPI_CHECK_H
#define DEMOCLES_TESTS_MPI_CHECK_H

#include <mpi.h>
#include <stdint.h>
#include <stdio.h>

static inline void mpi_check_failed(const char *what, const char *file, int line)
{
    int rank = -1;
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    fprintf(stderr, "rank %d: %s:%d: %s\n", rank, file, line, what);
    MPI_Abort(MPI_COMM_WORLD, 1);
}

#define CHECK(what) ((what) ? (void)0 : mpi_check_failed(#what, __FILE__, __LINE__))

/* splitmix64: the same numbers on every machine. */
static inline uint64_t mpi_check_random(uint64_t key)
{
    key += 0x9e3779b97f4a7c15u;
    key = (key ^ key >> 30) * 0xbf58476d1ce4e5b9u;
    key = (key ^ key >> 27) * 0x94d049bb133111ebu;
    return key ^ key >> 31;
}

#endif
