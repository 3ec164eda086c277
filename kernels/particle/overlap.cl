/* What may go wrong unseen: the largest overlap of now, centres that have passed a wall since the
 * lists were built, and elements that have left the room that these gave them. Rare: once per list
 * build and per look at the limit of the time step. Work-items stride over elements, and of equal
 * overlaps the lower id counts, so the result does not depend on how many groups there are.
 *
 * lint: WITH_TRIANGLE requires WITH_WALLS
 * lint: WITH_MATERIALS requires WITH_SPIN */
#include "limit_element.h"
#include "contact/contact_memory.h"
#include "contact/law_passage.h"
#include "wall_pose.h"

#define OVERLAP_GROUP 64

/* An overlap over the radius of the smaller sphere, of element id; with: global id of the other
 * one, or -1 - wall. */
struct overlap_found {
    real share;
    long id, with;
};

LAW struct overlap_found overlap_larger(struct overlap_found a, struct overlap_found b)
{
    int is_b = b.share > a.share || (!(b.share < a.share) && b.id < a.id);
    a.share = is_b ? b.share : a.share;
    a.id = is_b ? b.id : a.id;
    a.with = is_b ? b.with : a.with;
    return a;
}

/* partial [n_group], partial_id [n_group][2]: the largest of the elements that a group strides
 * over, 0 where nothing overlaps. table: as step_limit has it; pairs without any stiffness do not
 * count. */
__kernel __attribute__((reqd_work_group_size(OVERLAP_GROUP, 1, 1))) void overlap(int n_owned,
    int n_group, int n_material, int kind, __global const preal *position,
    __global const real *motion, __global const long *gid, __global const int *row_begin,
    __global const int *row,
#if WITH_PERIODIC
    preal period_x, preal period_y, preal period_z,
#endif
#if WITH_WALLS
    __global const int *wall_begin, __global const int *candidate, __global const preal *primitive,
    __global const int *wall_of, __global const int *wall_material, __global const preal *pose,
#endif
    __global const real *table, __global real *partial, __global long *partial_id)
{
    __local struct overlap_found found[OVERLAP_GROUP];
    int l = get_local_id(0), g = get_group_id(0);
    struct overlap_found largest = {0, LONG_MAX, 0};
#if !WITH_PERIODIC
    const preal period_x = 0, period_y = 0, period_z = 0;
#endif
    for (int e = g * OVERLAP_GROUP + l; e < n_owned && g < n_group; e += n_group * OVERLAP_GROUP) {
        struct limit_element a = limit_element_load(position, motion, e, kind);
        for (int k = row_begin[e]; k < row_begin[e + 1]; k++) {
            struct limit_element b = limit_element_load(position, motion, row[k], kind);
            pvec3 D = nearest_images(p3_sub(b.x, a.x), period_x, period_y, period_z);
            preal sum = (preal)a.r + (preal)b.r, square = p3_dot(D, D);
            if (!(square < sum * sum)) continue;
            if (!(table[MATERIAL_WIDTH * (a.kind * n_material + b.kind) + MATERIAL_k_n] > 0))
                continue;
            struct overlap_found one = {
                (real)(sum - p_sqrt(square)) / r_min(a.r, b.r), gid[e], gid[row[k]]};
            largest = overlap_larger(largest, one);
        }
#if WITH_WALLS
        for (int k = wall_begin[e]; k < wall_begin[e + 1]; k++) {
            int p = candidate[k], w = wall_of[p];
            pvec3 q = wall_to_reference(pose_frame(pose + w * POSE_WIDTH), a.x);
            real depth =
                (real)((preal)a.r - wall_closest(WALL_PRIMITIVE(primitive, p), q).distance);
            if (!(depth > 0)) continue;
            if (!(table[MATERIAL_WIDTH * (a.kind * n_material + wall_material[w]) + MATERIAL_k_n] >
                    0))
                continue;
            struct overlap_found one = {depth / a.r, gid[e], -1 - w};
            largest = overlap_larger(largest, one);
        }
#endif
    }
    found[l] = largest;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (l == 0 && g < n_group) {
        for (int m = 1; m < OVERLAP_GROUP; m++) largest = overlap_larger(largest, found[m]);
        partial[g] = largest.share;
        partial_id[2 * g] = largest.id;
        partial_id[2 * g + 1] = largest.with;
    }
}

/* partial [n_group]: largest displacement since the lists were built over the room that they gave:
 * above 1, neighbours may be missing. reference: as in integrate.h. */
__kernel __attribute__((reqd_work_group_size(OVERLAP_GROUP, 1, 1))) void room_used(int n_owned,
    int n_group, __global const preal *position, __global const preal *reference,
    __global real *partial)
{
    __local real used[OVERLAP_GROUP];
    int l = get_local_id(0), g = get_group_id(0);
    real most = 0;
    for (int e = g * OVERLAP_GROUP + l; e < n_owned && g < n_group; e += n_group * OVERLAP_GROUP) {
        preal4 from = vload4(e, reference);
        pvec3 way = p3_sub(XYZ(LOAD_POSITION(e)), XYZ(from));
        most = r_max(most, (real)(p_sqrt(p3_dot(way, way)) / from.s3));
    }
    used[l] = most;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (l == 0 && g < n_group) {
        for (int m = 1; m < OVERLAP_GROUP; m++) most = r_max(most, used[m]);
        partial[g] = most;
    }
}

#if WITH_WALLS
/* partial_count [n_group]: elements that have passed a wall on their way from `reference`, where
 * they were at the last build, while the walls came from pose_built; partial_id [n_group][2]: the
 * lowest id among them, and the wall. */
__kernel __attribute__((reqd_work_group_size(OVERLAP_GROUP, 1, 1))) void passage(int n_owned,
    int n_group, __global const preal *position, __global const preal *reference,
    __global const long *gid, __global const int *wall_begin, __global const int *candidate,
    __global const preal *primitive, __global const int *wall_of, __global const preal *pose,
    __global const preal *pose_built, __global int *partial_count, __global long *partial_id)
{
    __local int count[OVERLAP_GROUP];
    __local long id[OVERLAP_GROUP], wall[OVERLAP_GROUP];
    int l = get_local_id(0), g = get_group_id(0);
    count[l] = 0;
    id[l] = LONG_MAX;
    wall[l] = 0;
    for (int e = g * OVERLAP_GROUP + l; e < n_owned && g < n_group; e += n_group * OVERLAP_GROUP) {
        pvec3 now = XYZ(LOAD_POSITION(e)), before = XYZ(vload4(e, reference));
        for (int k = wall_begin[e]; k < wall_begin[e + 1]; k++) {
            int p = candidate[k], w = wall_of[p];
            pvec3 q0 = wall_to_reference(pose_frame(pose_built + w * POSE_WIDTH), before),
                  q1 = wall_to_reference(pose_frame(pose + w * POSE_WIDTH), now);
            if (!wall_is_passed(WALL_PRIMITIVE(primitive, p), q0, q1)) continue;
            count[l]++;
            if (gid[e] < id[l]) {
                id[l] = gid[e];
                wall[l] = w;
            }
            break;
        }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    if (l == 0 && g < n_group) {
        for (int m = 1; m < OVERLAP_GROUP; m++) {
            count[0] += count[m];
            if (id[m] < id[0]) {
                id[0] = id[m];
                wall[0] = wall[m];
            }
        }
        partial_count[g] = count[0];
        partial_id[2 * g] = id[0];
        partial_id[2 * g + 1] = wall[0];
    }
}
#endif
