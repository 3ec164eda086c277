/* Breakage in the lattice: what becomes of the link over a cell's upper face, how the cell keeps
 * it, and the cell's word after it. Host and device alike.
 *
 * A fate (lattice_words.h) takes effect at the end of the step: until then the word still has the
 * link. */
#ifndef DEMOCLES_LATTICE_FATE_H
#define DEMOCLES_LATTICE_FATE_H

#include "law_break.h"
#include "lattice_state.h"

/* A row of the table of limits (lattice_words.h). */
#define LATTICE_LIMITS(k, p)                                                                       \
    do {                                                                                           \
        (k).normal = (p)[0];                                                                       \
        (k).shear = (p)[1];                                                                        \
        (k).bend = (p)[2];                                                                         \
        (k).twist = (p)[3];                                                                        \
        (k).criterion = (int)(p)[4];                                                               \
    } while (0)

/* One over the limits of the covered share of a face. */
LAW struct break_limits lattice_limits_cut(struct break_limits k, real share)
{
    real per = share > 0 ? (real)1 / share : (real)0;
    k.normal *= per;
    k.shear *= per;
    k.bend *= per;
    k.twist *= per;
    return k;
}

/* Bits of the fate of `lower` for its link along `axis`, with the very force that moves both cells;
 * p: lambda Th [Pa]. */
LAW int lattice_fate(int axis, struct link_cell lower, struct link_cell upper,
    struct link_constants k, real p_lower, real p_upper, struct break_limits limits)
{
    struct link_state s = link_state_of(axis, lower, upper, k);
    return break_of(break_load_of(s, link_force_of(s, k, p_lower, p_upper)), limits).mode
           << (3 * axis);
}

/* The same of a link that is due by the word of either cell (link_principal.cl). */
LAW int lattice_due(int lower, int upper, int axis)
{
    int due = (WORD_DUE(lower) >> (2 * axis + 1) | WORD_DUE(upper) >> (2 * axis)) & 1;
    return lower >> (2 * axis + 1) & due ? BREAK_TENSION << (3 * axis) : 0;
}

/* Bits of links that are gone: on upper faces by the cell's own fate, on lower faces by those of
 * the cells there. */
LAW int lattice_gone(int own, int x, int y, int z)
{
    int upper = (FATE_MODE(own, 0) ? LINK_BIT(0, 1) : 0) |
                (FATE_MODE(own, 1) ? LINK_BIT(1, 1) : 0) | (FATE_MODE(own, 2) ? LINK_BIT(2, 1) : 0);
    int lower = (FATE_MODE(x, 0) ? LINK_BIT(0, 0) : 0) | (FATE_MODE(y, 1) ? LINK_BIT(1, 0) : 0) |
                (FATE_MODE(z, 2) ? LINK_BIT(2, 0) : 0);
    return upper | lower;
}

#endif
