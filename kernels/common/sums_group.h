/* Sums in integers (sums.h) over many items: each of SUMS_GROUPS groups strides over the items,
 * every work-item adds its own in registers, one work-item per number adds up the group's in local
 * memory, and the host adds up partial [SUMS_GROUPS][sums][SUMS_WIDTH]. For devices with double
 * precision. */
#ifndef DEMOCLES_SUMS_GROUP_H
#define DEMOCLES_SUMS_GROUP_H

#include "sums.h"
#include "types.h"

#if WITH_SUMS
#define SUMS_FIRST ((int)(get_group_id(0) * SUMS_GROUP + get_local_id(0)))
#define SUMS_STRIDE (SUMS_GROUPS * SUMS_GROUP)

/* Rows [SUMS_WIDTH] of local memory from sum number k on. */
LAW void sums_put(__local long *part, int k, struct sum s)
{
    __local long *row = part + k * SUMS_WIDTH * SUMS_GROUP + get_local_id(0);
    row[0] = s.hi;
    row[SUMS_GROUP] = s.mid;
    row[2 * SUMS_GROUP] = s.lo;
    row[3 * SUMS_GROUP] = s.bad;
}

/* After a barrier: the group's sums of n_sum quantities to their place in `partial`. */
LAW void sums_finish(__local const long *part, int n_sum, __global long *partial)
{
    int g = get_group_id(0), width = n_sum * SUMS_WIDTH;
    if (g >= SUMS_GROUPS) return;
    for (int k = get_local_id(0); k < width; k += SUMS_GROUP) {
        long total = 0;
        for (int l = 0; l < SUMS_GROUP; l++) total += part[k * SUMS_GROUP + l];
        partial[g * width + k] = total;
    }
}

LAW struct sum sums_zero(void)
{
    struct sum s;
    s.hi = s.mid = s.lo = s.bad = 0;
    return s;
}
#endif

#endif
