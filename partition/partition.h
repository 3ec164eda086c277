/* Partitioning: positions and weights in, owner of each point out. Knows no physics, no element, no device. */
#ifndef DEMOCLES_PARTITION_H
#define DEMOCLES_PARTITION_H

#include "../comm/comm.h"

/* Recursive coordinate bisection as a tree of cuts, the same on every rank. Node k: a point with x[axis] < cut goes to `left`, else to `right`;
 * a child c >= 0 is a node, c < 0 is the rank -1 - c. One rank: no nodes, everything belongs to rank 0. Flat arrays, ready for a device. */
struct rcb {
    int n_node;  /* n_rank - 1 */
    int *axis;   /* [n_node] 0, 1, 2 */
    double *cut; /* [n_node] [m] */
    int *left, *right;
};

/* Collective. Cuts the longest side of the bounding box of the points again and again so that every rank's sum of weights is as equal as points
 * allow; any number of ranks (an odd number is split into floor and ceil with proportional weights). Deterministic and independent of how the
 * points are spread over ranks: sums are of integers. x [n][3] points of this rank, weight [n] > 0. Works with fewer points than ranks, and none. */
struct rcb *rcb_create(const struct comm *comm, const double *x, const int64_t *weight, int64_t n);
int rcb_owner(const struct rcb *rcb, const double x[3]);
void rcb_free(struct rcb *rcb);

/* Imbalance U = (W_max - W_mean)/W_mean of a weight per rank. Collective. */
double partition_imbalance(const struct comm *comm, int64_t weight);

#endif
