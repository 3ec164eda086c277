/* Rotation of a cell as a unit quaternion (w, v), from the body to the world.
 *
 * Forces see a rotation through its displacement columns d = (R - I) e = 2 [w v x e + v x (v x e)]:
 * exact for small angles where R itself would lose digits against 1, which is what single precision
 * lives on. Without a rotation all of them are 0 to the last bit.
 *
 * The update is q <- exp(r) q with a rotation vector r in the world frame. exp(r) = (cos y, r
 * sin(y)/|r|), y = |r|/2, is one fixed series in y^2 up to y^8: error below 1e-16 for |r| < 0.2,
 * and the same bits everywhere. Then one Newton step for 1/|q|, q <- q (3 - |q|^2)/2. All in preal,
 * since steps are small against what they add up to. */
#ifndef DEMOCLES_QUAT_H
#define DEMOCLES_QUAT_H

#include "axis.h"

/* v first: in float, members of a struct that is passed go in pairs as vectors, and pairs that
 * straddle v keep pocl from vectorising. */
struct quat {
    pvec3 v;
    preal w;
};

LAW struct quat quat_of(preal w, preal x, preal y, preal z)
{
    struct quat q;
    q.w = w;
    q.v = p3(x, y, z);
    return q;
}

LAW struct quat quat_cycle(struct quat q, int a)
{
    q.v = p3_cycle(q.v, a);
    return q;
}

/* (R - I) e_x: 11 flops. */
LAW pvec3 quat_first(struct quat q)
{
    preal y = (preal)2 * q.v.y, z = (preal)2 * q.v.z;
    return p3(-p_fma(y, q.v.y, z * q.v.z), p_fma(y, q.v.x, z * q.w), p_fma(z, q.v.x, -(y * q.w)));
}

/* (R - I) e_a in world components; a = 0, 1, 2. */
LAW pvec3 quat_column(struct quat q, int a) { return p3_uncycle(quat_first(quat_cycle(q, a)), a); }

/* R s */
LAW pvec3 quat_rotate(struct quat q, pvec3 s)
{
    pvec3 t = p3_scale((preal)2, p3_cross(q.v, s));
    return p3_add(p3_fma(q.w, t, s), p3_cross(q.v, t));
}
/* R^T s: body components of a world vector. */
LAW pvec3 quat_unrotate(struct quat q, pvec3 s)
{
    pvec3 t = p3_scale((preal)2, p3_cross(s, q.v));
    return p3_add(p3_fma(q.w, t, s), p3_cross(t, q.v));
}

/* First b, then a. */
LAW struct quat quat_times(struct quat a, struct quat b)
{
    struct quat q;
    q.w = p_fma(a.w, b.w, -p3_dot(a.v, b.v));
    q.v = p3_add(p3_fma(a.w, b.v, p3_scale(b.w, a.v)), p3_cross(a.v, b.v));
    return q;
}

/* exp(r) q, normalised. r: rotation vector [rad], |r| < 0.2; a drift over dt has r = dt w. RK4 has
 * q at the start of the step and its r of the stage. */
LAW struct quat quat_turn(struct quat q, pvec3 r)
{
    preal s = (preal)0.25 * p3_dot(r, r);
    preal c = p_fma(s,
        p_fma(s,
            p_fma(
                s, p_fma(s, (preal)1 / (preal)40320, (preal)-1 / (preal)720), (preal)1 / (preal)24),
            (preal)-0.5),
        (preal)1);
    preal k = p_fma(s,
        p_fma(s,
            p_fma(s, p_fma(s, (preal)1 / (preal)362880, (preal)-1 / (preal)5040),
                (preal)1 / (preal)120),
            (preal)-1 / (preal)6),
        (preal)1);
    struct quat step;
    preal norm;
    step.w = c;
    step.v = p3_scale((preal)0.5 * k, r);
    q = quat_times(step, q);
    norm = (preal)0.5 * ((preal)3 - p_fma(q.w, q.w, p3_dot(q.v, q.v)));
    q.w = norm * q.w;
    q.v = p3_scale(norm, q.v);
    return q;
}

/* Rate of the rotation vector r that leads from a fixed start to now, for an angular velocity w in
 * the world frame [rad/s]: dr/dt = w - r x w/2 + r x (r x w)/12 + O(r^4). With + in the second term
 * a Runge-Kutta step loses its order. */
LAW pvec3 quat_rate(pvec3 r, pvec3 w)
{
    pvec3 x = p3_cross(r, w);
    return p3_fma((preal)1 / (preal)12, p3_cross(r, x), p3_fma((preal)-0.5, x, w));
}

/* Rotation vector over dt [s] of a body that starts with angular velocity w [rad/s], for RKN4: its
 * translation formula `shift` (w, b in place of v, a) and the commutator, -(dt^3/12) w x b, with an
 * angular acceleration b at the middle of the interval, or at its start [rad/s2]:
 *     stage 2   dt/2, dt w/2 + dt^2 b1/8, b1      stage 3   dt, dt w + dt^2 b2/2, b2      end   dt,
 *       dt w + dt^2 (b1 + 2 b2)/6, b2
 * (Magnus' series with w = w_0 + b t + ... : (1/2) the integral of w(t) x w(s) over s < t). The end
 * needs b at the middle for its fourth order; without commutators in the stages the torques see
 * attitudes that spoil it to 3, without any it is 2. */
LAW pvec3 quat_rkn4(pvec3 shift, pvec3 w, pvec3 b, preal dt)
{
    return p3_fma(-dt * dt * dt / (preal)12, p3_cross(w, b), shift);
}

#endif
