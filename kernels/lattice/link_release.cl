/* What breakage releases: the elastic energy of the links that go, and what it changes in that of
 * the cells' volumes. Links judged at x_n act on until x_n+1. With splittings that begin with a
 * kick the last kick of the step, of weight c, is without them, so that they go at x_n+1 - c dt v:
 * to second order that releases c of their energy at x_n and 1 - c of it at x_n+1. With the other
 * schemes it is all of it at x_n+1.
 *
 * lint: WITH_SUMS needs fp64
 * lint: WITH_SHEAR_APART requires WITH_VOLUME */
#include "lattice_fate.h"
#include "link_elastic.h"

#if WITH_SUMS && WITH_BREAK
/* After link_break, before link_sever. fresh: links of each cell that went with the step before,
 * then those that go with this one; before, after: c and 1 - c. */
__kernel __attribute__((reqd_work_group_size(BATCH_LANES, 1, 1))) void link_release(int n,
    __global const int *list, __global const int *info, __global const int *base,
    __global const int *word, int n_run, int n_kind, long plane, __global const preal *x, long x_in,
    __global const real *v, long v_in, __global const real *link, __global const real *cell,
    SHARE_ARGUMENTS
#if WITH_LOADS
        __global const int *row,
    __global const real *rows, int at_rows,
#endif
    __global const int *fate, double before, double after, __global int *restrict fresh,
    __global double *restrict released)
{
    if (get_group_id(0) >= (size_t)n) return;
    int run = list[get_group_id(0)];
    struct lattice_view s = lattice_view_of(x + x_in, v + v_in, word, link, base, run, n_run,
        n_kind, info[run] & (RUN_MIXED - 1), (size_t)plane);
    VIEW_SHARES(s)
    FOR_BATCH (l, BATCH) {
        size_t i = s.begin + l;
        int word_i = word[i], late = fresh[i];
        int gone = lattice_gone(fate[i], fate[lattice_beside(s, 0, l)],
            fate[lattice_beside(s, 2, l)], fate[lattice_beside(s, 4, l)]);
        gone &= LATTICE_LINKS(word_i);
        fresh[i] = gone;
        if (!(late | gone)) continue;
        struct lattice_load load = {.traction = 0};
#if WITH_LOADS
        __global const real *load_row = rows + at_rows + (size_t)row[i] * LOAD_WIDTH;
        load = lattice_load_of(load_row);
#endif
        __global const real *constants = cell + LATTICE_KIND(word_i) * CELL_WIDTH;
        if (late) released[i] += after * account_release(s, l, word_i, late, load, constants);
        if (gone) released[i] += before * account_release(s, l, word_i, gone, load, constants);
    }
}
#endif
