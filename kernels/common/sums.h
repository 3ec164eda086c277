/* Sums of doubles that do not depend on the order of their terms, and an element's share in each of
 * the conserved quantities.
 *
 * Every term is cut into three integers, x = hi 2^-20 + mid 2^-50 + lo 2^-80; integers are added,
 * and their sum is the same in any order, so on any number of ranks. Only what lies below 2^-80
 * (8.3e-25 J: thermal energies are 4e-21 J) is rounded, once per term and to nearest, so a sum of
 * terms that are whole multiples of 2^-80 is exact. Terms up to 2^33 in magnitude (8.6e9 J), sums
 * up to 2^43 (8.8e12 J), 2^33 terms: a term beyond that, or NaN, is not added but counted, and the
 * sum is then NaN.
 *
 * Same text on host and device; double on both, whatever `real` is. Knows no memory. */
#ifndef DEMOCLES_SUMS_H
#define DEMOCLES_SUMS_H

#ifdef __OPENCL_VERSION__
typedef long sums_int; /* 64 bits */
#define SUMS static inline
#else
#include <math.h>
#include <stdint.h>
typedef int64_t sums_int;
#define SUMS static inline __attribute__((unused))
#endif

#if !defined(__OPENCL_VERSION__) || WITH_SUMS /* double exists */

#define SUMS_GROUP 64  /* work-items per group */
#define SUMS_GROUPS 64 /* groups, so partial sums that the host reads */
#define SUMS_WIDTH 4   /* integers per sum, in the order of struct sum */

#define SUMS_LARGEST 8589934592.0 /* 2^33 */
#define SUMS_HEAD 1048576.0       /* 2^20 */
#define SUMS_STEP 1073741824.0    /* 2^30, between one integer and the next */

struct sum {
    sums_int hi, mid, lo;
    sums_int bad; /* terms that could not be added */
};

/* Casts cut towards zero, so that each rest is exact and has the sign of x. */
SUMS void sums_add(struct sum *sum, double x)
{
    int good = x > -SUMS_LARGEST && x < SUMS_LARGEST; /* not of NaN */
    double part = good ? x * SUMS_HEAD : 0.0;
    sums_int hi = (sums_int)part;
    sums_int mid;
    part = (part - (double)hi) * SUMS_STEP;
    mid = (sums_int)part;
    part = (part - (double)mid) * SUMS_STEP;
    sum->hi += hi;
    sum->mid += mid;
    sum->lo += (sums_int)rint(part);
    sum->bad += !good;
}

/* Sums over elements; of momentum and angular momentum three each. */
#define SUMS_KINETIC 0
#define SUMS_ROTATIONAL 1
#define SUMS_GRAVITY 2
#define SUMS_MOMENTUM 3
#define SUMS_ANGULAR 6
#define SUMS_ELEMENT 9

struct sums_element {
    double x[3], v[3], w[3]; /* [m], [m/s], [rad/s] of one time */
    double radius, mass;     /* [m], [kg] */
};

/* A sphere's terms: m v^2/2, I w^2/2 with I = 0.4 m r^2, -m g.(x - origin) [J]; m v [kg m/s]; x x m
 * v + I w [J s], about the zero of x. */
SUMS void sums_element(
    struct sums_element e, const double *gravity, const double *origin, double *term)
{
    double inertia = 0.4 * e.mass * e.radius * e.radius;
    double vv = e.v[0] * e.v[0] + e.v[1] * e.v[1] + e.v[2] * e.v[2];
    double ww = e.w[0] * e.w[0] + e.w[1] * e.w[1] + e.w[2] * e.w[2];
    double depth = gravity[0] * (e.x[0] - origin[0]) + gravity[1] * (e.x[1] - origin[1]) +
                   gravity[2] * (e.x[2] - origin[2]);

    term[SUMS_KINETIC] = 0.5 * e.mass * vv;
    term[SUMS_ROTATIONAL] = 0.5 * inertia * ww;
    term[SUMS_GRAVITY] = -e.mass * depth;
    for (int a = 0; a < 3; a++) {
        int b = a < 2 ? a + 1 : 0, c = a > 0 ? a - 1 : 2;
        term[SUMS_MOMENTUM + a] = e.mass * e.v[a];
        term[SUMS_ANGULAR + a] = e.mass * (e.x[b] * e.v[c] - e.x[c] * e.v[b]) + inertia * e.w[a];
    }
}

#endif

#endif
