/* Friction: a tangential spring with memory and a dashpot, capped by Coulomb's C = mu max(F_n, 0),
 * bonded mu max(F_n + F_b, 0).
 *
 * k_t = k_t s, gamma_t = gamma_t s^(1/2), s = 1 (linear) or delta^(1/2) (Mindlin's 8 G* (R*
 * delta)^(1/2)); see law_slider.h for how the spring turns, slips and keeps its energy. Second
 * order in dt: v_t of the half step in all its parts, the first step of a contact counted only from
 * the touch, and a dashpot on the predicted velocity of t^{n+1} as in law_normal.h: the relative
 * acceleration of the two surfaces is F_t (1/m* + l_i^2/I_i + l_j^2/I_j) = 3.5 F_t/m* for spheres,
 * so 3.5/m* takes the place of 1/m*.
 *
 * What other codes do differently is a choice of the contact (CONTACT_ bits in law_parameters.h):
 * whole or undamped slip and no rescaling (law_slider.h), levers (law_kinematics.h), and C = mu
 * |F_n|, with which a dashpot that pulls while the contact ends allows friction too. */
#ifndef DEMOCLES_LAW_TANGENTIAL_H
#define DEMOCLES_LAW_TANGENTIAL_H

#include "law_normal.h"
#include "law_slider.h"

LAW real tangential_cap(real force_n, int bonded, struct contact_parameters p)
{
    real load = force_n;
    if (WITH_COHESION) load = bonded ? load + normal_cohesion(p) : load;
    if (WITH_CAP_MAGNITUDE) load = parameters_choose(p, CONTACT_CAP_MAGNITUDE) ? r_abs(load) : load;
    return p.mu * r_max(load, (real)0);
}

/* How the friction spring is carried. */
LAW struct slider_carry tangential_carry(struct slider_carry c, struct contact_parameters p)
{
    if (WITH_NO_RESCALE) {
        int keeps = parameters_choose(p, CONTACT_NO_RESCALE);
        c.keep = keeps ? (real)1 : c.keep;
        c.gain = keeps ? (real)1 : c.gain;
    }
    return c;
}

/* trial: the spring carried to t^{n+1}, zero where there is no contact. */
LAW struct slider tangential_force(vec3 trial, vec3 before, struct contact_kinematics k,
    struct slider_carry carry, real cap, struct normal_factors f, struct contact_parameters p)
{
    struct slider slide;
    vec3 dashpot = v3(0, 0, 0);
    if (WITH_TANGENTIAL_DAMPING) {
        vec3 predicted = v3_fma(f.gain_t, k.kick_t, v3_scale(f.keep_t, k.v_t_end));
        dashpot = v3_scale(-(p.gamma_t * f.damper), predicted);
    }
    slide = slider_slip(trial, before, p.k_t * f.spring, WITH_TANGENTIAL_DAMPING, dashpot, cap);
    if (WITH_WHOLE_SLIP && WITH_TANGENTIAL_DAMPING) {
        /* the velocity of t^n is that of the half step less the kick since then */
        vec3 v_old = v3_sub(k.v_t_end, k.kick_t);
        real damper = f.damper;
        if (WITH_HERTZ)
            damper = normal_is_hertz(p)
                         ? f.damper * r_sqrt(carry.before / r_max(f.spring, SLIDER_TINY))
                         : damper;
        struct slider whole = slider_slip_whole(
            trial, before, p.k_t * f.spring, dashpot, v3_scale(-(p.gamma_t * damper), v_old), cap);
        if (parameters_choose(p, CONTACT_WHOLE_SLIP)) slide = whole;
        struct slider bare = slider_slip_undamped(trial, before, p.k_t * f.spring, dashpot, cap);
        if (parameters_choose(p, CONTACT_UNDAMPED_SLIP)) slide = bare;
    }
    return slide;
}

#endif
