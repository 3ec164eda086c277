/* Pairs of elements that may touch, and what they remember: built on the device from cells, anew
 * whenever somebody has used up the room to move.
 *
 * Two generations: histories pass from the old lists to the new ones. Knows no law (but asks the
 * program how wide a history is), no messages. */
#ifndef DEMOCLES_PAIRS_H
#define DEMOCLES_PAIRS_H

#include "cells.h"
#include "contact_store.h"

struct pair_list {
    int64_t n_owned, n_all;
    int64_t n_row, n_interior, first_boundary, n_boundary, n_incidence;
    /* boundary pairs that this rank computes, the first ones: all of them unless assigned.h says
     * else */
    int64_t n_mine;
    /* of the pairs that it computes, those count here whose lower element's number is below */
    int64_t n_lower;
    /* pairs whose lower element this rank owns: every pair counts on one rank */
    int64_t n_own;
    int64_t capacity;                      /* pairs that the arrays hold */
    struct buffer row_begin, row, row_gid; /* [n_all + 1], [n_row], [n_row] */
    struct buffer split, up_begin;         /* [n_all] */
    /* [n_owned + 1], [n_incidence], see kernels/particle/incidence.h */
    struct buffer incidence_begin, incidence;
    /* [capacity], history [layout.history][capacity] */
    struct buffer pair_i, pair_j, state, history;
};

struct pairs {
    struct contact_layout layout;
    const struct features *features;
    struct pair_list now, old;
    struct contact_arrivals arrivals;
    struct buffer interior, boundary, result, ledger, found;
    struct launch *rows, *count, *fill, *link, *carry, *leave;
};

struct pairs *pairs_create(struct device *dev, const struct features *features,
    const struct program *lists, const struct program *force);
void pairs_free(struct device *dev, struct pairs *pairs);

/* Builds pairs->now for owned elements and ghosts that are sorted into cells; what was `now`
 * becomes `old`. Histories are carried over by pairs_carry. */
void pairs_build(struct device *dev, struct pairs *pairs, struct cells *cells, struct scan *scan,
    const struct particles *p);

/* old_index [n_owned + n_ghost]: old number of an owned element, or old n_owned + its place among
 * the arrivals. */
void pairs_carry(struct device *dev, struct pairs *pairs, const struct particles *p,
    const struct buffer *old_index);

#endif
