/* A tree of boxes: finds the items whose bounds meet a given box, in O(log n). Knows nothing but
 * boxes. */
#ifndef DEMOCLES_BVH_H
#define DEMOCLES_BVH_H

struct bvh {
    int n_item, n_node;
    int *item; /* [n_item] items in the order of the leaves */
    /* [n_node] leaf: its items; inner node: count 0, children at `first` and `first + 1` */
    int *first, *count;
    double *low, *high; /* [n_node][3] */
};

/* Bounds low, high [n][3], finite. n may be 0. */
struct bvh *bvh_create(const double *low, const double *high, int n);
void bvh_free(struct bvh *bvh);

/* Calls visit(item, context) for every item whose leaf meets the box (so also for some just outside
 * it), in an order that depends on the items alone. */
void bvh_visit(const struct bvh *bvh, const double low[3], const double high[3],
    void (*visit)(int item, void *context), void *context);

#endif
