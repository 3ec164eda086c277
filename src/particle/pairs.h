/* Neighbour (Verlet) lists: pairs of elements that may touch, and the history of their contacts.
 * The lists are built on the device from cells, and rebuilt as soon as some element has used up its
 * room to move (the skin).
 *
 * There are two generations of lists, and histories pass from the old one to the new one. Knows no
 * contact law (except how wide a history is) and no messages. */
#ifndef DEMOCLES_PAIRS_H
#define DEMOCLES_PAIRS_H

#include "cells.h"
#include "contact_store.h"

/* Where the pairs of one list lie. Interior pairs have both elements on this rank; boundary pairs
 * have a ghost, and begin at the next multiple of 64:
 *
 *   0            n_interior   first_boundary       + n_mine       + n_boundary     capacity
 *   | interior pairs |  gap  | boundary, mine | boundary, theirs |      free      |
 *
 * "mine" are computed on this rank, "theirs" on the other one, which sends the results
 * (assigned.h). Without assignment both ranks compute every boundary pair: n_mine = n_boundary. */
struct pair_list {
    int64_t n_owned, n_all;                                 /* elements: owned; with ghosts */
    int64_t n_interior, first_boundary, n_mine, n_boundary; /* pairs, see above */
    int64_t n_row;       /* entries of all rows: neighbours, each pair from both its ends */
    int64_t n_incidence; /* entries of the gather's list, with its blanks */
    /* A pair that both ranks compute is counted on one of them: there where the number of its lower
     * element in memory is below n_lower (so that rank owns it; n_all where pairs are assigned). */
    int64_t n_lower;
    int64_t n_own;    /* pairs whose lower element this rank owns: its part of all interactions */
    int64_t capacity; /* pairs that the arrays hold */
    /* rows of neighbours in ascending id: first entry of each row [n_all + 1]; numbers and ids of
     * the neighbours [n_row] */
    struct buffer row_begin, row, row_gid;
    /* [n_all] where in its row the ids above the element's own begin; first pair of its row */
    struct buffer split, up_begin;
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
void pairs_free(struct pairs *pairs);

/* Builds pairs->now for owned elements and ghosts that are sorted into cells; what was `now`
 * becomes `old`. Histories are carried over by pairs_carry. */
void pairs_build(
    struct pairs *pairs, struct cells *cells, struct scan *scan, const struct particles *p);

/* Whether the counts of a list fit each other as above; asserted where lists are built. */
bool pairs_is_valid(const struct pair_list *list);

/* old_index [n_owned + n_ghost]: old number of an owned element, or old n_owned + its place among
 * the arrivals. */
void pairs_carry(struct pairs *pairs, const struct particles *p, const struct buffer *old_index);

#endif
