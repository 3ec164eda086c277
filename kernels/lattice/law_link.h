/* One elastic link between two rigid cubes: six springs at the common face of cell i (lower
 * coordinate) and cell j (higher), along axis a.
 *
 * Everything here is seen with axis a first: x, y, z of a vector stand for (a, b, c) cyclic, e =
 * (1, 0, 0), until link_on_lower and link_on_upper turn back. A link is always evaluated from lower
 * to higher, so the two cells (and two ranks) that do so find the same bits, and each keeps its
 * share: force f on i, -f on j. Displacements, never positions: strains keep their digits in single
 * precision.
 *
 * Small rotations (WITH_TURN = 0), theta [rad]; linear, not objective:
 *     g = u_j - u_i - (h/2) (theta_i + theta_j) x e,   chi = theta_j - theta_i
 *     f = (kn g_a + P, ks g_b, ks g_c),   mom = (kt chi_a, kb chi_b, kb chi_c)
 *     P = (h^2/2)(r_i p_i + r_j p_j)
 *     torque on i: (h/2) e x f + mom,   on j: (h/2) e x f - mom
 *
 * Any rotation (WITH_TURN = 1), unit quaternions q; a = R e, n = (a_i + a_j)/2 (not normalised),
 * (s, v) = q_j q_i^-1 the relative rotation. Energy
 *     U = ks |g|^2/2 + (kn - ks) (n.g)^2/2 + 2 kb |v|^2 + 2 (kt - kb) (v.a_i)^2
 *     g = u_j - u_i - (h/2)(d_i + d_j),   d = a - e
 * and force and torques are its exact gradient, hence objective, with linear and angular momentum
 * kept to rounding:
 *     f = ks g + f_e n,   f_e = (kn - ks) n.g + P
 *     mom = 2 kb s v + 2 (kt - kb) (v.a_i) (s a_i + v x a_i)
 *     torque on i: a_i x lever + mom,   on j: a_j x lever - mom,   lever = (h/2) f - (f_e/2) g
 * v.a_i = v.a_j, because the relative rotation leaves its own axis alone; U does not know which
 * cell is i, nor the signs of q. A pure bend or twist by an angle x has the moment k sin(x). For
 * bending this is kb (1 - a_i.a_j); for twist it is nearer to linear than (kt/2) sin^2 x. No
 * trigonometry, no root.
 *
 * Kelvin-Voigt damping (WITH_LINK_DAMPING), time eta [s], in addition:
 *     gd = v_j - v_i - (h/2)(w_i x a_i + w_j x a_j) - (w_i + w_j)/2 x g
 *          (zero for rigid motion of a strained body)
 *     f_d = eta (ks gd + (kn - ks)(n.gd) n) at the middle of the gap, arms (h/2) a_i + g/2 and
 *       -(h/2) a_j - g/2
 *     mom_d = eta (kb wr + (kt - kb)(n.wr) n),   wr = w_j - w_i
 * so the power -f_d.gd - mom_d.wr is never positive, and p takes n.g + eta d(n.g)/dt
 * (link_stretch). The small form is k (g + eta gd) with linear gd.
 *
 * WITH_SHARES: the link joins the covered parts of two faces. Its constants come in the covered
 * share, and it acts at the middle of that part, `offset` d beside the middle of the face:
 *     g + R_j d - R_i d in place of g,   torque on i: + (R_i d) x f,   on j: - (R_j d) x f
 * which is the gradient of the same U. A field of constant strain has the same gap as without d.
 *
 * WITH_VOLUME: P exists. WITH_SHEAR_APART: kn != ks, WITH_TWIST_APART: kt != kb, somewhere in the
 * body; the small form does not care, it is as cheap either way. A rigid wall is a cell j without
 * mass that the wall carries, centre h/2 behind the face, with the constants of a half-link. */
#ifndef DEMOCLES_LAW_LINK_H
#define DEMOCLES_LAW_LINK_H

#include "common/quat.h"

struct link_constants {
    real kn, ks;   /* normal, shear [N/m] */
    real kt, kb;   /* twist, bend [N m] */
    real r_i, r_j; /* share of the stretch in each half, times 2 [1] */
    real h;        /* edge of a cell [m] */
    real eta;      /* Kelvin-Voigt time [s] */
    int is_cut;    /* WITH_SHARES: whether the offset counts */
    vec3 offset;   /* WITH_SHARES: of the covered part's middle from the face's, axis first [m] */
};

/* What a link asks of a cell; members that the flags leave out need no value. */
struct link_cell {
    pvec3 u;       /* displacement of the centre [m] */
    pvec3 theta;   /* !WITH_TURN: [rad] */
    struct quat q; /* WITH_TURN */
    vec3 v;        /* WITH_LINK_DAMPING: [m/s] */
    vec3 w;        /* WITH_LINK_DAMPING: [rad/s] */
};

/* The strain of a link, axis first. */
struct link_state {
    vec3 gap;      /* g [m] */
    vec3 turn;     /* chi, or v of the relative rotation [1] */
    real scalar;   /* WITH_TURN: s */
    vec3 a_i, a_j; /* WITH_TURN: axis a of both cells */
    vec3 n;        /* WITH_TURN */
    vec3 gap_rate; /* gd [m/s] */
    vec3 spin;     /* wr [rad/s] */
    int is_cut;    /* WITH_SHARES */
    vec3 o_i, o_j; /* WITH_SHARES: R d of both cells [m] */
};

/* What both cells get, axis first: a x lever + couple +- moment. */
struct link_force {
    vec3 force;  /* on i [N] */
    vec3 moment; /* mom [N m] */
    vec3 lever;  /* [N m] */
    vec3 couple; /* [N m] */
};

struct link_share {
    vec3 force;  /* on the cell [N] */
    vec3 torque; /* about its centre [N m] */
};

/* v and w of the relative rotation. dq = q_j - q_i is exact for neighbours, so that no digit of the
 * angle is lost against 1. */
LAW void link_turn(struct quat i, struct quat j, struct link_state *s)
{
    real w = (real)i.w, dw = (real)(j.w - i.w);
    vec3 v = v3_of_p3(i.v), dv = v3_of_p3(p3_sub(j.v, i.v));

    s->turn = v3_sub(v3_fma(w, dv, v3_scale(-dw, v)), v3_cross(dv, v));
    s->scalar = r_fma(w, (real)j.w, v3_dot(v, v3_of_p3(j.v)));
}

/* v and w of both cells, axis first. */
LAW void link_rates(vec3 v_i, vec3 v_j, vec3 w_i, vec3 w_j, real arm, struct link_state *s)
{
    vec3 sum = v3_add(w_i, w_j), dv = v3_sub(v_j, v_i);

    s->spin = v3_sub(w_j, w_i);
    if (WITH_TURN) {
        vec3 swing = v3_add(v3_cross(w_i, s->a_i), v3_cross(w_j, s->a_j));
        s->gap_rate = v3_fma(-arm, swing, v3_fma((real)-0.5, v3_cross(sum, s->gap), dv));
    } else {
        s->gap_rate = v3(dv.x, r_fma(-arm, sum.z, dv.y), r_fma(arm, sum.y, dv.z));
    }
}

/* (R - I) d */
LAW pvec3 link_swung(struct quat q, pvec3 d)
{
    pvec3 t = p3_scale((preal)2, p3_cross(q.v, d));
    return p3_fma(q.w, t, p3_cross(q.v, t));
}

/* What the offset d adds to the gap. */
LAW void link_beside(
    int axis, struct link_cell i, struct link_cell j, pvec3 d, struct link_state *s)
{
    s->o_i = s->o_j = v3_of_p3(d);
    if (WITH_TURN) {
        pvec3 o_i = link_swung(quat_cycle(i.q, axis), d),
              o_j = link_swung(quat_cycle(j.q, axis), d);
        s->gap = v3_add(s->gap, v3_of_p3(p3_sub(o_j, o_i)));
        s->o_i = v3_of_p3(p3_add(d, o_i));
        s->o_j = v3_of_p3(p3_add(d, o_j));
    } else {
        s->gap = v3_add(s->gap, v3_cross(s->turn, s->o_i));
    }
}

/* Axis 0, 1, 2, a constant. */
LAW struct link_state link_state_of(
    int axis, struct link_cell i, struct link_cell j, struct link_constants k)
{
    struct link_state s;
    preal arm = (preal)0.5 * (preal)k.h;
    pvec3 du = p3_cycle(p3_sub(j.u, i.u), axis);
    vec3 zero = v3(0, 0, 0);

    s.scalar = 1;
    s.a_i = s.a_j = s.n = v3(1, 0, 0);
    s.gap_rate = s.spin = s.o_i = s.o_j = zero;
    s.is_cut = WITH_SHARES ? k.is_cut : 0;
    if (WITH_TURN) {
        struct quat q_i = quat_cycle(i.q, axis), q_j = quat_cycle(j.q, axis);
        pvec3 d_i = quat_first(q_i), d_j = quat_first(q_j), sum = p3_add(d_i, d_j);
        s.gap = v3_of_p3(p3_fma(-arm, sum, du));
        s.a_i = v3((real)1 + (real)d_i.x, (real)d_i.y, (real)d_i.z);
        s.a_j = v3((real)1 + (real)d_j.x, (real)d_j.y, (real)d_j.z);
        s.n = v3_fma((real)0.5, v3_of_p3(sum), s.n);
        link_turn(q_i, q_j, &s);
    } else {
        pvec3 t_i = p3_cycle(i.theta, axis), t_j = p3_cycle(j.theta, axis);
        s.gap = v3((real)du.x, (real)p_fma(-arm, t_i.z + t_j.z, du.y),
            (real)p_fma(arm, t_i.y + t_j.y, du.z));
        s.turn = v3_of_p3(p3_sub(t_j, t_i));
    }
    if (WITH_SHARES && k.is_cut) link_beside(axis, i, j, p3_of_v3(k.offset), &s);
    if (WITH_LINK_DAMPING) {
        vec3 w_i = v3_cycle(i.w, axis), w_j = v3_cycle(j.w, axis);
        link_rates(v3_cycle(i.v, axis), v3_cycle(j.v, axis), w_i, w_j, (real)arm, &s);
        if (WITH_SHARES && k.is_cut)
            s.gap_rate = v3_add(s.gap_rate, v3_sub(v3_cross(w_j, s.o_j), v3_cross(w_i, s.o_i)));
    }
    return s;
}

/* n.g [m], and its rate [m/s]: the part along n of gd, and of n turning against the mean spin, wr x
 * (a_j - a_i)/4. */
LAW real link_normal_gap(struct link_state s) { return WITH_TURN ? v3_dot(s.n, s.gap) : s.gap.x; }
LAW real link_normal_rate(struct link_state s)
{
    return WITH_TURN ? r_fma((real)0.25, v3_dot(s.gap, v3_cross(s.spin, v3_sub(s.a_j, s.a_i))),
                           v3_dot(s.n, s.gap_rate))
                     : s.gap_rate.x;
}
/* What Th of a cell takes from the link [m]; eta of that cell. */
LAW real link_stretch(struct link_state s, real eta)
{
    return WITH_LINK_DAMPING ? r_fma(eta, link_normal_rate(s), link_normal_gap(s))
                             : link_normal_gap(s);
}

/* P [N] of the pressures lambda Th of both cells [Pa]. */
LAW real link_pressure(struct link_constants k, real p_i, real p_j)
{
    return (real)0.5 * k.h * k.h * r_fma(k.r_i, p_i, k.r_j * p_j);
}

/* Small rotations: springs on g + eta gd. */
LAW struct link_force link_force_small(struct link_state s, struct link_constants k, real pressure)
{
    struct link_force f;
    vec3 g = WITH_LINK_DAMPING ? v3_fma(k.eta, s.gap_rate, s.gap) : s.gap;
    vec3 t = WITH_LINK_DAMPING ? v3_fma(k.eta, s.spin, s.turn) : s.turn;

    f.force = v3(WITH_VOLUME ? r_fma(k.kn, g.x, pressure) : k.kn * g.x, k.ks * g.y, k.ks * g.z);
    f.moment = v3(k.kt * t.x, k.kb * t.y, k.kb * t.z);
    f.lever = v3_scale((real)0.5 * k.h, f.force);
    f.couple = v3(0, 0, 0);
    return f;
}

/* Any rotation: the gradient of U, and the dashpots. */
LAW struct link_force link_force_turned(struct link_state s, struct link_constants k, real pressure)
{
    struct link_force f;
    real arm = (real)0.5 * k.h, apart = k.kn - k.ks, twist = k.kt - k.kb;
    real f_e = WITH_SHEAR_APART ? apart * v3_dot(s.n, s.gap) : (real)0;

    if (WITH_VOLUME) f_e += pressure;
    f.force = v3_scale(k.ks, s.gap);
    f.moment = v3_scale((real)2 * k.kb * s.scalar, s.turn);
    f.couple = v3(0, 0, 0);
    if (WITH_SHEAR_APART || WITH_VOLUME) f.force = v3_fma(f_e, s.n, f.force);
    if (WITH_TWIST_APART)
        f.moment = v3_fma((real)2 * twist * v3_dot(s.turn, s.a_i),
            v3_fma(s.scalar, s.a_i, v3_cross(s.turn, s.a_i)), f.moment);
    if (WITH_LINK_DAMPING) {
        vec3 d = v3_scale(k.eta * k.ks, s.gap_rate);
        if (WITH_SHEAR_APART) d = v3_fma(k.eta * apart * v3_dot(s.n, s.gap_rate), s.n, d);
        f.force = v3_add(f.force, d);
        f.moment = v3_fma(k.eta * k.kb, s.spin, f.moment);
        if (WITH_TWIST_APART) f.moment = v3_fma(k.eta * twist * v3_dot(s.n, s.spin), s.n, f.moment);
        f.couple = v3_scale((real)0.5, v3_cross(s.gap, d));
    }
    f.lever = v3_scale(arm, f.force);
    if (WITH_SHEAR_APART || WITH_VOLUME) f.lever = v3_fma((real)-0.5 * f_e, s.gap, f.lever);
    return f;
}

/* p_i, p_j: lambda Th of both cells [Pa]; not read without WITH_VOLUME. */
LAW struct link_force link_force_of(
    struct link_state s, struct link_constants k, real p_i, real p_j)
{
    real pressure = WITH_VOLUME ? link_pressure(k, p_i, p_j) : (real)0;
    return WITH_TURN ? link_force_turned(s, k, pressure) : link_force_small(s, k, pressure);
}

/* The torque of one cell, axis first; a: its axis; sign: +1 for i, -1 for j. */
LAW vec3 link_torque(struct link_force f, vec3 a, real sign)
{
    vec3 t = WITH_TURN ? v3_cross(a, f.lever) : v3(0, -f.lever.z, f.lever.y);
    if (WITH_TURN && WITH_LINK_DAMPING) t = v3_add(t, f.couple);
    return v3_fma(sign, f.moment, t);
}

/* The share of i, and of j, in world components. */
LAW struct link_share link_on_lower(int axis, struct link_state s, struct link_force f)
{
    struct link_share r;
    r.force = v3_uncycle(f.force, axis);
    vec3 torque = link_torque(f, s.a_i, 1);
    if (WITH_SHARES && s.is_cut) torque = v3_add(torque, v3_cross(s.o_i, f.force));
    r.torque = v3_uncycle(torque, axis);
    return r;
}
LAW struct link_share link_on_upper(int axis, struct link_state s, struct link_force f)
{
    struct link_share r;
    r.force = v3_uncycle(v3_neg(f.force), axis);
    vec3 torque = link_torque(f, s.a_j, -1);
    if (WITH_SHARES && s.is_cut) torque = v3_sub(torque, v3_cross(s.o_j, f.force));
    r.torque = v3_uncycle(torque, axis);
    return r;
}

/* r where the link exists, else zero: what lies beyond a missing link may be anything, NaN too. */
LAW struct link_share link_if(int exists, struct link_share r)
{
    r.force = v3(
        exists ? r.force.x : (real)0, exists ? r.force.y : (real)0, exists ? r.force.z : (real)0);
    r.torque = v3(exists ? r.torque.x : (real)0, exists ? r.torque.y : (real)0,
        exists ? r.torque.z : (real)0);
    return r;
}

/* U [J], without the cells' volumetric energy. */
LAW real link_energy(struct link_state s, struct link_constants k)
{
    real n = link_normal_gap(s), g2 = v3_dot(s.gap, s.gap), t2 = v3_dot(s.turn, s.turn);
    real a = WITH_TURN ? v3_dot(s.turn, s.a_i) : s.turn.x, four = WITH_TURN ? (real)4 : (real)1;
    return (real)0.5 *
           (r_fma(k.ks, g2, (k.kn - k.ks) * n * n) + four * r_fma(k.kb, t2, (k.kt - k.kb) * a * a));
}

/* What the dashpots of the link take [W], >= 0, without the part in p: that is 2 eta times the
 * volumetric energy of the rate of Th. */
LAW real link_dissipation(struct link_state s, struct link_constants k)
{
    real n = WITH_TURN ? v3_dot(s.n, s.gap_rate) : s.gap_rate.x,
         a = WITH_TURN ? v3_dot(s.n, s.spin) : s.spin.x;
    real shear = r_fma(k.ks, v3_dot(s.gap_rate, s.gap_rate), (k.kn - k.ks) * n * n);
    return k.eta * (shear + r_fma(k.kb, v3_dot(s.spin, s.spin), (k.kt - k.kb) * a * a));
}

#endif
