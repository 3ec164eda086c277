/* Energies and momenta of the lattice, in integers (sums_group.h): the same bits on any number of
 * ranks.
 *
 * lint: WITH_SUMS needs fp64
 * lint: WITH_SHEAR_APART requires WITH_VOLUME */
#include "link_elastic.h"
#include "common/sums_group.h"

#if WITH_SUMS
/* The cells of n runs of `list`. place [n_run][4]: where the centre of a run's first cell was [m],
 * and the edge of its cells [m]. */
__kernel __attribute__((reqd_work_group_size(SUMS_GROUP, 1, 1))) void link_energies(int n,
    __global const int *list, __global const int *info, __global const int *base,
    __global const int *word, int n_run, int n_kind, long plane, __global const preal *x, long x_in,
    __global const real *v, long v_in, __global const real *link, __global const real *cell,
    SHARE_ARGUMENTS
#if WITH_LOADS
        __global const int *row,
    __global const real *rows, int at_rows,
#endif
#if WITH_ENERGY
    __global const double *ledger,
#endif
#if WITH_ENERGY && WITH_BREAK
    __global const int *fresh, __global const double *released, double after,
#endif
    __global const double *place, double gravity_x, double gravity_y, double gravity_z,
    __global long *partial)
{
    __local long part[ACCOUNT_WIDTH * SUMS_WIDTH * SUMS_GROUP];
    struct sum sum[ACCOUNT_WIDTH];
    double gravity[3] = {gravity_x, gravity_y, gravity_z}, term[ACCOUNT_WIDTH];
    for (int k = 0; k < ACCOUNT_WIDTH; k++) sum[k] = sums_zero();
    for (long e = SUMS_FIRST; e < (long)n * BATCH; e += SUMS_STRIDE) {
        int run = list[e / BATCH];
        size_t l = (size_t)(e % BATCH), i = (size_t)run * BATCH + l;
        int word_i = word[i];
        if (!(word_i >> WORD_OWNED & 1)) continue;
        struct lattice_view s = lattice_view_of(x + x_in, v + v_in, word, link, base, run, n_run,
            n_kind, info[run] & (RUN_MIXED - 1), (size_t)plane);
        VIEW_SHARES(s)
        struct link_cell c = lattice_moving(s, i, lattice_cell(s, i));
        __global const real *constants = cell + LATTICE_KIND(word_i) * CELL_WIDTH;
        real per_mass = lattice_per_mass(1, s, i, constants);
        __global const double *from = place + (size_t)run * 4;
        double at[3] = {from[0], from[1], from[2]};
        at[RUN_AXIS] += (double)l * from[3];
        struct lattice_load load = {.traction = 0};
#if WITH_LOADS
        __global const real *load_row = rows + at_rows + (size_t)row[i] * LOAD_WIDTH;
        load = lattice_load_of(load_row);
#endif
        real links, volume, faces;
        account_elastic(s, l, word_i, c, load, constants, &links, &volume, &faces);
        account_cell(c, links, volume, at, (double)per_mass, (double)constants[1], gravity, term);
        term[ACCOUNT_WORK] = term[ACCOUNT_LINKS] = term[ACCOUNT_MASS] = 0.0;
#if WITH_ENERGY
        term[ACCOUNT_WORK] =
            ledger[i] + (double)faces +
            account_held(c, word_i, 1.0 / (double)per_mass, 1.0 / (double)constants[1]);
        term[ACCOUNT_LINKS] = ledger[s.plane + i];
        term[ACCOUNT_MASS] = ledger[2 * s.plane + i];
#endif
        term[ACCOUNT_STRAINED] =
            (double)(account_strain(0, s, l, word_i, c) + account_strain(1, s, l, word_i, c) +
                     account_strain(2, s, l, word_i, c));
        term[ACCOUNT_RELEASED] = 0.0;
#if WITH_ENERGY && WITH_BREAK
        term[ACCOUNT_RELEASED] =
            released[i] +
            (fresh[i] ? after * account_release(s, l, word_i, fresh[i], load, constants) : 0.0);
#endif
        for (int k = 0; k < ACCOUNT_WIDTH; k++) sums_add(&sum[k], term[k]);
    }
    for (int k = 0; k < ACCOUNT_WIDTH; k++) sums_put(part, k, sum[k]);
    barrier(CLK_LOCAL_MEM_FENCE);
    sums_finish(part, ACCOUNT_WIDTH, partial);
}
#endif
