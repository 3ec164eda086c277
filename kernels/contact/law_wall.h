/* Where a sphere meets a wall: the closest point of a wall primitive, which of several triangle
 * contacts count, and rigid motion of walls. Values in, values out; the same text runs on host and
 * device. Nothing here knows forces, lists or how many walls there are.
 *
 * A primitive is a row of 12 preal in the wall's own frame (its position at t = 0), read with
 * WALL_PRIMITIVE(table, k):
 *
 *   kind             a              b                  c                     r              s
 *   WALL_PLANE       point          unit normal m      -                     -              -
 *   WALL_RECTANGLE   centre         unit axis          unit axis             half edge (b)  (c)
 *   WALL_PIPE        start of axis  unit axis          unit, across the axis radius         length
 *   WALL_ROD         start of axis  unit axis          unit, across the axis radius         length
 *   WALL_TRIANGLE    corner         corner             corner                room           room
 *
 * One-sided: a plane pushes towards m from any depth, a rod (cylinder with elements outside) is a
 * solid with flat ends and pushes outwards from any depth. Two-sided: rectangle, triangle and pipe
 * (cylinder with elements inside: a thin shell with open ends); they lose a sphere whose centre
 * crosses.
 *
 * room: of law_fillet.h, on the side of the normal (b - a) x (c - a), and on the other side. Kinds
 * that a scene does not have are compiled out: WITH_PLANE, WITH_RECTANGLE, WITH_CYLINDER,
 * WITH_TRIANGLE, each 0 or 1. */
#ifndef DEMOCLES_LAW_WALL_H
#define DEMOCLES_LAW_WALL_H

#include "common/vec.h"

/* Device programs define every flag; the host knows all kinds. */
#ifndef __OPENCL_VERSION__
#ifndef WITH_PLANE
#define WITH_PLANE 1
#endif
#ifndef WITH_RECTANGLE
#define WITH_RECTANGLE 1
#endif
#ifndef WITH_CYLINDER
#define WITH_CYLINDER 1
#endif
#ifndef WITH_TRIANGLE
#define WITH_TRIANGLE 1
#endif
#endif

enum { WALL_PLANE = 0, WALL_RECTANGLE = 1, WALL_PIPE = 2, WALL_ROD = 3, WALL_TRIANGLE = 4 };
enum { WALL_PRIMITIVE_WIDTH = 12 }; /* preal per row: a, b, c, r, s, kind */

struct wall_primitive {
    pvec3 a, b, c;
    preal r, s;
    int kind;
};

/* A macro, because a row may lie in any address space. */
#define WALL_PRIMITIVE(table, k)                                                                   \
    wall_primitive(p3((table)[12 * (k)], (table)[12 * (k) + 1], (table)[12 * (k) + 2]),            \
        p3((table)[12 * (k) + 3], (table)[12 * (k) + 4], (table)[12 * (k) + 5]),                   \
        p3((table)[12 * (k) + 6], (table)[12 * (k) + 7], (table)[12 * (k) + 8]),                   \
        (table)[12 * (k) + 9], (table)[12 * (k) + 10], (int)(table)[12 * (k) + 11])

LAW struct wall_primitive wall_primitive(pvec3 a, pvec3 b, pvec3 c, preal r, preal s, int kind)
{
    struct wall_primitive w;
    w.a = a;
    w.b = b;
    w.c = c;
    w.r = r;
    w.s = s;
    w.kind = kind;
    return w;
}

/* The closest point of a wall, seen from a centre x. */
struct wall_closest {
    pvec3 D; /* closest point minus x = distance n [m] */
    pvec3 n; /* unit, from x to the wall; defined at zero distance too */
    /* [m]; negative behind a plane and within a rod. Overlap of a sphere: delta = radius -
     * distance */
    preal distance;
    /* triangle: 0 face, 1 edge ab, 2 edge bc, 3 edge ca, 4 corner a, 5 corner b, 6 corner c;
     * others: 0 face, 1 edge or first rim, 2 last rim, 4 corner of a rectangle */
    int feature;
};

/* From D alone: the two-sided surfaces. `fallback` is n where the centre lies on the surface. */
LAW struct wall_closest wall_two_sided(pvec3 D, pvec3 fallback, int feature)
{
    struct wall_closest k;
    preal distance = p_sqrt(p3_dot(D, D));
    int apart = distance > 0;
    preal scale = (preal)1 / (apart ? distance : (preal)1);
    k.D = D;
    k.distance = distance;
    k.n.x = apart ? scale * D.x : fallback.x;
    k.n.y = apart ? scale * D.y : fallback.y;
    k.n.z = apart ? scale * D.z : fallback.z;
    k.feature = feature;
    return k;
}

/* From a signed distance along a known unit vector n: the one-sided surfaces. */
LAW struct wall_closest wall_one_sided(preal distance, pvec3 n)
{
    struct wall_closest k;
    k.D = p3_scale(distance, n);
    k.n = n;
    k.distance = distance;
    k.feature = 0;
    return k;
}

/* `a` where `is`, else `b`: by selects, where a branch would keep a loop over contacts scalar. */
LAW struct wall_closest wall_choose(int is, struct wall_closest a, struct wall_closest b)
{
    a.D = p3(is ? a.D.x : b.D.x, is ? a.D.y : b.D.y, is ? a.D.z : b.D.z);
    a.n = p3(is ? a.n.x : b.n.x, is ? a.n.y : b.n.y, is ? a.n.z : b.n.z);
    a.distance = is ? a.distance : b.distance;
    a.feature = is ? a.feature : b.feature;
    return a;
}

/* Signed distance (x - p).m. */
LAW struct wall_closest wall_closest_plane(struct wall_primitive w, pvec3 x)
{
    return wall_one_sided(p3_dot(p3_sub(x, w.a), w.b), p3_scale((preal)-1, w.b));
}

/* In the frame of the two axes and their normal the closest point is a clamp; in-plane parts of D
 * are exactly zero over the face. */
LAW struct wall_closest wall_closest_rectangle(struct wall_primitive w, pvec3 x)
{
    pvec3 q = p3_sub(x, w.a), m = p3_cross(w.b, w.c);
    preal u = p3_dot(q, w.b), v = p3_dot(q, w.c), h = p3_dot(q, m);
    preal du = r_clamp(u, -w.r, w.r) - u, dv = r_clamp(v, -w.s, w.s) - v;
    pvec3 D = p3_fma(du, w.b, p3_fma(dv, w.c, p3_scale(-h, m)));
    int off = (du < 0 || du > 0) + (dv < 0 || dv > 0);
    return wall_two_sided(D, m, off == 2 ? 4 : off);
}

/* Cylindrical coordinates: z along the axis, rho from it, e the unit vector outwards; beyond = how
 * far z lies past the nearer end (negative: between the ends), `end` the unit vector out of that
 * end. Past an end the closest point of a pipe is on its rim. */
LAW struct wall_closest wall_closest_cylinder(struct wall_primitive w, pvec3 x)
{
    pvec3 q = p3_sub(x, w.a);
    preal z = p3_dot(q, w.b);
    pvec3 radial = p3_fma(-z, w.b, q);
    preal rho = p_sqrt(p3_dot(radial, radial));
    int apart = rho > 0;
    preal scale = (preal)1 / (apart ? rho : (preal)1);
    pvec3 e = p3(apart ? scale * radial.x : w.c.x, apart ? scale * radial.y : w.c.y,
        apart ? scale * radial.z : w.c.z);
    int last = z + z > w.s;
    preal beyond = last ? z - w.s : -z, out = rho - w.r;
    pvec3 end = p3_scale(last ? (preal)1 : (preal)-1, w.b);
    int past = beyond > 0;
    pvec3 D = p3_fma(-out, e, p3_scale(past ? -beyond : (preal)0, end));
    struct wall_closest rim = wall_two_sided(D, e, past ? 1 + last : 0);
    struct wall_closest side = wall_one_sided(out, p3_scale((preal)-1, e));
    struct wall_closest flat = wall_one_sided(beyond, p3_scale((preal)-1, end));
    return wall_choose(
        w.kind == WALL_ROD && !(out > 0 && past), wall_choose(out >= beyond, side, flat), rim);
}

/* Closest point a + v ab + w ac by Voronoi regions (Ericson, Real-Time Collision Detection, 2005,
 * section 5.1.5). The regions select numerators and one denominator, so that there is a single
 * path. */
LAW struct wall_closest wall_closest_triangle(struct wall_primitive t, pvec3 x)
{
    pvec3 ab = p3_sub(t.b, t.a), ac = p3_sub(t.c, t.a), ap = p3_sub(x, t.a), bp = p3_sub(x, t.b),
          cp = p3_sub(x, t.c);
    preal d1 = p3_dot(ab, ap), d2 = p3_dot(ac, ap), d3 = p3_dot(ab, bp), d4 = p3_dot(ac, bp),
          d5 = p3_dot(ab, cp), d6 = p3_dot(ac, cp);
    preal va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    preal e4 = d4 - d3, e5 = d5 - d6; /* along bc from b, and from c */
    preal nv = vb, nw = vc, den = va + vb + vc;
    int feature = 0;
    /* From the last test to the first: where several hold, the earlier one decides. */
    if (va <= 0 && e4 >= 0 && e5 >= 0) {
        nv = e5;
        nw = e4;
        den = e4 + e5;
        feature = 2;
    }
    if (vb <= 0 && d2 >= 0 && d6 <= 0) {
        nv = 0;
        nw = d2;
        den = d2 - d6;
        feature = 3;
    }
    if (d6 >= 0 && d5 <= d6) {
        nv = 0;
        nw = 1;
        den = 1;
        feature = 6;
    }
    if (vc <= 0 && d1 >= 0 && d3 <= 0) {
        nv = d1;
        nw = 0;
        den = d1 - d3;
        feature = 1;
    }
    if (d3 >= 0 && d4 <= d3) {
        nv = 1;
        nw = 0;
        den = 1;
        feature = 5;
    }
    if (d1 <= 0 && d2 <= 0) {
        nv = 0;
        nw = 0;
        den = 1;
        feature = 4;
    }
    preal v = nv / den, w = nw / den;
    pvec3 D = p3_sub(p3_fma(v, ab, p3_scale(w, ac)), ap);
    pvec3 m = p3_cross(ab, ac);
    return wall_two_sided(D, p3_scale((preal)1 / p_sqrt(p3_dot(m, m)), m), feature);
}

/* Constants carry their type: a device without doubles rejects a cast one. */
#if POSITION_IS_FLOAT
#define WALL_FAR 1e30f
#else
#define WALL_FAR 1e30
#endif

/* Closest point of a primitive to the centre x, both in the wall's frame. */
LAW struct wall_closest wall_closest(struct wall_primitive w, pvec3 x)
{
    if (WITH_PLANE && w.kind == WALL_PLANE) return wall_closest_plane(w, x);
    if (WITH_RECTANGLE && w.kind == WALL_RECTANGLE) return wall_closest_rectangle(w, x);
    if (WITH_CYLINDER && (w.kind == WALL_PIPE || w.kind == WALL_ROD))
        return wall_closest_cylinder(w, x);
    if (WITH_TRIANGLE && w.kind == WALL_TRIANGLE) return wall_closest_triangle(w, x);
    /* a kind that this program was built without: out of reach */
    return wall_one_sided(WALL_FAR, p3(0, 0, 1));
}

/* The room of a triangle on the side of the centre x, in the wall's frame. */
LAW preal wall_room(struct wall_primitive w, pvec3 x)
{
    if (!WITH_TRIANGLE || w.kind != WALL_TRIANGLE) return WALL_FAR;
    pvec3 m = p3_cross(p3_sub(w.b, w.a), p3_sub(w.c, w.a));
    return p3_dot(p3_sub(x, w.a), m) < 0 ? w.s : w.r;
}

/* One contact per local minimum of the distance. A sphere over a mesh sees several triangles; over
 * all candidates of one element and one wall, in ascending order of triangles:
 *   1. wall_closest of every candidate;
 *   2. drop candidate t if a candidate s has wall_hides(s, t);
 *   3. of those left drop t if a lower one, itself left, has wall_coincides with it.
 * What stays are the contacts (where distance < radius, or a bond holds); law_fillet.h says how
 * those of a smooth surface act together. Candidates further away than t can neither hide it nor
 * coincide with it, so the answer does not depend on how far the list reaches.
 *
 * Of walls that are flush (a gate in a floor, rectangles side by side) an edge or corner of one is
 * no minimum either where its point lies on another that is nearer: wall_is_flush, which needs no
 * common number. The same point of flat walls is met once, whoever has it.
 *
 * A shared edge or vertex has one number in the whole mesh; edges and vertices are numbered
 * together and never alike. */
struct wall_features {
    int edge_ab, edge_bc, edge_ca, corner_a, corner_b, corner_c;
};

#define WALL_FEATURES(table, k)                                                                    \
    wall_features((table)[6 * (k)], (table)[6 * (k) + 1], (table)[6 * (k) + 2],                    \
        (table)[6 * (k) + 3], (table)[6 * (k) + 4], (table)[6 * (k) + 5])

LAW struct wall_features wall_features(
    int edge_ab, int edge_bc, int edge_ca, int corner_a, int corner_b, int corner_c)
{
    struct wall_features f;
    f.edge_ab = edge_ab;
    f.edge_bc = edge_bc;
    f.edge_ca = edge_ca;
    f.corner_a = corner_a;
    f.corner_b = corner_b;
    f.corner_c = corner_c;
    return f;
}

/* Distances that differ by less than WALL_TIE radius are equal; points closer than WALL_MERGE
 * radius are one. Near a foot point distances are of second order, so WALL_MERGE > 2 sqrt(2 tie),
 * where tie is at least the rounding error of a distance to a triangle of 100 radii. */
#if POSITION_IS_FLOAT
#define WALL_TIE 1e-6f
#define WALL_MERGE 1e-2f
#else
#define WALL_TIE 1e-12
#define WALL_MERGE 1e-5
#endif

/* Number of the edge or vertex `feature` (1 to 6) of a triangle; -1 for its face. */
LAW int wall_feature_number(struct wall_features f, int feature)
{
    int edge = feature == 1 ? f.edge_ab : feature == 2 ? f.edge_bc : f.edge_ca;
    int corner = feature == 4 ? f.corner_a : feature == 5 ? f.corner_b : f.corner_c;
    return feature == 0 ? -1 : feature < 4 ? edge : corner;
}

/* Whether a triangle with features f has the edge or vertex of that number. */
LAW int wall_shares(struct wall_features f, int number)
{
    return number >= 0 && (f.edge_ab == number || f.edge_bc == number || f.edge_ca == number ||
                              f.corner_a == number || f.corner_b == number || f.corner_c == number);
}

/* Whether triangle s leads nearer to the centre than t's closest edge or vertex, which s shares:
 * then t's closest point is no local minimum. */
LAW int wall_hides(struct wall_closest s, struct wall_features s_features, struct wall_closest t,
    struct wall_features t_features, preal radius)
{
    return s.distance < t.distance - WALL_TIE * radius &&
           wall_shares(s_features, wall_feature_number(t_features, t.feature));
}

/* Whether two closest points of one wall are the same point of the surface. */
LAW int wall_coincides(struct wall_closest s, struct wall_closest t, preal radius)
{
    pvec3 gap = p3_sub(s.D, t.D);
    preal reach = WALL_MERGE * radius;
    return p3_dot(gap, gap) < reach * reach;
}

/* Coordinates of two files agree to so much of their size. */
#if POSITION_IS_FLOAT
#define WALL_ROUNDING 3e-6f
#else
#define WALL_ROUNDING 1e-6
#endif

/* Kinds that may lie in one plane: two of them whose closest points coincide are met once. */
LAW int wall_is_flat(int kind)
{
    return kind == WALL_PLANE || kind == WALL_RECTANGLE || kind == WALL_TRIANGLE;
}

/* Whether a point of one wall lies on a primitive s of another. on: wall_closest of s, seen from
 * that point; size: largest coordinate of the point [m]. */
LAW int wall_is_flush(struct wall_closest on, preal size, preal radius)
{
    preal reach = WALL_MERGE * radius + WALL_ROUNDING * size;
    return on.distance < reach && on.distance > -reach;
}

/* History passes from one flat primitive to the next as a sphere moves over a mesh, or friction
 * would restart at every edge. The contact that begins takes the spring of one that ended in the
 * same step if the normals agree: cos > 0.9. Of several the largest cosine, then the lowest
 * triangle; an old contact gives its history away once. Both are places of one sphere less than 26
 * degrees apart, so no common edge or vertex is asked for: a step may cross several thin
 * triangles. From wall to wall only where the points are closer than a tenth of the radius. Seen
 * from the same centre, in the same frame. */
LAW int wall_hands_over(
    struct wall_closest old, struct wall_closest begun, int same_wall, preal radius)
{
    pvec3 gap = p3_sub(old.D, begun.D);
    return 10 * p3_dot(old.n, begun.n) > 9 &&
           (same_wall || 100 * p3_dot(gap, gap) < radius * radius);
}

/* Rigid motion. A point q of the wall's frame is at p = R q + t; rows of the rotation R. */
struct wall_frame {
    pvec3 row_x, row_y, row_z, t;
};

LAW pvec3 wall_turn(struct wall_frame f, pvec3 d)
{
    return p3(p3_dot(f.row_x, d), p3_dot(f.row_y, d), p3_dot(f.row_z, d));
}

LAW pvec3 wall_turn_back(struct wall_frame f, pvec3 d)
{
    return p3_fma(d.x, f.row_x, p3_fma(d.y, f.row_y, p3_scale(d.z, f.row_z)));
}

LAW pvec3 wall_to_world(struct wall_frame f, pvec3 q) { return p3_add(wall_turn(f, q), f.t); }
LAW pvec3 wall_to_reference(struct wall_frame f, pvec3 p)
{
    return wall_turn_back(f, p3_sub(p, f.t));
}

/* The closest point of a primitive in world coordinates. */
LAW struct wall_closest wall_closest_moved(struct wall_primitive w, struct wall_frame f, pvec3 x)
{
    struct wall_closest k = wall_closest(w, wall_to_reference(f, x));
    k.D = wall_turn(f, k.D);
    k.n = wall_turn(f, k.n);
    return k;
}

/* Velocity of the wall at the point p: V + W x (p - c), arm = p - c. With V, W, c of walls_poses
 * and p halfway between the point's places at both ends of the step this is exactly its
 * displacement over dt. */
LAW vec3 wall_velocity(vec3 velocity, vec3 spin, vec3 arm)
{
    return v3_add(velocity, v3_cross(spin, arm));
}

#endif
