/* Who belongs where: owner of each element by the tree of cuts, elements outside the domain, ghosts
 * for a neighbour, bounds, and the room to move. */
#include "element.h"
#include "particle_words.h"

/* Wraps periodic coordinates into [low, low + period), in place, and finds the owner: tree of cuts
 * as in partition.h (nodes: axis, left, right). Outside the domain (remove 1): owner -1. stay [n]:
 * 1 where the owner is this rank; leave [n + 1]: 0 where it is. */
__kernel __attribute__((reqd_work_group_size(SELECT_GROUP, 1, 1))) void select_owner(int n,
    int rank, int n_node, int remove, __global preal *position, __global const int *node,
    __global const preal *cut,
#if WITH_PERIODIC
    preal period_x, preal period_y, preal period_z,
#endif
    __global const preal *domain, __global int *owner, __global int *stay, __global int *leave)
{
    int e = get_global_id(0);
    if (e >= n) return;
    preal4 p = LOAD_POSITION(e);
    preal x[3];
    x[0] = p.s0;
    x[1] = p.s1;
    x[2] = p.s2;
#if WITH_PERIODIC
    const preal period[3] = {period_x, period_y, period_z};
    for (int a = 0; a < 3; a++) {
        if (period[a] <= 0) continue;
        if (x[a] < domain[a]) x[a] += period[a];
        if (x[a] >= domain[3 + a]) x[a] -= period[a];
    }
    STORE_POSITION(e, (preal4)(x[0], x[1], x[2], p.s3));
#endif
    int to = n_node > 0 ? 0 : -1;
    while (to >= 0) {
        __global const int *k = node + 3 * to;
        to = x[k[0]] < cut[to] ? k[1] : k[2];
    }
    to = n_node > 0 ? -1 - to : 0;
    if (remove)
        for (int a = 0; a < 3; a++)
            if (x[a] < domain[a] || x[a] > domain[3 + a]) to = -1;
    owner[e] = to;
    stay[e] = to == rank;
    leave[e] = to != rank;
}

/* reference: place now, lane 3 the room to move, skin + horizon |v| [m]; reach: radius + room +
 * half the range of bonds. */
__kernel __attribute__((reqd_work_group_size(SELECT_GROUP, 1, 1))) void select_room(int n,
    __global const preal *position, __global const real *motion, real skin, real horizon,
    real bond_range, __global preal *reference, __global preal *reach)
{
    int e = get_global_id(0);
    if (e >= n) return;
    preal4 x = LOAD_POSITION(e);
    real4 v = LOAD_VELOCITY(e);
    real room = r_fma(horizon, r_sqrt(v.s0 * v.s0 + v.s1 * v.s1 + v.s2 * v.s2), skin);
    reach[e] = x.s3 + (preal)room + (preal)0.5 * (preal)bond_range;
    x.s3 = (preal)room;
    vstore4(x, e, reference);
}

/* The larger one; NaN wins, whichever it is, and stays. */
LAW preal select_worse(preal a, preal b) { return a > b || a != a ? a : b; }

/* Bounds of centres, smallest and largest reach, largest squared velocity: partial
 * [n_group][BOUNDS_WIDTH], each group strides over the elements. Minima are stored negated, so that
 * all are maxima. */
__kernel __attribute__((reqd_work_group_size(SELECT_GROUP, 1, 1))) void select_bounds(int n,
    int n_group, __global const preal *position, __global const real *motion,
    __global const preal *reach, __global preal *partial)
{
    __local preal loc[BOUNDS_WIDTH * SELECT_GROUP];
    int l = get_local_id(0), g = get_group_id(0);
    preal b[BOUNDS_WIDTH];
    for (int k = 0; k < BOUNDS_WIDTH; k++) b[k] = (preal)-1e30;
    for (int e = g * SELECT_GROUP + l; e < n && g < n_group; e += n_group * SELECT_GROUP) {
        preal4 x = LOAD_POSITION(e);
        real4 v = LOAD_VELOCITY(e);
        preal s = (preal)(v.s0 * v.s0 + v.s1 * v.s1 + v.s2 * v.s2), r = reach[e];
        b[0] = r_max(b[0], -x.s0);
        b[1] = r_max(b[1], -x.s1);
        b[2] = r_max(b[2], -x.s2);
        b[3] = r_max(b[3], x.s0);
        b[4] = r_max(b[4], x.s1);
        b[5] = r_max(b[5], x.s2);
        b[6] = r_max(b[6], -r);
        b[7] = r_max(b[7], r);
        /* NaN if anything is NaN or infinite */
        b[8] = select_worse(b[8], s + (s - s) + (x.s0 - x.s0) + (x.s1 - x.s1) + (x.s2 - x.s2));
    }
    for (int k = 0; k < BOUNDS_WIDTH; k++) loc[k * SELECT_GROUP + l] = b[k];
    barrier(CLK_LOCAL_MEM_FENCE);
    if (l == 0 && g < n_group)
        for (int k = 0; k < BOUNDS_WIDTH; k++) {
            preal best = loc[k * SELECT_GROUP];
            for (int m = 1; m < SELECT_GROUP; m++)
                best = select_worse(best, loc[k * SELECT_GROUP + m]);
            partial[g * BOUNDS_WIDTH + k] = best;
        }
}

/* Distance of x from the interval low..high, round a period (0: none) the shorter way. */
LAW preal select_gap(preal x, preal low, preal high, preal period)
{
    preal gap = r_max(r_max(low - x, x - high), (preal)0);
    preal up = r_max(x + period - high, (preal)0), down = r_max(low - (x - period), (preal)0);
    preal round = r_min(up, down);
    return period > 0 && round < gap ? round : gap;
}

/* Nodes that wait on the way through a tree of cuts: at most one per level, and a tree is as deep
 * as the logarithm of its leaves. */
#define SELECT_DEPTH 32

/* Whether the cube of half an edge r round x meets a leaf of the tree that belongs to `rank`. */
LAW int select_meets(const preal *x, preal r, int rank, int n_node, __global const int *node,
    __global const preal *cut)
{
    int waiting[SELECT_DEPTH], n = 0, to = n_node > 0 ? 0 : -1;
    for (;;) {
        while (to >= 0) {
            __global const int *k = node + 3 * to;
            preal y = x[k[0]], c = cut[to];
            if (y - r < c && y + r >= c && n < SELECT_DEPTH) waiting[n++] = k[2];
            to = y - r < c ? k[1] : k[2];
        }
        if (-1 - to == rank) return 1;
        if (n == 0) return 0;
        to = waiting[--n];
    }
}

/* The same of x and all its images whose cubes reach into the domain (low and high of each
 * axis). */
LAW int select_meets_image(pvec3 own, preal r, preal period_x, preal period_y, preal period_z,
    __global const preal *domain, int rank, int n_node, __global const int *node,
    __global const preal *cut)
{
    const preal centre[3] = {own.x, own.y, own.z}, period[3] = {period_x, period_y, period_z};
    for (int image = 0; image < 27; image++) {
        int shift[3] = {image % 3, image / 3 % 3, image / 9}, is_near = 1;
        preal x[3];
        for (int a = 0; a < 3; a++) {
            x[a] = centre[a] + (preal)(shift[a] == 2 ? -1 : shift[a]) * period[a];
            if (shift[a] != 0 &&
                (period[a] <= 0 || x[a] + r < domain[a] || x[a] - r > domain[3 + a]))
                is_near = 0;
        }
        if (is_near && select_meets(x, r, rank, n_node, node, cut)) return 1;
    }
    return 0;
}

/* Ghosts for one neighbour, `rank`: at [n + 1] = 1 where the element's reach comes within far_reach
 * of the box of the neighbour's centres and of a leaf that is the neighbour's. */
__kernel __attribute__((reqd_work_group_size(SELECT_GROUP, 1, 1))) void select_ghosts(int n,
    int rank, int n_node, __global const preal *position, __global const preal *reach,
    __global const int *node, __global const preal *cut, __global const preal *domain, preal low_x,
    preal low_y, preal low_z, preal high_x, preal high_y, preal high_z, preal far_reach,
#if WITH_PERIODIC
    preal period_x, preal period_y, preal period_z,
#endif
    __global int *at)
{
    int e = get_global_id(0);
    if (e >= n) return;
    preal4 x = LOAD_POSITION(e);
#if !WITH_PERIODIC
    const preal period_x = 0, period_y = 0, period_z = 0;
#endif
    pvec3 gap = p3(select_gap(x.s0, low_x, high_x, period_x),
        select_gap(x.s1, low_y, high_y, period_y), select_gap(x.s2, low_z, high_z, period_z));
    preal r = (reach[e] + far_reach) * (preal)1.0001;
    at[e] = p3_dot(gap, gap) < r * r && select_meets_image(XYZ(x), r, period_x, period_y, period_z,
                                            domain, rank, n_node, node, cut);
}
