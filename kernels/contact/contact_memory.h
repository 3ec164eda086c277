/* How contacts (pairs, and elements at walls) lie in memory: history as planes
 * [HISTORY_WIDTH][capacity] of real that the force kernels stream through, the state bits as int
 * [capacity], results as one record per contact that the gather reads whole.
 *
 * A plane that no feature needs does not exist; the numbers below shift accordingly.
 *
 * lint: WITH_ENERGY needs fp64 */
#ifndef DEMOCLES_CONTACT_MEMORY_H
#define DEMOCLES_CONTACT_MEMORY_H

#include "common/batch.h"
#include "law_contact.h"
#include "ledger.h"

#ifndef WITH_MOVING
#define WITH_MOVING 0
#endif
/* Each width is asked for with W(TANGENTIAL), ...: whether there is that feature. A kernel's W is
 * FLAG (law_parameters.h), its own build options; the host has the features of a scene. The
 * program of pairs has no MOVING. */
#define ROLLING_OF(W) (W(ROLLING_CDT) || W(ROLLING_EPSD))
#define ROTATION_OF(W) (W(TANGENTIAL) || ROLLING_OF(W))
#define HISTORY_OF(W) (W(TANGENTIAL) || ROLLING_OF(W) || COHESION_OF(W) || W(ENERGY))
#define THETA_OF(W) (W(TANGENTIAL) ? 3 : 0)
#define DAMPING_N_OF(W) (THETA_OF(W) + (W(ROLLING_EPSD) ? 3 : 0))
#define DAMPING_T_OF(W) (DAMPING_N_OF(W) + (W(ENERGY) ? 1 : 0))
#define DAMPING_R_OF(W) (DAMPING_T_OF(W) + (W(ENERGY) && W(TANGENTIAL_DAMPING) ? 3 : 0))
#define WALL_FORCE_OF(W) (DAMPING_R_OF(W) + (W(ENERGY) && ROLLING_OF(W) ? 3 : 0))
#define HISTORY_WIDTH_OF(W) (WALL_FORCE_OF(W) + (W(ENERGY) && W(MOVING) ? 3 : 0))

#define WITH_ROLLING ROLLING_OF(FLAG)
#define WITH_HISTORY HISTORY_OF(FLAG)
#define WITH_WALL_WORK (WITH_ENERGY && WITH_MOVING)
#define XI_AT 0
#define THETA_AT THETA_OF(FLAG)
#define DAMPING_N_AT DAMPING_N_OF(FLAG)
#define DAMPING_T_AT DAMPING_T_OF(FLAG)
#define DAMPING_R_AT DAMPING_R_OF(FLAG)
#define WALL_FORCE_AT WALL_FORCE_OF(FLAG)
#define HISTORY_WIDTH HISTORY_WIDTH_OF(FLAG)

/* Result record: force; with rotation also the torque, which is the same on both of two equal
 * spheres; or the couple and both levers; or both torques. In fours, so that the gather takes a
 * force and a torque with one load each. */
#define RESULT_WIDTH_OF(W) (ROLLING_OF(W) ? 12 : ROTATION_OF(W) ? 8 : 4)
#define WITH_ROTATION ROTATION_OF(FLAG)
#define RESULT_WIDTH RESULT_WIDTH_OF(FLAG)

#ifdef __OPENCL_VERSION__
#include "common/planes.h"

/* Vectors in rows of local memory [row][BATCH], l the contact. */
#define ROW3_LOAD(type, memory, row, l)                                                            \
    type((memory)[(row)*BATCH + (l)], (memory)[((row) + 1) * BATCH + (l)],                         \
        (memory)[((row) + 2) * BATCH + (l)])
#define ROW3_STORE(memory, row, l, x, y, z)                                                        \
    do {                                                                                           \
        (memory)[(row)*BATCH + (l)] = (x);                                                         \
        (memory)[((row) + 1) * BATCH + (l)] = (y);                                                 \
        (memory)[((row) + 2) * BATCH + (l)] = (z);                                                 \
    } while (0)

LAW struct contact_history history_none(void)
{
    struct contact_history h;
    h.xi = h.theta = h.damping_t = h.damping_r = v3(0, 0, 0);
    h.damping_n = 0;
    h.state = 0;
    return h;
}

/* history: plane 0 at the first contact of the work-group, l the work-item. */
LAW struct contact_history history_load(
    __global const real *history, __global const int *state, size_t capacity, size_t l)
{
    struct contact_history h = history_none();
    if (WITH_HISTORY) h.state = state[l];
    if (WITH_TANGENTIAL) h.xi = v3_load(history + XI_AT * capacity, capacity, 0, l);
    if (WITH_ROLLING_EPSD) h.theta = v3_load(history + THETA_AT * capacity, capacity, 0, l);
    if (WITH_ENERGY) h.damping_n = history[DAMPING_N_AT * capacity + l];
    if (WITH_ENERGY && WITH_TANGENTIAL_DAMPING)
        h.damping_t = v3_load(history + DAMPING_T_AT * capacity, capacity, 0, l);
    if (WITH_ENERGY && WITH_ROLLING)
        h.damping_r = v3_load(history + DAMPING_R_AT * capacity, capacity, 0, l);
    return h;
}

LAW void history_store(struct contact_history h, __global real *history, __global int *state,
    size_t capacity, size_t l)
{
    if (WITH_HISTORY) state[l] = h.state;
    if (WITH_TANGENTIAL) v3_store(history + XI_AT * capacity, capacity, 0, l, h.xi);
    if (WITH_ROLLING_EPSD) v3_store(history + THETA_AT * capacity, capacity, 0, l, h.theta);
    if (WITH_ENERGY) history[DAMPING_N_AT * capacity + l] = h.damping_n;
    if (WITH_ENERGY && WITH_TANGENTIAL_DAMPING)
        v3_store(history + DAMPING_T_AT * capacity, capacity, 0, l, h.damping_t);
    if (WITH_ENERGY && WITH_ROLLING)
        v3_store(history + DAMPING_R_AT * capacity, capacity, 0, l, h.damping_r);
}

#if WITH_WALL_WORK
/* What the wall gave in this step: mean of the force on the element before, which the history
 * keeps, and now, along the wall's way v_wall dt. A wall has no angular velocity in the rolling
 * law, so moments take no part. */
LAW real wall_work(
    vec3 force, vec3 v_wall, real dt, __global real *history, size_t capacity, size_t l)
{
    vec3 before = v3_load(history + WALL_FORCE_AT * capacity, capacity, 0, l);
    v3_store(history + WALL_FORCE_AT * capacity, capacity, 0, l, force);
    return (real)0.5 * dt * v3_dot(v3_add(before, force), v_wall);
}
#endif

#if WITH_ENERGY
LAW void ledger_add(struct contact_result r, __global double *ledger, size_t capacity, size_t l)
{
    ledger[LEDGER_NORMAL * capacity + l] += (double)r.loss_n;
    if (WITH_TANGENTIAL_DAMPING) ledger[LEDGER_TANGENTIAL * capacity + l] += (double)r.loss_t;
    if (WITH_TANGENTIAL) ledger[LEDGER_SLIDING * capacity + l] += (double)r.loss_s;
    if (WITH_ROLLING) ledger[LEDGER_ROLLING * capacity + l] += (double)r.loss_r;
    if (WITH_COHESION) ledger[LEDGER_BONDS * capacity + l] += (double)r.loss_b;
    ledger[LEDGER_ELASTIC * capacity + l] = (double)r.elastic;
}
#endif

/* In a kernel: whatever its arguments state, history and ledger are, or nothing. */
#if WITH_HISTORY
#define HISTORY_LOAD(base, planes, l) history_load(history + (base), state + (base), planes, l)
#define HISTORY_STORE(h, base, planes, l)                                                          \
    history_store(h, history + (base), state + (base), planes, l)
#else
#define HISTORY_LOAD(base, planes, l) history_none()
#define HISTORY_STORE(h, base, planes, l) (void)(h), (void)(planes)
#endif
#if WITH_ENERGY
#define LEDGER_ADD(r, base, planes, l) ledger_add(r, ledger + (base), planes, l)
#else
#define LEDGER_ADD(r, base, planes, l) (void)(r)
#endif

/* Parameters as kernel arguments, where all contacts of a program have the same; else rows of a
 * table by pair of materials: material_load (kinds > 1 size) or parameters_load. */
#define PARAMETER_ARGUMENT(type, name) type name,
#define PARAMETER_NAME(type, name) name,
#define PARAMETER_ARGUMENTS CONTACT_PARAMETERS(PARAMETER_ARGUMENT)
#define PARAMETERS_OF_ARGUMENTS ((struct contact_parameters){CONTACT_PARAMETERS(PARAMETER_NAME)})
#endif

#endif
