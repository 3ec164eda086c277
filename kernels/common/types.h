/* Numbers that host and device share. The laws (law_*.h) are written in these types alone, so that
 * the very same text runs on both.
 *
 * real   arithmetic of contacts and velocities: float or double, by REAL_IS_FLOAT (0 or 1,
 *        default 0)
 * preal  positions and their differences: by POSITION_IS_FLOAT; `mixed` precision is real = float,
 *        preal = double
 *
 * Only + - * / sqrt fma are used on state: they are correctly rounded (division and sqrt in float
 * where the device says so), so bits do not depend on the vendor. No contraction: fma is written
 * where it is wanted. */
#ifndef DEMOCLES_TYPES_H
#define DEMOCLES_TYPES_H

#ifndef REAL_IS_FLOAT
#define REAL_IS_FLOAT 0
#endif
#ifndef POSITION_IS_FLOAT
#define POSITION_IS_FLOAT 0
#endif

#ifdef __OPENCL_VERSION__
#pragma OPENCL FP_CONTRACT OFF
#if !REAL_IS_FLOAT || !POSITION_IS_FLOAT
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#endif
/* a call that is left over keeps the loop over work-items scalar */
#define LAW static inline __attribute__((always_inline))
#define r_sqrt(x) sqrt(x)
#define r_fma(a, b, c) fma((a), (b), (c))
#define r_abs(x) fabs(x)
#define p_sqrt(x) sqrt(x)
#define p_fma(a, b, c) fma((a), (b), (c))
#else
#include <math.h>
#include <stdint.h>
#define __global /* the host has one address space: laws that read tables compile there too */
#define LAW static inline __attribute__((unused))
#if REAL_IS_FLOAT
#define r_sqrt(x) sqrtf(x)
#define r_fma(a, b, c) fmaf((a), (b), (c))
#define r_abs(x) fabsf(x)
#else
#define r_sqrt(x) sqrt(x)
#define r_fma(a, b, c) fma((a), (b), (c))
#define r_abs(x) fabs(x)
#endif
#if POSITION_IS_FLOAT
#define p_sqrt(x) sqrtf(x)
#define p_fma(a, b, c) fmaf((a), (b), (c))
#else
#define p_sqrt(x) sqrt(x)
#define p_fma(a, b, c) fma((a), (b), (c))
#endif
#endif

#if REAL_IS_FLOAT
typedef float real;
#else
typedef double real;
#endif
#if POSITION_IS_FLOAT
typedef float preal;
#else
typedef double preal;
#endif

/* A selection, not a call: fmin and fmax of OpenCL are slower and treat NaN in their own way. */
#define r_max(a, b) ((a) > (b) ? (a) : (b))
#define r_min(a, b) ((a) < (b) ? (a) : (b))
#define r_clamp(x, lo, hi) r_min(r_max((x), (lo)), (hi))

#endif
