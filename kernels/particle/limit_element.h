/* An element as the rare kernels over contacts read it: step_limit.cl and overlap.cl, which are
 * built as one program. */
#ifndef DEMOCLES_LIMIT_ELEMENT_H
#define DEMOCLES_LIMIT_ELEMENT_H

#include "element.h"

#ifdef __OPENCL_VERSION__
struct limit_element {
    pvec3 x;
    vec3 v;
    real w, r; /* 1/m, radius */
    int kind;  /* material */
};

LAW struct limit_element limit_element_load(
    __global const preal *position, __global const real *motion, int e, int kind)
{
    struct limit_element a;
    preal4 x = LOAD_POSITION(e);
    real4 v = LOAD_VELOCITY(e);
    a.x = XYZ(x);
    a.v = VXYZ(v);
    a.w = v.s3;
    a.r = (real)x.s3;
    a.kind = kind;
#if WITH_MATERIALS
    a.kind = (int)motion[(size_t)e * MOTION_STRIDE + SPIN_AT + 3];
#endif
    return a;
}
#endif

#endif
