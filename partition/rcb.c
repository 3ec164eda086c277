/* Level by level, all groups of a level together, so the number of reductions grows with the
 * logarithm of the number of leaves: about ten per level.
 *
 * The cut of a group is found exactly and without sorting: each coordinate is taken as a 64-bit key
 * of the same order, and a radix selection finds the key at which the sum of weights passes the
 * target, 8 bits per pass over the points and one reduction of 256 sums per group. Points of that
 * very coordinate go all to the left or all to the right, whichever lies nearer to the target, so
 * equal coordinates stay together. The cut lies half-way to the next point, away from round-off of
 * both.
 *
 * Only integers are summed, and minima and maxima do not depend on order: the same points give the
 * same tree however they are spread over ranks. */
#include "partition.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"

enum { DIGIT = 256, N_DIGIT = 8 };

/* Leaves first to first + count - 1 and the points that are theirs together. */
struct group {
    int node, first, count;
    int64_t shares, left; /* of all of them, of the first count/2 */
    int64_t weight;
    int axis[3]; /* longest side first */
    /* The best cut so far: its axis, and the left side's keys, those below `key`, with `key` itself
     * if `with`. */
    int best;
    uint64_t key;
    bool with;
    int64_t miss; /* |left weight shares - weight left|, in weights times shares; -1: no cut yet */
    bool open;    /* another axis is to be tried */
};

struct points {
    const double *x;       /* [n][3] */
    const int64_t *weight; /* [n] */
    int *group;            /* [n]; -1: has its leaf */
    int64_t n;
};

/* Unsigned integer of the same order as the double. */
static uint64_t key_of(double x)
{
    uint64_t bits;
    x += 0.0; /* -0 becomes +0 */
    memcpy(&bits, &x, sizeof bits);
    return bits >> 63 ? ~bits : bits | (uint64_t)1 << 63;
}

static bool is_left(const struct group *g, const double x[3])
{
    uint64_t key = key_of(x[g->best]);
    return key < g->key || (g->with && key == g->key);
}

/* Weight and axes, longest side first, of each group. */
static void measure(
    const struct comm *comm, const struct points *p, struct group *group, int n_group)
{
    int64_t *weight = fail_alloc((size_t)n_group * sizeof *weight);
    /* max of x and of -x: empty groups keep -inf */
    double(*top)[6] = fail_alloc((size_t)n_group * sizeof *top);
    for (int g = 0; g < n_group; g++)
        for (int a = 0; a < 6; a++) top[g][a] = -HUGE_VAL;
    for (int64_t i = 0; i < p->n; i++) {
        int g = p->group[i];
        if (g < 0) continue;
        weight[g] += p->weight[i];
        for (int a = 0; a < 3; a++) {
            double x = p->x[3 * i + a];
            if (x > top[g][a]) top[g][a] = x;
            if (-x > top[g][3 + a]) top[g][3 + a] = -x;
        }
    }
    comm_sum_i64(comm, weight, n_group);
    comm_max_f64(comm, top[0], 6 * n_group);
    for (int g = 0; g < n_group; g++) {
        struct group *h = &group[g];
        h->weight = weight[g];
        for (int a = 0; a < 3; a++) { /* insertion sort; ties keep x before y before z */
            int k = a;
            for (; k > 0 &&
                   top[g][a] + top[g][3 + a] > top[g][h->axis[k - 1]] + top[g][3 + h->axis[k - 1]];
                 k--)
                h->axis[k] = h->axis[k - 1];
            h->axis[k] = a;
        }
        h->best = h->axis[0];
        h->miss = -1;
        h->open = weight[g] > 0;
    }
    free(weight);
    free(top);
}

/* Takes the cut at `key` along `axis` if it is better than what the group has. `below`, `at`:
 * weight of points below and at the key. A cut is good enough where it misses by at most half the
 * heaviest point (what distinct coordinates allow) or 5 % of the smaller side; else the
 * next-longest axis is tried too: a plane of points with one coordinate cannot be split along
 * it. */
static void consider(
    struct group *g, int axis, uint64_t key, int64_t below, int64_t at, int64_t heaviest)
{
    int64_t goal = g->weight * g->left, low = llabs(below * g->shares - goal),
            high = llabs((below + at) * g->shares - goal);
    int64_t smaller = g->left < g->shares - g->left ? g->left : g->shares - g->left;
    bool with = high < low;
    int64_t miss = with ? high : low;
    if (g->miss < 0 || miss < g->miss) {
        g->best = axis;
        g->key = key;
        g->with = with;
        g->miss = miss;
    }
    g->open = g->miss > heaviest * g->shares / 2 && g->miss > g->weight * smaller / 20;
}

/* Finds the cut of each open group along its `attempt`-longest axis. */
static void select_keys(const struct comm *comm, const struct points *p, struct group *group,
    int n_group, int attempt, int64_t heaviest)
{
    uint64_t *prefix = fail_alloc((size_t)n_group * sizeof *prefix); /* leading digits of the key */
    /* weight of points with a smaller prefix */
    int64_t *below = fail_alloc((size_t)n_group * sizeof *below);
    int64_t *sum = fail_alloc((size_t)n_group * DIGIT * sizeof *sum);
    int *digit = fail_alloc((size_t)n_group * sizeof *digit);
    for (int pass = 0; pass < N_DIGIT; pass++) {
        int shift = 8 * (N_DIGIT - 1 - pass);
        memset(sum, 0, (size_t)n_group * DIGIT * sizeof *sum);
        for (int64_t i = 0; i < p->n; i++) {
            int g = p->group[i];
            if (g < 0 || !group[g].open) continue;
            uint64_t key = key_of(p->x[3 * i + group[g].axis[attempt]]) >> shift;
            if (key >> 8 == prefix[g]) sum[g * DIGIT + (int)(key & 255)] += p->weight[i];
        }
        comm_sum_i64(comm, sum, n_group * DIGIT);
        for (int g = 0; g < n_group; g++) {
            if (!group[g].open) continue;
            /* < weight, so a digit is found */
            int64_t target = group[g].weight * group[g].left / group[g].shares;
            int d = 0;
            for (; below[g] + sum[g * DIGIT + d] <= target; d++) below[g] += sum[g * DIGIT + d];
            prefix[g] = prefix[g] << 8 | (uint64_t)d;
            digit[g] = d;
        }
    }
    for (int g = 0; g < n_group; g++)
        if (group[g].open)
            consider(&group[g], group[g].axis[attempt], prefix[g], below[g],
                sum[g * DIGIT + digit[g]], heaviest);
    free(prefix);
    free(below);
    free(sum);
    free(digit);
}

/* Coordinates of the cuts: half-way between the last point on the left and the first on the right.
 * A group without points gets 0, which is as good as any. */
static void place_cuts(const struct comm *comm, const struct points *p, const struct group *group,
    int n_group, double *cut)
{
    /* max of x on the left, of -x on the right */
    double(*side)[2] = fail_alloc((size_t)n_group * sizeof *side);
    for (int g = 0; g < n_group; g++) side[g][0] = side[g][1] = -HUGE_VAL;
    for (int64_t i = 0; i < p->n; i++) {
        int g = p->group[i];
        if (g < 0) continue;
        bool left = is_left(&group[g], &p->x[3 * i]);
        double x = p->x[3 * i + group[g].best], *most = &side[g][left ? 0 : 1];
        if (!left) x = -x;
        if (x > *most) *most = x;
    }
    comm_max_f64(comm, side[0], 2 * n_group);
    for (int g = 0; g < n_group; g++) {
        double a = side[g][0], b = -side[g][1]; /* a < b */
        if (group[g].weight == 0) cut[g] = 0;
        else if (isinf(a)) cut[g] = b;                      /* all right */
        else if (isinf(b)) cut[g] = nextafter(a, HUGE_VAL); /* all left */
        else {
            cut[g] = 0.5 * a + 0.5 * b;
            if (!(cut[g] > a && cut[g] <= b)) cut[g] = b; /* neighbouring numbers */
        }
    }
    free(side);
}

static int64_t shares_of(const int64_t *share, int first, int count)
{
    int64_t sum = 0;
    for (int k = first; k < first + count; k++) sum += share ? share[k] : 1;
    return sum;
}

/* Child of node g->node with `count` leaves from `first`: a leaf, or a node and a group of the next
 * level. */
static int child(
    const int64_t *share, int first, int count, struct group *next, int *n_next, int *n_node)
{
    if (count == 1) return -1 - first;
    next[(*n_next)++] = (struct group){.node = *n_node,
        .first = first,
        .count = count,
        .shares = shares_of(share, first, count),
        .left = shares_of(share, first, count / 2)};
    return (*n_node)++;
}

/* Writes the level's nodes and makes the groups of the next level. Returns how many. */
static int split(struct rcb *rcb, const int64_t *share, struct points *p, const struct group *group,
    int n_group, const double *cut, struct group *next, int *n_node)
{
    int n_next = 0;
    /* group of the next level, -1: a leaf */
    int(*to)[2] = fail_alloc((size_t)n_group * sizeof *to);
    for (int g = 0; g < n_group; g++) {
        const struct group *h = &group[g];
        int n_left = h->count / 2, k = h->node;
        rcb->axis[k] = h->best;
        rcb->cut[k] = cut[g];
        to[g][0] = n_left > 1 ? n_next : -1;
        rcb->left[k] = child(share, h->first, n_left, next, &n_next, n_node);
        to[g][1] = h->count - n_left > 1 ? n_next : -1;
        rcb->right[k] = child(share, h->first + n_left, h->count - n_left, next, &n_next, n_node);
    }
    for (int64_t i = 0; i < p->n; i++) {
        int g = p->group[i];
        if (g >= 0) p->group[i] = to[g][p->x[3 * i + group[g].best] < cut[g] ? 0 : 1];
    }
    free(to);
    return n_next;
}

struct rcb *rcb_create(const struct comm *comm, int n_leaf, const int64_t *share, const double *x,
    const int64_t *weight, int64_t n)
{
    int n_group = 0, n_node = 0;
    struct rcb *rcb = fail_alloc(sizeof *rcb);
    struct points p = {x, weight, fail_alloc((size_t)n * sizeof *p.group), n};
    struct group *group = fail_alloc((size_t)n_leaf * sizeof *group),
                 *next = fail_alloc((size_t)n_leaf * sizeof *next);
    double *cut = fail_alloc((size_t)n_leaf * sizeof *cut);
    int64_t heaviest = 0;

    rcb->n_node = n_leaf - 1;
    rcb->axis = fail_alloc((size_t)rcb->n_node * sizeof *rcb->axis);
    rcb->cut = fail_alloc((size_t)rcb->n_node * sizeof *rcb->cut);
    rcb->left = fail_alloc((size_t)rcb->n_node * sizeof *rcb->left);
    rcb->right = fail_alloc((size_t)rcb->n_node * sizeof *rcb->right);
    for (int64_t i = 0; i < n; i++) {
        assert(weight[i] > 0 && isfinite(x[3 * i]) && isfinite(x[3 * i + 1]) &&
               isfinite(x[3 * i + 2]));
        if (weight[i] > heaviest) heaviest = weight[i];
    }
    comm_max_i64(comm, &heaviest, 1);

    if (n_leaf > 1) child(share, 0, n_leaf, group, &n_group, &n_node);
    while (n_group > 0) {
        measure(comm, &p, group, n_group);
        for (int attempt = 0; attempt < 3; attempt++) {
            bool open = false;
            for (int g = 0; g < n_group; g++) open |= group[g].open;
            if (open) select_keys(comm, &p, group, n_group, attempt, heaviest);
        }
        place_cuts(comm, &p, group, n_group, cut);
        n_group = split(rcb, share, &p, group, n_group, cut, next, &n_node);
        struct group *swap = group;
        group = next;
        next = swap;
    }
    free(p.group);
    free(group);
    free(next);
    free(cut);
    return rcb;
}

int rcb_owner(const struct rcb *rcb, const double x[3])
{
    int k = rcb->n_node > 0 ? 0 : -1;
    while (k >= 0) k = x[rcb->axis[k]] < rcb->cut[k] ? rcb->left[k] : rcb->right[k];
    return -1 - k;
}

void rcb_assign(struct rcb *rcb, const int *owner)
{
    int *child[] = {rcb->left, rcb->right};
    for (int side = 0; side < 2; side++)
        for (int k = 0; k < rcb->n_node; k++)
            if (child[side][k] < 0) child[side][k] = -1 - owner[-1 - child[side][k]];
}

void rcb_free(struct rcb *rcb)
{
    if (!rcb) return;
    free(rcb->axis);
    free(rcb->cut);
    free(rcb->left);
    free(rcb->right);
    free(rcb);
}
