/* Three-vectors of real (vec3) and of preal (pvec3): plain scalars in a struct, because OpenCL's
 * vector types stop pocl's vectoriser. So does a choice between two structs of floats, which LLVM
 * copies by two at a time: v3_choose, p3_choose. */
#ifndef DEMOCLES_VEC_H
#define DEMOCLES_VEC_H

#include "types.h"

typedef struct {
    real x, y, z;
} vec3;
typedef struct {
    preal x, y, z;
} pvec3;

LAW vec3 v3(real x, real y, real z)
{
    vec3 r;
    r.x = x;
    r.y = y;
    r.z = z;
    return r;
}
LAW vec3 v3_add(vec3 a, vec3 b) { return v3(a.x + b.x, a.y + b.y, a.z + b.z); }
LAW vec3 v3_sub(vec3 a, vec3 b) { return v3(a.x - b.x, a.y - b.y, a.z - b.z); }
LAW vec3 v3_scale(real s, vec3 a) { return v3(s * a.x, s * a.y, s * a.z); }
LAW vec3 v3_neg(vec3 a) { return v3(-a.x, -a.y, -a.z); }
/* s a + b */
LAW vec3 v3_fma(real s, vec3 a, vec3 b)
{
    return v3(r_fma(s, a.x, b.x), r_fma(s, a.y, b.y), r_fma(s, a.z, b.z));
}
LAW real v3_dot(vec3 a, vec3 b) { return r_fma(a.x, b.x, r_fma(a.y, b.y, a.z * b.z)); }
LAW vec3 v3_cross(vec3 a, vec3 b)
{
    return v3(r_fma(a.y, b.z, -(a.z * b.y)), r_fma(a.z, b.x, -(a.x * b.z)),
        r_fma(a.x, b.y, -(a.y * b.x)));
}
LAW vec3 v3_choose(int which, vec3 yes, vec3 no)
{
    return v3(which ? yes.x : no.x, which ? yes.y : no.y, which ? yes.z : no.z);
}
/* The part of a that is perpendicular to the unit vector n. */
LAW vec3 v3_tangent(vec3 a, vec3 n) { return v3_fma(-v3_dot(a, n), n, a); }

LAW pvec3 p3(preal x, preal y, preal z)
{
    pvec3 r;
    r.x = x;
    r.y = y;
    r.z = z;
    return r;
}
LAW pvec3 p3_add(pvec3 a, pvec3 b) { return p3(a.x + b.x, a.y + b.y, a.z + b.z); }
LAW pvec3 p3_sub(pvec3 a, pvec3 b) { return p3(a.x - b.x, a.y - b.y, a.z - b.z); }
LAW pvec3 p3_scale(preal s, pvec3 a) { return p3(s * a.x, s * a.y, s * a.z); }
LAW pvec3 p3_fma(preal s, pvec3 a, pvec3 b)
{
    return p3(p_fma(s, a.x, b.x), p_fma(s, a.y, b.y), p_fma(s, a.z, b.z));
}
LAW preal p3_dot(pvec3 a, pvec3 b) { return p_fma(a.x, b.x, p_fma(a.y, b.y, a.z * b.z)); }
LAW pvec3 p3_cross(pvec3 a, pvec3 b)
{
    return p3(p_fma(a.y, b.z, -(a.z * b.y)), p_fma(a.z, b.x, -(a.x * b.z)),
        p_fma(a.x, b.y, -(a.y * b.x)));
}
LAW pvec3 p3_choose(int which, pvec3 yes, pvec3 no)
{
    return p3(which ? yes.x : no.x, which ? yes.y : no.y, which ? yes.z : no.z);
}
LAW vec3 v3_of_p3(pvec3 a) { return v3((real)a.x, (real)a.y, (real)a.z); }
LAW pvec3 p3_of_v3(vec3 a) { return p3((preal)a.x, (preal)a.y, (preal)a.z); }

#endif
