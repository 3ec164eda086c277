/* The volumetric pass: p = lambda Th of each cell, from its six links. Runs as link_force.cl.
 * Ghosts that owned cells are linked to get theirs here too, from their own neighbours, in the same
 * order as on the rank that owns them. The balance of energy needs p without dashpots beside it, in
 * a second plane. */
#include "lattice_view.h"

/* still: without dashpots. */
LAW real lattice_pressure(int still, int mixed, struct lattice_view s, size_t l, int word,
    __global const real *cell, real traction)
{
    struct volume_constants c;
    struct link_cell me = lattice_cell(s, s.begin + l);
    real eta = cell[5], sum;
    s.still = still;
    if (WITH_LINK_DAMPING && !still) me = lattice_moving(s, s.begin + l, me);
    sum = lattice_part(0, mixed, s, l, word, me, eta);
    sum += lattice_part(1, mixed, s, l, word, me, eta);
    sum += lattice_part(2, mixed, s, l, word, me, eta);
    sum += lattice_part(3, mixed, s, l, word, me, eta);
    sum += lattice_part(4, mixed, s, l, word, me, eta);
    sum += lattice_part(5, mixed, s, l, word, me, eta);
    c = lattice_volume_of(
        cell, WITH_SHARES && mixed ? lattice_share(s, s.begin + l) : 0, word & 63);
    return c.lambda * volume_strain(sum, traction, word & 63, c);
}

#if WITH_LOADS
#define TRACTION(i) rows[at_rows + row[i] * LOAD_WIDTH + LOAD_TRACTION]
#else
#define TRACTION(i) 0
#endif

#define VOLUMES(mixed, constants, traction)                                                        \
    FOR_PIECES (piece) {                                                                           \
        lattice_fetch(s.x + s.base[3] + piece + PIECES_AHEAD * BATCH_WIDTH, sizeof(preal),         \
            s.plane, LATTICE_X(WITH_TURN));                                                        \
        BATCH_VECTOR                                                                               \
        FOR_PIECE (l, piece) {                                                                     \
            size_t i = s.begin + l;                                                                \
            __global const real *at = constants;                                                   \
            p[i] = lattice_pressure(0, mixed, s, l, word[i], at, traction);                        \
            if (WITH_ENERGY && WITH_LINK_DAMPING)                                                  \
                p[s.plane + i] = lattice_pressure(1, mixed, s, l, word[i], at, traction);          \
        }                                                                                          \
    }

__kernel __attribute__((reqd_work_group_size(BATCH_LANES, 1, 1))) void link_volume(int first, int n,
    __global const int *list, __global const int *info, __global const int *base,
    __global const int *word, int n_run, int n_kind, long plane, __global const preal *x, long x_in,
    __global const real *v, long v_in, __global const real *link, __global const real *cell,
    SHARE_ARGUMENTS
#if WITH_LOADS
        __global const int *row,
    __global const real *rows, int at_rows,
#endif
    __global real *restrict p)
{
    if (get_group_id(0) >= (size_t)n) return;
    int run = list[first + get_group_id(0)], what = info[run], kind = what & (RUN_MIXED - 1);
    struct lattice_view s = lattice_view_of(
        x + x_in, v + v_in, word, link, base, run, n_run, n_kind, kind, (size_t)plane);
    VIEW_SHARES(s)
    if ((WITH_KINDS || WITH_LOADS || WITH_SHARES) && what >= RUN_MIXED) {
        VOLUMES(1, cell + LATTICE_KIND(word[i]) * CELL_WIDTH, (real)TRACTION(i))
    } else {
        VOLUMES(0, cell + kind * CELL_WIDTH, (real)0)
    }
}
