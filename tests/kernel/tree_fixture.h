/* Random elements in a cube and random trees of cuts, on the host and for kernels. */
#ifndef TREE_FIXTURE_H
#define TREE_FIXTURE_H

#include "../../partition/partition.h"
#include "lists_fixture.h"

enum { TREE_LEAVES = 13 };

/* Node k is a child of a lower one. Cuts are such as preal holds. */
struct tree {
    struct rcb rcb;
    int axis[TREE_LEAVES - 1], left[TREE_LEAVES - 1], right[TREE_LEAVES - 1];
    double cut[TREE_LEAVES - 1];
};

static const bool tree_periodic[3] = {WITH_PERIODIC_X, WITH_PERIODIC_Y, WITH_PERIODIC_Z};

double tree_random(double low, double high);
/* Coordinates in the unit cube and up to `beyond` outside of it. */
struct crowd tree_crowd(int n, double beyond);
void tree_upload(struct lists *lists, const struct crowd *c);
void tree_grow(struct tree *t, int n_leaf);
/* Arguments node, cut, domain (buffers that the caller frees) and n_node. */
void tree_bind(
    struct lists *lists, struct launch *k, const struct tree *t, struct buffer buffer[3]);

#endif
