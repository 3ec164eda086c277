/* Breakage by the largest principal stress of the cells (law_principal.h). The owner of a cell
 * judges it once per step, from the state at the step's start, and marks in the cell's word which
 * of its links is due. Words of ghosts travel with their positions (lattice_pack.cl), so in the
 * next step every rank that holds the link knows, and it goes at the end of that one, on all of
 * them: one step later than by link_break.cl, and without any message. Runs as link_force.cl.
 *
 * lint: WITH_SHEAR_APART requires WITH_VOLUME */
#include "lattice_fate.h"
#include "law_principal.h"
#include "link_through.h"

#define PRINCIPAL_LINK(axis) (lattice_due(word_i, word[lattice_beside(s, 2 * (axis) + 1, l)], axis))

/* Links that are due get their fate: all runs as link_break, ghosts are lower cells too. */
__kernel __attribute__((reqd_work_group_size(BATCH_LANES, 1, 1))) void link_due(int n,
    __global const int *base, __global const int *word, int n_run, __global int *restrict fate)
{
    if (get_group_id(0) >= (size_t)n) return;
    struct lattice_view s;
    lattice_view_runs(&s, base, 1 + get_group_id(0), n_run);
    BATCH_VECTOR
    FOR_BATCH (l, BATCH) {
        int word_i = word[s.begin + l];
        fate[s.begin + l] |= PRINCIPAL_LINK(0) | PRINCIPAL_LINK(1) | PRINCIPAL_LINK(2);
    }
}

/* The force on a cell through its links and its stress, in the same axes. */
struct principal_cell {
    struct lattice_through f;
    struct stress s;
};

LAW struct principal_cell principal_cell_of(int mixed, struct lattice_view s, size_t l, int word,
    struct link_cell me, struct lattice_load load)
{
    struct principal_cell c;
    c.f = lattice_through_of(mixed, s, l, word, me);
    c.s = lattice_stress_at(mixed, s, l, word, c.f, me, load, 0);
    return c;
}

#define CELL(mixed)                                                                                \
    size_t i = s.begin + l;                                                                        \
    int word_i = word[i];                                                                          \
    struct link_cell me = lattice_moving(s, i, lattice_cell(s, i));                                \
    struct lattice_load load = LOAD_OF(i);                                                         \
    struct principal_cell c = principal_cell_of(mixed, s, l, word_i, me, load)
#define LIMIT(mixed) (mixed ? LATTICE_KIND(word_i) : kind)
#define RUN(mixed)                                                                                 \
    BATCH_VECTOR                                                                                   \
    FOR_BATCH (l, BATCH) {                                                                         \
        CELL(mixed);                                                                               \
        due[i] = principal_fails(c.s, inverse[LIMIT(mixed)]);                                      \
    }                                                                                              \
    FOR_BATCH (l, BATCH) {                                                                         \
        if (!due[s.begin + l]) continue;                                                           \
        CELL(mixed);                                                                               \
        int going = lattice_gone(fate[i], fate[lattice_beside(s, 0, l)],                           \
            fate[lattice_beside(s, 2, l)], fate[lattice_beside(s, 4, l)]);                         \
        int links = LATTICE_LINKS(word_i);                                                         \
        due[i] = going & links ? 0                                                                 \
                               : lattice_principal(c.f, c.s, me, links, inverse[LIMIT(mixed)],     \
                                     inverse[n_kind + LIMIT(mixed)], lot[i]);                      \
    }

/* After link_due (and link_break), before link_sever. inverse [2 n_kind]: 1/sigma_c [1/Pa], then
 * rise [1]; lot: law_principal.h; due: of each cell the link that goes with the next step, a mask.
 * A cell that loses a link with this one waits: its stress is about to change. */
__kernel __attribute__((reqd_work_group_size(BATCH_LANES, 1, 1))) void link_judge(int n,
    __global const int *list, __global const int *info, __global const int *base,
    __global const int *word, int n_run, int n_kind, long plane, __global const preal *x, long x_in,
    __global const real *v, long v_in, __global const real *link, __global const real *inverse,
    SHARE_ARGUMENTS
#if WITH_VOLUME
        __global const real *p,
#endif
#if WITH_LOADS
    __global const int *row, __global const real *rows, int at_rows,
#endif
    __global const real *lot, __global const int *fate, __global int *restrict due)
{
    if (get_group_id(0) >= (size_t)n) return;
    int run = list[get_group_id(0)], what = info[run], kind = what & (RUN_MIXED - 1);
    RUN_CELLS(run, what)
}
