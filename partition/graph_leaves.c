#include "graph.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/migrate.h"
#include "comm/fail.h"
#include "partition.h"

/* Cuts of one graph with weights that are raised in between, and how finely weights are kept while
 * they are. */
enum { ROUNDS = 4, FINE = 16 };

/* What one rank knows of the graph. a != b: `amount` neighbours that elements of leaf a have in
 * leaf b. a == b: `amount` of work in leaf a, and `n` elements of it that are with this rank. */
struct item {
    int32_t a, b;
    int64_t amount, n;
};

/* Elements of vertex v that are with a rank now. */
struct here {
    int v, rank;
    int64_t n;
};

/* The graph on rank 0; its vertices are the leaves with something in them. */
struct leaves {
    int n_leaf, n_rank;
    int *vertex;     /* [n_leaf], -1: empty */
    int64_t *work;   /* [n] */
    int64_t *weight; /* [n] for METIS: work times FINE, raised */
    struct here *here;
    int64_t n_here;
    struct graph graph;
    const int64_t *share; /* [n_rank] */
    bool both_sides;
};

struct edge {
    int from, to;
    int64_t amount;
};

static int by_ends(const void *a, const void *b)
{
    const struct edge *x = a, *y = b;
    return x->from != y->from ? (x->from > y->from) - (x->from < y->from)
                              : (x->to > y->to) - (x->to < y->to);
}

/* Vertices in the order of leaves, with what is in them; items [n_rank] one after the other,
 * from[r] bytes of rank r. */
static void add_vertices(struct leaves *l, const struct item *item, const int64_t *bytes_from)
{
    const struct item *at = item;
    int64_t *work = fail_alloc((size_t)l->n_leaf * sizeof *work);
    for (int r = 0; r < l->n_rank; r++)
        for (int64_t k = bytes_from[r] / (int64_t)sizeof *item; k > 0; k--, at++)
            if (at->a == at->b) {
                work[at->a] += at->amount;
                l->n_here++;
            }
    l->vertex = fail_alloc((size_t)l->n_leaf * sizeof *l->vertex);
    l->work = fail_alloc((size_t)l->n_leaf * sizeof *l->work);
    l->here = fail_alloc((size_t)l->n_here * sizeof *l->here);
    for (int leaf = 0; leaf < l->n_leaf; leaf++) {
        l->vertex[leaf] = work[leaf] > 0 ? l->graph.n : -1;
        if (work[leaf] > 0) l->work[l->graph.n++] = work[leaf];
    }
    at = item;
    l->n_here = 0;
    for (int r = 0; r < l->n_rank; r++)
        for (int64_t k = bytes_from[r] / (int64_t)sizeof *item; k > 0; k--, at++)
            if (at->a == at->b && l->vertex[at->a] >= 0)
                l->here[l->n_here++] = (struct here){l->vertex[at->a], r, at->n};
    free(work);
}

/* Edges both ways, each with what was counted from either end: twice the number of interactions
 * that it stands for. */
static void add_edges(struct leaves *l, const struct item *item, int64_t n_item)
{
    struct edge *edge = fail_alloc(2 * (size_t)n_item * sizeof *edge);
    size_t n = 0, n_merged = 0;
    for (int64_t k = 0; k < n_item; k++) {
        int a = l->vertex[item[k].a], b = l->vertex[item[k].b];
        /* a leaf may have lost its last element since its neighbour has heard of it */
        if (a == b || a < 0 || b < 0) continue;
        edge[n++] = (struct edge){a, b, item[k].amount};
        edge[n++] = (struct edge){b, a, item[k].amount};
    }
    qsort(edge, n, sizeof *edge, by_ends);
    for (size_t k = 0; k < n; k++) {
        if (n_merged > 0 && by_ends(&edge[n_merged - 1], &edge[k]) == 0)
            edge[n_merged - 1].amount += edge[k].amount;
        else edge[n_merged++] = edge[k];
    }
    int *begin = fail_alloc((size_t)(l->graph.n + 1) * sizeof *begin),
        *to = fail_alloc(n_merged * sizeof *to);
    int64_t *link = fail_alloc(n_merged * sizeof *link);
    for (size_t k = 0; k < n_merged; k++) {
        begin[edge[k].from + 1]++;
        to[k] = edge[k].to;
        link[k] = edge[k].amount;
    }
    for (int v = 0; v < l->graph.n; v++) begin[v + 1] += begin[v];
    l->graph.begin = begin;
    l->graph.to = to;
    l->graph.link = link;
    free(edge);
}

/* Names the parts, of which p was cut for the share of rank name[p], for ranks whose shares are
 * within 1/`slack` of that. Returns whether all shares are the same as before. */
static bool name_parts(const struct leaves *l, const int *part, int64_t slack, int *name)
{
    size_t n = (size_t)l->n_rank;
    bool fits = true;
    int64_t *overlap = fail_alloc(n * n * sizeof *overlap);
    int *now = fail_alloc(n * sizeof *now);
    for (int64_t k = 0; k < l->n_here; k++)
        overlap[(size_t)part[l->here[k].v] * n + (size_t)l->here[k].rank] += l->here[k].n;
    for (size_t p = 0; p < n; p++)
        for (size_t r = 0; r < n; r++) {
            bool may = llabs(l->share[r] - l->share[name[p]]) * slack <= l->share[r];
            overlap[p * n + r] = may ? overlap[p * n + r] + 1 : 0;
        }
    graph_names(l->n_rank, overlap, now);
    for (int p = 0; p < l->n_rank; p++) fits &= l->share[now[p]] == l->share[name[p]];
    memcpy(name, now, n * sizeof *name);
    free(now);
    free(overlap);
    return fits;
}

/* Work of each rank. */
static void add_up(const struct leaves *l, const int *part, const int *name, int64_t *work)
{
    const struct graph *g = &l->graph;
    memset(work, 0, (size_t)l->n_rank * sizeof *work);
    for (int v = 0; v < g->n; v++) {
        int64_t *own = &work[name[part[v]]];
        *own += l->work[v];
        for (int k = g->begin[v]; k < g->begin[v + 1]; k++)
            if (l->both_sides && part[g->to[k]] != part[v]) *own += g->link[k] / 2;
    }
}

static void raise_weights(struct leaves *l, const int *part, const int *name, const int64_t *work)
{
    double all = 0, shares = 0;
    for (int r = 0; r < l->n_rank; r++) {
        all += (double)work[r];
        shares += (double)l->share[r];
    }
    for (int v = 0; v < l->graph.n; v++) {
        int r = name[part[v]];
        double ratio = all > 0 ? (double)work[r] / (double)l->share[r] * shares / all : 1;
        int64_t raised = llround(fmin((double)l->weight[v] * ratio, 0x1p62));
        l->weight[v] = raised > 1 ? raised : 1;
    }
}

/* Rank for each vertex. */
static void choose(struct leaves *l, double threshold, int *rank)
{
    size_t n = (size_t)l->graph.n, n_rank = (size_t)l->n_rank;
    int *part = fail_alloc(n * sizeof *part), *name = fail_alloc(n_rank * sizeof *name);
    int64_t *target = fail_alloc(n_rank * sizeof *target),
            *work = fail_alloc(n_rank * sizeof *work);
    double best = HUGE_VAL;
    for (int p = 0; p < l->n_rank; p++) name[p] = p;
    for (int round = 0; round < ROUNDS && best > threshold; round++) {
        for (int p = 0; p < l->n_rank; p++) target[p] = l->share[name[p]];
        graph_partition(&l->graph, l->n_rank, target, part);
        bool fits = name_parts(l, part, round == 0 ? 16 : INT64_MAX >> 32, name);
        add_up(l, part, name, work);
        double imbalance = partition_imbalance(work, l->share, l->n_rank);
        if (imbalance < best) {
            best = imbalance;
            for (size_t v = 0; v < n; v++) rank[v] = name[part[v]];
        }
        if (fits) raise_weights(l, part, name, work);
    }
    free(part);
    free(name);
    free(target);
    free(work);
}

static void assign(struct leaves l, const struct item *item, const int64_t *bytes_from,
    double threshold, int *owner)
{
    int64_t n_item = 0, *equal = fail_alloc((size_t)l.n_rank * sizeof *equal);
    for (int r = 0; r < l.n_rank; r++) {
        n_item += bytes_from[r] / (int64_t)sizeof *item;
        equal[r] = 1;
    }
    if (!l.share) l.share = equal;
    add_vertices(&l, item, bytes_from);
    add_edges(&l, item, n_item);
    l.weight = fail_alloc((size_t)l.graph.n * sizeof *l.weight);
    for (int v = 0; v < l.graph.n; v++) l.weight[v] = FINE * l.work[v];
    l.graph.weight = l.weight;
    int *rank = fail_alloc((size_t)l.graph.n * sizeof *rank);
    choose(&l, threshold, rank);
    /* who moves into an empty leaf goes to who has the one beside it */
    for (int leaf = 0, last = 0; leaf < l.n_leaf; leaf++) {
        if (l.vertex[leaf] >= 0) last = rank[l.vertex[leaf]];
        owner[leaf] = last;
    }
    void *all[] = {equal, l.vertex, l.work, l.weight, l.here, rank, (void *)l.graph.begin,
        (void *)l.graph.to, (void *)l.graph.link};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
}

int graph_leaves_wanted(const struct comm *comm, int64_t n_element)
{
    int64_t most = (int64_t)GRAPH_LEAVES * comm->n_rank, least = comm->n_rank;
    return (int)(n_element > most ? most : n_element > least ? n_element : least);
}

/* Elements in the order of their leaves: those of leaf k are order[begin[k]] to order[begin[k + 1]]
 * - 1. */
static int *sort_by_leaf(int n_leaf, const struct graph_elements *e, int64_t *begin)
{
    int *order = fail_alloc((size_t)e->n * sizeof *order);
    for (int64_t i = 0; i < e->n; i++) begin[e->leaf[i] + 1]++;
    for (int k = 0; k < n_leaf; k++) begin[k + 1] += begin[k];
    for (int64_t i = e->n - 1; i >= 0; i--) order[--begin[e->leaf[i] + 1]] = (int)i;
    for (int k = 0; k < n_leaf; k++) begin[k] = begin[k + 1];
    begin[n_leaf] = e->n;
    return order;
}

static struct item *collect(int n_leaf, const struct graph_elements *e, int64_t *n_item)
{
    int64_t *begin = fail_alloc(((size_t)n_leaf + 1) * sizeof *begin),
            *amount = fail_alloc((size_t)n_leaf * sizeof *amount), room = 0;
    int *order = sort_by_leaf(n_leaf, e, begin), *met = fail_alloc((size_t)n_leaf * sizeof *met);
    struct item *item = NULL;
    *n_item = 0;
    for (int a = 0; a < n_leaf; a++) {
        struct item own = {a, a, 0, begin[a + 1] - begin[a]};
        int n_met = 0;
        if (own.n == 0) continue;
        for (int64_t k = begin[a]; k < begin[a + 1]; k++) {
            int i = order[k];
            own.amount += e->weight[i];
            for (int m = e->begin[i]; m < e->begin[i + 1]; m++) {
                int b = e->leaf[e->to[m]];
                if (b == a) continue;
                if (amount[b]++ == 0) met[n_met++] = b;
            }
        }
        if (*n_item + n_met + 1 > room)
            item = fail_realloc(item, (size_t)(room = 2 * (*n_item + n_met + 1)) * sizeof *item);
        item[(*n_item)++] = own;
        for (int m = 0; m < n_met; m++) {
            item[(*n_item)++] = (struct item){a, met[m], amount[met[m]], 0};
            amount[met[m]] = 0;
        }
    }
    free(begin);
    free(amount);
    free(order);
    free(met);
    return item;
}

void graph_leaves(const struct comm *comm, int n_leaf, const struct graph_elements *elements,
    const int64_t *share, double threshold, int *owner)
{
    int64_t *bytes_to = fail_alloc((size_t)comm->n_rank * sizeof *bytes_to),
            *bytes_from = fail_alloc((size_t)comm->n_rank * sizeof *bytes_from), n;
    struct item *mine = collect(n_leaf, elements, &n);
    bytes_to[0] = n * (int64_t)sizeof *mine;
    struct item *all = migrate_bytes(comm, mine, bytes_to, bytes_from);
    if (comm->rank == 0) {
        struct leaves leaves = {.n_leaf = n_leaf,
            .n_rank = comm->n_rank,
            .share = share,
            .both_sides = elements->both_sides};
        assign(leaves, all, bytes_from, threshold, owner);
    }
    comm_bcast(comm, owner, (size_t)n_leaf * sizeof *owner, 0);
    free(mine);
    free(all);
    free(bytes_to);
    free(bytes_from);
}
