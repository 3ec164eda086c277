/* Cell grids of several levels: where a point lies, and which cells a search has to visit. See
 * cells.cl for the tables. */
#ifndef DEMOCLES_GRID_H
#define DEMOCLES_GRID_H

#include "element.h"
#include "particle_words.h"

/* Levels go from coarse to fine; an element belongs to the finest one whose largest reach is not
 * below its own. */
LAW int grid_level(preal reach, int n_level, __global const preal *grid_real)
{
    int level = 0;
    for (int k = 1; k < n_level; k++)
        if (reach <= grid_real[k * GRID_REALS + 6]) level = k;
    return level;
}

LAW int grid_clamp(preal cells, int n)
{
    int c = cells > 0 ? (cells < (preal)n ? (int)cells : n - 1) : 0;
    return c < n ? c : n - 1;
}

/* Points outside (there are none but for rounding and unwrapped periodic ones) count to the
 * outermost cells, or to those of their image. */
LAW int grid_axis(
    preal x, int axis, int level, __global const preal *grid_real, __global const int *grid_int)
{
    int n = grid_int[level * GRID_INTS + axis];
    int periodic = axis == 0 ? WITH_PERIODIC_X : axis == 1 ? WITH_PERIODIC_Y : WITH_PERIODIC_Z;
    preal cells =
        (x - grid_real[level * GRID_REALS + axis]) * grid_real[level * GRID_REALS + 3 + axis];
    if (periodic) {
        preal turns = floor(cells / (preal)n);
        cells -= turns * (preal)n;
    }
    return grid_clamp(cells, n);
}

LAW int grid_cell(pvec3 x, int level, __global const preal *grid_real, __global const int *grid_int)
{
    __global const int *n = grid_int + level * GRID_INTS;
    int cx = grid_axis(x.x, 0, level, grid_real, grid_int),
        cy = grid_axis(x.y, 1, level, grid_real, grid_int),
        cz = grid_axis(x.z, 2, level, grid_real, grid_int);
    return n[3] + (cz * n[1] + cy) * n[0] + cx;
}

/* Cells of one axis that reach from x - r to x + r: *first and how many. Periodic axes may run past
 * n; take the remainder. */
LAW int grid_range(preal x, preal r, int axis, int level, __global const preal *grid_real,
    __global const int *grid_int, int *first)
{
    int n = grid_int[level * GRID_INTS + axis];
    int periodic = axis == 0 ? WITH_PERIODIC_X : axis == 1 ? WITH_PERIODIC_Y : WITH_PERIODIC_Z;
    preal per_metre = grid_real[level * GRID_REALS + 3 + axis];
    preal low = (x - r - grid_real[level * GRID_REALS + axis]) * per_metre,
          high = (x + r - grid_real[level * GRID_REALS + axis]) * per_metre;
    if (periodic) {
        preal turns = floor(low / (preal)n);
        int a, count;
        low -= turns * (preal)n;
        high -= turns * (preal)n;
        a = grid_clamp(low, n);
        count = (int)high - a + 1;
        *first = a;
        return count < n ? count : n;
    }
    *first = grid_clamp(low, n);
    return grid_clamp(high, n) - *first + 1;
}

#endif
