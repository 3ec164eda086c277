/* Neighbour rows: for every element all elements whose listing reaches overlap its own, in
 * ascending global id.
 *
 * Owned elements list owned and ghost neighbours, ghosts list owned ones alone (a pair of two
 * ghosts is somebody else's). Reach: radius plus the room to move until the next build plus half
 * the range of bonds, so two elements without a common row entry cannot interact before. Called
 * twice, to count and to fill, so no row is ever too long.
 *
 * The test uses differences and sums that are the same bits from either side, so b is in a's row if
 * and only if a is in b's. */
#include "grid.h"

/* Longer rows are sorted by heap. */
#define ROW_INSERTION 48

LAW int row_holds(pvec3 xa, preal ra, pvec3 xb, preal rb, preal px, preal py, preal pz)
{
    pvec3 d = nearest_images(p3_sub(xb, xa), px, py, pz);
    preal r = ra + rb;
    return p3_dot(d, d) < r * r;
}

LAW void row_swap(__global int *row, __global long *gid, int a, int b)
{
    int r = row[a];
    long g = gid[a];
    row[a] = row[b];
    gid[a] = gid[b];
    row[b] = r;
    gid[b] = g;
}

LAW void row_sink(__global int *row, __global long *gid, int k, int n)
{
    for (;;) {
        int child = 2 * k + 1;
        if (child >= n) return;
        if (child + 1 < n && gid[child + 1] > gid[child]) child++;
        if (gid[k] >= gid[child]) return;
        row_swap(row, gid, k, child);
        k = child;
    }
}

LAW void row_sort(__global int *row, __global long *gid, int n)
{
    if (n <= ROW_INSERTION) {
        for (int a = 1; a < n; a++) {
            int r = row[a], b = a;
            long g = gid[a];
            for (; b > 0 && gid[b - 1] > g; b--) {
                row[b] = row[b - 1];
                gid[b] = gid[b - 1];
            }
            row[b] = r;
            gid[b] = g;
        }
        return;
    }
    for (int k = n / 2 - 1; k >= 0; k--) row_sink(row, gid, k, n);
    for (int k = n - 1; k > 0; k--) {
        row_swap(row, gid, 0, k);
        row_sink(row, gid, 0, k);
    }
}

/* Everything a search needs. */
struct row_search {
    pvec3 x;
    preal reach, period_x, period_y, period_z;
    int element, n_owned;
};

/* Visits the members first <= m < end and appends the neighbours among them; entries beyond `room`
 * are counted but not kept. Returns the count so far. */
LAW int row_visit(struct row_search s, int first, int end, int count, int room,
    __global const preal *position, __global const preal *reach, __global const int *member,
    __global int *out)
{
    for (int m = first; m < end; m++) {
        int b = member[m];
        if (b == s.element || (s.element >= s.n_owned && b >= s.n_owned)) continue;
        if (!row_holds(
                s.x, s.reach, XYZ(LOAD_POSITION(b)), reach[b], s.period_x, s.period_y, s.period_z))
            continue;
        if (count < room) out[count] = b;
        count++;
    }
    return count;
}

/* All cells of all levels that the reach overlaps. Cells of one line along x are neighbours in the
 * member list: one visit, two where it wraps. */
LAW int row_find(struct row_search s, int n_level, int room, __global const preal *position,
    __global const preal *reach, __global const preal *grid_real, __global const int *grid_int,
    __global const int *cell_begin, __global const int *member, __global int *out)
{
    int count = 0;
    for (int level = 0; level < n_level; level++) {
        __global const int *n = grid_int + level * GRID_INTS;
        preal far = (s.reach + grid_real[level * GRID_REALS + 6]) * (preal)1.0001;
        int ax, ay, az;
        int nx = grid_range(s.x.x, far, 0, level, grid_real, grid_int, &ax),
            ny = grid_range(s.x.y, far, 1, level, grid_real, grid_int, &ay),
            nz = grid_range(s.x.z, far, 2, level, grid_real, grid_int, &az);
        int over = ax + nx > n[0] ? ax + nx - n[0] : 0;
        for (int cz = az; cz < az + nz; cz++)
            for (int cy = ay; cy < ay + ny; cy++) {
                int line =
                    n[3] +
                    ((cz < n[2] ? cz : cz - n[2]) * n[1] + (cy < n[1] ? cy : cy - n[1])) * n[0];
                count = row_visit(s, cell_begin[line + ax], cell_begin[line + ax + nx - over],
                    count, room, position, reach, member, out);
                if (over > 0)
                    count = row_visit(s, cell_begin[line], cell_begin[line + over], count, room,
                        position, reach, member, out);
            }
    }
    return count;
}

/* fill 0: begin[e] = length of the row; the first ROW_FOUND entries stay in found
 * [n_all][ROW_FOUND], so that short rows are searched only once. fill 1: begin [n_all + 1] from the
 * scan; row and row_gid get the entries, sorted. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void rows(int n_owned, int n_all, int fill,
    int n_level, __global const preal *position, __global const preal *reach,
    __global const long *gid, __global const preal *grid_real, __global const int *grid_int,
    __global const int *cell_begin, __global const int *member,
#if WITH_PERIODIC
    preal period_x, preal period_y, preal period_z,
#endif
    __global int *found, __global int *begin, __global int *row, __global long *row_gid)
{
    int e = get_global_id(0);
    if (e >= n_all) return;
    struct row_search s;
    s.x = XYZ(LOAD_POSITION(e));
    s.reach = reach[e];
    s.element = e;
    s.n_owned = n_owned;
    s.period_x = s.period_y = s.period_z = 0;
#if WITH_PERIODIC
    s.period_x = period_x;
    s.period_y = period_y;
    s.period_z = period_z;
#endif
    __global int *mine = found + (size_t)e * ROW_FOUND;
    if (!fill) {
        begin[e] = row_find(
            s, n_level, ROW_FOUND, position, reach, grid_real, grid_int, cell_begin, member, mine);
        return;
    }
    int first = begin[e], n = begin[e + 1] - first;
    if (n <= ROW_FOUND)
        for (int k = 0; k < n; k++) row[first + k] = mine[k];
    else
        row_find(
            s, n_level, n, position, reach, grid_real, grid_int, cell_begin, member, row + first);
    for (int k = 0; k < n; k++) row_gid[first + k] = gid[row[first + k]];
    row_sort(row + first, row_gid + first, n);
}
