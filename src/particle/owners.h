/* Who owns what: elements that have crossed into another subdomain move there with all that their
 * contacts remember, those that have left the domain are taken out, and the rest are put into
 * storage order.
 *
 * The rare path, once per list build. Only what moves passes through the host; it goes straight to
 * its new owner. Knows no halo and no lists but the contacts' histories. */
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
    struct buffer node, cut, domain; /* tree of cuts, for select.cl; domain box */
    int n_node;
    struct buffer owner, stay, leave, index; /* per element */
    struct buffer old_index;                 /* [n_owned + n_ghost] for the carriers */
    struct buffer picked;
    struct launch *select, *compact, *number, *gather;
    struct owners_removed *removed; /* [n_removed] in the last owners_move, on this rank */
    int64_t n_removed;
    int64_t n_moved; /* elements that this rank gave away in the last owners_move */
};

struct owners *owners_create(struct device *dev, const struct comm *comm,
    const struct features *features, const struct program *lists, const double period[3],
    const double domain[6]);
void owners_free(struct device *dev, struct owners *o);
void owners_set_tree(struct device *dev, struct owners *o, const struct rcb *rcb);

/* Brings every element to its owner and into storage order; o->old_index is then ready for
 * pairs_carry and wall_contacts_carry. Collective. */
void owners_move(struct device *dev, struct owners *o, struct cells *cells, struct scan *scan,
    struct particles *p, struct pairs *pairs, struct wall_contacts *walls,
    const struct cells_bounds *bounds);

#endif
