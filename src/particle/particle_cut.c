/* Partition: which rank shall own which elements. A tree of cuts is made by the scene's method,
 * from positions and listed interactions.
 *
 *   geometric     the longest side of all elements is cut again and again, elements weighted by
 *                 their interactions
 *   interactions  the same with an element and each of its pairs a point of its own, pairs at their
 *                 midpoints
 *   graph         a fine tree whose leaves METIS distributes, so that few pairs lead from rank to
 *                 rank
 *
 * Whatever the method, an element goes where its own position is in the tree: who owns what is a
 * function of position, until the next cut too. */
#include "particle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "partition/graph.h"
#include "base/whole.h"
#include "comm/fail.h"

/* Cuts with raised weights, and how finely weights are kept meanwhile. */
enum { ROUNDS = 4, FINE = 16 };

/* Owned elements, and positions and number of all. Work, in halves of an interaction: an element
 * counts as one, so does each wall that it may touch; a pair counts half at both ends, and a whole
 * one on both ranks where they are two and both compute it. */
struct view {
    int64_t n, n_all;
    double (*x)[3];  /* [n_all] */
    cl_int *begin;   /* [n + 1] */
    cl_int *row;     /* [begin[n]] neighbours of the owned */
    int64_t *weight; /* [n] */
};

static void read_positions(struct sim *s, struct view *v)
{
    struct particle_run *run = s->particle;
    const struct field *state = &run->particles->field[FIELD_STATE];
    char *record = fail_alloc((size_t)v->n_all * state->bytes);
    buffer_read(&state->now, 0, (size_t)v->n_all * state->bytes, record);
    v->x = fail_alloc((size_t)v->n_all * sizeof *v->x);
    for (int64_t i = 0; i < v->n_all; i++) {
        const void *x = record + (size_t)i * state->bytes;
        for (size_t a = 0; a < 3; a++)
            v->x[i][a] = reals_get(x, run->features.position_is_float, a);
    }
    free(record);
}

static struct view view_create(struct sim *s)
{
    struct particle_run *run = s->particle;
    const struct pair_list *l = &run->pairs->now;
    struct view v = {.n = l->n_owned, .n_all = l->n_all};
    size_t n = (size_t)v.n;
    cl_int *wall = fail_alloc((n + 1) * sizeof *wall);
    v.begin = fail_alloc((n + 1) * sizeof *v.begin);
    buffer_read(&l->row_begin, 0, (n + 1) * sizeof *v.begin, v.begin);
    v.row = fail_alloc((size_t)v.begin[n] * sizeof *v.row);
    buffer_read(&l->row, 0, (size_t)v.begin[n] * sizeof *v.row, v.row);
    if (run->wall_contacts)
        buffer_read(&run->wall_contacts->now.begin, 0, (n + 1) * sizeof *wall, wall);
    v.weight = fail_alloc(n * sizeof *v.weight);
    for (size_t i = 0; i < n; i++)
        v.weight[i] = 2 + 2 * (wall[i + 1] - wall[i]) + v.begin[i + 1] - v.begin[i];
    free(wall);
    read_positions(s, &v);
    return v;
}

static void view_free(struct view *v)
{
    free(v->x);
    free(v->begin);
    free(v->row);
    free(v->weight);
}

static int *owners(const struct view *v, const struct rcb *tree)
{
    int *owner = fail_alloc((size_t)v->n_all * sizeof *owner);
    for (int64_t i = 0; i < v->n_all; i++) owner[i] = rcb_owner(tree, v->x[i]);
    return owner;
}

/* Points that are cut, with weights that may be raised. */
struct points {
    int64_t n;
    double (*x)[3];
    int64_t *weight;
};

static void add_point(struct points *p, const double x[3], int64_t weight)
{
    memcpy(p->x[p->n], x, sizeof *p->x);
    p->weight[p->n++] = FINE * weight;
}

/* Pairs of two owned elements once, others here with the half that is this rank's. */
static void add_pairs(const struct sim *s, const struct view *v, struct points *p)
{
    for (int64_t i = 0; i < v->n; i++)
        for (int k = v->begin[i]; k < v->begin[i + 1]; k++) {
            int j = v->row[k];
            double middle[3];
            if (j < v->n && j < i) continue;
            for (int a = 0; a < 3; a++) {
                double d = v->x[j][a] - v->x[i][a], period = s->particle->period[a];
                if (period > 0) d -= period * round(d / period);
                middle[a] = v->x[i][a] + 0.5 * d;
            }
            add_point(p, middle, j < v->n ? 2 : 1);
        }
}

static struct points points_create(const struct sim *s, const struct view *v)
{
    bool pairs = s->scene->partition.method == PARTITION_INTERACTIONS;
    size_t n = (size_t)v->n + (pairs ? (size_t)v->begin[v->n] : 0);
    struct points p = {0, fail_alloc(n * sizeof *p.x), fail_alloc(n * sizeof *p.weight)};
    for (int64_t i = 0; i < v->n; i++)
        add_point(&p, v->x[i], v->weight[i] - (pairs ? v->begin[i + 1] - v->begin[i] : 0));
    if (pairs) add_pairs(s, v, &p);
    return p;
}

/* Work of each rank, and the imbalance that it makes. */
static double add_up(
    const struct sim *s, const struct view *v, const struct rcb *tree, int64_t *work)
{
    int *owner = owners(v, tree);
    bool both = s->scene->partition.boundary == CUT_PAIRS_BOTH;
    memset(work, 0, (size_t)s->comm->n_rank * sizeof *work);
    for (int64_t i = 0; i < v->n; i++) {
        int64_t n_far = 0;
        for (int k = v->begin[i]; k < v->begin[i + 1] && both; k++)
            n_far += owner[v->row[k]] != owner[i];
        work[owner[i]] += v->weight[i] + n_far;
    }
    comm_sum_i64(s->comm, work, s->comm->n_rank);
    free(owner);
    return partition_imbalance(work, s->balance->share, s->comm->n_rank);
}

/* Cutting is exact in the weights of points, but that pairs between ranks are computed twice is
 * known only afterwards: where that leaves a rank with too much, its weights are raised and all is
 * cut again. */
static struct rcb *cut_points(struct sim *s, const struct view *v)
{
    int n_rank = s->comm->n_rank;
    struct points p = points_create(s, v);
    struct rcb *best = NULL;
    double least = HUGE_VAL, all = 0, shares = 0;
    int64_t *work = fail_alloc((size_t)n_rank * sizeof *work);
    for (int round = 0; round < ROUNDS && least > s->scene->partition.threshold; round++) {
        struct rcb *tree =
            rcb_create(s->comm, n_rank, s->balance->share, (const double *)p.x, p.weight, p.n);
        double imbalance = add_up(s, v, tree, work);
        all = shares = 0;
        for (int r = 0; r < n_rank; r++) {
            all += (double)work[r];
            shares += (double)s->balance->share[r];
        }
        for (int64_t i = 0; i < p.n; i++) {
            int r = rcb_owner(tree, p.x[i]);
            p.weight[i] = whole_round(fmax(
                (double)p.weight[i] * (double)work[r] / (double)s->balance->share[r] * shares / all,
                1));
        }
        bool is_better = imbalance < least;
        rcb_free(is_better ? best : tree);
        if (!is_better) continue;
        best = tree;
        least = imbalance;
    }
    free(p.x);
    free(p.weight);
    free(work);
    return best;
}

static struct rcb *cut_graph(struct sim *s, const struct view *v)
{
    int n_leaf = graph_leaves_wanted(s->comm, s->particle->particles->n_global);
    struct rcb *tree = rcb_create(s->comm, n_leaf, NULL, (const double *)v->x, v->weight, v->n);
    int *leaf = owners(v, tree), *owner = fail_alloc((size_t)n_leaf * sizeof *owner);
    struct graph_elements elements = {
        v->n, v->weight, v->begin, v->row, leaf, s->scene->partition.boundary == CUT_PAIRS_BOTH};
    graph_leaves(
        s->comm, n_leaf, &elements, s->balance->share, s->scene->partition.threshold, owner);
    rcb_assign(tree, owner);
    free(leaf);
    free(owner);
    return tree;
}

void particle_cut(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct view v = view_create(s);
    struct rcb *tree =
        s->scene->partition.method == PARTITION_GRAPH ? cut_graph(s, &v) : cut_points(s, &v);
    view_free(&v);
    rcb_free(run->rcb);
    run->rcb = tree;
    owners_set_tree(run->owners, tree);
}

void particle_spread(struct sim *s, const double *x, int64_t n)
{
    struct particle_run *run = s->particle;
    int64_t *weight = fail_alloc((size_t)n * sizeof *weight);
    for (int64_t i = 0; i < n; i++) weight[i] = 1;
    run->rcb = rcb_create(s->comm, s->comm->n_rank, NULL, x, weight, n);
    owners_set_tree(run->owners, run->rcb);
    free(weight);
}
