/* METIS 5.1. What it cannot do is done here: one part (it divides by zero), no edges, fewer
 * vertices than parts, parts that it leaves empty.
 *
 * It catches SIGTERM and SIGABRT while it works, and jumps: SIGTERM waits until it is done. Threads
 * other than this one must not take it either, see signals_hold. */
#include "graph.h"

#if HAVE_METIS
#include <metis.h>
#endif
#include <signal.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"

/* Recursive bisection, the best of four: the direct k-way method cut 8,000 pairs where this cut
 * 6,200 (16 parts of 64 leaves of the L-box), in no less time, and may leave parts empty. SLACK:
 * imbalance that METIS may leave, in thousandths. */
enum { SEED = 1, CUTS = 4, SLACK = 5 };

/* Vertices in their order, each part up to its share. */
static void cut_in_order(const struct graph *g, int n_part, const int64_t *share, int *part)
{
    double all = 0, shares = 0, weight = 0, bound = 0;
    for (int v = 0; v < g->n; v++) all += (double)g->weight[v];
    for (int p = 0; p < n_part; p++) shares += (double)share[p];
    int p = 0;
    bound = all * (double)share[0] / shares;
    for (int v = 0; v < g->n; v++) {
        double middle = weight + 0.5 * (double)g->weight[v];
        while (p < n_part - 1 && middle > bound) bound += all * (double)share[++p] / shares;
        part[v] = p;
        weight += (double)g->weight[v];
    }
}

/* Each empty part takes a vertex from the part that has most. */
static void fill_empty(int n, int n_part, int *part)
{
    int *count = fail_alloc((size_t)n_part * sizeof *count);
    for (int v = 0; v < n; v++) count[part[v]]++;
    for (int p = 0; p < n_part; p++) {
        if (count[p] > 0) continue;
        int most = 0, v = 0;
        for (int q = 1; q < n_part; q++)
            if (count[q] > count[most]) most = q;
        while (part[v] != most) v++;
        part[v] = p;
        count[p]++;
        count[most]--;
    }
    free(count);
}

#if HAVE_METIS
/* Weights as METIS numbers: it adds them up in 32 bits. */
static idx_t *scaled(const int64_t *value, int64_t n, int64_t least)
{
    idx_t *out = fail_alloc((size_t)n * sizeof *out);
    int64_t sum = 0;
    for (int64_t k = 0; k < n; k++) sum += value[k];
    int64_t divisor = sum / (1 << 30) + 1;
    for (int64_t k = 0; k < n; k++) {
        int64_t small = value[k] / divisor;
        out[k] = (idx_t)(small > least ? small : least);
    }
    return out;
}

static idx_t *copied(const int *value, int64_t n)
{
    idx_t *out = fail_alloc((size_t)n * sizeof *out);
    for (int64_t k = 0; k < n; k++) out[k] = (idx_t)value[k];
    return out;
}

static void call_metis(const struct graph *g, int n_part, const int64_t *share, int *part)
{
    idx_t n = g->n, n_weight = 1, parts = n_part, cut, option[METIS_NOPTIONS];
    int64_t n_edge = g->begin[g->n];
    double shares = 0;
    idx_t *begin = copied(g->begin, g->n + 1), *to = copied(g->to, n_edge),
          *weight = scaled(g->weight, g->n, 1), *link = scaled(g->link, n_edge, 1);
    idx_t *found = fail_alloc((size_t)g->n * sizeof *found);
    real_t *target = fail_alloc((size_t)n_part * sizeof *target);
    sigset_t term, before;
    for (int p = 0; p < n_part; p++) shares += (double)share[p];
    for (int p = 0; p < n_part; p++) target[p] = (real_t)((double)share[p] / shares);
    METIS_SetDefaultOptions(option);
    option[METIS_OPTION_SEED] = SEED;
    option[METIS_OPTION_UFACTOR] = SLACK;
    option[METIS_OPTION_NCUTS] = CUTS;
    sigemptyset(&term);
    sigaddset(&term, SIGTERM);
    sigprocmask(SIG_BLOCK, &term, &before);
    int code = METIS_PartGraphRecursive(
        &n, &n_weight, begin, to, weight, NULL, link, &parts, target, NULL, option, &cut, found);
    sigprocmask(SIG_SETMASK, &before, NULL);
    if (code != METIS_OK)
        fail_stop(EXIT_IO, "METIS cannot cut a graph of %d vertices into %d parts: code %d", g->n,
            n_part, code);
    for (int v = 0; v < g->n; v++) part[v] = (int)found[v];
    void *all[] = {begin, to, weight, link, found, target};
    for (int k = 0; k < 6; k++) free(all[k]);
}
#else
/* The check of a scene has refused `method: graph` before. */
static void call_metis(const struct graph *g, int n_part, const int64_t *share, int *part)
{
    (void)share;
    (void)part;
    fail_stop(EXIT_USAGE, "%d parts of a graph of %d vertices need METIS", n_part, g->n);
}
#endif

void graph_partition(const struct graph *graph, int n_part, const int64_t *share, int *part)
{
    int n = graph->n;
    if (n_part == 1 || n == 0) memset(part, 0, (size_t)n * sizeof *part);
    else if (n <= n_part)
        for (int v = 0; v < n; v++) part[v] = v;
    else {
        if (graph->begin[n] == 0) cut_in_order(graph, n_part, share, part);
        else call_metis(graph, n_part, share, part);
        fill_empty(n, n_part, part);
    }
}

struct match {
    int64_t overlap;
    int part, rank;
};

/* Largest overlap first; of equal ones in order, so that nothing depends on the sort. */
static int compare(const void *a, const void *b)
{
    const struct match *x = a, *y = b;
    if (x->overlap != y->overlap) return x->overlap < y->overlap ? 1 : -1;
    return x->part != y->part ? x->part - y->part : x->rank - y->rank;
}

void graph_names(int n_part, const int64_t *overlap, int *name)
{
    size_t n = 0;
    struct match *match = fail_alloc((size_t)n_part * (size_t)n_part * sizeof *match);
    bool *taken = fail_alloc((size_t)n_part * sizeof *taken);
    for (int p = 0; p < n_part; p++)
        for (int r = 0; r < n_part; r++)
            if (overlap[(size_t)p * (size_t)n_part + (size_t)r] > 0)
                match[n++] = (struct match){overlap[(size_t)p * (size_t)n_part + (size_t)r], p, r};
    qsort(match, n, sizeof *match, compare);
    for (int p = 0; p < n_part; p++) name[p] = -1;
    for (size_t k = 0; k < n; k++) {
        if (name[match[k].part] >= 0 || taken[match[k].rank]) continue;
        name[match[k].part] = match[k].rank;
        taken[match[k].rank] = true;
    }
    for (int p = 0; p < n_part; p++) /* who overlaps with nobody keeps its number where it can */
        if (name[p] < 0 && !taken[p]) taken[name[p] = p] = true;
    for (int p = 0, r = 0; p < n_part; p++) {
        if (name[p] >= 0) continue;
        while (taken[r]) r++;
        taken[name[p] = r] = true;
    }
    free(match);
    free(taken);
}
