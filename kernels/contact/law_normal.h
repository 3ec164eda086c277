/* Normal force: linear spring or Hertz, each with a dashpot that gives one restitution at all
 * speeds.
 *
 * Linear  F_n = k_n delta + gamma_n v_n,                gamma_n = 2 z (k_n m*)^(1/2)
 * Hertz   F_n = K delta^(3/2) + gamma delta^(1/4) v_n,  gamma = 5^(1/2) z (K m*)^(1/2)
 *         (Antypov and Elliott 2011, EPL 94, 50004)
 * Both are k s delta + gamma s^(1/2) v_n with s = 1 or |delta|^(1/2). Bonded pairs go on to delta <
 * 0, Hertz as an odd function.
 *
 * Second order in dt although v_n is of the half step:
 * - predicted velocity: the dashpot acts on v_p^{n+1} = v_n + (dt/2) a^{n+1}, where a^{n+1} is what
 *   the pair's own force gives, with this dashpot in it, and all other forces (weight, other
 *   contacts) give as at t^n. Their part is the total a^n = kick 2/dt of the last step less the
 *   pair's own. With the spring's tangent k and gamma the latter follows from the same velocities,
 *   v^n = v_n - (dt/2) a^n, so no contact has to remember its force:
 *       v_p = v_n (1 - T/(1 + c)) + kick (1 - c)/(1 + c),
 *       c = gamma dt/(2 m*) (centring), T = k dt^2/(2 m*) (turning).
 *   In the steps in which the pair meets or parts, with h the onset weight (below) of t^n and f the
 *   part of the step in contact:
 *       v_p = [v_n (1 + c h - T f) + kick h' (1 - c h)]/(1 + c),
 *   h' that of now: without this factor contacts that flicker about the touch feed a bed that
 *   should come to rest (at 1e-5 s that of cases/packing, e-fold in 20 to 100 ms).
 *   For a pair alone that is the trapezoidal rule in its own force; at rest v_n and the kick are
 *   zero, and so is the dashpot: the spring alone holds the load, to rounding. Both factors are
 *   kept at or above 0, which is all that the bound of law_limit.h asks for. In a dense bed the
 *   error is that of the trapezoidal rule solved for all contacts at once.
 * - onset weight: at delta = 0 the dashpot jumps (linear), or starts with an infinite slope
 *   (Hertz). The kick at t^{n+1} stands for the time from dt/2 before to dt/2 after, so the
 *   dashpot gets its mean over that time, with a = delta/(|v_n| dt):
 *   linear: the part in contact, clamp(1/2 + a, 0, 1);
 *   Hertz:  the mean of max(delta, 0)^(1/4): for a < 1/2
 *           (4/5) (a + 1/2) (delta + |v_n| dt/2)^(1/4), later delta^(1/4) (1 - 1/(128 a^2) - ...).
 *           The latter is written without a division, (1 - 0.011 (2 - a)^4) for a < 2, and 4/5 is
 *           taken as 0.792: with these two numbers the sum over the steps of a linear onset equals
 *           the integral within 0.005 steps at any phase (0.32 without the weight).
 *   So the dashpot acts up to |v_n| dt/2 before the touch. A bond has passed its onset.
 *
 * JKR (Johnson, Kendall and Roberts 1971, Proc. R. Soc. A 324, 301): Hertz with the work of
 * adhesion w [J/m2] (2 gamma of equal materials) over the contact area. With the contact radius a,
 *     delta = a^2/R* - (2 pi w a/E*)^(1/2),  F_n = 4 E* a^3/(3 R*) - (8 pi w E* a^3)^(1/2),
 * and in the length L = (2 pi w R*^(1/2)/E*)^(2/3), K = (4/3) E* R*^(1/2), a = (L R*)^(1/2) u^2:
 *     delta = L (u^4 - u),  F_n = K L^(3/2) (u^6 - (3/2) u^3),
 *     energy K L^(5/2) ((2/5) u^10 - u^7 + (3/8) u^4 + 9/40), 0 at the touch.
 * It begins at the touch (u = 1), pulls with up to (3/2) pi w R* (u^3 = 3/4), rests at u^3 = 3/2
 * and ends where delta is least (u^3 = 1/4, delta = -0.47 L), which loses the energy left then.
 * u comes from Newton's method, below: the usual solution of the quartic by cosines and cube roots
 * (Parteli et al. 2014, Sci. Rep. 4, 6227) has bits that depend on the vendor. The other springs
 * and dashpots follow s = a/R*^(1/2); friction is capped by mu (F_n + 3 pi w R*) (Thornton 1991, J.
 * Phys. D 24, 1942). The force jumps at the touch, so it has the onset weight of a linear dashpot.
 *
 * Whoever adds a normal law adds it here: the spring and its energy, whether it holds beyond the
 * touch, and how stiff an impact can make it, for the bound of law_limit.h. */
#ifndef DEMOCLES_LAW_NORMAL_H
#define DEMOCLES_LAW_NORMAL_H

#include "contact_state.h"
#include "law_binding.h"
#include "law_kinematics.h"
#include "law_parameters.h"

#define NORMAL_TINY ((real)1e-30) /* keeps 0/0 away; far below any |v_n| dt that matters */

/* Laws that hold beyond the touch: W as in contact_memory.h. */
#define COHESION_OF(W) (W(BINDING) || W(JKR))
#define WITH_COHESION COHESION_OF(FLAG)

/* The spring at an overlap, whether or not there is contact. */
struct normal_spring {
    real s;     /* what all springs and dashpots of the contact follow: 1 or |delta|^(1/2) */
    real force; /* k_n s delta [N] */
    int apart;  /* beyond the point without load, where friction that follows the load is lost */
};

/* Overlap dependence shared by all springs and dashpots of the contact. */
struct normal_factors {
    real spring;         /* s */
    real damper;         /* s^(1/2), weighted */
    real keep_n, gain_n; /* v_p = keep v + gain kick, along n [1] */
    real keep_t, gain_t; /* and across it */
};

/* One step along the normal. */
struct normal_step {
    int alive, bonded, was_bonded;
    int broke;   /* the bond did, in this step */
    real steps;  /* overlap/way of a step: how many steps ago the surfaces met */
    real spring; /* elastic part of the force while the contact lives, else 0 [N] */
    real force;  /* > 0 repels [N] */
    struct normal_factors factors;
};

LAW int normal_is_hertz(struct contact_parameters p)
{
    return WITH_HERTZ && (!WITH_LINEAR || (p.law & CONTACT_HERTZ) != 0);
}

/* JKR: u and delta/L where the contact ends, 4^(-1/3) and -(3/4) 4^(-1/3). */
#define JKR_END ((real)0.62996052494743658)
#define JKR_REACH ((real)-0.47247039371057744)

LAW int normal_is_jkr(struct contact_parameters p) { return WITH_JKR && p.jkr > 0; }

/* A Newton step for t (t^2 + 4 e t + 6 e^2)^(1/2) = z, e = JKR_END. */
LAW real jkr_newton(real t, real z)
{
    real more = t * (t + (real)2 * JKR_END);
    real q = r_sqrt(t * (t + (real)4 * JKR_END) + (real)6 * JKR_END * JKR_END);
    return (t * more + z * q) / (q * q + more);
}

/* u of u^4 - u = d, the branch that is stable under a given distance. With t = u - e the quartic is
 * t^2 (t^2 + 4 e t + 6 e^2) = d - JKR_REACH, whose root is smooth in t from the end on; the start
 * t (t + 1.45) = z is 2 % off at most, three steps leave rounding. */
LAW real jkr_root(real d)
{
    real z = r_sqrt(r_max(d - JKR_REACH, (real)0));
    real t = (real)2 * z / ((real)1.45 + r_sqrt((real)2.1025 + (real)4 * z));
    return JKR_END + jkr_newton(jkr_newton(jkr_newton(t, z), z), z);
}

LAW struct normal_spring normal_spring_of(real delta, struct contact_parameters p)
{
    struct normal_spring n;
    n.s = 1;
    if (WITH_HERTZ) n.s = normal_is_hertz(p) ? r_sqrt(r_abs(delta)) : (real)1;
    n.force = p.k_n * n.s * delta;
    n.apart = delta < 0;
    if (WITH_JKR) {
        int jkr = normal_is_jkr(p);
        real length = jkr ? p.jkr : (real)1, root = r_sqrt(length);
        real u = jkr_root(delta / length), cube = u * u * u;
        n.s = jkr ? root * u * u : n.s;
        n.force = jkr ? p.k_n * length * root * cube * (cube - (real)1.5) : n.force;
        n.apart = jkr ? 0 : n.apart;
    }
    return n;
}

/* Energy of the spring [J]: k delta^2/2 or (2/5) K |delta|^(5/2). */
LAW real normal_energy(struct normal_spring n, real delta, struct contact_parameters p)
{
    real energy = (normal_is_hertz(p) ? (real)0.4 : (real)0.5) * n.force * delta;
    if (WITH_JKR) {
        real root = r_sqrt(p.jkr), u = r_sqrt(n.s / r_max(root, NORMAL_TINY));
        real cube = u * u * u, u4 = u * cube;
        real of_u = u4 * (cube * ((real)0.4 * cube - (real)1) + (real)0.375) + (real)0.225;
        energy = normal_is_jkr(p) ? p.k_n * p.jkr * p.jkr * root * of_u : energy;
    }
    return energy;
}

/* Whether the contact holds at t^{n+1}, so that it may go on beyond the touch. */
LAW int normal_holds(int was_bonded, real delta, real spring, struct contact_parameters p)
{
    int jkr = normal_is_jkr(p) && (delta > 0 || (was_bonded && delta > JKR_REACH * p.jkr));
    return jkr || binding_holds(was_bonded, delta, spring, p);
}

/* How much more than F_n presses the surfaces of a contact that holds together, for friction. */
LAW real normal_cohesion(struct contact_parameters p)
{
    real pull = WITH_JKR ? (real)1.125 * p.k_n * p.jkr * r_sqrt(p.jkr) : (real)0; /* 3 pi w R* */
    return normal_is_jkr(p) ? pull : p.f_b;
}

/* v_p = keep v + gain kick; c_old: c h, turning: T f, damp: 1/(1 + c) above. */
LAW real normal_keep(real c_old, real turning, real damp)
{
    return damp * r_max((real)1 + c_old - turning, (real)0);
}
LAW real normal_gain(real c_old, real damp) { return damp * r_max((real)1 - c_old, (real)0); }

/* delta [m]; s at it, s_old at t^n; v_n [m/s]; way: |v_n| dt [m]; steps: delta/way; was_bonded: at
 * t^n. */
LAW struct normal_factors normal_factors_of(real delta, real s, real s_old, real v_n, real way,
    real steps, int was_bonded, struct contact_parameters p)
{
    struct normal_factors f;
    real onset = was_bonded ? (real)1 : r_clamp((real)0.5 + steps, (real)0, (real)1);
    /* delta/way at t^n, and what follows from it */
    real steps_old = v_n > 0 ? steps - (real)1 : steps + (real)1;
    real onset_old = was_bonded ? (real)1 : r_clamp((real)0.5 + steps_old, (real)0, (real)1);
    real part = was_bonded ? (real)1 : r_clamp(v_n > 0 ? steps : steps_old, (real)0, (real)1);
    real c_n = p.centring_n, c_t = WITH_TANGENTIAL_DAMPING ? p.centring_t : (real)0;
    real damp_n = p.damp_n, damp_t = WITH_TANGENTIAL_DAMPING ? p.damp_t : (real)1;
    int hertz = normal_is_hertz(p);

    f.spring = s;
    f.damper = onset;
    if (WITH_HERTZ) { /* one division for both */
        int entering = onset < 1;
        real late = was_bonded ? (real)0 : r_clamp((real)2 - steps, (real)0, (real)1.5);
        real weight = entering ? (real)0.792 * onset
                               : r_fma((real)-0.011 * late * late, late * late, (real)1);
        real damper = weight * r_sqrt(entering ? r_sqrt(r_abs(r_fma((real)0.5, way, delta))) : s);
        if (WITH_JKR) damper = normal_is_jkr(p) ? onset * r_sqrt(s) : damper;
        real one_n = r_fma(p.centring_n, damper, (real)1);
        real one_t = WITH_TANGENTIAL_DAMPING ? r_fma(p.centring_t, damper, (real)1) : (real)1;
        real both = (real)1 / (one_n * one_t);
        f.damper = hertz ? damper : f.damper;
        damp_n = hertz ? both * one_t : damp_n;
        damp_t = hertz ? both * one_n : damp_t;
        real before = onset_old > 0 ? r_sqrt(s_old) : (real)0;
        c_n = hertz ? p.centring_n * before : c_n;
        c_t = hertz && WITH_TANGENTIAL_DAMPING ? p.centring_t * before : c_t;
        part *= hertz ? (real)0.5 * (s + s_old) : (real)1;
    }
    f.keep_n = normal_keep(c_n * onset_old, p.turning_n * part, damp_n);
    f.gain_n = onset * normal_gain(c_n * onset_old, damp_n);
    f.keep_t = normal_keep(c_t * onset_old, p.turning_t * part, damp_t);
    f.gain_t = onset * normal_gain(c_t * onset_old, damp_t);
    return f;
}

/* F_n > 0 repels [N]. spring: as in struct normal_step; v_n, kick_n: as in contact_kinematics. */
LAW real normal_force(
    real spring, real v_n, real kick_n, struct normal_factors f, struct contact_parameters p)
{
    real predicted = r_fma(f.gain_n, kick_n, f.keep_n * v_n);
    real force = r_fma(p.gamma_n * f.damper, predicted, spring);
    if (WITH_NO_ATTRACTION) { /* the dashpot may not pull; the spring of a bond may */
        real least = spring < 0 ? spring : (real)0;
        force = (p.law & CONTACT_NO_ATTRACTION) != 0 && force < least ? least : force;
    }
    return force;
}

/* state: of the contact at t^n. */
LAW struct normal_step normal_step_of(
    struct contact_kinematics k, real dt, int state, struct contact_parameters p)
{
    struct normal_step n;
    real delta = k.delta, v_n = k.v_n;
    struct normal_spring spring = normal_spring_of(delta, p);
    real way = r_abs(v_n) * dt;

    n.was_bonded = WITH_COHESION && (state & CONTACT_BONDED) != 0;
    n.steps = delta / (way + NORMAL_TINY);
    real s_old = 1;
    if (WITH_HERTZ) {
        real old = r_fma(-v_n, dt, delta);
        s_old = n.was_bonded || old > 0 ? normal_spring_of(old, p).s : (real)0;
    }
    n.factors = normal_factors_of(delta, spring.s, s_old, v_n, way, n.steps, n.was_bonded, p);
    n.bonded = normal_holds(n.was_bonded, delta, spring.force, p);
    n.broke = n.was_bonded && !n.bonded;
    n.alive = delta > 0 || n.bonded;
    n.factors.damper = n.broke ? (real)0 : n.factors.damper;
    n.spring = n.alive ? spring.force : (real)0;
    if (WITH_JKR) { /* from half a step before the touch on, but not after the end */
        int jkr = normal_is_jkr(p), acts = n.alive || (v_n > 0 && !n.broke);
        real onset = n.was_bonded ? (real)1 : r_clamp((real)0.5 + n.steps, (real)0, (real)1);
        n.spring = jkr ? (acts ? onset * spring.force : (real)0) : n.spring;
        n.factors.damper = jkr && !acts ? (real)0 : n.factors.damper;
    }
    n.force = normal_force(n.spring, v_n, k.kick_n, n.factors, p);
    return n;
}

/* Whether two materials act on each other at this overlap: touch, or are near enough to hold. */
LAW int normal_acts(struct contact_material c, real r_star, real delta)
{
    real apart = r_abs(delta);
    real spring = material_is_hertz(c) ? c.k_n * r_sqrt(r_star * apart) * apart : c.k_n * apart;
    int jkr = WITH_JKR && c.jkr > 0 && delta > JKR_REACH * c.jkr * r_cube_root(r_star);
    return delta > 0 || jkr || (WITH_BINDING && c.f_b > 0 && spring <= c.f_b);
}

/* q^(1/5) from above: 1/5 = 3/16 (1 + 1/16 + 1/256 + ...) by square roots, then a Newton step,
 * which ends above the root of a convex function. */
LAW real normal_fifth_root(real q)
{
    real eighth = r_sqrt(r_sqrt(r_sqrt(q)));
    real first = eighth * r_sqrt(eighth);
    real second = r_sqrt(r_sqrt(r_sqrt(r_sqrt(first))));
    real y = first * second * r_sqrt(r_sqrt(r_sqrt(r_sqrt(second))));
    real y4 = y * y * y * y;
    return y4 > 0 ? (real)0.2 * ((real)4 * y + q / y4) : (real)0;
}

/* JKR's s at the deepest overlap, from above. Beyond the touch its force is at least that of Hertz
 * less K L^(3/2)/2 (equal at u = 1), and its energy at the end is 0.249 K L^(5/2), so that
 * x = delta_m^(1/2) has
 *     x^5 <= A + B x^2,  A = max(delta, 0)^(5/2) + (5/4) m* v_n^2/K (+ 0.625 L^(5/2) if delta < 0),
 *     B = (5/4) L^(3/2);  x <= A^(1/5) + B^(1/3),
 * and Newton's steps from there stay above the root of a convex function. The tangent
 * dF_n/ddelta = 2 E* a (4 u^3 - 3)/(4 u^3 - 1) is below 2 E* a = (3/2) K s. */
LAW real jkr_deepest(struct contact_material c, real r_star, real m_star, real delta, real v_n)
{
    real length = c.jkr * r_cube_root(r_star), root = r_sqrt(length);
    real now = r_sqrt(r_max(delta, (real)0)), L2 = length * length * root;
    real a = now * now * now * now * now +
             (real)1.25 * m_star * v_n * v_n / (r_sqrt(r_star) * c.k_n) +
             (delta < 0 ? (real)0.625 * L2 : (real)0);
    real b = (real)1.25 * length * root;
    real x = normal_fifth_root(a) + (real)1.0773 * root;
    for (int k = 0; k < 3; k++) {
        real slope = (real)5 * x * x * x * x - (real)2 * b * x;
        x -= r_max(x * x * (x * x * x - b) - a, (real)0) / slope;
    }
    real u = jkr_root(x * x / length);
    return root * u * u;
}

/* s where the two bodies alone would come to rest, for a bound: a Hertz contact stiffens with
 * depth,
 *     (2/5) K delta_m^(5/2) = (2/5) K |delta|^(5/2) + m* v_n^2/2. */
LAW real normal_deepest(struct contact_material c, real r_star, real m_star, real delta, real v_n)
{
    real stiffness = r_sqrt(r_star) * c.k_n;
    real speed = v_n > 0 || c.f_b > 0 ? v_n : (real)0; /* a bond turns receding bodies round */
    real now = r_sqrt(r_abs(delta));
    real later = normal_fifth_root(
        now * now * now * now * now + (real)1.25 * m_star * speed * speed / stiffness);
    if (WITH_JKR && c.jkr > 0) return jkr_deepest(c, r_star, m_star, delta, v_n);
    return material_is_hertz(c) ? r_max(now, later) : (real)1;
}

#endif
