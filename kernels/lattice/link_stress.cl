/* Stress of each owned cell from the forces of its links and loads: those that move it, evaluated
 * once more (lattice_through.h). Runs as link_force.cl.
 *
 * lint: WITH_SHEAR_APART requires WITH_VOLUME */
#include "link_through.h"

LAW void lattice_stress_keep(
    __global real *stress, size_t plane, size_t i, struct stress s, real von_mises)
{
    stress[i] = s.xx;
    stress[plane + i] = s.yy;
    stress[2 * plane + i] = s.zz;
    stress[3 * plane + i] = s.yz;
    stress[4 * plane + i] = s.zx;
    stress[5 * plane + i] = s.xy;
    stress[6 * plane + i] = von_mises;
}

#define RUN(mixed)                                                                                 \
    BATCH_VECTOR                                                                                   \
    FOR_BATCH (l, BATCH) {                                                                         \
        size_t i = s.begin + l;                                                                    \
        int word_i = word[i];                                                                      \
        struct link_cell c = lattice_moving(s, i, lattice_cell(s, i));                             \
        struct lattice_load load = LOAD_OF(i);                                                     \
        struct stress r = lattice_stress_at(mixed, s, l, word_i,                                   \
            lattice_through_of(mixed, s, l, word_i, c), c, load, extrapolate);                     \
        lattice_stress_keep(stress, s.plane, i, lattice_stress_world(r, c), stress_von_mises(r));  \
    }

/* stress [7][plane]: xx, yy, zz, yz, zx, xy, von Mises [Pa]. */
__kernel __attribute__((reqd_work_group_size(BATCH_LANES, 1, 1))) void link_stress(int n,
    __global const int *list, __global const int *info, __global const int *base,
    __global const int *word, int n_run, int n_kind, long plane, __global const preal *x, long x_in,
    __global const real *v, long v_in, __global const real *link,
    SHARE_ARGUMENTS
#if WITH_VOLUME
        __global const real *p,
#endif
#if WITH_LOADS
    __global const int *row, __global const real *rows, int at_rows,
#endif
    int extrapolate, __global real *restrict stress)
{
    if (get_group_id(0) >= (size_t)n) return;
    int run = list[get_group_id(0)], what = info[run];
    RUN_CELLS(run, what)
}
