/* Friction: a tangential spring with memory and a dashpot, capped by Coulomb's C = mu max(F_n, 0),
 * bonded mu max(F_n + F_b, 0).
 *
 * k_t = k_t s, gamma_t = gamma_t s^(1/2), s = 1 (linear) or delta^(1/2) (Mindlin's 8 G* (R*
 * delta)^(1/2)); see law_slider.h for how the spring turns, slips and keeps its energy. Second
 * order in dt: v_t of the half step in all its parts, the first step of a contact counted only from
 * the touch, and a dashpot on the predicted velocity of t^{n+1} as in law_normal.h: the relative
 * acceleration of the two surfaces is F_t (1/m* + l_i^2/I_i + l_j^2/I_j) = 3.5 F_t/m* for spheres,
 * so 3.5/m* takes the place of 1/m*. */
#ifndef DEMOCLES_LAW_TANGENTIAL_H
#define DEMOCLES_LAW_TANGENTIAL_H

#include "law_normal.h"
#include "law_slider.h"

LAW real tangential_cap(real force_n, int bonded, struct contact_parameters p)
{
    real load = force_n;
    if (WITH_COHESION) load = bonded ? load + normal_cohesion(p) : load;
    return p.mu * r_max(load, (real)0);
}

/* trial: the spring carried to t^{n+1}, zero where there is no contact. */
LAW struct slider tangential_force(vec3 trial, vec3 before, struct contact_kinematics k, real cap,
    struct normal_factors f, struct contact_parameters p)
{
    vec3 dashpot = v3(0, 0, 0);
    if (WITH_TANGENTIAL_DAMPING) {
        vec3 predicted = v3_fma(f.gain_t, k.kick_t, v3_scale(f.keep_t, k.v_t_end));
        dashpot = v3_scale(-(p.gamma_t * f.damper), predicted);
    }
    return slider_slip(trial, before, p.k_t * f.spring, WITH_TANGENTIAL_DAMPING, dashpot, cap);
}

#endif
