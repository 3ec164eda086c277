/* Leaves of a fine tree dealt out to the ranks: a grid of points with six neighbours each, of which
 * every rank has its own. */
#include <stdlib.h>
#include <string.h>

#include "../mpi_check.h"
#include "partition/graph.h"
#include "partition/partition.h"

enum { SIDE = 24, N = SIDE * SIDE * SIDE };

static double x[N][3];
static int begin[N + 1], to[6 * N], leaf[N];
static int64_t weight[N];

/* Points v % stride == first of the grid come first, as this rank's; the others behind them, as its
 * ghosts. Returns how many are its own. */
static int make(int first, int stride)
{
    static int number[N], grid[N];
    int n = 0, n_edge = 0;
    for (int own = 1; own >= 0; own--)
        for (int v = 0; v < N; v++)
            if ((v % stride == first) == own) {
                grid[n] = v;
                number[v] = n++;
            }
    n = 0;
    for (int k = 0; k < N; k++) {
        int v = grid[k], at[3] = {v % SIDE, v / SIDE % SIDE, v / (SIDE * SIDE)},
            step[3] = {1, SIDE, SIDE * SIDE};
        for (int a = 0; a < 3; a++) x[k][a] = at[a] + 1e-3 * ((7 * v + a) % 13); /* no ties */
        if (v % stride != first) continue;
        n++;
        weight[k] = 2;
        for (int a = 0; a < 3; a++)
            for (int d = -1; d <= 1; d += 2) {
                if (at[a] + d < 0 || at[a] + d >= SIDE) continue;
                to[n_edge++] = number[v + d * step[a]];
                weight[k]++;
            }
        begin[k + 1] = n_edge;
    }
    return n;
}

/* Deals the grid out and checks that every rank gets its share of the work, pairs of two ranks
 * counted on both, within one leaf of the smallest. */
static void deal(const struct comm *comm, int stride, const int64_t *share)
{
    int64_t shares = 0, least = INT64_MAX;
    for (int r = 0; r < comm->n_rank; r++) {
        int64_t own = share ? share[r] : 1;
        shares += own;
        least = own < least ? own : least;
    }
    int n = comm->rank < stride ? make(comm->rank, stride) : 0,
        n_leaf = graph_leaves_wanted(comm, N);
    int *owner = calloc((size_t)n_leaf, sizeof *owner),
        *first = calloc((size_t)n_leaf, sizeof *first);
    int64_t *work = calloc((size_t)comm->n_rank, sizeof *work), n_all = n, n_stay = 0;
    struct rcb *tree = rcb_create(comm, n_leaf, NULL, x[0], weight, n);
    for (int k = 0; k < N; k++) leaf[k] = rcb_owner(tree, x[k]);
    struct graph_elements elements = {n, weight, begin, to, leaf, true};
    double accepted = (double)shares / ((double)least * n_leaf);
    graph_leaves(comm, n_leaf, &elements, share, accepted, owner);
    memcpy(first, owner, (size_t)n_leaf * sizeof *first);
    comm_bcast(comm, first, (size_t)n_leaf * sizeof *first, 0);
    CHECK(!memcmp(first, owner, (size_t)n_leaf * sizeof *first));
    rcb_assign(tree, owner);
    for (int k = 0; k < n; k++) {
        int own = rcb_owner(tree, x[k]);
        CHECK(own >= 0 && own < comm->n_rank);
        work[own] += weight[k];
        n_stay += own == comm->rank;
        for (int e = begin[k]; e < begin[k + 1]; e++) work[own] += owner[leaf[to[e]]] != own;
    }
    comm_sum_i64(comm, work, comm->n_rank);
    comm_sum_i64(comm, &n_all, 1);
    comm_sum_i64(comm, &n_stay, 1);
    CHECK(n_all == N);
    CHECK(partition_imbalance(work, share, comm->n_rank) <= accepted);
    rcb_free(tree);
    free(owner);
    free(first);
    free(work);
}

int main(int argc, char **argv)
{
    struct comm *comm = comm_create(&argc, &argv);
    int64_t share[128];
    for (int r = 0; r < comm->n_rank; r++) share[r] = 100 * (1 + r % 3);
    deal(comm, comm->n_rank, NULL);
    deal(comm, 1, NULL); /* all on rank 0 */
    deal(comm, comm->n_rank, share);
    comm_free(comm);
    return 0;
}
