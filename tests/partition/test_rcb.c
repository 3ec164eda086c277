/* Recursive bisection: balance, the same tree for any distribution of the points, the first cut
 * against brute force, and the awkward inputs: coordinates that tie, fewer points than parts, none;
 * parts of unlike shares, leaves with owners. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../mpi_check.h"
#include "partition/partition.h"

enum { MAX_POINTS = 3000 };

/* All points of a case, the same on every rank. */
struct cloud {
    int n;
    double x[MAX_POINTS][3];
    int64_t weight[MAX_POINTS];
};

static double uniform(uint64_t key)
{
    return (double)(mpi_check_random(key) >> 11) * 0x1p-53;
}

static struct cloud *random_cloud(int n, const double size[3], int max_weight, uint64_t seed)
{
    struct cloud *c = calloc(1, sizeof *c);
    c->n = n;
    for (int i = 0; i < n; i++) {
        for (int a = 0; a < 3; a++)
            c->x[i][a] = size[a] * (uniform(seed + (uint64_t)(4 * i + a)) - 0.5);
        c->weight[i] =
            1 + (int64_t)(mpi_check_random(seed + (uint64_t)(4 * i + 3)) % (uint64_t)max_weight);
    }
    return c;
}

/* Where point i lies: 0 all on the last rank, 1 in turn, 2 in blocks, 3 in reverse blocks. */
static int home(int spread, int i, int n, int n_rank)
{
    if (spread == 0) return n_rank - 1;
    if (spread == 1) return i % n_rank;
    int block = (int)((int64_t)i * n_rank / n);
    return spread == 2 ? block : n_rank - 1 - block;
}

static struct rcb *cut_shares(
    const struct comm *comm, const struct cloud *c, int n_part, const int64_t *share, int spread)
{
    static double x[MAX_POINTS][3];
    static int64_t weight[MAX_POINTS];
    int n = 0;
    for (int k = 0; k < c->n; k++) {
        int i = spread == 3 ? c->n - 1 - k : k; /* another order, too */
        if (home(spread, i, c->n, comm->n_rank) != comm->rank) continue;
        memcpy(x[n], c->x[i], sizeof x[n]);
        weight[n++] = c->weight[i];
    }
    return rcb_create(comm, n_part, share, x[0], weight, n);
}

static struct rcb *cut(const struct comm *comm, const struct cloud *c, int n_part, int spread)
{
    return cut_shares(comm, c, n_part, NULL, spread);
}

/* Every node but the root is a child once, every rank is a leaf once, cuts are numbers. */
static void check_tree(const struct rcb *rcb, int n_part)
{
    int seen[2 * 128] = {0};
    CHECK(rcb->n_node == n_part - 1);
    for (int k = 0; k < rcb->n_node; k++) {
        CHECK(rcb->axis[k] >= 0 && rcb->axis[k] < 3 && isfinite(rcb->cut[k]));
        int child[2] = {rcb->left[k], rcb->right[k]};
        for (int s = 0; s < 2; s++) {
            CHECK(child[s] >= -n_part && child[s] < rcb->n_node && child[s] != 0);
            seen[child[s] >= 0 ? child[s] : n_part + (-1 - child[s])]++;
        }
    }
    for (int k = 1; k < rcb->n_node; k++) CHECK(seen[k] == 1);
    for (int r = 0; r < n_part && n_part > 1; r++) CHECK(seen[n_part + r] == 1);
}

static void check_same(const struct rcb *a, const struct rcb *b)
{
    size_t n = (size_t)a->n_node;
    CHECK(a->n_node == b->n_node && !memcmp(a->axis, b->axis, n * sizeof(int)) &&
          !memcmp(a->cut, b->cut, n * sizeof(double)));
    CHECK(
        !memcmp(a->left, b->left, n * sizeof(int)) && !memcmp(a->right, b->right, n * sizeof(int)));
}

/* The tree of rank 0, so that all ranks can be compared with it. */
static void check_same_on_all(const struct comm *comm, const struct rcb *rcb)
{
    double mine[128][4] = {{0}}, first[128][4];
    for (int k = 0; k < rcb->n_node; k++) {
        double node[4] = {rcb->axis[k], rcb->cut[k], rcb->left[k], rcb->right[k]};
        memcpy(mine[k], node, sizeof node);
    }
    memcpy(first, mine, sizeof first);
    comm_bcast(comm, first, sizeof first, 0);
    CHECK(!memcmp(first, mine, sizeof first));
}

static void sums(const struct rcb *rcb, const struct cloud *c, int n_part, int64_t *sum)
{
    memset(sum, 0, (size_t)n_part * sizeof *sum);
    for (int i = 0; i < c->n; i++) {
        int r = rcb_owner(rcb, c->x[i]);
        CHECK(r >= 0 && r < n_part);
        sum[r] += c->weight[i];
    }
}

/* Distinct coordinates: every part has its share within the weight of one point. */
static void balanced(const struct comm *comm, const struct cloud *c, int n_part)
{
    int64_t sum[128], total = 0, heaviest = 0;
    struct rcb *rcb = cut(comm, c, n_part, 1);
    check_tree(rcb, n_part);
    check_same_on_all(comm, rcb);
    sums(rcb, c, n_part, sum);
    for (int i = 0; i < c->n; i++) {
        total += c->weight[i];
        if (c->weight[i] > heaviest) heaviest = c->weight[i];
    }
    for (int r = 0; r < n_part; r++) CHECK(llabs(sum[r] * n_part - total) <= heaviest * n_part);
    for (int spread = n_part % 4; spread < 4; spread += 2) {
        struct rcb *other = cut(comm, c, n_part, spread);
        check_same(rcb, other);
        rcb_free(other);
    }
    rcb_free(rcb);
}

/* The root's cut is along the longest side, and no other place there splits the weights better. */
static void first_cut(const struct comm *comm, const struct cloud *c, int n_part, int axis)
{
    struct rcb *rcb = cut(comm, c, n_part, 2);
    int64_t total = 0, best = INT64_MAX, got = 0;
    for (int i = 0; i < c->n; i++) total += c->weight[i];
    for (int i = 0; i < c->n; i++) { /* just below point i */
        int64_t left = 0;
        for (int k = 0; k < c->n; k++)
            if (c->x[k][axis] < c->x[i][axis]) left += c->weight[k];
        int64_t miss = llabs(left * n_part - total * (n_part / 2));
        if (miss < best) best = miss;
    }
    for (int i = 0; i < c->n; i++)
        if (c->x[i][axis] < rcb->cut[0]) got += c->weight[i];
    CHECK(rcb->axis[0] == axis);
    CHECK(llabs(got * n_part - total * (n_part / 2)) == best);
    rcb_free(rcb);
}

/* Points of a plane, of a line, of one place, and of a regular grid. */
static void ties(const struct comm *comm)
{
    int64_t sum[128];
    struct cloud *c = random_cloud(1000, (double[3]){1, 2, 0.5}, 1, 77);
    struct rcb *rcb;

    /* a plane y = const: cut along x and z only */
    for (int i = 0; i < c->n; i++) c->x[i][1] = 0.25;
    rcb = cut(comm, c, 8, 1);
    check_tree(rcb, 8);
    sums(rcb, c, 8, sum);
    for (int r = 0; r < 8; r++) CHECK(sum[r] == 125);
    for (int k = 0; k < 7; k++) CHECK(rcb->axis[k] != 1);
    rcb_free(rcb);

    /* x is by far the longest side, but most points share theirs: z has to do */
    for (int i = 0; i < 950; i++) c->x[i][0] = -10;
    for (int i = 950; i < c->n; i++) c->x[i][0] = 10;
    rcb = cut(comm, c, 2, 1);
    sums(rcb, c, 2, sum);
    CHECK(rcb->axis[0] == 2 && sum[0] == 500 && sum[1] == 500);
    rcb_free(rcb);

    /* one place */
    for (int i = 0; i < c->n; i++) c->x[i][0] = c->x[i][1] = c->x[i][2] = i % 2 ? 0.0 : -0.0;
    rcb = cut(comm, c, 5, 1);
    check_tree(rcb, 5);
    sums(rcb, c, 5, sum);
    int owners = 0;
    for (int r = 0; r < 5; r++) owners += sum[r] > 0;
    CHECK(owners == 1 && rcb_owner(rcb, c->x[0]) == rcb_owner(rcb, c->x[1]));
    rcb_free(rcb);

    /* 10 x 10 x 10, of unlike sides: cut in halves along x, then y, then z */
    for (int i = 0; i < c->n; i++)
        for (int a = 0, k = i; a < 3; a++, k /= 10) c->x[i][a] = (3 - a) * 0.001 * (k % 10 - 20);
    rcb = cut(comm, c, 8, 1);
    sums(rcb, c, 8, sum);
    for (int r = 0; r < 8; r++) CHECK(sum[r] == 125);
    CHECK(rcb->axis[0] == 0 && fabs(rcb->cut[0] - 3 * 0.001 * (4.5 - 20)) < 1e-12);
    rcb_free(rcb);

    /* 41 planes of 9 points along the long x, y irregular: 2.4 % off along x is good enough, no cut
     * across */
    c->n = 369;
    for (int i = 0; i < c->n; i++) {
        c->x[i][0] = i / 9;
        c->x[i][1] = uniform((uint64_t)i);
        c->x[i][2] = i % 3;
    }
    rcb = cut(comm, c, 2, 1);
    sums(rcb, c, 2, sum);
    CHECK(rcb->axis[0] == 0 && llabs(sum[0] - sum[1]) == 9);
    rcb_free(rcb);
    free(c);
}

static void few(const struct comm *comm)
{
    int64_t sum[128];
    for (int n = 0; n <= 3; n++)
        for (int n_part = 1; n_part <= 128; n_part = n_part < 6 ? n_part + 1 : 5 * n_part) {
            struct cloud *c = random_cloud(n, (double[3]){1, 1, 1}, 1, 5);
            struct rcb *rcb = cut(comm, c, n_part, 1);
            check_tree(rcb, n_part);
            sums(rcb, c, n_part, sum);
            for (int r = 0; r < n_part && n_part >= n; r++) CHECK(sum[r] <= 1);
            int r = rcb_owner(rcb, (double[3]){1e9, -1e9, 0}); /* anywhere belongs to someone */
            CHECK(r >= 0 && r < n_part);
            rcb_free(rcb);
            free(c);
        }
}

/* Every part has its share within the weight of one point; the same share for all is the same tree
 * as no shares. */
static void shares(const struct comm *comm, const struct cloud *c)
{
    static const int64_t share[7] = {1000, 1, 400, 2, 50, 3, 900};
    int64_t sum[7], total = 0, all = 0, equal[7];
    struct rcb *rcb = cut_shares(comm, c, 7, share, 1), *same, *none = cut(comm, c, 7, 2);
    check_tree(rcb, 7);
    check_same_on_all(comm, rcb);
    sums(rcb, c, 7, sum);
    for (int i = 0; i < c->n; i++) total += c->weight[i];
    for (int p = 0; p < 7; p++) {
        all += share[p];
        equal[p] = 123;
    }
    for (int p = 0; p < 7; p++) CHECK(llabs(sum[p] * all - total * share[p]) <= 9 * all);
    same = cut_shares(comm, c, 7, equal, 3);
    check_same(same, none);
    rcb_free(rcb);
    rcb_free(same);
    rcb_free(none);
}

/* Leaves that belong to somebody. */
static void owned_leaves(const struct comm *comm, const struct cloud *c)
{
    static const int owner[6] = {3, 0, 3, 1, 0, 2};
    struct rcb *leaves = cut(comm, c, 6, 1), *owned = cut(comm, c, 6, 1);
    rcb_assign(owned, owner);
    for (int i = 0; i < c->n; i++)
        CHECK(rcb_owner(owned, c->x[i]) == owner[rcb_owner(leaves, c->x[i])]);
    rcb_free(leaves);
    rcb_free(owned);
}

static void imbalance(const struct comm *comm)
{
    int n = comm->n_rank;
    double mean = 0;
    struct partition_quality q = {0};
    CHECK(partition_imbalance((int64_t[]){1, 2, 3, 4}, NULL, 4) == 4 / 2.5 - 1);
    CHECK(partition_imbalance((int64_t[]){7, 7, 7}, NULL, 3) == 0 &&
          partition_imbalance((int64_t[]){0, 0}, NULL, 2) == 0);
    CHECK(partition_imbalance((int64_t[]){12, 0, 0}, NULL, 3) == 2);
    CHECK(partition_imbalance((int64_t[]){10, 20, 30}, (int64_t[]){1, 2, 3}, 3) == 0);
    /* 30 where 20 are due */
    CHECK(fabs(partition_imbalance((int64_t[]){30, 30}, (int64_t[]){1, 2}, 2) - 0.5) < 1e-15);
    for (int r = 0; r < n; r++) mean += (r + 1.0) / n;
    partition_quality_add(
        &q, comm, &(struct partition_part){comm->rank + 1, 2 * comm->rank, comm->rank}, NULL);
    partition_quality_add(&q, comm, &(struct partition_part){5, 1, 1}, NULL);
    CHECK(q.n == 2 && fabs(q.imbalance_max - (n / mean - 1)) < 1e-15 && q.imbalance == 0 &&
          q.imbalance_sum == q.imbalance_max);
    CHECK(q.cut_sum == n * (n - 1) + n && q.neighbours_max == (n > 2 ? n - 1 : 1) &&
          fabs(q.neighbours_sum - ((n - 1) / 2.0 + 1)) < 1e-12);
}

int main(int argc, char **argv)
{
    static const int n_part[] = {1, 2, 3, 5, 8, 23, 128};
    struct comm *comm = comm_create(&argc, &argv);
    struct cloud *even = random_cloud(1013, (double[3]){0.3, 0.1, 1.0}, 1, 1),
                 *heavy = random_cloud(3000, (double[3]){1, 5, 2}, 9, 99);
    for (size_t k = 0; k < sizeof n_part / sizeof *n_part; k++) {
        balanced(comm, even, n_part[k]);
        balanced(comm, heavy, n_part[k]);
    }
    for (int k = 2; k <= 5; k++) {
        first_cut(comm, even, k, 2);
        first_cut(comm, heavy, k, 1);
    }
    ties(comm);
    few(comm);
    shares(comm, heavy);
    owned_leaves(comm, heavy);
    imbalance(comm);
    rcb_free(NULL);
    free(even);
    free(heavy);
    comm_free(comm);
    return 0;
}
