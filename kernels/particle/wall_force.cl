/* Forces of walls on elements, by candidates (element, primitive), in the three phases of
 * pair_force.cl.
 *
 * The wall is body j of the contact: no radius, no lever, as heavy as it likes. Geometry is taken
 * twice, at the end of the step and at its middle, as the second-order friction of law_slider.h
 * wants it; a moving wall is looked at from its own frame.
 *
 * lint: WITH_TANGENTIAL_DAMPING requires WITH_TANGENTIAL
 * lint: WITH_WHOLE_SLIP requires WITH_TANGENTIAL
 * lint: WITH_RADIUS_LEVER requires WITH_TANGENTIAL
 * lint: WITH_NO_RESCALE requires WITH_TANGENTIAL
 * lint: WITH_CAP_MAGNITUDE requires WITH_TANGENTIAL
 * lint: WITH_TANGENTIAL requires WITH_SPIN
 * lint: WITH_ROLLING_CDT requires WITH_SPIN
 * lint: WITH_ROLLING_EPSD requires WITH_SPIN
 * lint: WITH_MATERIALS requires WITH_TABLE
 * lint: WITH_MATERIALS requires WITH_SPIN
 * lint: WITH_SPIN_KICK requires WITH_SPIN
 * lint: WITH_SPIN_KICK requires WITH_KICK
 * lint: WITH_TANGENTIAL_DAMPING requires WITH_SPIN_KICK
 * lint: WITH_ROLLING_CDT requires WITH_SPIN_KICK
 * lint: WITH_ROLLING_EPSD requires WITH_SPIN_KICK
 * lint: some of WITH_LINEAR WITH_HERTZ */
#include "element.h"
#include "contact/contact_memory.h"
#include "particle_words.h"
#include "wall_geometry.h"
#include "wall_near.h"

/* Rows of local memory: real, then preal; results take the place of the former. */
#define SPIN_KICKS (WITH_TANGENTIAL_DAMPING || WITH_ROLLING)
#define L_V 0
#define L_KICK 3
#define L_W (WITH_KICK ? 6 : 3)
#define L_SPUN (L_W + (WITH_ROTATION ? 3 : 0))
#define L_MASS (L_SPUN + (SPIN_KICKS ? 3 : 0))  /* 1/m */
#define L_KIND (L_MASS + (WITH_SIZES ? 1 : 0))  /* row of the table */
#define L_SHARE (L_KIND + (WITH_TABLE ? 1 : 0)) /* of wall_keep.cl */
#define L_ROWS (L_SHARE + (WITH_JOINED ? 1 : 0))
#define ROWS (L_ROWS > 6 ? L_ROWS : 6)
#define P_X 0
#define P_RADIUS 3
#define P_PRIMITIVE 4
#define P_PARTNER 16 /* n, distance, the smaller room of both */
#define P_ROWS (WITH_JOINED ? 21 : 16)
#define LOC(row) loc[(row)*BATCH + l]
#define PLACE(row) place[(row)*BATCH + l]

#define TABLE_ROW (WITH_TABLE ? (int)LOC(L_KIND) : 0)
#if WITH_SIZES
#define PARAMETERS                                                                                 \
    contact_parameters_of(material_load(table + MATERIAL_WIDTH * TABLE_ROW),                       \
        contact_pair_wall(LOC(L_MASS), radius), dt)
#elif WITH_TABLE
#define PARAMETERS parameters_load(table + PARAMETER_WIDTH * TABLE_ROW)
#else
#define PARAMETERS PARAMETERS_OF_ARGUMENTS
#endif
#if WITH_MOVING
#define GEOMETRY(primitive, x, v)                                                                  \
    wall_geometry_moving(primitive, x, v, pose + wall[l] * POSE_WIDTH, dt)
#else
#define GEOMETRY(primitive, x, v) wall_geometry(primitive, x, v, dt)
#endif

#if WITH_JOINED
#define SHARE LOC(L_SHARE)
#define VALLEY(g, v, radius)                                                                       \
    wall_geometry_valley(g,                                                                        \
        fillet_plane(                                                                              \
            ROW3_LOAD(p3, place, P_PARTNER, l), PLACE(P_PARTNER + 3), PLACE(P_PARTNER + 4)),       \
        v, radius, dt)

/* What wall_keep.cl found. */
LAW void wall_load_near(__global const preal *near, int own, int partner, real keep,
    __local preal *place, __local real *loc, size_t l)
{
    struct fillet_plane other = wall_partner(near, partner);
    ROW3_STORE(place, P_PARTNER, l, other.n.x, other.n.y, other.n.z);
    PLACE(P_PARTNER + 3) = other.distance;
    PLACE(P_PARTNER + 4) = r_min(other.room, wall_plane(near, own).room);
    LOC(L_SHARE) = keep;
}
#else
#define SHARE ((real)1)
#define VALLEY(g, v, radius) g
#endif

/* One element and one primitive. */
LAW void wall_load(int e, __global const preal *row, __global const preal *position,
    __global const real *motion, __local preal *place, __local real *loc, size_t l)
{
    preal4 x = LOAD_POSITION(e), a = vload4(0, row), b = vload4(1, row), c = vload4(2, row);
    real4 v = LOAD_VELOCITY(e);
    ROW3_STORE(place, P_X, l, x.s0, x.s1, x.s2);
    PLACE(P_RADIUS) = x.s3;
    ROW3_STORE(place, P_PRIMITIVE, l, a.s0, a.s1, a.s2);
    ROW3_STORE(place, P_PRIMITIVE + 3, l, a.s3, b.s0, b.s1);
    ROW3_STORE(place, P_PRIMITIVE + 6, l, b.s2, b.s3, c.s0);
    ROW3_STORE(place, P_PRIMITIVE + 9, l, c.s1, c.s2, c.s3);
    ROW3_STORE(loc, L_V, l, v.s0, v.s1, v.s2);
    if (WITH_SIZES) LOC(L_MASS) = v.s3;
#if WITH_KICK
    real4 kick = LOAD_KICK(e);
    ROW3_STORE(loc, L_KICK, l, kick.s0, kick.s1, kick.s2);
#endif
#if WITH_SPIN
    if (WITH_ROTATION) {
        real4 w = LOAD_SPIN(e);
        ROW3_STORE(loc, L_W, l, w.s0, w.s1, w.s2);
    }
#endif
#if WITH_SPIN_KICK
    if (SPIN_KICKS) {
        real4 spun = LOAD_SPIN_KICK(e);
        ROW3_STORE(loc, L_SPUN, l, spun.s0, spun.s1, spun.s2);
    }
#endif
}

/* Relative to the wall point. */
LAW struct kinematics_motion wall_motion(struct wall_geometry g, __local const real *loc, size_t l)
{
    vec3 zero = v3(0, 0, 0);
    struct kinematics_motion m = kinematics_free(ROW3_LOAD(v3, loc, L_V, l), g.v, zero, zero);
    if (WITH_KICK) m.kick = v3_sub(ROW3_LOAD(v3, loc, L_KICK, l), g.kick);
    if (WITH_ROTATION) m.w_i = ROW3_LOAD(v3, loc, L_W, l);
    if (SPIN_KICKS) m.spun_i = ROW3_LOAD(v3, loc, L_SPUN, l);
    return m;
}

LAW struct wall_primitive wall_stored(__local const preal *place, size_t l)
{
    return wall_primitive(ROW3_LOAD(p3, place, P_PRIMITIVE, l),
        ROW3_LOAD(p3, place, P_PRIMITIVE + 3, l), ROW3_LOAD(p3, place, P_PRIMITIVE + 6, l),
        PLACE(P_PRIMITIVE + 9), PLACE(P_PRIMITIVE + 10), (int)PLACE(P_PRIMITIVE + 11));
}

/* n_material: edge of the table, whose rows are (element's, wall's material). */
__kernel __attribute__((reqd_work_group_size(BATCH_LANES, 1, 1))) void wall_force(int n_candidate,
    int capacity, __global const preal *position, __global const real *motion,
    __global const int *candidate, __global const int *candidate_element,
    __global const preal *primitive,
#if WITH_MOVING || WITH_TABLE
    __global const int *wall_of,
#endif
#if WITH_MOVING
    __global const preal *restrict pose,
#endif
#if WITH_JOINED
    __global const real *restrict keep, __global const int *restrict partner,
    __global const preal *restrict near,
#endif
#if WITH_HISTORY
    __global int *restrict state, __global real *restrict history,
#endif
#if WITH_ENERGY
    __global double *restrict ledger,
#endif
#if WITH_TABLE
    int n_material, __global const int *wall_material,
#endif
#if WITH_TABLE || WITH_SIZES
    __global const real *restrict table,
#else
    PARAMETER_ARGUMENTS
#endif
    __global real *restrict result, real dt)
{
    __local real loc[ROWS * BATCH];
    __local preal place[P_ROWS * BATCH];
#if WITH_MOVING
    __local int wall[BATCH];
#endif
    size_t base = get_group_id(0) * BATCH, planes = (size_t)capacity;
    size_t left = (size_t)n_candidate > base ? (size_t)n_candidate - base : 0,
           n = left < BATCH ? left : BATCH;
    FOR_BATCH (l, n) {
        int e = candidate_element[base + l], k = candidate[base + l];
        wall_load(e, primitive + WALL_PRIMITIVE_WIDTH * k, position, motion, place, loc, l);
#if WITH_MOVING
        wall[l] = wall_of[k];
#endif
#if WITH_JOINED
        wall_load_near(near, (int)(base + l), partner[base + l], keep[base + l], place, loc, l);
#endif
#if WITH_TABLE
        real kind = WITH_MATERIALS ? motion[(size_t)e * MOTION_STRIDE + SPIN_AT + 3] : (real)0;
        LOC(L_KIND) = kind * (real)n_material + (real)wall_material[wall_of[k]];
#endif
    }
    BATCH_BARRIER;
    BATCH_VECTOR
    FOR_BATCH (l, n) {
        real radius = (real)PLACE(P_RADIUS);
        vec3 v = ROW3_LOAD(v3, loc, L_V, l);
        struct wall_geometry g =
            VALLEY(GEOMETRY(wall_stored(place, l), ROW3_LOAD(p3, place, P_X, l), v), v, radius);
        struct contact_parameters p = PARAMETERS;
        struct contact_history h = HISTORY_LOAD(base, planes, l);
        real share = SHARE;
        g.distance = share > 0 ? g.distance : (preal)2 * (preal)radius;
        h.state = share > 0 ? h.state : 0;
        struct kinematics_motion m = wall_motion(g, loc, l);
        m.radius_lever = parameters_radius_lever(p);
        struct contact_kinematics k = contact_kinematics_wall(
            g.n, g.n_half, radius - (real)g.distance, radius - (real)g.distance_half, m, radius);
        struct contact_result r = contact_law(k, p, dt, &h);
        r = contact_result_share(r, share > 0 ? share : (real)1);
        HISTORY_STORE(h, base, planes, l);
        LEDGER_ADD(r, base, planes, l);
#if WITH_WALL_WORK
        ledger[(size_t)LEDGER_WORK * planes + base + l] +=
            (double)wall_work(r.force, g.v, dt, history + base, planes, l);
#endif
        vec3 torque = v3_fma(k.l_i, r.couple, r.moment);
        ROW3_STORE(loc, 0, l, r.force.x, r.force.y, r.force.z);
        if (WITH_ROTATION) { ROW3_STORE(loc, 3, l, torque.x, torque.y, torque.z); }
    }
    BATCH_BARRIER;
    FOR_BATCH (l, n) {
        __global real *out = result + (base + l) * WALL_RESULT_WIDTH(WITH_ROTATION);
        vstore4((real4)(LOC(0), LOC(1), LOC(2), (real)0), 0, out);
        if (WITH_ROTATION) vstore4((real4)(LOC(3), LOC(4), LOC(5), (real)0), 1, out);
    }
}
