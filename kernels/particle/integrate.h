/* Kick and drift of one element: the leapfrog of physics in one place, for the fused and for the
 * split step.
 *
 *   kick   v <- v + (dt/2) (F/m + g),  w <- w + (dt/2) tau/I,  I = 0.4 m r^2 of a sphere
 *   drift  x <- x + dt v
 * Lane 3 of every vector carries something else (radius, 1/m, material), of a kick 0, and passes
 * through untouched. */
#ifndef DEMOCLES_INTEGRATE_H
#define DEMOCLES_INTEGRATE_H

#include "element.h"

#if REAL_IS_FLOAT == POSITION_IS_FLOAT
#define TO_PREAL4(v) (v)
#else
#define TO_PREAL4(v) convert_double4(v)
#endif

/* What half a step adds to v. */
LAW real4 half_kick(real4 force, real inverse_m, real4 gravity, real half_dt)
{
    real4 a = fma(force, (real4)inverse_m, gravity);
    a.s3 = 0;
    return half_dt * a;
}

/* And to w; inverse_m / (0.4 r^2) = 1/I */
LAW real4 half_spin(real4 torque, real inverse_m, real radius, real half_dt)
{
    real inverse_inertia = (real)2.5 * inverse_m / (radius * radius);
    real4 a = inverse_inertia * torque;
    a.s3 = 0;
    return half_dt * a;
}

LAW preal4 drift(preal4 x, real4 v, preal dt)
{
    preal4 u = TO_PREAL4(v);
    u.s3 = 0;
    return fma((preal4)dt, u, x);
}

/* Orientation as a quaternion (w, x, y, z): q <- dq q with dq = ((1 - u.u), 2u)/(1 + u.u), u = w
 * dt/4: unit norm without trigonometry, angle error |w dt|^3/48 per step. */
LAW real4 turn(real4 q, real4 w, real dt)
{
    vec3 u = v3_scale((real)0.25 * dt, v3(w.s0, w.s1, w.s2));
    real uu = v3_dot(u, u), inverse = (real)1 / ((real)1 + uu);
    real s = ((real)1 - uu) * inverse;
    vec3 d = v3_scale((real)2 * inverse, u), p = v3(q.s1, q.s2, q.s3);
    vec3 r = v3_add(v3_add(v3_scale(s, p), v3_scale(q.s0, d)), v3_cross(d, p));
    return (real4)(s * q.s0 - v3_dot(d, p), r.x, r.y, r.z);
}

/* Whether the element has, or within margin_dt will have, used up the room that the lists gave it.
 * reference: place when the lists were built, lane 3 the room [m]. margin_dt: time until the host
 * can act on the flag [s]. NaN counts as stale: the check that follows finds it. */
LAW int is_stale(preal4 x, preal4 reference, real4 v, real margin_dt)
{
    preal4 d = x - reference;
    preal square = d.s0 * d.s0 + d.s1 * d.s1 + d.s2 * d.s2;
    real moving = v.s0 * v.s0 + v.s1 * v.s1 + v.s2 * v.s2, room = (real)reference.s3;
    /* (a + b)^2 <= 2 (a^2 + b^2): most are seen to be far from it without a square root */
    if ((real)2.001 * r_fma(margin_dt * margin_dt, moving, (real)square) <= room * room) return 0;
    return !(r_fma(margin_dt, r_sqrt(moving), (real)p_sqrt(square)) <= room);
}

#endif
