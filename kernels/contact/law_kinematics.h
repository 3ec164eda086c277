/* Geometry and velocities of one contact, at the two times that a second-order step needs.
 *
 * The force at t^{n+1} is made from positions at t^{n+1} and velocities at the half step before it.
 * What is integrated over the step (the sliding and rolling of the two surfaces on each other) must
 * be taken at the half step in everything, normal and lever arms too: with v^{n+1/2} and n^{n+1} a
 * spinning sphere creeps sideways, to first order in dt. What acts at t^{n+1} (the dashpots) takes
 * n^{n+1} and velocities of that time, which nobody knows before the forces: they are predicted
 * from the half kick (dt/2) a^n that all forces of the last step gave (law_normal.h). Leapfrog
 * makes D_h = D^{n+1} - (v_j - v_i) dt/2 the exact mean of D^n and D^{n+1}.
 *
 * i is the lower global id. Knows no law. Angular velocities are not read unless WITH_TANGENTIAL or
 * rolling asks for them. */
#ifndef DEMOCLES_LAW_KINEMATICS_H
#define DEMOCLES_LAW_KINEMATICS_H

#include "common/vec.h"

#ifndef WITH_SIZES /* host */
#define WITH_SIZES 1
#endif
#ifndef WITH_KICK /* host; 0: no contact has a dashpot, so that nothing is predicted */
#define WITH_KICK 1
#endif
#define KINEMATICS_HALF (WITH_TANGENTIAL || WITH_ROLLING_EPSD || WITH_ENERGY)
#define KINEMATICS_ROLLING (WITH_ROLLING_CDT || WITH_ROLLING_EPSD)

/* How two bodies move in the step. */
struct kinematics_motion {
    vec3 v;              /* of i relative to j at the centres, at the half step [m/s] */
    vec3 kick;           /* what v gains until t^{n+1} by the forces of t^n: (dt/2) a^n [m/s] */
    vec3 w_i, w_j;       /* at the half step [rad/s] */
    vec3 spun_i, spun_j; /* what these gain [rad/s] */
    int radius_lever;    /* WITH_RADIUS_LEVER: lever arms are the radii, in all that follows */
};

struct contact_kinematics {
    vec3 n;      /* unit normal from i to j at t^{n+1} */
    vec3 n_half; /* the same at the half step */
    real delta;  /* overlap at t^{n+1} [m] */
    /* lever arms at t^{n+1} [m]; l_i + l_j is the distance of the centres, or the sum of radii */
    real l_i, l_j;
    real v_n;    /* approach speed of the half step along n [m/s] */
    real kick_n; /* what it gains until t^{n+1} by the forces of t^n [m/s] */
    /* along n_half: v_n_half dt is the growth of delta over the step, to third order */
    real v_n_half;
    vec3 v_t;     /* of i relative to j at the contact, perpendicular to n_half [m/s] */
    vec3 v_t_end; /* the half-step velocities seen at t^{n+1}, perpendicular to n [m/s] */
    vec3 kick_t;  /* what v_t_end gains until t^{n+1} [m/s] */
    vec3 w_r;     /* w_i - w_j perpendicular to n_half [rad/s] */
    vec3 w_r_end; /* of t^{n+1}, as predicted, perpendicular to n */
};

/* Two bodies that no force has kicked. */
LAW struct kinematics_motion kinematics_free(vec3 v_i, vec3 v_j, vec3 w_i, vec3 w_j)
{
    struct kinematics_motion m;
    m.v = v3_sub(v_i, v_j);
    m.w_i = w_i;
    m.w_j = w_j;
    m.kick = m.spun_i = m.spun_j = v3(0, 0, 0);
    m.radius_lever = 0;
    return m;
}

/* l_i w_i + l_j w_j, written so that equal levers need the sum of the spins alone (a kernel for
 * equal spheres loads no more), with the same bits, also when i and j change places. */
LAW vec3 kinematics_spin(real l_i, real l_j, vec3 w_i, vec3 w_j)
{
    vec3 mean = v3_scale((real)0.5 * (l_i + l_j), v3_add(w_i, w_j));
#if WITH_SIZES
    mean = v3_add(mean, v3_scale((real)0.5 * (l_i - l_j), v3_sub(w_i, w_j)));
#endif
    return mean;
}

/* What pairs and walls share. spin_half, spin_end: l_i w_i + l_j w_j with the levers of the half
 * step and of t^{n+1}; spun_end: the same of spun_i, spun_j. */
LAW struct contact_kinematics contact_kinematics_of(vec3 n, vec3 n_half, real delta, real l_i,
    real l_j, struct kinematics_motion m, vec3 spin_half, vec3 spin_end, vec3 spun_end)
{
    struct contact_kinematics k;
    vec3 zero = v3(0, 0, 0);

    k.n = n;
    k.n_half = n_half;
    k.delta = delta;
    k.l_i = l_i;
    k.l_j = l_j;
    k.v_n = v3_dot(m.v, n);
    k.kick_n = WITH_KICK ? v3_dot(m.kick, n) : (real)0;
    k.v_n_half = k.v_n;
    k.v_t = k.v_t_end = k.kick_t = k.w_r = k.w_r_end = zero;
    if (KINEMATICS_HALF) k.v_n_half = v3_dot(m.v, n_half);
    if (WITH_TANGENTIAL) {
        k.v_t = v3_tangent(v3_add(m.v, v3_cross(spin_half, n_half)), n_half);
        if (WITH_TANGENTIAL_DAMPING) {
            k.v_t_end = v3_tangent(v3_add(m.v, v3_cross(spin_end, n)), n);
            k.kick_t = v3_tangent(v3_add(m.kick, v3_cross(spun_end, n)), n);
        }
    }
    if (KINEMATICS_ROLLING) {
        vec3 w = v3_sub(m.w_i, m.w_j), spun = v3_sub(m.spun_i, m.spun_j);
        if (WITH_ROLLING_EPSD || WITH_ENERGY) k.w_r = v3_tangent(w, n_half);
        k.w_r_end = v3_tangent(v3_add(w, spun), n);
    }
    return k;
}

/* Direction of u, given that |u| is near 1, and |u| itself: two Newton steps for 1/|u| from 1, y <-
 * y (3 - |u|^2 y^2)/2, whose error is (|u|^2 - 1)^4/5. Where |u|^2 is off by more than a half (a
 * step that crosses the centre) it is n, and 1. */
LAW vec3 kinematics_unit(vec3 u, vec3 n, real *length)
{
    real s = v3_dot(u, u);
    real y = r_fma((real)-0.5, s, (real)1.5);
    int near = s > (real)0.5 && s < (real)1.5;
    y = y * r_fma((real)-0.5 * s, y * y, (real)1.5);
    *length = near ? s * y : (real)1;
    return v3(near ? y * u.x : n.x, near ? y * u.y : n.y, near ? y * u.z : n.z);
}

/* Two spheres. D = x_j - x_i at t^{n+1} [m] (periodic image taken); radii [m]; dt [s]. Without
 * WITH_SIZES and rolling only w_i + w_j and spun_i + spun_j are used. The distance and the overlap
 * are formed in preal, everything after in real. Coincident centres: n = (1, 0, 0). */
LAW struct contact_kinematics contact_kinematics_pair(
    pvec3 D, struct kinematics_motion m, real r_i, real r_j, real dt)
{
    preal sum = (preal)r_i + (preal)r_j;
    preal square = p3_dot(D, D);
    int coincide = square <= (preal)1e-20 * sum * sum;
    preal distance = coincide ? (preal)0 : p_sqrt(square);
    real d = coincide ? (real)sum : (real)distance;
    real inverse = (real)1 / d;
    real delta = (real)(sum - distance);
    int radii = WITH_RADIUS_LEVER && m.radius_lever;
    real half_delta = radii ? (real)0 : (real)0.5 * delta;
    real l_i = r_i - half_delta, l_j = r_j - half_delta;
    vec3 x = v3_of_p3(D);
    vec3 n = v3(coincide ? (real)1 : inverse * x.x, coincide ? (real)0 : inverse * x.y,
        coincide ? (real)0 : inverse * x.z);
    vec3 n_half = n;
    real shift = 0; /* l_half - l */

    if (KINEMATICS_HALF) {
        real length;
        n_half = kinematics_unit(v3_scale(inverse, v3_fma((real)0.5 * dt, m.v, x)), n, &length);
        shift = radii ? (real)0 : (real)0.5 * d * (length - (real)1);
    }
    return contact_kinematics_of(n, n_half, delta, l_i, l_j, m,
        kinematics_spin(l_i + shift, l_j + shift, m.w_i, m.w_j),
        kinematics_spin(l_i, l_j, m.w_i, m.w_j), kinematics_spin(l_i, l_j, m.spun_i, m.spun_j));
}

/* A sphere and a wall whose overlap and normal the caller knows (one-sided plane: the distance has
 * a sign). n, n_half: unit vectors from the centre towards the wall at t^{n+1} and at the half
 * step; delta, delta_half: r - distance [m]; m: relative to the wall point, which has no spin and
 * whose velocity of the half step is (p^{n+1} - p^n)/dt. */
LAW struct contact_kinematics contact_kinematics_wall(
    vec3 n, vec3 n_half, real delta, real delta_half, struct kinematics_motion m, real r_i)
{
    int radius = WITH_RADIUS_LEVER && m.radius_lever;
    real l_i = radius ? r_i : r_i - delta, l_half = radius ? r_i : r_i - delta_half;
    return contact_kinematics_of(n, n_half, delta, l_i, 0, m, v3_scale(l_half, m.w_i),
        v3_scale(l_i, m.w_i), v3_scale(l_i, m.spun_i));
}

#endif
