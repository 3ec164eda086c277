/* Makes one MPI call that fails on rank 1: check_mpi has to end the job. Run by test_mpi_error. */
#include "comm/comm.h"

int main(int argc, char **argv)
{
    struct comm *comm = comm_create(&argc, &argv);
    if (comm->rank == 1) check_mpi(MPI_Send(argv, 1, MPI_BYTE, 99, 0, comm->world));
    comm_barrier(comm);
    comm_free(comm);
    return 0;
}
