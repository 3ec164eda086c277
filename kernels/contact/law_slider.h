/* A spring in series with a slider, and a dashpot beside the spring: friction and rolling
 * resistance are both of this kind.
 *
 * Trial, then slip: T = -k x. |T| <= cap: the force is T with the dashpot, shortened to the cap.
 * |T| > cap: the spring is cut to the cap, so that it never holds more than cap^2/(2 k), and the
 * rest is the same. At rest the dashpot has no part, so T is the force itself, and the contact
 * holds any load up to the cap. The dashpot stays where the spring is cut: where the cap falls
 * below a spring that moves back, the force would jump without it, which is of first order.
 *
 * The slip goes along the mean force of the step: with B the spring's force before this step's way,
 *     F = T - a (B + F), |F| = cap  =>  F = (T - a B)/(1 + a),
 *     a = (T^2 - cap^2)/(T.B + cap^2 + ((T.B + cap^2)^2 - (B^2 - cap^2)(T^2 - cap^2))^(1/2)),
 * the midpoint rule of plasticity (Ortiz and Popov 1985, Int. J. Numer. Methods Eng. 21, 1561). The
 * way back along T alone is of first order where the direction of sliding turns. A step that turns
 * the force round (no such a) goes back along T. The loss, a k (B + F)^2/(2 k^2), is not negative.
 *
 * Whole slip, by choice (LAMMPS): slip is tested on spring and dashpot together, T = -k x - gamma
 * v. If |T| > cap, F goes back to the cap as above, B with the dashpot of t^n, and the spring is
 * what the dashpot leaves of it, x = -(F + gamma v)/k. So the spring may hold more than the cap,
 * against the slip; its energy is in the account as it is.
 *
 * Undamped slip, by choice (LIGGGHTS, Yade): slip is tested on the spring, which is cut as by
 * default. Where it slips the dashpot has no part; where it sticks the sum has no limit. The force
 * jumps by the dashpot's where slip begins and ends.
 *
 * The spring lies in the tangent plane and turns with it. For x perpendicular to n_old the rotation
 * of n_old into n is
 *     x' = x - (n.x) (n + n_old)/(1 + n.n_old),
 * and with n_half in the middle (n + n_old)/(1 + n.n_old) = n_half/(n.n_half), here n_half + (1 -
 * n.n_half) n, called `turn`: no square root, no division, x' is perpendicular to n to rounding for
 * any n_half, and its part along the motion is shortened by angle^4/16 per step (by O(angle^2 v_n
 * dt/d) if the distance changes). The increment, perpendicular to n_half, goes the same way with an
 * error of third order.
 *
 * Springs whose stiffness follows the overlap (Mindlin: k = c delta^(1/2)) must not gain energy
 * from that. While the load grows the force is kept, T' = T - (mean k) dx; while it falls the
 * displacement is, T' = T k'/k - k' dx. Storing x = -T/k with r = k/k' this is
 *     x' = keep x + gain dx
 *     growing (r < 1): keep = r, gain = (mean k)/k';  falling: keep = gain = 1.
 * Without rescaling, by choice (F_t = k_t(delta) x), keep = gain = 1 always: a cycle of loading
 * then gives energy, which the account shows as a loss below zero.
 * For delta linear in time (mean k)/k' = (2/3)(1 + r + r^2)/(1 + r); (4 + r + r^2)/6 equals it at r
 * = 0 (onset) and to second order at 1. */
#ifndef DEMOCLES_LAW_SLIDER_H
#define DEMOCLES_LAW_SLIDER_H

#include "law_normal.h"

#define SLIDER_TINY ((real)1e-30) /* keeps 0/0 away */

struct slider_carry {
    vec3 turn;
    real keep;   /* [1] */
    real gain;   /* [1] */
    real time;   /* part of dt in contact [s] */
    real before; /* overlap factor s at t^n; the linear law has 1 */
};

/* A force beyond the cap that goes back to it along the mean force of the step. */
struct slider_return {
    vec3 force;
    real back, scale; /* force = scale (T - back B) */
    int slips;
};

struct slider {
    vec3 spring; /* x at t^{n+1} */
    vec3 force;  /* spring and dashpot */
    int slips;
};

/* s: overlap factor at t^{n+1} (struct normal_spring); time: part of dt in contact [s]. */
LAW struct slider_carry slider_carry_of(
    struct contact_kinematics k, struct contact_parameters p, real s, real time, real dt)
{
    struct slider_carry c;

    c.turn = v3_fma((real)1 - v3_dot(k.n, k.n_half), k.n, k.n_half);
    c.time = time;
    c.keep = c.gain = c.before = 1;
    if (WITH_HERTZ) {
        int hertz = normal_is_hertz(p);
        real old = r_fma(-k.v_n_half, dt, k.delta); /* overlap at t^n */
        struct normal_spring before = normal_spring_of(old, p), now = normal_spring_of(k.delta, p);
        real ratio = before.s / r_max(s, SLIDER_TINY);
        real keep = before.apart != now.apart ? (real)0 : r_min(ratio, (real)1);
        c.before = before.s;
        c.keep = hertz ? keep : (real)1;
        c.gain = hertz ? r_fma(keep, keep, keep + (real)4) * ((real)1 / (real)6) : (real)1;
    }
    return c;
}

/* The spring at t^{n+1} before slip. rate: velocity across it at the half step. */
LAW vec3 slider_trial(vec3 spring, vec3 rate, struct slider_carry c, vec3 n)
{
    vec3 x = v3_fma(c.gain * c.time, rate, v3_scale(c.keep, spring));
    return v3_fma(-v3_dot(n, x), c.turn, x);
}

/* u, b: T and B above. */
LAW struct slider_return slider_back(vec3 u, vec3 b, real cap)
{
    struct slider_return r;
    real limit = cap * cap;
    real square = v3_dot(u, u);
    int slips = square > limit;
    real excess = square - limit, along = v3_dot(u, b) + limit;
    real root = along * along - (v3_dot(b, b) - limit) * excess;
    int turns = slips && along > 0 && root > 0;
    r.slips = slips;
    r.back = turns ? excess / (along + r_sqrt(root)) : (real)0;
    u = v3_fma(-r.back, b, u);
    square = turns ? v3_dot(u, u) : square;
    r.scale = slips ? cap / r_sqrt(square) : (real)1;
    r.force = v3_scale(r.scale, u);
    return r;
}

/* trial: from slider_trial; before: the same without the way of this step; k: stiffness; dashpot:
 * its force at t^{n+1}, zero where there is none (damped = 0); cap >= 0: largest force. */
LAW struct slider slider_slip(vec3 trial, vec3 before, real k, int damped, vec3 dashpot, real cap)
{
    struct slider r;
    struct slider_return way = slider_back(v3_scale(-k, trial), v3_scale(-k, before), cap);
    vec3 u = way.force, x = v3_fma(-way.back, before, trial);
    r.spring = v3(way.slips ? way.scale * x.x : trial.x, way.slips ? way.scale * x.y : trial.y,
        way.slips ? way.scale * x.z : trial.z);
    r.slips = way.slips;
    if (damped) {
        u = v3_add(u, dashpot);
        real limit = cap * cap, square = v3_dot(u, u);
        /* a spring that has just been cut to the cap is not cut again for its rounding */
        int shorten = square > limit && v3_dot(dashpot, dashpot) > 0;
        u = v3_scale(shorten ? cap / r_sqrt(square) : (real)1, u);
    }
    r.force = u;
    return r;
}

/* Whole slip; dashpot_old: its force at t^n. */
LAW struct slider slider_slip_whole(
    vec3 trial, vec3 before, real k, vec3 dashpot, vec3 dashpot_old, real cap)
{
    struct slider r;
    struct slider_return way =
        slider_back(v3_fma(-k, trial, dashpot), v3_fma(-k, before, dashpot_old), cap);
    real inverse = (real)1 / r_max(k, SLIDER_TINY);
    vec3 left = v3_scale(inverse, v3_sub(dashpot, way.force));
    r.spring = v3(
        way.slips ? left.x : trial.x, way.slips ? left.y : trial.y, way.slips ? left.z : trial.z);
    r.force = way.force;
    r.slips = way.slips;
    return r;
}

/* Undamped slip. */
LAW struct slider slider_slip_undamped(vec3 trial, vec3 before, real k, vec3 dashpot, real cap)
{
    struct slider r = slider_slip(trial, before, k, 0, dashpot, cap);
    vec3 sum = v3_add(r.force, dashpot);
    r.force =
        v3(r.slips ? r.force.x : sum.x, r.slips ? r.force.y : sum.y, r.slips ? r.force.z : sum.z);
    return r;
}

/* What slip, and the change of stiffness, took from the spring in this step [J]: old energy - new
 * energy - work of the spring's force, the latter by the trapezoid of the step. k_old, old:
 * stiffness and spring at t^n; k: at t^{n+1}. Zero to the last bit for a linear spring that
 * sticks. */
LAW real slider_loss(
    real k_old, vec3 old, real k, vec3 trial, vec3 spring, vec3 rate, struct slider_carry c)
{
    vec3 dx = v3_scale(c.time, rate);
    vec3 cut = v3_sub(trial, spring);
    real loss = (real)0.5 * k * v3_dot(cut, v3_sub(v3_add(spring, trial), dx));
    if (!WITH_HERTZ) { /* k is k_old, or zero where the contact has ended */
        loss += (real)0.5 * (k_old - k) * v3_dot(old, v3_add(old, dx));
    } else {
        real kept = k * c.keep;
        real a = k_old - kept * c.keep;
        real b = k_old + kept - (real)2 * kept * c.gain;
        real g = k * c.gain * ((real)1 - c.gain);
        loss += (real)0.5 * (a * v3_dot(old, old) + b * v3_dot(old, dx) + g * v3_dot(dx, dx));
    }
    return loss;
}

#endif
