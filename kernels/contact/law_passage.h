/* Whether a centre that went straight from q0 to q1, both in the wall's frame, has passed a wall:
 * which side it is on is known from two places alone, because two-sided surfaces (law_wall.h) push
 * towards the side where the centre is now. Values in, values out. */
#ifndef DEMOCLES_LAW_PASSAGE_H
#define DEMOCLES_LAW_PASSAGE_H

#include "law_wall.h"

/* From one side to the other of a height above the surface; a point on it is above. */
LAW int passage_changes(preal before, preal after) { return (before < 0) != (after < 0); }

/* Where the height is zero on the way. */
LAW pvec3 passage_point(pvec3 q0, pvec3 q1, preal before, preal after)
{
    return p3_fma(before / (before - after), p3_sub(q1, q0), q0);
}

LAW int passage_rectangle(struct wall_primitive w, pvec3 q0, pvec3 q1)
{
    pvec3 m = p3_cross(w.b, w.c);
    preal before = p3_dot(p3_sub(q0, w.a), m), after = p3_dot(p3_sub(q1, w.a), m);
    if (!passage_changes(before, after)) return 0;
    pvec3 p = p3_sub(passage_point(q0, q1, before, after), w.a);
    preal u = p3_dot(p, w.b), v = p3_dot(p, w.c);
    return u >= -w.r && u <= w.r && v >= -w.s && v <= w.s;
}

/* The shell of a pipe, between its ends. */
LAW int passage_pipe(struct wall_primitive w, pvec3 q0, pvec3 q1)
{
    pvec3 a = p3_sub(q0, w.a), b = p3_sub(q1, w.a);
    preal z0 = p3_dot(a, w.b), z1 = p3_dot(b, w.b);
    pvec3 across0 = p3_fma(-z0, w.b, a), across1 = p3_fma(-z1, w.b, b);
    preal before = p_sqrt(p3_dot(across0, across0)) - w.r,
          after = p_sqrt(p3_dot(across1, across1)) - w.r;
    if (!passage_changes(before, after)) return 0;
    preal z = z0 + before / (before - after) * (z1 - z0);
    return z >= 0 && z <= w.s;
}

/* Through the plane, on the inner side of each edge; edges belong to both of their triangles. */
LAW int passage_triangle(struct wall_primitive t, pvec3 q0, pvec3 q1)
{
    pvec3 m = p3_cross(p3_sub(t.b, t.a), p3_sub(t.c, t.a));
    preal before = p3_dot(p3_sub(q0, t.a), m), after = p3_dot(p3_sub(q1, t.a), m);
    if (!passage_changes(before, after)) return 0;
    pvec3 p = passage_point(q0, q1, before, after);
    return p3_dot(p3_cross(p3_sub(t.b, t.a), p3_sub(p, t.a)), m) >= 0 &&
           p3_dot(p3_cross(p3_sub(t.c, t.b), p3_sub(p, t.b)), m) >= 0 &&
           p3_dot(p3_cross(p3_sub(t.a, t.c), p3_sub(p, t.c)), m) >= 0;
}

/* One-sided surfaces know their inside. */
LAW int wall_is_passed(struct wall_primitive w, pvec3 q0, pvec3 q1)
{
    if (WITH_RECTANGLE && w.kind == WALL_RECTANGLE) return passage_rectangle(w, q0, q1);
    if (WITH_TRIANGLE && w.kind == WALL_TRIANGLE) return passage_triangle(w, q0, q1);
    if (WITH_CYLINDER && w.kind == WALL_PIPE) return passage_pipe(w, q0, q1);
    return wall_closest(w, q0).distance >= 0 && wall_closest(w, q1).distance < 0;
}

#endif
