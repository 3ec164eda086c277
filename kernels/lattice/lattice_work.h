/* The account of energy that enters and leaves a lattice cell: work of loads and of prescribed
 * motion, and what damping takes. Host and device alike, in double whatever `real` is.
 *
 * These are three more quantities that a scheme integrates together with the motion, with rates
 * that depend on the state of an evaluation. So they move where v does: over a kick of s seconds at
 * fixed x by integrals along it, v(s) = v e^(-alpha s) + a (1 - e^(-alpha s))/alpha,
 *     way  = integral of v = g v + G a                          (struct lattice_kick)
 *     lost = integral of alpha v^2 = A v^2 + alpha g^2 v a + C a^2
 * and over a Runge-Kutta stage of weight s by way = s v, lost = s alpha v^2. The balance then
 * closes with the scheme's order, and what rounding does to v stays visible in it. Per degree of
 * freedom, M its mass or inertia, f the force (torque) of links, e that of links without dashpots:
 *     links += (e - f) way       dashpots
 *     mass  += M lost            of a free DOF
 *     work  += load way          of a free DOF: forces, pressures, levers, and M times the
 *                                accelerations that boundaries add
 *     work  -= (f + weight) way  of a fixed DOF, way = s times the prescribed velocity: its drive
 *                                carries links and gravity, and cancels loads. What goes into the
 *                                DOF's own kinetic energy is a function of the state, and is not
 *                                summed here
 *
 * A traction t.n also moves the face that it acts on, by (h/2) eps, eps = (t.n - p)/(2 G)
 * (law_volume.h, p without dashpots): its work has the rate (h^3/2) t.n d(eps)/dt. By parts, with T
 * the sum of t.n over a cell's faces, that is h^3/(4 G) (sum of t.n^2/2 - T p), a function of the
 * state, and the rate h^3/(4 G) p dT/dt. */
#ifndef DEMOCLES_LATTICE_WORK_H
#define DEMOCLES_LATTICE_WORK_H

#include "lattice_state.h"

#if !defined(__OPENCL_VERSION__) || WITH_ENERGY /* double exists */

/* What acts on a cell at one evaluation. */
struct lattice_effort {
    struct link_share links, still, loads; /* of links, of links without dashpots, of loads */
    vec3 weight, added;                    /* accelerations: gravity's, boundaries' [m/s2] */
    vec3 v, w;                             /* prescribed at this time [m/s] [rad/s] */
    real face;                             /* h^3/(4 G) p dT/dt [W] */
};

/* One kick: v <- f v + g a over s [s]. */
struct lattice_kick {
    real f, g, s;
    real whole;          /* G [s2] */
    real lost_v, lost_a; /* A [1], C [s2] */
};
LAW struct lattice_kick lattice_kick_of(__global const real *p)
{
    struct lattice_kick k;
    k.f = p[0];
    k.g = p[1];
    k.s = p[2];
    k.whole = p[3];
    k.lost_v = p[4];
    k.lost_a = p[5];
    return k;
}

/* Integrals along a kick or a stage, of a DOF that is free. */
struct lattice_way {
    double way, lost;
};
struct lattice_ways {
    struct lattice_way x, y, z, rx, ry, rz;
};

/* [J]; planes in this order in memory. */
struct lattice_ledger {
    double work, links, mass;
};

LAW struct lattice_way lattice_way_kick(real v, real a, struct lattice_kick k, double alpha)
{
    struct lattice_way r;
    double dv = (double)v, da = (double)a, g = (double)k.g;
    r.way = g * dv + (double)k.whole * da;
    r.lost = WITH_MASS_DAMPING
                 ? (double)k.lost_v * dv * dv + alpha * g * g * dv * da + (double)k.lost_a * da * da
                 : 0.0;
    return r;
}
LAW struct lattice_ways lattice_ways_kick(
    struct link_cell c, vec3 a, vec3 b, struct lattice_kick k, double alpha)
{
    struct lattice_ways r;
    r.x = lattice_way_kick(c.v.x, a.x, k, alpha);
    r.y = lattice_way_kick(c.v.y, a.y, k, alpha);
    r.z = lattice_way_kick(c.v.z, a.z, k, alpha);
    r.rx = lattice_way_kick(c.w.x, b.x, k, alpha);
    r.ry = lattice_way_kick(c.w.y, b.y, k, alpha);
    r.rz = lattice_way_kick(c.w.z, b.z, k, alpha);
    return r;
}

LAW struct lattice_way lattice_way_stage(real v, double s, double alpha)
{
    struct lattice_way r;
    r.way = s * (double)v;
    r.lost = WITH_MASS_DAMPING ? alpha * r.way * (double)v : 0.0;
    return r;
}
LAW struct lattice_ways lattice_ways_stage(vec3 v, vec3 w, double s, double alpha)
{
    struct lattice_ways r;
    r.x = lattice_way_stage(v.x, s, alpha);
    r.y = lattice_way_stage(v.y, s, alpha);
    r.z = lattice_way_stage(v.z, s, alpha);
    r.rx = lattice_way_stage(w.x, s, alpha);
    r.ry = lattice_way_stage(w.y, s, alpha);
    r.rz = lattice_way_stage(w.z, s, alpha);
    return r;
}

/* One DOF. given: s times its prescribed velocity; load, weight: forces or torques. */
LAW struct lattice_ledger lattice_work_dof(struct lattice_ledger sum, int is_held,
    struct lattice_way free, double given, real links, real still, double load, double weight,
    double mass)
{
    double way = is_held ? given : free.way;
    sum.work += (is_held ? -((double)links + weight) : load) * way;
    if (WITH_LINK_DAMPING) sum.links += ((double)still - (double)links) * way;
    if (WITH_MASS_DAMPING) sum.mass += is_held ? 0.0 : mass * free.lost;
    return sum;
}

/* What one kick or stage over s [s] adds. word: bits of held DOF; 0 if there are none. */
LAW struct lattice_ledger lattice_work_of(struct lattice_effort e, struct lattice_ways way,
    int word, double s, double mass, double inertia)
{
    struct lattice_ledger r;
    int held = word >> WORD_FIX;
    r.work = s * (double)e.face;
    r.links = r.mass = 0.0;
#define DOF(bit, name, share, axis, given, load, weight, m)                                        \
    r = lattice_work_dof(r, held >> (bit)&1, way.name, s * (double)e.given.axis,                   \
        e.links.share.axis, e.still.share.axis, (double)e.loads.share.axis + (load), weight, m)
    DOF(0, x, force, x, v, mass * (double)e.added.x, mass * (double)e.weight.x, mass);
    DOF(1, y, force, y, v, mass * (double)e.added.y, mass * (double)e.weight.y, mass);
    DOF(2, z, force, z, v, mass * (double)e.added.z, mass * (double)e.weight.z, mass);
    DOF(3, rx, torque, x, w, 0.0, 0.0, inertia);
    DOF(4, ry, torque, y, w, 0.0, 0.0, inertia);
    DOF(5, rz, torque, z, w, 0.0, 0.0, inertia);
#undef DOF
    return r;
}

/* a + b, or a. */
LAW struct lattice_ledger lattice_ledger_add(
    struct lattice_ledger a, struct lattice_ledger b, int is_counted)
{
    a.work += is_counted ? b.work : 0.0;
    a.links += is_counted ? b.links : 0.0;
    a.mass += is_counted ? b.mass : 0.0;
    return a;
}

/* A splitting's two kicks, of which an observed step counts the first, and the step after it the
 * second. count: bits 0 and 1. */
LAW struct lattice_ledger lattice_work_split(struct lattice_ledger sum, struct lattice_effort e,
    struct link_cell c, vec3 a, vec3 b, struct lattice_kick end, struct lattice_kick begin,
    int word, double alpha, double mass, double inertia, int count)
{
    struct lattice_ways way = lattice_ways_kick(c, a, b, end, alpha);
    sum = lattice_ledger_add(
        sum, lattice_work_of(e, way, word, (double)end.s, mass, inertia), count & 1);
    c.v = lattice_kick(c.v, a, end.f, end.g);
    c.w = lattice_kick(c.w, b, end.f, end.g);
    way = lattice_ways_kick(c, a, b, begin, alpha);
    return lattice_ledger_add(
        sum, lattice_work_of(e, way, word, (double)begin.s, mass, inertia), count & 2);
}

/* Nystrom's stages have the velocity of the step's start. For the work of loads at full order they
 * take v + before a_before + own a, with the accelerations of this stage and the one before: v_1 =
 * v, v_2 = v + dt (k1 + k2)/4, v_3 = v + dt k2. With b = (1, 4, 1)/6 and c = (0, 1/2, 1) these meet
 * the conditions of a Runge-Kutta scheme for W' = F(t).v up to order 4: sum of b_s V_s(c) = 1/6, of
 * b_s c_s V_s(c) = 1/8, of b_s V_s(c^2) = 1/12, V_s(x) the sum of x over the accelerations in v_s
 * with their weights. */
struct lattice_speed {
    real before, own; /* [s] */
};
LAW struct link_cell lattice_speed_of(struct link_cell c, vec3 a, vec3 b, vec3 before_a,
    vec3 before_b, struct lattice_speed k, int is_first)
{
    c.v = v3_choose(is_first, c.v, v3_fma(k.before, before_a, c.v));
    c.w = v3_choose(is_first, c.w, v3_fma(k.before, before_b, c.w));
    c.v = v3_fma(k.own, a, c.v);
    c.w = v3_fma(k.own, b, c.w);
    return c;
}

/* A stage of weight s [s]; v and w as they count for it. */
LAW struct lattice_ledger lattice_work_stage(struct lattice_ledger sum, struct lattice_effort e,
    struct link_cell c, int word, double alpha, double mass, double inertia, double s)
{
    return lattice_ledger_add(
        sum, lattice_work_of(e, lattice_ways_stage(c.v, c.w, s, alpha), word, s, mass, inertia), 1);
}

#endif

#endif
