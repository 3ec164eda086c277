/* One cell of the lattice: what a link gives it, what loads give it, and how it moves. Host and
 * device alike.
 *
 * A fixed DOF (lattice_words.h) has the velocity that its row of loads prescribes, 0 without one:
 * accelerations do not reach it.
 *
 * Splittings: kick (at fixed x: dv/dt = a - alpha v, exactly) v <- f v + g a, with f = exp(-alpha c
 * dt), g = (1 - f)/alpha, or 1 and c dt; drift x <- x + c dt v. The kick that ends a step and the
 * one that begins the next are done one after the other, so that a step that is looked at in
 * between has the same bits.
 *
 * Runge-Kutta and Runge-Kutta-Nystrom: a stage sees the state at its place, s, and the step's
 * start, 0; see struct lattice_stage. */
#ifndef DEMOCLES_LATTICE_STATE_H
#define DEMOCLES_LATTICE_STATE_H

#include "lattice_words.h"
#include "law_link.h"
#include "law_volume.h"
#include "loads.h"

#define LATTICE_KIND(word) ((word) >> WORD_KIND & 255)
/* Links that act on the cell: a ghost has none, its owner moves it. */
#define LATTICE_LINKS(word) ((word) & (63 & -((word) >> WORD_OWNED & 1)))

struct lattice_load {
    vec3 force, lever[3], body;
    real traction;
    vec3 lower, upper; /* t.n of the lower and the upper faces */
    vec3 acceleration, v, w;
    vec3 now_v, now_w;
    real rate;
    vec3 turn;
};

/* A row of loads, from device or host memory. */
LAW vec3 lattice_vec(__global const real *p, int k) { return v3(p[k], p[k + 1], p[k + 2]); }
LAW struct lattice_load lattice_load_of(__global const real *p)
{
    struct lattice_load l;
    l.force = lattice_vec(p, LOAD_FORCE);
    l.lever[0] = lattice_vec(p, LOAD_LEVER);
    l.lever[1] = lattice_vec(p, LOAD_LEVER + 3);
    l.lever[2] = lattice_vec(p, LOAD_LEVER + 6);
    l.body = lattice_vec(p, LOAD_BODY);
    l.traction = p[LOAD_TRACTION];
    l.lower = v3(p[LOAD_NORMAL], p[LOAD_NORMAL + 2], p[LOAD_NORMAL + 4]);
    l.upper = v3(p[LOAD_NORMAL + 1], p[LOAD_NORMAL + 3], p[LOAD_NORMAL + 5]);
    l.acceleration = lattice_vec(p, LOAD_ACCELERATION);
    l.v = lattice_vec(p, LOAD_VELOCITY);
    l.w = lattice_vec(p, LOAD_VELOCITY + 3);
    l.now_v = lattice_vec(p, LOAD_NOW);
    l.now_w = lattice_vec(p, LOAD_NOW + 3);
    l.rate = p[LOAD_RATE];
    l.turn = lattice_vec(p, LOAD_TURN);
    return l;
}
/* A row of the table of links. */
LAW struct link_constants lattice_constants_of(__global const real *p)
{
    struct link_constants k;
    k.kn = p[0];
    k.ks = p[1];
    k.kt = p[2];
    k.kb = p[3];
    k.r_i = p[4];
    k.r_j = p[5];
    k.h = p[6];
    k.eta = p[7];
    k.is_cut = 0;
    k.offset = v3(0, 0, 0);
    return k;
}
/* The same of the covered part of a face; row: of the table of shares. */
LAW struct link_constants lattice_constants_cut(
    struct link_constants k, __global const real *row, int face)
{
    real share = row[SHARE_FACE + face];
    k.kn *= share;
    k.ks *= share;
    k.kt *= share;
    k.kb *= share;
    k.r_i *= share;
    k.r_j *= share;
    k.is_cut = 1;
    k.offset = v3(0, row[SHARE_OFFSET + 2 * face], row[SHARE_OFFSET + 2 * face + 1]);
    return k;
}

/* Covered share of a face with a link [1]. */
LAW real lattice_linked(int face, int links, __global const real *share)
{
    return links >> face & 1 ? share[SHARE_FACE + face] : (real)0;
}

/* A row of the table of cells; `share`: of the table of shares, NULL: whole. */
LAW struct volume_constants lattice_volume_of(
    __global const real *p, __global const real *share, int links)
{
    struct volume_constants c;
    c.lambda = p[2];
    c.per_4g = p[3];
    c.per_2h = p[4];
    c.volume = p[7];
    if (WITH_SHARES) {
        c.share = share ? share[SHARE_VOLUME] : (real)1;
        c.least = share ? share[SHARE_LEAST] : (real)0;
        c.missing = (real)volume_missing(links);
        if (share) {
            c.missing = (real)6 * c.share;
            c.missing -= lattice_linked(0, links, share);
            c.missing -= lattice_linked(1, links, share);
            c.missing -= lattice_linked(2, links, share);
            c.missing -= lattice_linked(3, links, share);
            c.missing -= lattice_linked(4, links, share);
            c.missing -= lattice_linked(5, links, share);
        }
    }
    return c;
}

/* What the link over face `face` (bit of the mask, a constant) does to the cell `me`; p: lambda Th
 * [Pa]. */
LAW struct link_share lattice_link(int face, int exists, struct link_cell me,
    struct link_cell other, struct link_constants k, real p_me, real p_other)
{
    int axis = face >> 1, is_lower = face & 1;
    struct link_state s =
        is_lower ? link_state_of(axis, me, other, k) : link_state_of(axis, other, me, k);
    struct link_force f =
        is_lower ? link_force_of(s, k, p_me, p_other) : link_force_of(s, k, p_other, p_me);
    return link_if(exists, is_lower ? link_on_lower(axis, s, f) : link_on_upper(axis, s, f));
}

/* What the link adds to the sum of stretches of the cell [m]. */
LAW real lattice_stretch(int face, int exists, struct link_cell me, struct link_cell other,
    struct link_constants k, real eta)
{
    int axis = face >> 1, is_lower = face & 1;
    struct link_state s =
        is_lower ? link_state_of(axis, me, other, k) : link_state_of(axis, other, me, k);
    return volume_part(exists, is_lower ? k.r_i : k.r_j, link_stretch(s, eta));
}

LAW struct link_share lattice_add(struct link_share a, struct link_share b)
{
    a.force = v3_add(a.force, b.force);
    a.torque = v3_add(a.torque, b.torque);
    return a;
}

/* R s of the cell. */
LAW vec3 lattice_turned(struct link_cell c, vec3 s)
{
    return WITH_TURN ? v3_of_p3(quat_rotate(c.q, p3_of_v3(s))) : s;
}

/* Adds force and torque of the loads. */
LAW struct link_share lattice_load_add(
    struct link_share sum, struct link_cell c, struct lattice_load l)
{
    sum.force = v3_add(v3_add(sum.force, l.force), lattice_turned(c, l.body));
    sum.torque = v3_add(sum.torque, v3_cross(lattice_turned(c, v3(1, 0, 0)), l.lever[0]));
    sum.torque = v3_add(sum.torque, v3_cross(lattice_turned(c, v3(0, 1, 0)), l.lever[1]));
    sum.torque = v3_add(sum.torque, v3_cross(lattice_turned(c, v3(0, 0, 1)), l.lever[2]));
    if (WITH_SHARES) sum.torque = v3_add(sum.torque, lattice_turned(c, l.turn));
    return sum;
}

/* Components of v whose bit, from `bit` on, is set, are as given. */
LAW vec3 lattice_hold(vec3 v, int word, int bit, vec3 given)
{
    return v3(word >> bit & 1 ? given.x : v.x, word >> (bit + 1) & 1 ? given.y : v.y,
        word >> (bit + 2) & 1 ? given.z : v.z);
}

LAW vec3 lattice_kick(vec3 v, vec3 a, real f, real g)
{
    return v3_fma(g, a, WITH_MASS_DAMPING ? v3_scale(f, v) : v);
}

/* x, theta or q after a drift over dt. */
LAW struct link_cell lattice_drift(struct link_cell c, preal dt)
{
    c.u = p3_fma(dt, p3_of_v3(c.v), c.u);
    if (WITH_TURN) c.q = quat_turn(c.q, p3_scale(dt, p3_of_v3(c.w)));
    else c.theta = p3_fma(dt, p3_of_v3(c.w), c.theta);
    return c;
}

/* Coefficients of one stage, with their powers of dt [s]. x stands for u and the rotation vector
 * from the step's start, a for both accelerations:
 *     sums     X <- X + sum_v v_s + sum_a a_s,   V <- V + sum_k a_s
 *     then     x = x_0 + next_v v_s + next_a a_s, v = v_0 + next_k a_s;   last stage: x = x_0 + X,
 *       v = v_0 + V
 * Rotation: RK4 takes its rate (quat_rate) in place of w; Nystrom adds commutators over `next_turn`
 * and `sum_turn` (quat_rkn4). */
struct lattice_stage {
    preal sum_v, sum_a, next_v, next_a, next_turn, sum_turn;
    real sum_k, next_k;
    int is_first, is_last, is_nystrom;
};

/* Sums so far: X of u and of the rotation vector, V of v and w; r: rotation vector of the stage
 * from the step's start [rad]. */
struct lattice_sums {
    pvec3 u, turn, r;
    vec3 v, w;
};

LAW struct lattice_sums lattice_sums_zero(void)
{
    struct lattice_sums s;
    s.u = s.turn = s.r = p3(0, 0, 0);
    s.v = s.w = v3(0, 0, 0);
    return s;
}

/* The cell at the next stage, or at the end of the step; `now`: v and w of this stage, `start`: the
 * step's start; a, b: accelerations, 0 of fixed DOF. mean_v, mean_w: (v_1 + v_2)/2, of the
 * prescribed velocities at this stage and the next, on Nystrom's way to its second stage: what dt^2
 * k1/8 is to a free DOF. With v_2 on the way to the third their errors cancel as those of a free
 * DOF do. */
LAW struct link_cell lattice_stage_next(struct link_cell now, struct link_cell start, vec3 a,
    vec3 b, vec3 mean_v, vec3 mean_w, struct lattice_stage c, struct lattice_sums *sum)
{
    struct link_cell next = start;
    pvec3 v = p3_of_v3(now.v), w = p3_of_v3(now.w), pa = p3_of_v3(a), pb = p3_of_v3(b), shift, r;

    if (WITH_TURN) w = p3_choose(c.is_nystrom, w, quat_rate(sum->r, w));
    sum->u = p3_fma(c.sum_a, pa, p3_fma(c.sum_v, v, sum->u));
    sum->turn = quat_rkn4(p3_fma(c.sum_a, pb, p3_fma(c.sum_v, w, sum->turn)), w, pb, c.sum_turn);
    sum->v = v3_fma(c.sum_k, a, sum->v);
    sum->w = v3_fma(c.sum_k, b, sum->w);
    v = p3_choose(c.is_nystrom && c.is_first, p3_of_v3(mean_v), v);
    w = p3_choose(c.is_nystrom && c.is_first, p3_of_v3(mean_w), w);
    shift = p3_choose(c.is_last, sum->u, p3_fma(c.next_a, pa, p3_scale(c.next_v, v)));
    r = p3_choose(c.is_last, sum->turn,
        quat_rkn4(p3_fma(c.next_a, pb, p3_scale(c.next_v, w)), w, pb, c.next_turn));
    next.u = p3_add(start.u, shift);
    if (WITH_TURN) next.q = quat_turn(start.q, r);
    else next.theta = p3_add(start.theta, r);
    next.v = v3_choose(c.is_last, v3_add(start.v, sum->v), v3_fma(c.next_k, a, start.v));
    next.w = v3_choose(c.is_last, v3_add(start.w, sum->w), v3_fma(c.next_k, b, start.w));
    sum->r = r;
    return next;
}

#endif
