/* For the tests of program and launch: scalars of several types, and an argument that a feature
 * removes. */
#include "inner.h"
#include "../anywhere/outer.h"

__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void scale(__global const real *x,
    __global real *y,
#if WITH_SHIFT
    __global const real *shift,
#endif
    real factor, long bias, int n)
{
    int i = (int)get_global_id(0);
    if (i >= n) return;
    real r = factor * x[i] + (real)bias;
#if WITH_SHIFT
    r += shift[i];
#endif
    y[i] = r;
}

/* No declared work-group size; writes whatever the padding adds, so that the padded size shows. */
__kernel void count(__global int *seen)
{
    seen[get_global_id(0)] += OUTER(0);
}

__kernel __attribute__((reqd_work_group_size(32, 1, 1))) void width(__global int *local_size)
{
    if (get_global_id(0) == 0) local_size[0] = (int)get_local_size(0);
}
