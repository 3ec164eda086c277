/* Collectives against closed forms, the node's ranks, and what Open MPI is told before it
 * starts. */
#include <stdlib.h>
#include <string.h>

#include "../mpi_check.h"
#include "comm/comm.h"

static void reductions(const struct comm *comm)
{
    int64_t n = comm->n_rank, r = comm->rank;
    int64_t sum[2] = {r, (int64_t)1 << 40}, most[2] = {r, -r}, least[2] = {r, -r};
    int32_t bits[2] = {1 << (r % 30), 0};
    double high = -0.5 * (double)r, low = -0.5 * (double)r;
    comm_sum_i64(comm, sum, 2);
    comm_max_i64(comm, most, 2);
    comm_min_i64(comm, least, 2);
    comm_or_i32(comm, bits, 2);
    comm_max_f64(comm, &high, 1);
    comm_min_f64(comm, &low, 1);
    CHECK(sum[0] == n * (n - 1) / 2 && sum[1] == n << 40);
    CHECK(most[0] == n - 1 && most[1] == 0);
    CHECK(least[0] == 0 && least[1] == -(n - 1));
    CHECK(bits[0] == (int32_t)((1u << n) - 1) && bits[1] == 0);
    CHECK(high == 0 && low == -0.5 * (double)(n - 1));
    CHECK(comm_exscan_i64(comm, r + 1) == r * (r + 1) / 2);
}

static void bytes(const struct comm *comm)
{
    char mine[3] = {(char)comm->rank, 'x', (char)(7 * comm->rank)};
    char *all = malloc(3 * (size_t)comm->n_rank);
    comm_gather(comm, mine, all, sizeof mine);
    for (int r = 0; r < comm->n_rank; r++)
        CHECK(all[3 * r] == (char)r && all[3 * r + 1] == 'x' && all[3 * r + 2] == (char)(7 * r));
    free(all);
    int last = comm->n_rank - 1;
    char text[32] = "";
    if (comm->rank == last) strcpy(text, "from the last rank");
    comm_bcast(comm, text, sizeof text, last);
    CHECK(strcmp(text, "from the last rank") == 0);
    comm_bcast(comm, NULL, 0, 0);
}

static void node(const struct comm *comm)
{
    unsigned char bits[16] = {0};
    CHECK(comm->n_node_rank >= 1 && comm->n_node_rank <= comm->n_rank && comm->node_rank >= 0 &&
          comm->node_rank < comm->n_node_rank);
    bits[comm->node_rank] = (unsigned char)(1 + comm->node_rank);
    comm_node_or(comm, bits, sizeof bits);
    for (int r = 0; r < 16; r++) CHECK(bits[r] == (r < comm->n_node_rank ? 1 + r : 0));
    comm_node_barrier(comm);
    comm_barrier(comm);
}

/* Argument: what OMPI_MCA_io has to be after start, that is ^ompio unless the user has set
 * something. */
int main(int argc, char **argv)
{
    struct comm *comm = comm_create(&argc, &argv);
    CHECK(argc == 2 && getenv("OMPI_MCA_io") && strcmp(getenv("OMPI_MCA_io"), argv[1]) == 0);
    reductions(comm);
    bytes(comm);
    node(comm);
    comm_free(comm);
    return 0;
}
