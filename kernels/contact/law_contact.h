/* One contact, one step: from kinematics, parameters and history to the force, torques and energies
 * at t^{n+1}, which is the t^n of run/step.h: the time of the forces of this step.
 *
 * Straight line: no loop, no early return, selects instead of branches, so that a kernel with one
 * work-item per interaction vectorises. A feature that a scene does not use (WITH_ flag 0) leaves
 * no instruction, and one that is compiled in but not used by a pair leaves the bits of the result
 * alone. All structs are private; which members live in buffers is the kernel's choice (the flags
 * say which are needed). Knows no elements, no lists, no memory. */
#ifndef DEMOCLES_LAW_CONTACT_H
#define DEMOCLES_LAW_CONTACT_H

#include "law_kinematics.h"
#include "law_normal.h"
#include "law_parameters.h"
#include "law_rolling.h"
#include "law_slider.h"
#include "law_tangential.h"

/* What a contact remembers, in the orientation i to j; all zero once the contact has ended. */
struct contact_history {
    vec3 xi;        /* WITH_TANGENTIAL: friction spring [m] */
    vec3 theta;     /* WITH_ROLLING_EPSD: rolling angle [rad] */
    int state;      /* WITH_TANGENTIAL, WITH_ROLLING_EPSD or WITH_COHESION: CONTACT_ bits */
    real damping_n; /* WITH_ENERGY: dashpot part of F_n at t^n [N] */
    vec3 damping_t; /* WITH_ENERGY and WITH_TANGENTIAL_DAMPING: of F_t [N] */
    vec3 damping_r; /* WITH_ENERGY and rolling: of M; CDT: all of M [N m] */
};

/* Force on i (on j: -force, exactly). Torque on i: l_i couple + moment, on j: l_j couple -
 * moment. */
struct contact_result {
    vec3 force;   /* -F_n n + F_t [N] */
    vec3 couple;  /* n x F_t [N] */
    vec3 moment;  /* M [N m] */
    real elastic; /* energy in all springs at t^{n+1} [J] */
    real loss_n;  /* what the step took, by the trapezoid of the step [J]: normal dashpot, */
    real loss_t;  /* tangential dashpot, */
    real loss_s;  /* sliding, */
    real loss_r;  /* rolling, */
    real loss_b;  /* broken bond */
};

/* The part `share` of a contact. */
LAW struct contact_result contact_result_share(struct contact_result r, real share)
{
    r.force = v3_scale(share, r.force);
    r.couple = v3_scale(share, r.couple);
    r.moment = v3_scale(share, r.moment);
    r.elastic *= share;
    r.loss_n *= share;
    r.loss_t *= share;
    r.loss_s *= share;
    r.loss_r *= share;
    r.loss_b *= share;
    return r;
}

/* The contact on its way through the step. */
struct contact_step {
    struct normal_step normal;
    real cap_t;
    vec3 trial_t, trial_r;
    struct slider_carry carry, carry_t; /* of rolling, of friction */
    struct slider slide, roll;          /* friction; EPSD */
};

LAW int contact_is_epsd(struct contact_parameters p)
{
    return WITH_ROLLING_EPSD && (!WITH_ROLLING_CDT || p.k_r > 0);
}

/* Normal part, state and the factors that friction and rolling share. */
LAW struct contact_step contact_begin(
    struct contact_kinematics k, struct contact_parameters p, real dt, int state)
{
    struct contact_step s;
    real part;

    s.normal = normal_step_of(k, dt, state, p);
    part = state != 0 ? (real)1 : r_clamp(s.normal.steps, (real)0, (real)1);
    s.carry = slider_carry_of(k, p, s.normal.factors.spring, part * dt, dt);
    s.carry_t = tangential_carry(s.carry, p);
    s.cap_t = tangential_cap(s.normal.force, s.normal.bonded, p);
    s.trial_t = s.trial_r = v3(0, 0, 0);
    s.slide.spring = s.slide.force = s.roll.spring = s.roll.force = v3(0, 0, 0);
    s.slide.slips = s.roll.slips = 0;
    return s;
}

/* x where `live`, else zero. */
LAW vec3 contact_select(int live, vec3 x)
{
    return v3(live ? x.x : (real)0, live ? x.y : (real)0, live ? x.z : (real)0);
}

/* The energy ledger; h still holds what was at t^n, r gets energies and losses, the dashpot forces
 * of t^{n+1} go to h. Each loss is the mean of the old and the new force times the half-step
 * velocity: that, and no end-of-step value, is what the kicks of leapfrog took. A bond that breaks
 * loses the energy of its springs less the work they still did in this step. */
LAW void contact_ledger(struct contact_kinematics k, struct contact_parameters p, real dt,
    struct contact_step s, vec3 moment, struct contact_history *h, struct contact_result *r)
{
    /* without friction there is no spring */
    real stiffness_t = p.mu > 0 ? p.k_t * s.normal.factors.spring : (real)0;
    real stiffness_r = p.k_r * s.normal.factors.spring;
    real damping_n = s.normal.force - s.normal.spring;
    real half_dt = (real)0.5 * dt;
    /* springs start from the touch, kicks take the whole step */
    real before_touch = (real)0.5 * (dt - s.carry.time);

    r->elastic = s.normal.alive ? normal_energy(normal_spring_of(k.delta, p), k.delta, p) : (real)0;
    r->loss_n = half_dt * (h->damping_n + damping_n) * k.v_n_half;
    h->damping_n = damping_n;
    if (WITH_TANGENTIAL) {
        real stiffness_old = p.mu > 0 ? p.k_t * s.carry.before : (real)0;
        real lost = slider_loss(stiffness_old, h->xi, s.normal.alive ? stiffness_t : (real)0,
            s.trial_t, s.slide.spring, k.v_t, s.carry_t);
        lost +=
            s.slide.slips ? before_touch * stiffness_t * v3_dot(s.slide.spring, k.v_t) : (real)0;
        r->elastic += (real)0.5 * stiffness_t * v3_dot(s.slide.spring, s.slide.spring);
        r->loss_s = s.normal.broke ? (real)0 : lost;
        r->loss_b = s.normal.broke ? lost : (real)0;
        if (WITH_TANGENTIAL_DAMPING) {
            vec3 damping = v3_fma(stiffness_t, s.slide.spring, s.slide.force);
            r->loss_t = -half_dt * v3_dot(v3_add(h->damping_t, damping), k.v_t);
            h->damping_t = damping;
        }
    }
    if (WITH_COHESION) {
        real before = r_fma(-k.v_n_half, dt, k.delta); /* overlap at t^n */
        struct normal_spring spring = normal_spring_of(before, p);
        real lost = normal_energy(spring, before, p) + half_dt * spring.force * k.v_n_half;
        r->loss_b = s.normal.broke ? r->loss_b + lost : r->loss_b;
    }
    if (KINEMATICS_ROLLING) {
        vec3 damping = moment;
        if (WITH_ROLLING_EPSD) {
            real lost = slider_loss(p.k_r * s.carry.before, h->theta,
                s.normal.alive ? stiffness_r : (real)0, s.trial_r, s.roll.spring, k.w_r, s.carry);
            /* CDT: spring 0 */
            damping = v3_fma(stiffness_r, s.roll.spring, moment);
            r->elastic += (real)0.5 * stiffness_r * v3_dot(s.roll.spring, s.roll.spring);
            r->loss_r = s.roll.slips && contact_is_epsd(p)
                            ? lost + before_touch * stiffness_r * v3_dot(s.roll.spring, k.w_r)
                            : lost;
        }
        r->loss_r -= half_dt * v3_dot(v3_add(h->damping_r, damping), k.w_r);
        h->damping_r = damping;
    }
}

/* The contact law. h: history at t^n on entry, at t^{n+1} on return; dt [s]. */
LAW struct contact_result contact_law(
    struct contact_kinematics k, struct contact_parameters p, real dt, struct contact_history *h)
{
    struct contact_step s = contact_begin(k, p, dt, h->state);
    struct contact_result r;

    r.couple = r.moment = v3(0, 0, 0);
    r.elastic = r.loss_n = r.loss_t = r.loss_s = r.loss_r = r.loss_b = 0;
    r.force = v3_scale(-s.normal.force, k.n);
    if (WITH_TANGENTIAL) {
        s.trial_t =
            contact_select(s.normal.alive && p.mu > 0, slider_trial(h->xi, k.v_t, s.carry_t, k.n));
        vec3 before = contact_select(
            s.normal.alive && p.mu > 0, slider_trial(h->xi, v3(0, 0, 0), s.carry_t, k.n));
        s.slide = tangential_force(s.trial_t, before, k, s.carry_t, s.cap_t, s.normal.factors, p);
        if (WITH_WHOLE_SLIP)
            s.slide.spring = contact_select(s.normal.alive && p.mu > 0, s.slide.spring);
        r.force = v3_fma(-s.normal.force, k.n, s.slide.force);
        r.couple = v3_cross(k.n, s.slide.force);
    }
    if (WITH_ROLLING_CDT) r.moment = rolling_cdt(k.w_r_end, rolling_cap(s.normal.force, p), p);
    if (WITH_ROLLING_EPSD) {
        int epsd = contact_is_epsd(p);
        s.trial_r =
            contact_select(s.normal.alive && epsd, slider_trial(h->theta, k.w_r, s.carry, k.n));
        vec3 before = contact_select(
            s.normal.alive && epsd, slider_trial(h->theta, v3(0, 0, 0), s.carry, k.n));
        s.roll = rolling_epsd(
            s.trial_r, before, k.w_r_end, rolling_cap(s.normal.force, p), s.normal.factors, p);
        r.moment.x = epsd ? s.roll.force.x : r.moment.x;
        r.moment.y = epsd ? s.roll.force.y : r.moment.y;
        r.moment.z = epsd ? s.roll.force.z : r.moment.z;
    }
    if (WITH_ENERGY) contact_ledger(k, p, dt, s, r.moment, h, &r);
    h->xi = contact_select(s.normal.alive, s.slide.spring);
    h->theta = contact_select(s.normal.alive, s.roll.spring);
    h->state = (k.delta > 0 ? CONTACT_TOUCHING : 0) | (s.normal.bonded ? CONTACT_BONDED : 0);
    return r;
}

#endif
