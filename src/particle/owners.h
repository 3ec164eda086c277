/* Ownership and migration: an element that has crossed into another subdomain moves to its new rank
 * with all that its contacts remember, an element that has left the domain is removed, and the
 * others are put into storage order.
 *
 * This is the rare path, once per list rebuild. Only what migrates passes through the host, and it
 * goes straight to its new owner. Knows no halo, and of the lists only the contacts' histories. */
#ifndef DEMOCLES_OWNERS_H
#define DEMOCLES_OWNERS_H

#include "partition/partition.h"
#include "wall_contacts.h"

/* An element that has left the run: its record at that moment. */
struct owners_removed {
    int64_t gid;
    double x[3], radius;    /* [m] */
    double v[3], inverse_m; /* [m/s], [1/kg] */
    double w[3];            /* [rad/s]; zero without spin */
};

struct owners {
    const struct comm *comm;
    const struct features *features;
    struct buffer node, cut, domain; /* tree of cuts, for select.cl; domain box [6] [m] */
    int n_node;                      /* inner nodes of the tree */
    /* int per owned element: rank that owns it from now on (negative: outside the domain); whether
     * it stays, whether it leaves, later prefix sums of these; its new number */
    struct buffer owner, stay, leave, index;
    /* int [n_owned + n_ghost] number that an element had before, for pairs_carry and
     * wall_contacts_carry */
    struct buffer old_index;
    struct buffer picked; /* records of the elements that leave, packed for the host */
    struct launch *select, *compact, *gather, *copy;
    struct owners_removed *removed; /* [n_removed] in the last owners_move, on this rank */
    int64_t n_removed;
    int64_t n_moved; /* elements that this rank gave away in the last owners_move */
};

struct owners *owners_create(struct device *dev, const struct comm *comm,
    const struct features *features, const struct program *lists, const double period[3],
    const double domain[6]);
void owners_free(struct owners *o);
void owners_set_tree(struct owners *o, const struct rcb *rcb);

/* Brings every element to its owner and into storage order; o->old_index is then ready for
 * pairs_carry and wall_contacts_carry. Collective. */
void owners_move(struct owners *o, struct cells *cells, struct scan *scan, struct particles *p,
    struct pairs *pairs, struct wall_contacts *walls, const struct cells_bounds *bounds);

#endif
