/* Built top down: the boxes of a node are sorted by their middle along its longest side and cut in
 * half. Children lie side by side behind their parent. */
#include "bvh.h"

#include "comm/fail.h"

#include <math.h>
#include <stdlib.h>

enum { LEAF = 4, DEPTH = 64 }; /* items in a leaf; halving 2^31 items never goes deeper */

struct middle {
    double at;
    int item;
};

/* Ties by item, so that the order is a function of the boxes. */
static int compare_middles(const void *a, const void *b)
{
    const struct middle *p = a, *q = b;
    if (p->at < q->at || p->at > q->at) return p->at < q->at ? -1 : 1;
    return (p->item > q->item) - (p->item < q->item);
}

static void bound(struct bvh *bvh, int node, const double *low, const double *high)
{
    for (int a = 0; a < 3; a++) {
        bvh->low[3 * node + a] = HUGE_VAL;
        bvh->high[3 * node + a] = -HUGE_VAL;
        for (int k = bvh->first[node]; k < bvh->first[node] + bvh->count[node]; k++) {
            bvh->low[3 * node + a] = fmin(bvh->low[3 * node + a], low[3 * bvh->item[k] + a]);
            bvh->high[3 * node + a] = fmax(bvh->high[3 * node + a], high[3 * bvh->item[k] + a]);
        }
    }
}

/* Makes a leaf of more than LEAF items an inner node with two leaves. */
static void split(
    struct bvh *bvh, int node, const double *low, const double *high, struct middle *middle)
{
    int first = bvh->first[node], count = bvh->count[node], axis = 0, left = bvh->n_node;
    for (int a = 1; a < 3; a++)
        if (bvh->high[3 * node + a] - bvh->low[3 * node + a] >
            bvh->high[3 * node + axis] - bvh->low[3 * node + axis])
            axis = a;
    for (int k = 0; k < count; k++) {
        int item = bvh->item[first + k];
        middle[k] = (struct middle){0.5 * (low[3 * item + axis] + high[3 * item + axis]), item};
    }
    qsort(middle, (size_t)count, sizeof *middle, compare_middles);
    for (int k = 0; k < count; k++) bvh->item[first + k] = middle[k].item;
    bvh->first[left] = first;
    bvh->count[left] = count / 2;
    bvh->first[left + 1] = first + count / 2;
    bvh->count[left + 1] = count - count / 2;
    bvh->first[node] = left;
    bvh->count[node] = 0;
    bvh->n_node += 2;
    bound(bvh, left, low, high);
    bound(bvh, left + 1, low, high);
}

struct bvh *bvh_create(const double *low, const double *high, int n)
{
    struct bvh *bvh = fail_alloc(sizeof *bvh);
    size_t room = 2 * (size_t)n + 1; /* a binary tree with at most n leaves */
    bvh->n_item = n;
    bvh->item = fail_alloc((size_t)n * sizeof *bvh->item);
    bvh->first = fail_alloc(room * sizeof *bvh->first);
    bvh->count = fail_alloc(room * sizeof *bvh->count);
    bvh->low = fail_alloc(room * 3 * sizeof *bvh->low);
    bvh->high = fail_alloc(room * 3 * sizeof *bvh->high);
    for (int k = 0; k < n; k++) bvh->item[k] = k;
    if (n == 0) return bvh;
    struct middle *middle = fail_alloc((size_t)n * sizeof *middle);
    bvh->n_node = 1;
    bvh->count[0] = n;
    bound(bvh, 0, low, high);
    for (int node = 0; node < bvh->n_node; node++)
        if (bvh->count[node] > LEAF) split(bvh, node, low, high, middle);
    free(middle);
    return bvh;
}

void bvh_free(struct bvh *bvh)
{
    if (!bvh) return;
    free(bvh->item);
    free(bvh->first);
    free(bvh->count);
    free(bvh->low);
    free(bvh->high);
    free(bvh);
}

void bvh_visit(const struct bvh *bvh, const double low[3], const double high[3],
    void (*visit)(int item, void *context), void *context)
{
    int stack[2 * DEPTH], top = 0;
    if (bvh->n_node) stack[top++] = 0;
    while (top) {
        int node = stack[--top], apart = 0;
        for (int a = 0; a < 3; a++)
            apart |= bvh->low[3 * node + a] > high[a] || bvh->high[3 * node + a] < low[a];
        if (apart) continue;
        if (bvh->count[node] == 0) {
            stack[top++] = bvh->first[node] + 1;
            stack[top++] = bvh->first[node];
            continue;
        }
        for (int k = bvh->first[node]; k < bvh->first[node] + bvh->count[node]; k++)
            visit(bvh->item[k], context);
    }
}
