/* Partitioning: positions and weights in, owner of each point out. Knows no physics, no element, no
 * device. graph.h does it for graphs. */
#ifndef DEMOCLES_PARTITION_H
#define DEMOCLES_PARTITION_H

#include "comm/comm.h"

/* A tree of cuts, the same on every rank. Node k: a point with x[axis] < cut goes to `left`, else
 * to `right`; a child c >= 0 is a node, c < 0 is the leaf -1 - c. A leaf is a rank, or what
 * rcb_assign gives to one. No nodes: everything is leaf 0. Flat arrays, ready for a device. */
struct rcb {
    int n_node;  /* leaves - 1 */
    int *axis;   /* [n_node] 0, 1, 2 */
    double *cut; /* [n_node] [m] */
    int *left, *right;
};

/* Collective. Recursive coordinate bisection: cuts the longest side of the bounding box of the
 * points again and again so that every leaf's sum of weights is as near to its share of all as
 * points allow; any number of leaves (an odd number is split into floor and ceil). share [n_leaf] >
 * 0 of one sum, below 2^24 together; NULL: equal ones. Deterministic and independent of how the
 * points are spread over ranks: sums are of integers. x [n][3] points of this rank, weight [n] > 0.
 * Works with fewer points than leaves, and none. */
struct rcb *rcb_create(const struct comm *comm, int n_leaf, const int64_t *share, const double *x,
    const int64_t *weight, int64_t n);
/* Leaf k becomes owner[k]. */
void rcb_assign(struct rcb *rcb, const int *owner);
/* The leaf that x is in, or its owner. */
int rcb_owner(const struct rcb *rcb, const double x[3]);
void rcb_free(struct rcb *rcb);

/* Imbalance U = (W_max - W_mean)/W_mean of work [n]; with shares: of work per share, against all
 * work over all shares. */
double partition_imbalance(const int64_t *work, const int64_t *share, int n);

/* One rank's part: its work, the interactions that it has in common with others, those whose other
 * end it owns counted there too, the ranks that it exchanges with. */
struct partition_part {
    int64_t work, cut, neighbours;
};

/* What partitions were like, over all that were added. */
struct partition_quality {
    int64_t n;
    double imbalance_sum, imbalance_max, imbalance; /* U: of all, of the last one */
    /* interactions between ranks, each counted once */
    double cut_sum, cut;
    double neighbours_sum; /* of means over ranks */
    int64_t neighbours_max;
};

/* Collective. share [n_rank] or NULL. */
void partition_quality_add(struct partition_quality *quality, const struct comm *comm,
    const struct partition_part *mine, const int64_t *share);

#endif
