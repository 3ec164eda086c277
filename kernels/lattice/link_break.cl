/* Breakage of links. Each link is judged once, by its lower cell, from the state at the step's
 * start; a link that a border cuts by both ranks, from the same copies. What is broken is gone at
 * the end of the step, at the same time on all ranks: words of ghosts travel with their positions
 * (lattice_pack.cl). Runs as link_force.cl.
 *
 * lint: WITH_SHEAR_APART requires WITH_VOLUME */
#include "lattice_fate.h"
#include "lattice_view.h"

/* 0 where there is no link; what lies beyond may be anything then. */
LAW int lattice_judge(int axis, int mixed, struct lattice_view s, size_t l, int word,
    struct link_cell me, __global const real *limit, int kind)
{
    size_t i = s.begin + l, j = lattice_beside(s, 2 * axis + 1, l);
    struct link_cell other = lattice_cell(s, j);
    struct break_limits limits;
    __global const real *row =
        limit + (size_t)(WITH_KINDS && mixed
                             ? LATTICE_KIND(word) * s.n_kind + LATTICE_KIND(s.word[j])
                             : kind * s.n_kind + kind) *
                    BREAK_WIDTH;
    real p_me = 0, p_other = 0;
    LATTICE_LIMITS(limits, row);
    if (WITH_SHARES && mixed)
        limits = lattice_limits_cut(limits, lattice_share(s, i)[SHARE_FACE + 2 * axis + 1]);
    if (WITH_LINK_DAMPING) other = lattice_moving(s, j, other);
    if (WITH_VOLUME) {
        p_me = s.p[i];
        p_other = s.p[j];
    }
    int fate = lattice_fate(axis, me, other, lattice_constants(s, 2 * axis + 1, mixed, word, i, j),
        p_me, p_other, limits);
    return word >> (2 * axis + 1) & 1 ? fate : 0;
}

#define RUN(mixed)                                                                                 \
    BATCH_VECTOR                                                                                   \
    FOR_BATCH (l, BATCH) {                                                                         \
        size_t i = s.begin + l;                                                                    \
        int word_i = word[i];                                                                      \
        struct link_cell c = lattice_cell(s, i);                                                   \
        if (WITH_LINK_DAMPING) c = lattice_moving(s, i, c);                                        \
        fate[i] |= lattice_judge(0, mixed, s, l, word_i, c, limit, kind) |                         \
                   lattice_judge(1, mixed, s, l, word_i, c, limit, kind) |                         \
                   lattice_judge(2, mixed, s, l, word_i, c, limit, kind);                          \
    }

/* All runs but the empty ones in front and behind: ghosts are lower cells too. Of a ghost only its
 * links to own cells are judged rightly, and only these are asked for. */
__kernel __attribute__((reqd_work_group_size(BATCH_LANES, 1, 1))) void link_break(int n,
    __global const int *info, __global const int *base, __global const int *word, int n_run,
    int n_kind, long plane, __global const preal *x, long x_in, __global const real *v, long v_in,
    __global const real *link, __global const real *limit,
    SHARE_ARGUMENTS
#if WITH_VOLUME
        __global const real *p,
#endif
    __global int *restrict fate)
{
    if (get_group_id(0) >= (size_t)n) return;
    int run = 1 + get_group_id(0), what = info[run], kind = what & (RUN_MIXED - 1);
    RUN_CELLS(run, what)
}

/* Own cells of the runs of `list` lose the links that are broken, and learn which are due. */
__kernel __attribute__((reqd_work_group_size(BATCH_LANES, 1, 1))) void link_sever(int n,
    __global const int *list, __global const int *base, int n_run, __global int *restrict word,
#if WITH_PRINCIPAL
    __global const int *due,
#endif
    __global const int *fate)
{
    if (get_group_id(0) >= (size_t)n) return;
    struct lattice_view s;
    lattice_view_runs(&s, base, list[get_group_id(0)], n_run);
    BATCH_VECTOR
    FOR_BATCH (l, BATCH) {
        size_t i = s.begin + l;
        int word_i = word[i];
        int gone = lattice_gone(fate[i], fate[lattice_beside(s, 0, l)],
            fate[lattice_beside(s, 2, l)], fate[lattice_beside(s, 4, l)]);
        int left = word_i & ~(word_i >> WORD_OWNED & 1 ? gone : 0);
#if WITH_PRINCIPAL
        if (word_i >> WORD_OWNED & 1) left = (left & ~(63 << WORD_DUE_AT)) | due[i] << WORD_DUE_AT;
#endif
        word[i] = left;
    }
}
