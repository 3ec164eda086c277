/* The same law along each of the three axes: a vector seen with axis a first, (v_a, v_b, v_c) with
 * (a, b, c) cyclic. That is a rotation, so cross products stay what they are and a law is written
 * once, for a = x. With a constant a the compiler renames registers and nothing more. */
#ifndef DEMOCLES_AXIS_H
#define DEMOCLES_AXIS_H

#include "vec.h"

/* a = 0, 1, 2 */
LAW vec3 v3_cycle(vec3 v, int a)
{
    return v3(a == 0   ? v.x
              : a == 1 ? v.y
                       : v.z,
        a == 0   ? v.y
        : a == 1 ? v.z
                 : v.x,
        a == 0   ? v.z
        : a == 1 ? v.x
                 : v.y);
}
LAW pvec3 p3_cycle(pvec3 v, int a)
{
    return p3(a == 0   ? v.x
              : a == 1 ? v.y
                       : v.z,
        a == 0   ? v.y
        : a == 1 ? v.z
                 : v.x,
        a == 0   ? v.z
        : a == 1 ? v.x
                 : v.y);
}
/* (v_a, v_b, v_c) back to (x, y, z). */
LAW vec3 v3_uncycle(vec3 v, int a) { return v3_cycle(v, a == 0 ? 0 : 3 - a); }
LAW pvec3 p3_uncycle(pvec3 v, int a) { return p3_cycle(v, a == 0 ? 0 : 3 - a); }

#endif
