/* Where a sphere meets a wall at the end of the step and in its middle, and how fast the wall moves
 * there. */
#ifndef DEMOCLES_WALL_GEOMETRY_H
#define DEMOCLES_WALL_GEOMETRY_H

#include "contact/law_fillet.h"
#include "contact/law_wall.h"
#include "wall_pose.h"

struct wall_geometry {
    /* unit vectors from the centre to the wall, at t^{n+1} and at the half step */
    vec3 n, n_half;
    preal distance, distance_half; /* [m] */
    vec3 v;                        /* velocity of the wall point, at the half step [m/s] */
    vec3 kick;                     /* what it gains until t^{n+1} [m/s] */
};

/* wall_closest without branches, which would keep the loop over contacts scalar: all kinds that the
 * program knows are computed, and that of the wall is taken; same bits. plane: the answer where it
 * is a plane. */
LAW struct wall_closest wall_closest_lane(
    struct wall_primitive w, pvec3 x, struct wall_closest plane)
{
    struct wall_closest k = plane;
    if (WITH_RECTANGLE) k = wall_choose(w.kind == WALL_RECTANGLE, wall_closest_rectangle(w, x), k);
    if (WITH_CYLINDER)
        k = wall_choose(w.kind == WALL_PIPE || w.kind == WALL_ROD, wall_closest_cylinder(w, x), k);
    if (WITH_TRIANGLE) k = wall_choose(w.kind == WALL_TRIANGLE, wall_closest_triangle(w, x), k);
    return k;
}

LAW struct wall_closest wall_closest_end(struct wall_primitive w, pvec3 x)
{
    return wall_closest_lane(
        w, x, WITH_PLANE ? wall_closest_plane(w, x) : wall_one_sided(WALL_FAR, p3(0, 0, 1)));
}

/* Closest point in the middle of the step, when the centre was at x - u dt/2. The distance to a
 * plane is linear in the way: that is cheaper than a second look at it, and two equal chains of
 * arithmetic would tempt LLVM into packing them, which keeps the loop over work-items scalar. */
LAW struct wall_closest wall_closest_half(
    struct wall_primitive w, struct wall_closest now, pvec3 x, pvec3 way)
{
    struct wall_closest plane = now;
    plane.distance = now.distance + p3_dot(now.n, way);
    return wall_closest_lane(w, p3_sub(x, way), plane);
}

LAW struct wall_geometry wall_geometry_of(
    struct wall_closest now, struct wall_closest half_way, vec3 v)
{
    struct wall_geometry g;
    g.n = v3_of_p3(now.n);
    g.n_half = v3_of_p3(half_way.n);
    g.distance = now.distance;
    g.distance_half = half_way.distance;
    g.v = v;
    g.kick = v3(0, 0, 0);
    return g;
}

/* A wall at rest. x: centre at t^{n+1}; v: its velocity at the half step. */
LAW struct wall_geometry wall_geometry(struct wall_primitive w, pvec3 x, vec3 v, real dt)
{
    struct wall_closest now = wall_closest_end(w, x);
    return wall_geometry_of(now,
        wall_closest_half(w, now, x, p3_scale((preal)0.5 * (preal)dt, p3_of_v3(v))), v3(0, 0, 0));
}

/* The contact with the plane `other` of the same wall on the other side of a valley, at the end of
 * the step; v: velocity of the centre at the half step. A plane's distance is linear in the way, so
 * that of the middle of the step is known; the wall's turn within half a step is left out of
 * other.n, which changes the valley by that times its angle. other.room: the smaller of both. */
LAW struct wall_geometry wall_geometry_valley(
    struct wall_geometry g, struct fillet_plane other, vec3 v, real radius, real dt)
{
    preal way = p3_dot(other.n, p3_of_v3(v3_sub(v, g.v)));
    struct fillet_plane then =
        fillet_plane(other.n, p_fma((preal)0.5 * (preal)dt, way, other.distance), other.room);
    struct fillet_plane end = fillet_of(fillet_plane(p3_of_v3(g.n), g.distance, other.room), other,
                            (preal)radius),
                        middle =
                            fillet_of(fillet_plane(p3_of_v3(g.n_half), g.distance_half, other.room),
                                then, (preal)radius);
    g.n = v3_of_p3(end.n);
    g.distance = end.distance;
    g.n_half = v3_of_p3(middle.n);
    g.distance_half = middle.distance;
    return g;
}

#ifdef __OPENCL_VERSION__
/* A wall in motion, at its pose of t^{n+1}. Its velocity V, spin W and centre c belong to the half
 * step: a point that is at y then goes with V + W x (y - c), and is half a step's way further on at
 * the end. So the place that the centre had in the middle is carried along with the wall, looked at
 * in the pose of now, and the normal turned back by half the wall's turn. The wall's velocity is
 * that at the contact in the middle of the step: a wall that turns in itself has none along the
 * normal. Until t^{n+1} it goes over into the true velocity of then, at the contact of then. */
LAW struct wall_geometry wall_geometry_moving(
    struct wall_primitive w, pvec3 x, vec3 v, __global const preal *pose, real dt)
{
    struct wall_frame f = pose_frame(pose);
    vec3 velocity = v3((real)pose[12], (real)pose[13], (real)pose[14]),
         spin = v3((real)pose[15], (real)pose[16], (real)pose[17]);
    preal half_dt = (preal)0.5 * (preal)dt;
    pvec3 q = wall_to_reference(f, x);
    /* of the centre, in the middle */
    vec3 arm = v3_of_p3(p3_fma(-half_dt, p3_of_v3(v), p3_sub(x, p3(pose[18], pose[19], pose[20]))));
    /* seen from the wall */
    vec3 rate = v3_sub(v, wall_velocity(velocity, spin, arm));
    struct wall_closest now = wall_closest_end(w, q);
    struct wall_closest half_way =
        wall_closest_half(w, now, q, wall_turn_back(f, p3_scale(half_dt, p3_of_v3(rate))));
    now.n = wall_turn(f, now.n);
    half_way.n = wall_turn(f, half_way.n);
    struct wall_geometry g = wall_geometry_of(now, half_way, velocity);
    g.n_half = v3_fma((real)-0.5 * dt, v3_cross(spin, g.n_half), g.n_half);
    g.v = wall_velocity(velocity, spin, v3_fma((real)g.distance_half, g.n_half, arm));
    if (WITH_KICK) {
        vec3 arm_end = v3_of_p3(p3_sub(x, p3(pose[28], pose[29], pose[30])));
        vec3 end = wall_velocity(v3((real)pose[22], (real)pose[23], (real)pose[24]),
            v3((real)pose[25], (real)pose[26], (real)pose[27]),
            v3_fma((real)g.distance, g.n, arm_end));
        g.kick = v3_sub(end, g.v);
    }
    return g;
}
#endif

#endif
