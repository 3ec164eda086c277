/* Sorts elements into cells by counting: key and histogram, prefix sum (scan.cl), scatter. The
 * order inside a cell is left to chance; nobody may depend on it.
 *
 * Cells of several levels, because sizes may differ: level l has cells of edge h_l, and every
 * element on it has a listing reach of at most h_l/2. grid describes them: see grid.h. */
#include "element.h"
#include "grid.h"

/* key [n]: cell of each element; count [n_cell + 1] zeroed before. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void cell_count(int n, int n_level,
    __global const preal *position, __global const preal *reach, __global const preal *grid_real,
    __global const int *grid_int, __global int *key, volatile __global int *count)
{
    int e = get_global_id(0);
    if (e >= n) return;
    int cell = grid_cell(
        XYZ(LOAD_POSITION(e)), grid_level(reach[e], n_level, grid_real), grid_real, grid_int);
    key[e] = cell;
    atomic_inc(&count[cell]);
}

/* begin [n_cell + 1]: from the scan; cursor: a copy of it that is used up; member [n]. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void cell_fill(
    int n, __global const int *key, volatile __global int *cursor, __global int *member)
{
    int e = get_global_id(0);
    if (e >= n) return;
    member[atomic_inc(&cursor[key[e]])] = e;
}

/* Storage order of owned elements: cells of level 0 of a coarse grid; elements with keep 0 go to a
 * last cell of their own (number n_cell). */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void order_count(int n, int n_cell,
    __global const preal *position, __global const int *keep, __global const preal *grid_real,
    __global const int *grid_int, __global int *key, volatile __global int *count)
{
    int e = get_global_id(0);
    if (e >= n) return;
    int cell = keep[e] ? grid_cell(XYZ(LOAD_POSITION(e)), 0, grid_real, grid_int) : n_cell;
    key[e] = cell;
    atomic_inc(&count[cell]);
}
