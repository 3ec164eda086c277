#include "lattice_owners.h"

#include <stdlib.h>
#include <string.h>

#include "partition/graph.h"
#include "comm/fail.h"

/* How long a side counts when a body is to be cut across its longest: a cut across runs splits
 * them, whose parts are padded and send single cells, one between layers of runs sends whole
 * layers. Measured on 100^3 cells in runs along x and two ranks: 390 bytes per cell with a cut
 * across x, 267 across z. */
static double side_counts(int axis, int run_axis)
{
    int last = run_axis == 2 ? 1 : 2; /* along which whole layers follow each other */
    return axis == run_axis ? 0.5 : axis == last ? 1 : 0.99;
}

static int64_t work_of(const struct lattice_cells *cells, int64_t i)
{
    return 1 + __builtin_popcount(cells->bits[i] & CELL_LINKS);
}

/* Places of cells with sides as they count. */
static double (*places(const struct lattice_cells *cells, int run_axis))[3]
{
    double(*x)[3] = fail_alloc((size_t)cells->n * sizeof *x);
    for (int64_t i = 0; i < cells->n; i++) {
        const struct lattice_grid *g = &cells->grid[cells->kind[cells->kind_of[i]].grid];
        for (int a = 0; a < 3; a++)
            x[i][a] = side_counts(a, run_axis) * (g->origin[a] + (cells->at[i][a] + 0.5) * g->h);
    }
    return x;
}

/* Cuts this rank's share of the cells into n_leaf; `by_links`: each link to an upper cell is a
 * point of its own, at its middle. */
static struct rcb *cut(const struct comm *comm, const struct lattice_cells *cells, double (*x)[3],
    int run_axis, int n_leaf, const int64_t *share, bool by_links)
{
    int64_t part = (cells->n + comm->n_rank - 1) / comm->n_rank, begin = part * comm->rank,
            end = begin + part < cells->n ? begin + part : cells->n;
    size_t room = end > begin ? (size_t)(end - begin) : 0;
    double(*point)[3] = fail_alloc(4 * room * sizeof *point);
    int64_t *weight = fail_alloc(4 * room * sizeof *weight), n = 0;
    for (int64_t i = begin; i < end; i++) {
        memcpy(point[n], x[i], sizeof *point);
        weight[n++] = by_links ? 1 : work_of(cells, i);
        for (int a = 0; a < 3 && by_links; a++) {
            if (!(cells->bits[i] & CELL_LINK(2 * a + 1))) continue;
            memcpy(point[n], x[i], sizeof *point);
            point[n][a] +=
                0.5 * side_counts(a, run_axis) * cells->grid[cells->kind[cells->kind_of[i]].grid].h;
            weight[n++] = 2;
        }
    }
    struct rcb *tree = rcb_create(comm, n_leaf, share, (const double *)point, weight, n);
    free(point);
    free(weight);
    return tree;
}

/* METIS deals the leaves of a fine tree out; links are its edges. Rank 0 has all cells, so it needs
 * none of the others'. */
static void deal(const struct comm *comm, const struct lattice_cells *cells,
    const struct lattice_options *options, struct rcb *tree, double (*x)[3])
{
    int64_t n = comm->rank == 0 ? cells->n : 0;
    int n_leaf = tree->n_node + 1, *begin = fail_alloc((size_t)(n + 1) * sizeof *begin),
        *to = fail_alloc(3 * (size_t)n * sizeof *to);
    int *leaf = fail_alloc((size_t)n * sizeof *leaf),
        *owner = fail_alloc((size_t)n_leaf * sizeof *owner), at = 0;
    int32_t *upper = fail_alloc(3 * (size_t)n * sizeof *upper);
    int64_t *weight = fail_alloc((size_t)n * sizeof *weight);
    for (int a = 0; a < 3 && n > 0; a++) lattice_cells_upper(cells, a, upper + a * n);
    for (int64_t i = 0; i < n; i++) {
        for (int a = 0; a < 3; a++)
            if (cells->bits[i] & CELL_LINK(2 * a + 1)) to[at++] = upper[a * n + i];
        begin[i + 1] = at;
        weight[i] = work_of(cells, i);
        leaf[i] = rcb_owner(tree, x[i]);
    }
    graph_leaves(comm, n_leaf, &(struct graph_elements){n, weight, begin, to, leaf, false},
        options->share, options->partition.threshold, owner);
    rcb_assign(tree, owner);
    void *all[] = {begin, to, leaf, owner, upper, weight};
    for (int k = 0; k < 6; k++) free(all[k]);
}

int *lattice_owners(const struct comm *comm, const struct lattice_cells *cells,
    const struct lattice_options *options, int run_axis)
{
    enum partition_method method = options->partition.method;
    double(*x)[3] = places(cells, run_axis);
    int *owner = fail_alloc((size_t)cells->n * sizeof *owner);
    struct rcb *tree;
    if (method == PARTITION_GRAPH && comm->n_rank > 1) {
        tree = cut(comm, cells, x, run_axis, graph_leaves_wanted(comm, cells->n), NULL, false);
        deal(comm, cells, options, tree, x);
    } else {
        tree = cut(comm, cells, x, run_axis, comm->n_rank, options->share,
            method == PARTITION_INTERACTIONS);
    }
    for (int64_t i = 0; i < cells->n; i++) owner[i] = rcb_owner(tree, x[i]);
    rcb_free(tree);
    free(x);
    return owner;
}

struct partition_part lattice_owners_part(
    const struct lattice_cells *cells, const int *owner, int rank, int64_t neighbours)
{
    struct partition_part part = {0, 0, neighbours};
    int32_t *upper = fail_alloc((size_t)cells->n * sizeof *upper);
    for (int a = 0; a < 3; a++) {
        lattice_cells_upper(cells, a, upper);
        for (int64_t i = 0; i < cells->n; i++)
            if (owner[i] == rank && cells->bits[i] & CELL_LINK(2 * a + 1) &&
                owner[upper[i]] != rank)
                part.cut++;
    }
    for (int64_t i = 0; i < cells->n; i++)
        if (owner[i] == rank) part.work += work_of(cells, i);
    free(upper);
    return part;
}
