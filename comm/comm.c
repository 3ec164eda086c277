#include "comm.h"

#include <assert.h>
#include <limits.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "fail.h"

/* What Open MPI has to be told before MPI_Init; a setting of the user's own wins.
 *
 * io: OMPIO of Open MPI up to 4.1.6 silently corrupts parallel HDF5 files (ompi #12718), and Debian
 * 12 takes it by default: ROMIO instead. hwloc: MPI_Init of a rank without mpirun looks for OpenCL
 * devices by itself if hwloc's plugins are there, and pocl then starts its threads before device.c
 * has said how many; it asks X servers for theirs too, and Xlib ends the process where one goes.
 * mpi_yield_when_idle: a rank's OpenCL workers often share its core (mpirun binds to one), so a
 * rank that waits has to let them run. eager_limit: a message above it takes several looks of both
 * ranks, and they look rarely while their device computes on the same cores; ghosts of one
 * neighbour are some 100 KB. (vader is the shared-memory transport of Open MPI 4, sm that of 5.)
 * ess_singleton_isolated: without mpirun MPI_Init would start a daemon for processes that the rank
 * may start later (this one starts none), which takes longer than all the rest of it.
 * orte_create_session_dirs: without that daemon all such ranks of a user have the same folder,
 * which the first that ends takes away from others that begin. */
static void environment(void)
{
    setenv("OMPI_MCA_io", "^ompio", 0);
    setenv("HWLOC_COMPONENTS", "-opencl,-gl", 0);
    setenv("OMPI_MCA_mpi_yield_when_idle", "1", 0);
    setenv("OMPI_MCA_btl_vader_eager_limit", "262144", 0);
    setenv("OMPI_MCA_btl_sm_eager_limit", "262144", 0);
    setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
    if (!getenv("OMPI_COMM_WORLD_SIZE") && !getenv("PMIX_RANK") && !getenv("PMI_RANK"))
        setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
}

static void warn_of_ompio(void)
{
    const char *io = getenv("OMPI_MCA_io");
    if (io && io[0] != '^' && strstr(io, "ompio"))
        fail_warn(
            "OMPI_MCA_io=%s: OMPIO of Open MPI before 4.1.7 corrupts parallel HDF5 files; unset "
            "it, or use ^ompio",
            io);
}

/* Under an mpirun of another MPI the ranks do not find each other, and each would run the whole
 * scene. Both name the size of the job in the environment. */
static void refuse_other_mpirun(int n_rank)
{
    static const char *const size[] = {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"};
    for (int k = 0; k < 2; k++) {
        const char *text = getenv(size[k]);
        if (n_rank == 1 && text && atoi(text) > 1)
            fail_stop(EXIT_USAGE,
                "mpirun started %s ranks (%s), but this one is alone: mpirun is not of the MPI "
                "that democles is built with",
                text, size[k]);
    }
}

struct comm *comm_create(int *argc, char ***argv)
{
    int provided;
    environment();
    check_mpi(MPI_Init_thread(argc, argv, MPI_THREAD_FUNNELED, &provided));
    if (provided < MPI_THREAD_FUNNELED)
        fail_stop(EXIT_IO,
            "this MPI cannot run with threads in the process (MPI_THREAD_FUNNELED), which OpenCL "
            "has");
    warn_of_ompio();

    struct comm *comm = fail_alloc(sizeof *comm);
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    MPI_Comm_set_errhandler(MPI_COMM_SELF, MPI_ERRORS_RETURN);
    check_mpi(MPI_Comm_dup(MPI_COMM_WORLD, &comm->world));
    check_mpi(MPI_Comm_rank(comm->world, &comm->rank));
    check_mpi(MPI_Comm_size(comm->world, &comm->n_rank));
    refuse_other_mpirun(comm->n_rank);
    check_mpi(MPI_Comm_split_type(
        comm->world, MPI_COMM_TYPE_SHARED, comm->rank, MPI_INFO_NULL, &comm->node));
    check_mpi(MPI_Comm_rank(comm->node, &comm->node_rank));
    check_mpi(MPI_Comm_size(comm->node, &comm->n_node_rank));
    return comm;
}

void comm_free(struct comm *comm)
{
    if (!comm) return;
    check_mpi(MPI_Comm_free(&comm->node));
    check_mpi(MPI_Comm_free(&comm->world));
    free(comm);
    check_mpi(MPI_Finalize());
}

void comm_check(int code, const char *call, const char *file, int line)
{
    if (code == MPI_SUCCESS) return;
    char text[MPI_MAX_ERROR_STRING] = "";
    int n = 0;
    MPI_Error_string(code, text, &n);
    fail_stop(EXIT_IO, "%s:%d: %s: %s", file, line, call, text); /* adds the rank */
}

void comm_sum_i64(const struct comm *comm, int64_t *value, int n)
{
    check_mpi(MPI_Allreduce(MPI_IN_PLACE, value, n, MPI_INT64_T, MPI_SUM, comm->world));
}

void comm_max_i64(const struct comm *comm, int64_t *value, int n)
{
    check_mpi(MPI_Allreduce(MPI_IN_PLACE, value, n, MPI_INT64_T, MPI_MAX, comm->world));
}

void comm_min_i64(const struct comm *comm, int64_t *value, int n)
{
    check_mpi(MPI_Allreduce(MPI_IN_PLACE, value, n, MPI_INT64_T, MPI_MIN, comm->world));
}

void comm_or_i32(const struct comm *comm, int32_t *value, int n)
{
    check_mpi(MPI_Allreduce(MPI_IN_PLACE, value, n, MPI_INT32_T, MPI_BOR, comm->world));
}

void comm_max_f64(const struct comm *comm, double *value, int n)
{
    check_mpi(MPI_Allreduce(MPI_IN_PLACE, value, n, MPI_DOUBLE, MPI_MAX, comm->world));
}

void comm_min_f64(const struct comm *comm, double *value, int n)
{
    check_mpi(MPI_Allreduce(MPI_IN_PLACE, value, n, MPI_DOUBLE, MPI_MIN, comm->world));
}

void comm_bcast(const struct comm *comm, void *data, size_t bytes, int root)
{
    const size_t piece = (size_t)1 << 30; /* MPI counts are int */
    for (size_t at = 0; at < bytes; at += piece) {
        size_t n = bytes - at < piece ? bytes - at : piece;
        check_mpi(MPI_Bcast((char *)data + at, (int)n, MPI_BYTE, root, comm->world));
    }
}

void comm_gather(const struct comm *comm, const void *mine, void *all, size_t bytes)
{
    assert(bytes <= INT_MAX);
    check_mpi(MPI_Allgather(mine, (int)bytes, MPI_BYTE, all, (int)bytes, MPI_BYTE, comm->world));
}

int64_t comm_exscan_i64(const struct comm *comm, int64_t value)
{
    int64_t before = 0;
    check_mpi(MPI_Exscan(&value, &before, 1, MPI_INT64_T, MPI_SUM, comm->world));
    return comm->rank == 0 ? 0 : before; /* MPI leaves it undefined on rank 0 */
}

void comm_barrier(const struct comm *comm)
{
    check_mpi(MPI_Barrier(comm->world));
}

void comm_node_barrier(const struct comm *comm)
{
    const struct timespec nap = {0, 1000000}; /* s, ns */
    MPI_Request request;
    int done = 0;
    check_mpi(MPI_Ibarrier(comm->node, &request));
    while (check_mpi(MPI_Test(&request, &done, MPI_STATUS_IGNORE)), !done) nanosleep(&nap, NULL);
}

void comm_node_or(const struct comm *comm, void *bits, size_t bytes)
{
    assert(bytes <= INT_MAX);
    check_mpi(MPI_Allreduce(MPI_IN_PLACE, bits, (int)bytes, MPI_BYTE, MPI_BOR, comm->node));
}

void comm_vote_begin(const struct comm *comm, struct comm_vote *vote, int32_t value)
{
    vote->mine = vote->all = value;
    vote->open = true;
    vote->request = MPI_REQUEST_NULL;
    if (comm->n_rank > 1)
        check_mpi(MPI_Iallreduce(
            &vote->mine, &vote->all, 1, MPI_INT32_T, MPI_BOR, comm->world, &vote->request));
}

void comm_set_naps(struct comm *comm, bool naps, double spin_ns)
{
    comm->naps = naps;
    comm->spin_ns = spin_ns;
}

/* Whether a wait that began then is still short. Its first call notes when it began. */
static bool is_short(struct timespec *began, double most_ns)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    if (began->tv_sec == 0 && began->tv_nsec == 0) *began = now;
    return (double)(now.tv_sec - began->tv_sec) * 1e9 + (double)(now.tv_nsec - began->tv_nsec) <
           most_ns;
}

void comm_pause(const struct comm *comm, struct timespec *began)
{
    const struct timespec nap = {0, 5000}; /* s, ns */
    if (!comm->naps) sched_yield();
    else if (!is_short(began, comm->spin_ns)) nanosleep(&nap, NULL);
}

int32_t comm_vote_end(const struct comm *comm, struct comm_vote *vote)
{
    if (!vote->open) return 0;
    int done = vote->request == MPI_REQUEST_NULL;
    struct timespec began = {0};
    while (!done) {
        check_mpi(MPI_Test(&vote->request, &done, MPI_STATUS_IGNORE));
        if (!done) comm_pause(comm, &began);
    }
    vote->open = false;
    return vote->all;
}
