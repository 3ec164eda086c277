/* Partitioning of graphs by METIS, serial, on rank 0: vertices have weights, edges have weights,
 * the parts have shares of the whole.
 *
 * democles gives it no element but leaves of a fine tree of cuts (partition.h), GRAPH_LEAVES per
 * rank: the graph stays small however many elements there are, and who owns what stays a function
 * of position. Measured on the L-box, 46,680 elements: METIS on elements themselves cuts 12 to 18 %
 * fewer pairs, needs as many ghosts, and takes 100 to 500 ms where leaves take 10 to 50. Knows no
 * positions. */
#ifndef DEMOCLES_GRAPH_H
#define DEMOCLES_GRAPH_H

#include "comm/comm.h"

/* With 64 leaves and more METIS finds worse cuts, with 8 parts are up to 15 % too large. */
enum { GRAPH_LEAVES = 32 };

struct graph {
    int n;                 /* vertices */
    const int64_t *weight; /* [n] > 0 */
    const int *begin;      /* [n + 1] edges of each vertex, both ways, no loops */
    const int *to;         /* [begin[n]] */
    const int64_t *link;   /* [begin[n]] weight of the edge > 0, the same both ways */
};

/* part [n]: 0 to n_part - 1, so that the weights of parts are as share [n_part] > 0 and few edges
 * lead from part to part. The same graph gives the same parts. No part is empty unless there are
 * fewer vertices than parts; one part, no edges, no vertices, several components are fine. */
void graph_partition(const struct graph *graph, int n_part, const int64_t *share, int *part);

/* Names of parts, so that little changes hands: name [n_part], a permutation. overlap
 * [n_part][n_part]: what part p holds of what is with rank r. Greedy: the largest overlap first. */
void graph_names(int n_part, const int64_t *overlap, int *name);

/* Elements of one rank and their neighbours, as far as the tree of cuts sorts them into leaves. */
struct graph_elements {
    int64_t n;
    const int64_t *weight; /* [n] work > 0 */
    const int *begin;      /* [n + 1] */
    /* [begin[n]] neighbours: of a pair, one end names the other, or both do, for all pairs alike */
    const int *to;
    const int *leaf; /* of the n elements, and of whatever else `to` names */
    /* a pair of two ranks, named from both ends, is work for both once more */
    bool both_sides;
};

/* Leaves for so many elements in all: one for each where they are few. */
int graph_leaves_wanted(const struct comm *comm, int64_t n_element);

/* Collective. owner [n_leaf]: a rank for each leaf. The work of a rank is that of its elements and,
 * with `both_sides`, one for each neighbour that they have on another rank. Weights of ranks with
 * too much work are raised and the graph is cut again until the imbalance against share [n_rank]
 * (NULL: equal ones) is at most `threshold`, a few times; the best is taken. */
void graph_leaves(const struct comm *comm, int n_leaf, const struct graph_elements *elements,
    const int64_t *share, double threshold, int *owner);

#endif
