/* How an element's state lies in memory: one record of 4 preal, 4 or 8 real and 0 to 8 float,
 * loaded by vectors.
 *
 *   x y z radius | vx vy vz 1/m | wx wy wz material | half kick of v | half kick of w
 *
 * from w on only WITH_SPIN, WITH_KICK and WITH_SPIN_KICK. The half kicks are what the forces of the
 * last step have added to v and w since then, (dt/2) a^n: dashpots predict from them the velocities
 * at the end of the step (contact/law_normal.h). They are made at each drift, so that no frame has
 * them; and they are floats, because 1e-7 of such a part of a velocity is nothing to a dashpot,
 * and a record in double precision then fills two cache lines of 64 bytes and not two and a half.
 * One record instead of nine arrays: a pair's partner is one or two cache lines away instead of
 * nine, and a ghost is one contiguous record that arrives without unpacking. Measured on the
 * settled bed: gathers from nine arrays 18 ns per pair, from records 16 ns. Owned elements come
 * first, ghosts after. Velocities are those of the half step between drifts, of the full step when
 * observed. Arguments that kernels take: `__global const preal *position, __global const real
 * *motion`, the same buffer seen with two types. */
#ifndef DEMOCLES_ELEMENT_H
#define DEMOCLES_ELEMENT_H

#include "common/vec.h"

#define ELEMENT_REALS (WITH_SPIN ? 8 : 4)                   /* real per record, behind 4 preal */
#define ELEMENT_FLOATS (4 * WITH_KICK + 4 * WITH_SPIN_KICK) /* float behind those */
#define ELEMENT_BYTES                                                                              \
    (4 * (POSITION_IS_FLOAT ? 4 : 8) + ELEMENT_REALS * (REAL_IS_FLOAT ? 4 : 8) + 4 * ELEMENT_FLOATS)
#define POSITION_STRIDE (ELEMENT_BYTES / (POSITION_IS_FLOAT ? 4 : 8)) /* in preal */
#define MOTION_STRIDE (ELEMENT_BYTES / (REAL_IS_FLOAT ? 4 : 8))       /* in real */
#define VELOCITY_AT (4 * (POSITION_IS_FLOAT ? 4 : 8) / (REAL_IS_FLOAT ? 4 : 8))
#define SPIN_AT (VELOCITY_AT + 4)
#define KICK_AT (ELEMENT_BYTES / 4 - ELEMENT_FLOATS) /* in float */

#ifdef __OPENCL_VERSION__
#if REAL_IS_FLOAT
typedef float4 real4;
#define TO_REAL4(v) (v)
#define TO_FLOAT4(v) (v)
#else
typedef double4 real4;
#define TO_REAL4(v) convert_double4(v)
#define TO_FLOAT4(v) convert_float4(v)
#endif
#if POSITION_IS_FLOAT
typedef float4 preal4;
#else
typedef double4 preal4;
#endif

#define LOAD_POSITION(e) vload4(0, position + (size_t)(e)*POSITION_STRIDE)
#define LOAD_VELOCITY(e) vload4(0, motion + (size_t)(e)*MOTION_STRIDE + VELOCITY_AT)
#define LOAD_SPIN(e) vload4(0, motion + (size_t)(e)*MOTION_STRIDE + SPIN_AT)
#define KICK_OF(e, k, type)                                                                        \
    ((__global type *)motion + (size_t)(e) * (ELEMENT_BYTES / 4) + KICK_AT + 4 * (k))
#define LOAD_KICK(e) TO_REAL4(vload4(0, KICK_OF(e, 0, const float)))
#define LOAD_SPIN_KICK(e) TO_REAL4(vload4(0, KICK_OF(e, 1, const float)))
#define STORE_POSITION(e, p) vstore4(p, 0, position + (size_t)(e)*POSITION_STRIDE)
#define STORE_VELOCITY(e, v) vstore4(v, 0, motion + (size_t)(e)*MOTION_STRIDE + VELOCITY_AT)
#define STORE_SPIN(e, w) vstore4(w, 0, motion + (size_t)(e)*MOTION_STRIDE + SPIN_AT)
#define STORE_KICK(e, k) vstore4(TO_FLOAT4(k), 0, KICK_OF(e, 0, float))
#define STORE_SPIN_KICK(e, k) vstore4(TO_FLOAT4(k), 0, KICK_OF(e, 1, float))
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
