/* Ranks: which one this is, how many there are, who shares its node; and the few collectives that
 * set-up needs. The only part of democles, besides the rest of comm/ and the writing of frames,
 * that calls MPI. */
#ifndef DEMOCLES_COMM_H
#define DEMOCLES_COMM_H

#include <mpi.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>

struct comm {
    MPI_Comm world; /* a duplicate, owned */
    MPI_Comm node;  /* ranks that share this node's memory, owned */
    int rank, n_rank;
    int node_rank, n_node_rank;
    bool naps;      /* comm_pause sleeps: something else computes on this thread's core */
    double spin_ns; /* but not before a wait has lasted as long as this */
};

/* MPI_Init (with OMPIO switched off, see comm.c) and MPI_Finalize. Collective. Once per process.
 * Only the calling thread may use comm/ afterwards. */
struct comm *comm_create(int *argc, char ***argv);
void comm_free(struct comm *comm);

/* All collective; `value` arrays are reduced in place. Sums are of integers only: a sum of doubles
 * would depend on the number of ranks. */
void comm_sum_i64(const struct comm *comm, int64_t *value, int n);
void comm_max_i64(const struct comm *comm, int64_t *value, int n);
void comm_min_i64(const struct comm *comm, int64_t *value, int n);
void comm_or_i32(const struct comm *comm, int32_t *value, int n);
void comm_max_f64(const struct comm *comm, double *value, int n);
void comm_min_f64(const struct comm *comm, double *value, int n);
void comm_bcast(const struct comm *comm, void *data, size_t bytes, int root);
void comm_gather(const struct comm *comm, const void *mine,
    void *all /* [n_rank][bytes], every rank gets it */, size_t bytes);
/* sum over lower ranks; 0 on rank 0 */
int64_t comm_exscan_i64(const struct comm *comm, int64_t value);
void comm_barrier(const struct comm *comm);
/* of the ranks of this node, which sleep meanwhile: one of them works for seconds on their cores */
void comm_node_barrier(const struct comm *comm);
/* bit-or over the ranks of this node, in place */
void comm_node_or(const struct comm *comm, void *bits, size_t bytes);

/* Backs off between two polls for messages. If `naps`: looks again at once for the first `spin_ns`
 * of a wait, then sleeps for some microseconds; else yields the core to whoever waits for it.
 * `began`: the wait's, to be given as {0} with its first poll. */
void comm_pause(const struct comm *comm, struct timespec *began);
/* How comm_pause waits from now on. */
void comm_set_naps(struct comm *comm, bool naps, double spin_ns);

/* One bit-or of an int over all ranks that runs beside other work: started now, asked for later. */
struct comm_vote {
    MPI_Request request;
    int32_t mine, all;
    bool open;
};
/* collective */
void comm_vote_begin(const struct comm *comm, struct comm_vote *vote, int32_t value);
/* waits; 0 if none was begun */
int32_t comm_vote_end(const struct comm *comm, struct comm_vote *vote);

/* Prints `rank R: file:line: call: name of the MPI error` and stops the job, exit code 6. */
#define check_mpi(call) comm_check((call), #call, __FILE__, __LINE__)
void comm_check(int code, const char *call, const char *file, int line);

#endif
