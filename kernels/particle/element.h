/* How an element's state lies in memory: one record of 4 preal and 4 or 8 real, loaded by vectors.
 *
 *   x y z radius | vx vy vz 1/m | wx wy wz material          (the last four only WITH_SPIN)
 *
 * One record instead of nine arrays: a pair's partner is one or two cache lines away instead of
 * nine, and a ghost is one contiguous record that arrives without unpacking. Measured on the
 * settled bed: gathers from nine arrays 18 ns per pair, from records 16 ns. Owned elements come
 * first, ghosts after. Velocities are those of the half step between drifts, of the full step when
 * observed. Arguments that kernels take: `__global const preal *position, __global const real
 * *motion`, the same buffer seen with two types. */
#ifndef DEMOCLES_ELEMENT_H
#define DEMOCLES_ELEMENT_H

#include "common/vec.h"

#define ELEMENT_REALS (WITH_SPIN ? 8 : 4) /* real per record, behind 4 preal */
#define ELEMENT_BYTES (4 * (POSITION_IS_FLOAT ? 4 : 8) + ELEMENT_REALS * (REAL_IS_FLOAT ? 4 : 8))
#define POSITION_STRIDE (ELEMENT_BYTES / (POSITION_IS_FLOAT ? 4 : 8)) /* in preal */
#define MOTION_STRIDE (ELEMENT_BYTES / (REAL_IS_FLOAT ? 4 : 8))       /* in real */
#define VELOCITY_AT (MOTION_STRIDE - ELEMENT_REALS)
#define SPIN_AT (MOTION_STRIDE - 4)

#ifdef __OPENCL_VERSION__
#if REAL_IS_FLOAT
typedef float4 real4;
#else
typedef double4 real4;
#endif
#if POSITION_IS_FLOAT
typedef float4 preal4;
#else
typedef double4 preal4;
#endif

#define LOAD_POSITION(e) vload4(0, position + (size_t)(e)*POSITION_STRIDE)
#define LOAD_VELOCITY(e) vload4(0, motion + (size_t)(e)*MOTION_STRIDE + VELOCITY_AT)
#define LOAD_SPIN(e) vload4(0, motion + (size_t)(e)*MOTION_STRIDE + SPIN_AT)
#define STORE_POSITION(e, p) vstore4(p, 0, position + (size_t)(e)*POSITION_STRIDE)
#define STORE_VELOCITY(e, v) vstore4(v, 0, motion + (size_t)(e)*MOTION_STRIDE + VELOCITY_AT)
#define STORE_SPIN(e, w) vstore4(w, 0, motion + (size_t)(e)*MOTION_STRIDE + SPIN_AT)
#define XYZ(p) p3((p).s0, (p).s1, (p).s2)
#define VXYZ(v) v3((v).s0, (v).s1, (v).s2)
#endif

#define WITH_PERIODIC (WITH_PERIODIC_X || WITH_PERIODIC_Y || WITH_PERIODIC_Z)

/* Difference of two coordinates at most one and a half periods apart, brought to the nearest image.
 * period 0: not periodic. */
LAW preal nearest_image(preal d, preal period)
{
    preal limit = (preal)0.5 * period;
    preal up = d < -limit ? d + period : d;
    return d > limit ? d - period : up;
}

LAW pvec3 nearest_images(pvec3 d, preal px, preal py, preal pz)
{
    if (WITH_PERIODIC_X) d.x = nearest_image(d.x, px);
    if (WITH_PERIODIC_Y) d.y = nearest_image(d.y, py);
    if (WITH_PERIODIC_Z) d.z = nearest_image(d.z, pz);
    return d;
}

#endif
