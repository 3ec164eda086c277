/* Adds up what acts on each owned element, in ascending order of the partner's global id, then walls, then gravity; and moves it.
 *
 * The order does not depend on ranks, partition or storage, so the bits do not either. Pairs in which the element is the higher id (down) come
 * through an index list; those in which it is the lower (up) are one contiguous run of the pair list.
 *
 * Two uses. Fused: second kick of this step, first kick and drift of the next, one pass over the state. Observed: second kick only, force and torque
 * kept; output then sees positions and velocities of one time, and kick_drift.cl does the rest, with the same bits.
 *
 * lint: WITH_PAIR_ROTATION requires WITH_SPIN
 * lint: WITH_WALL_ROTATION requires WITH_SPIN
 * lint: WITH_PAIR_ROLLING requires WITH_PAIR_ROTATION
 * lint: WITH_WALL_ROTATION requires WITH_WALLS
 * lint: WITH_ORIENTATION requires WITH_SPIN */
#include "integrate.h"

#define PAIR_WIDTH (WITH_PAIR_ROLLING ? 12 : !WITH_PAIR_ROTATION ? 4 : WITH_SIZES ? 8 : 6) /* RESULT_WIDTH of the pairs' program */
#define WALL_WIDTH (WITH_WALL_ROTATION ? 8 : 4)

#define FLAG_STALE 0
#define FLAG_LOST 1

/* Adds the result record r of a pair to force and torque; is_down: the element is the higher id (j). */
LAW void gather_add(__global const real *r, int is_down, real4 *f, real4 *t)
{
    real4 a = vload4(0, r);
    *f += (is_down ? (real)-1 : (real)1) * a;
    if (WITH_PAIR_ROLLING) {
        *t += vload4(is_down ? 2 : 1, r);
    } else if (PAIR_WIDTH == 8) {
        real4 couple = vload4(1, r);
        *t += (is_down ? couple.s3 : a.s3) * couple;
    } else if (PAIR_WIDTH == 6) {
        real2 rest = vload2(2, r);
        *t += (real4)(a.s3, rest.s0, rest.s1, 0);
    }
}

__kernel __attribute__((reqd_work_group_size(64, 1, 1)))
void gather(int n_owned, int observe, __global preal *position, __global real *motion,
            __global const int *down_begin, __global const int *down, __global const int *up_begin, __global const int *up_count,
            __global const real *result,
#if WITH_WALLS
            __global const int *wall_begin, __global const real *wall_result,
#endif
#if !WITH_SIZES
            real radius, real inverse_m,
#endif
            real gravity_x, real gravity_y, real gravity_z, preal dt, real half_dt, real margin_dt,
#if WITH_ORIENTATION
            __global real *orientation,
#endif
            __global real *force, __global real *torque, __global const preal *reference, __global int *flags)
{
    int e = get_global_id(0);
    if (e >= n_owned) return;
    real4 f = (real4)(0), t = (real4)(0);
    /* One loop for both kinds: a loop's end is what a processor guesses wrong. The index read beyond the down entries is not used. */
    int first = down_begin[e], n_down = down_begin[e + 1] - first, n = n_down + up_count[e], up = up_begin[e] - n_down;
    for (int k = 0; k < n; k++) {
        int is_down = k < n_down, listed = down[first + (is_down ? k : 0)];
        gather_add(result + (size_t)(is_down ? listed : up + k) * PAIR_WIDTH, is_down, &f, &t);
    }
#if WITH_WALLS
    for (int k = wall_begin[e]; k < wall_begin[e + 1]; k++) {
        __global const real *r = wall_result + (size_t)k * WALL_WIDTH;
        f += vload4(0, r);
        if (WITH_WALL_ROTATION) t += vload4(1, r);
    }
#endif
    preal4 x = LOAD_POSITION(e);
    real4 v = LOAD_VELOCITY(e), g = (real4)(gravity_x, gravity_y, gravity_z, 0);
#if WITH_SIZES
    real radius = (real)x.s3, inverse_m = v.s3;
#endif
    (void)radius; /* unless something rotates */
    v = kick(v, f, inverse_m, g, half_dt);
    if (!observe) v = kick(v, f, inverse_m, g, half_dt);
    STORE_VELOCITY(e, v);
#if WITH_SPIN
    real4 w = LOAD_SPIN(e);
    if (WITH_PAIR_ROTATION || WITH_WALL_ROTATION) {
        w = kick_spin(w, t, inverse_m, radius, half_dt);
        if (!observe) w = kick_spin(w, t, inverse_m, radius, half_dt);
        STORE_SPIN(e, w);
    }
#endif
    if (observe) {
        vstore4(f, e, force);
        if (WITH_SPIN) vstore4(t, e, torque);
        return;
    }
    x = drift(x, v, dt);
    STORE_POSITION(e, x);
#if WITH_ORIENTATION
    vstore4(turn(vload4(e, orientation), w, (real)dt), e, orientation);
#endif
    if (is_stale(x, vload4(e, reference), v, margin_dt)) {
        flags[FLAG_STALE] = 1;
        real4 sum = f + v;
        if (!(fabs(sum.s0 + sum.s1 + sum.s2) < (real)1e30)) flags[FLAG_LOST] = 1;
    }
}

/* First kick and drift after an observed step (force of gather) or at the start. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1)))
void kick_drift(int n_owned, __global preal *position, __global real *motion,
#if !WITH_SIZES
                real radius, real inverse_m,
#endif
                real gravity_x, real gravity_y, real gravity_z, preal dt, real half_dt, real margin_dt,
#if WITH_ORIENTATION
                __global real *orientation,
#endif
                __global const real *force, __global const real *torque, __global const preal *reference, __global int *flags)
{
    int e = get_global_id(0);
    if (e >= n_owned) return;
    preal4 x = LOAD_POSITION(e);
    real4 v = LOAD_VELOCITY(e);
    (void)torque;
#if WITH_SIZES
    real radius = (real)x.s3, inverse_m = v.s3;
#endif
    (void)radius; /* unless something rotates */
    v = kick(v, vload4(e, force), inverse_m, (real4)(gravity_x, gravity_y, gravity_z, 0), half_dt);
    STORE_VELOCITY(e, v);
#if WITH_SPIN
    real4 w = LOAD_SPIN(e);
    if (WITH_PAIR_ROTATION || WITH_WALL_ROTATION) {
        w = kick_spin(w, vload4(e, torque), inverse_m, radius, half_dt);
        STORE_SPIN(e, w);
    }
#endif
    x = drift(x, v, dt);
    STORE_POSITION(e, x);
#if WITH_ORIENTATION
    vstore4(turn(vload4(e, orientation), w, (real)dt), e, orientation);
#endif
    if (is_stale(x, vload4(e, reference), v, margin_dt)) {
        flags[FLAG_STALE] = 1;
        if (!(fabs(v.s0 + v.s1 + v.s2) < (real)1e30)) flags[FLAG_LOST] = 1;
    }
}
