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
 * - pair-centred dashpot: v_n^{n+1} = v_n - F_n dt/(2 m*), solved for F_n: division by 1 + gamma
 *   dt/(2 m*). Momentum stays exact.
 * - onset weight: at delta = 0 the dashpot jumps (linear), or starts with an infinite slope
 *   (Hertz). The kick at t^{n+1} stands for the time from dt/2 before to dt/2 after, so the
 *   dashpot gets its mean over that time, with a = delta/(|v_n| dt):
 *   linear: the part in contact, clamp(1/2 + a, 0, 1);
 *   Hertz:  the mean of max(delta, 0)^(1/4): for a < 1/2
 *           (4/5) (a + 1/2) (delta + |v_n| dt/2)^(1/4), later delta^(1/4) (1 - 1/(128 a^2) - ...).
 *           The latter is written without a division, (1 - 0.011 (2 - a)^4) for a < 2, and 4/5 is
 *           taken as 0.792: with these two numbers the sum over the steps of a linear onset equals
 *           the integral within 0.005 steps at any phase (0.32 without the weight).
 *   So the dashpot acts up to |v_n| dt/2 before the touch. A bond has passed its onset. */
#ifndef DEMOCLES_LAW_NORMAL_H
#define DEMOCLES_LAW_NORMAL_H

#include "law_kinematics.h"
#include "law_parameters.h"

#define NORMAL_TINY ((real)1e-30) /* keeps 0/0 away; far below any |v_n| dt that matters */

/* Overlap dependence shared by all springs and dashpots of the contact. */
struct normal_factors {
    real spring; /* s */
    real damper; /* s^(1/2), weighted */
    real damp_n; /* 1/(1 + gamma_n dt/(2 m*)) */
    real damp_t; /* 1/(1 + 3.5 gamma_t dt/(2 m*)) */
};

LAW int normal_is_hertz(struct contact_parameters p)
{
    return WITH_HERTZ && (!WITH_LINEAR || (p.law & CONTACT_HERTZ) != 0);
}

/* way: |v_n| dt [m]. Returns delta/way: how many steps ago the surfaces met. */
LAW real normal_steps(real delta, real way) { return delta / (way + NORMAL_TINY); }

/* way, steps: as above; was_bonded: at t^n. */
LAW struct normal_factors normal_factors_of(
    real delta, real way, real steps, int was_bonded, struct contact_parameters p)
{
    struct normal_factors f;
    real onset = was_bonded ? (real)1 : r_clamp((real)0.5 + steps, (real)0, (real)1);
    int hertz = normal_is_hertz(p);

    f.spring = 1;
    f.damper = onset;
    f.damp_n = p.damp_n;
    f.damp_t = WITH_TANGENTIAL_DAMPING ? p.damp_t : (real)1;
    if (WITH_HERTZ) { /* one division for both */
        int entering = onset < 1;
        real s = r_sqrt(r_abs(delta));
        real late = was_bonded ? (real)0 : r_clamp((real)2 - steps, (real)0, (real)1.5);
        real weight = entering ? (real)0.792 * onset
                               : r_fma((real)-0.011 * late * late, late * late, (real)1);
        real damper = weight * r_sqrt(entering ? r_sqrt(r_abs(r_fma((real)0.5, way, delta))) : s);
        real one_n = r_fma(p.centring_n, damper, (real)1);
        real one_t = WITH_TANGENTIAL_DAMPING ? r_fma(p.centring_t, damper, (real)1) : (real)1;
        real both = (real)1 / (one_n * one_t);
        f.spring = hertz ? s : f.spring;
        f.damper = hertz ? damper : f.damper;
        f.damp_n = hertz ? both * one_t : f.damp_n;
        /* without dashpot 1 to the last bit */
        f.damp_t = hertz ? (one_t > 1 ? both * one_n : (real)1) : f.damp_t;
    }
    return f;
}

/* F_n > 0 repels [N]. spring: k_n s delta while the contact lives, else 0. */
LAW real normal_force(real spring, real v_n, struct normal_factors f, struct contact_parameters p)
{
    real force = r_fma(p.gamma_n * f.damper, v_n, spring) * f.damp_n;
    if (WITH_NO_ATTRACTION) { /* the dashpot may not pull; the spring of a bond may */
        real least = spring < 0 ? spring : (real)0;
        force = (p.law & CONTACT_NO_ATTRACTION) != 0 && force < least ? least : force;
    }
    return force;
}

/* Energy of the spring [J]: k delta^2/2 or (2/5) K |delta|^(5/2). */
LAW real normal_energy(real spring, real delta, struct contact_parameters p)
{
    return (normal_is_hertz(p) ? (real)0.4 : (real)0.5) * spring * delta;
}

#endif
