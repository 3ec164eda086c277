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
#define WITH_ROLLING (WITH_ROLLING_CDT || WITH_ROLLING_EPSD)
#define WITH_HISTORY (WITH_TANGENTIAL || WITH_ROLLING || WITH_BINDING || WITH_ENERGY)
#define WITH_WALL_WORK (WITH_ENERGY && WITH_MOVING) /* the program of pairs has WITH_MOVING 0 */
#define XI_AT 0
#define THETA_AT (WITH_TANGENTIAL ? 3 : 0)
#define DAMPING_N_AT (THETA_AT + (WITH_ROLLING_EPSD ? 3 : 0))
#define DAMPING_T_AT (DAMPING_N_AT + (WITH_ENERGY ? 1 : 0))
#define DAMPING_R_AT (DAMPING_T_AT + (WITH_ENERGY && WITH_TANGENTIAL_DAMPING ? 3 : 0))
#define WALL_FORCE_AT (DAMPING_R_AT + (WITH_ENERGY && WITH_ROLLING ? 3 : 0))
#define HISTORY_WIDTH (WALL_FORCE_AT + (WITH_WALL_WORK ? 3 : 0))

/* Result record: force; with rotation also the torque, which is the same on both of two equal
 * spheres; or the couple and both levers; or both torques. In fours, so that the gather takes a
 * force and a torque with one load each. */
#define WITH_ROTATION (WITH_TANGENTIAL || WITH_ROLLING)
#define RESULT_WIDTH (WITH_ROLLING ? 12 : WITH_ROTATION ? 8 : 4)

#ifdef __OPENCL_VERSION__
/* Vectors in rows of local memory [row][BATCH], l the contact. */
#define ROW3_LOAD(type, memory, row, l)                                                            \
    type((memory)[(row)*BATCH + (l)], (memory)[((row) + 1) * BATCH + (l)],                         \
        (memory)[((row) + 2) * BATCH + (l)])
#define ROW3_STORE(memory, row, l, x, y, z)                                                        \
    (memory)[(row)*BATCH + (l)] = (x);                                                             \
    (memory)[((row) + 1) * BATCH + (l)] = (y);                                                     \
    (memory)[((row) + 2) * BATCH + (l)] = (z)

LAW vec3 plane3_load(__global const real *plane, size_t capacity, size_t l)
{
    return v3(plane[l], plane[capacity + l], plane[2 * capacity + l]);
}

LAW void plane3_store(__global real *plane, size_t capacity, size_t l, vec3 a)
{
    plane[l] = a.x;
    plane[capacity + l] = a.y;
    plane[2 * capacity + l] = a.z;
}

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
    if (WITH_TANGENTIAL) h.xi = plane3_load(history + XI_AT * capacity, capacity, l);
    if (WITH_ROLLING_EPSD) h.theta = plane3_load(history + THETA_AT * capacity, capacity, l);
    if (WITH_ENERGY) h.damping_n = history[DAMPING_N_AT * capacity + l];
    if (WITH_ENERGY && WITH_TANGENTIAL_DAMPING)
        h.damping_t = plane3_load(history + DAMPING_T_AT * capacity, capacity, l);
    if (WITH_ENERGY && WITH_ROLLING)
        h.damping_r = plane3_load(history + DAMPING_R_AT * capacity, capacity, l);
    return h;
}

LAW void history_store(struct contact_history h, __global real *history, __global int *state,
    size_t capacity, size_t l)
{
    if (WITH_HISTORY) state[l] = h.state;
    if (WITH_TANGENTIAL) plane3_store(history + XI_AT * capacity, capacity, l, h.xi);
    if (WITH_ROLLING_EPSD) plane3_store(history + THETA_AT * capacity, capacity, l, h.theta);
    if (WITH_ENERGY) history[DAMPING_N_AT * capacity + l] = h.damping_n;
    if (WITH_ENERGY && WITH_TANGENTIAL_DAMPING)
        plane3_store(history + DAMPING_T_AT * capacity, capacity, l, h.damping_t);
    if (WITH_ENERGY && WITH_ROLLING)
        plane3_store(history + DAMPING_R_AT * capacity, capacity, l, h.damping_r);
}

#if WITH_WALL_WORK
/* What the wall gave in this step: mean of the force on the element before, which the history
 * keeps, and now, along the wall's way v_wall dt. A wall has no angular velocity in the rolling
 * law, so moments take no part. */
LAW real wall_work(
    vec3 force, vec3 v_wall, real dt, __global real *history, size_t capacity, size_t l)
{
    vec3 before = plane3_load(history + WALL_FORCE_AT * capacity, capacity, l);
    plane3_store(history + WALL_FORCE_AT * capacity, capacity, l, force);
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
    if (WITH_BINDING) ledger[LEDGER_BONDS * capacity + l] += (double)r.loss_b;
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
 * table by pair of materials. */
#define PARAMETER_ARGUMENTS                                                                        \
    real k_n, real gamma_n, real centring_n, real damp_n, real k_t, real gamma_t, real centring_t, \
        real damp_t, real mu, real f_b, real roll_limit, real roll_stop, real k_r, real c_r,       \
        int law
#define PARAMETERS_OF_ARGUMENTS                                                                    \
    parameters_of(k_n, gamma_n, centring_n, damp_n, k_t, gamma_t, centring_t, damp_t, mu, f_b,     \
        roll_limit, roll_stop, k_r, c_r, law)

LAW struct contact_parameters parameters_of(PARAMETER_ARGUMENTS)
{
    struct contact_parameters p;
    p.k_n = k_n;
    p.gamma_n = gamma_n;
    p.centring_n = centring_n;
    p.damp_n = damp_n;
    p.k_t = k_t;
    p.gamma_t = gamma_t;
    p.centring_t = centring_t;
    p.damp_t = damp_t;
    p.mu = mu;
    p.f_b = f_b;
    p.roll_limit = roll_limit;
    p.roll_stop = roll_stop;
    p.k_r = k_r;
    p.c_r = c_r;
    p.law = law;
    return p;
}

/* Parameters by material pair: rows of PARAMETER_WIDTH real, in the order of struct
 * contact_material (kinds > 1 size) or contact_parameters. */
#define MATERIAL_WIDTH 10
#define PARAMETER_WIDTH 15

LAW struct contact_material material_load(__global const real *row)
{
    struct contact_material c;
    c.k_n = row[0];
    c.k_t = row[1];
    c.gamma_n = row[2];
    c.gamma_t = row[3];
    c.mu = row[4];
    c.f_b = row[5];
    c.mu_r = row[6];
    c.k_r = row[7];
    c.c_r = row[8];
    c.law = (int)row[9];
    return c;
}

LAW struct contact_parameters parameters_load(__global const real *row)
{
    return parameters_of(row[0], row[1], row[2], row[3], row[4], row[5], row[6], row[7], row[8],
        row[9], row[10], row[11], row[12], row[13], (int)row[14]);
}
#endif

#endif
