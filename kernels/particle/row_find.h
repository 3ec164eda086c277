/* Looking for an id in a row of ascending ids. */
#ifndef DEMOCLES_ROW_FIND_H
#define DEMOCLES_ROW_FIND_H

#include "common/types.h"

#ifdef __OPENCL_VERSION__
/* The first place in begin <= k < end with an id above `own`; end if there is none. */
LAW int first_above(__global const long *gid, int begin, int end, long own)
{
    while (begin < end) {
        int mid = begin + (end - begin) / 2;
        if (gid[mid] > own) end = mid;
        else begin = mid + 1;
    }
    return begin;
}

/* The place of `wanted`, or -1. */
LAW int find(__global const long *gid, int begin, int end, long wanted)
{
    int k = first_above(gid, begin, end, wanted) - 1;
    return k >= begin && gid[k] == wanted ? k : -1;
}
#endif

#endif
