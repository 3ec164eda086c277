/* Adds up what acts on each owned element, in ascending order of the partner's global id, then
 * walls, then gravity; and moves it.
 *
 * The order does not depend on ranks, partition or storage, so the bits do not either. The row of
 * an element lists its pairs (incidence.h), in eights that are filled up with a blank pair of force
 * zero: a loop of varying length would cost a processor more in wrong guesses than the blanks do.
 *
 * Two uses. Fused: second kick of this step, first kick and drift of the next, one pass over the
 * state. Observed: second kick only, force and torque kept; output then sees positions and
 * velocities of one time, and the kernel kick_drift below does the rest, with the same bits.
 *
 * lint: WITH_PAIR_ROTATION requires WITH_SPIN
 * lint: WITH_WALL_ROTATION requires WITH_SPIN
 * lint: WITH_PAIR_ROLLING requires WITH_PAIR_ROTATION
 * lint: WITH_WALL_ROTATION requires WITH_WALLS
 * lint: WITH_ORIENTATION requires WITH_SPIN
 * lint: WITH_SPIN_KICK requires WITH_SPIN
 * lint: WITH_SPIN_KICK requires WITH_KICK */
#include "common/batch.h"
#include "common/flags.h"
#include "incidence.h"
#include "integrate.h"
#include "particle_words.h"

/* RESULT_WIDTH of the pairs' program */
#define PAIR_WIDTH (WITH_PAIR_ROLLING ? 12 : WITH_PAIR_ROTATION ? 8 : 4)

/* 1, or -1 where is_down is 1, by its bits: no branch, no table. */
#if REAL_IS_FLOAT
#define SIGN(is_down) as_float(0x3f800000u | (is_down) << 31)
#else
#define SIGN(is_down) as_double(0x3ff0000000000000ul | (ulong)(is_down) << 63)
#endif

/* Adds the result record r of a pair to force and torque; is_down: the element is the higher id
 * (j). */
LAW void gather_add(__global const real *r, uint is_down, real4 *f, real4 *t)
{
    real4 a = vload4(0, r);
    *f = fma((real4)SIGN(is_down), a, *f);
    if (WITH_PAIR_ROLLING) {
        *t += vload4(is_down ? 2 : 1, r);
    } else if (WITH_PAIR_ROTATION) {
        real4 couple = vload4(1, r);
        *t += WITH_SIZES ? (is_down ? couple.s3 : a.s3) * couple : couple;
    }
}

/* Results of pairs lie where the pairs do, not where the element does: this fetches those of an
 * element AHEAD elements later. On the settled bed of docs/performance.md the kernel takes two
 * fifths less time with it. */
#define AHEAD 8
LAW void gather_fetch(int e, __global const int *incidence_begin, __global const int *incidence,
    __global const real *result)
{
    for (int row = incidence_begin[e]; row < incidence_begin[e + 1]; row++)
        PREFETCH(result + (size_t)((uint)incidence[row] >> 1) * PAIR_WIDTH);
    (void)incidence, (void)result;
}

/* What both kernels move an element with: their last parameters, and move_element's. */
#if WITH_SIZES
#define SIZE_PARAMETERS
#define SIZE_ARGUMENTS
#else
#define SIZE_PARAMETERS real radius, real inverse_m,
#define SIZE_ARGUMENTS radius, inverse_m,
#endif
#if WITH_ORIENTATION
#define ORIENTATION_PARAMETER __global real *orientation,
#define ORIENTATION_ARGUMENT orientation,
#else
#define ORIENTATION_PARAMETER
#define ORIENTATION_ARGUMENT
#endif
#define STATE_PARAMETERS __global preal *position, __global real *motion,
#define MOVE_PARAMETERS                                                                            \
    SIZE_PARAMETERS real gravity_x, real gravity_y, real gravity_z, preal dt, real half_dt,        \
        real margin_dt, ORIENTATION_PARAMETER __global const preal *reference, __global int *flags
#define MOVE_ARGUMENTS                                                                             \
    position, motion, SIZE_ARGUMENTS gravity_x, gravity_y, gravity_z, dt, half_dt, margin_dt,      \
        ORIENTATION_ARGUMENT reference, flags

/* One or two half kicks of element e by force f [N] and torque t [N m]; then, if it drifts, its
 * drift, and what the host has to know of its new place. */
LAW void move_element(
    int e, real4 f, real4 t, bool twice, bool drifts, STATE_PARAMETERS MOVE_PARAMETERS)
{
    preal4 x = LOAD_POSITION(e);
    real4 v = LOAD_VELOCITY(e), g = (real4)(gravity_x, gravity_y, gravity_z, 0);
#if WITH_SIZES
    real radius = (real)x.s3, inverse_m = v.s3;
#endif
    (void)radius, (void)t; /* unless something rotates */
    real4 kick = half_kick(f, inverse_m, g, half_dt);
    v += kick;
    if (twice) v += kick;
    STORE_VELOCITY(e, v);
    if (WITH_KICK) STORE_KICK(e, kick);
#if WITH_SPIN
    real4 w = LOAD_SPIN(e);
    if (WITH_PAIR_ROTATION || WITH_WALL_ROTATION) {
        real4 spun = half_spin(t, inverse_m, radius, half_dt);
        w += spun;
        if (twice) w += spun;
        STORE_SPIN(e, w);
        if (WITH_SPIN_KICK) STORE_SPIN_KICK(e, spun);
    }
#endif
    if (!drifts) return;
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

__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void gather(int n_owned, int observe,
    STATE_PARAMETERS __global const int *incidence_begin, __global const int *incidence,
    __global const real *result,
#if WITH_WALLS
    __global const int *wall_begin, __global const real *wall_result,
#endif
    __global real *force, __global real *torque, MOVE_PARAMETERS)
{
    int e = get_global_id(0);
    if (e >= n_owned) return;
    real4 f = (real4)(0), t = (real4)(0);
    if (e + AHEAD < n_owned) gather_fetch(e + AHEAD, incidence_begin, incidence, result);
    for (int row = incidence_begin[e]; row < incidence_begin[e + 1]; row += INCIDENCE_ALIGN) {
#pragma unroll
        for (int k = 0; k < INCIDENCE_ALIGN; k++) {
            uint end = (uint)incidence[row + k];
            gather_add(result + (size_t)(end >> 1) * PAIR_WIDTH, end & 1, &f, &t);
        }
    }
#if WITH_WALLS
    for (int k = wall_begin[e]; k < wall_begin[e + 1]; k++) {
        __global const real *r = wall_result + (size_t)k * WALL_RESULT_WIDTH(WITH_WALL_ROTATION);
        f += vload4(0, r);
        if (WITH_WALL_ROTATION) t += vload4(1, r);
    }
#endif
    move_element(e, f, t, !observe, !observe, MOVE_ARGUMENTS);
    if (observe) {
        vstore4(f, e, force);
        if (WITH_SPIN) vstore4(t, e, torque);
    }
}

/* First kick and drift after an observed step (force of gather) or at the start. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void kick_drift(int n_owned,
    STATE_PARAMETERS __global const real *force, __global const real *torque, MOVE_PARAMETERS)
{
    int e = get_global_id(0);
    if (e >= n_owned) return;
    real4 t = (real4)(0);
    if (WITH_PAIR_ROTATION || WITH_WALL_ROTATION) t = vload4(e, torque);
    move_element(e, vload4(e, force), t, false, true, MOVE_ARGUMENTS);
}
