/* The time step that the contacts of now allow: bound of law_limit.h for each owned element,
 * smallest of all.
 *
 * Rare: once per list build. Built with the features of pairs and walls together; materials come as
 * rows for any two, pairs and walls alike. Sums run in ascending global id and then by primitive,
 * so an element's bound has the same bits on any rank.
 *
 * lint: some of WITH_LINEAR WITH_HERTZ
 * lint: WITH_TANGENTIAL_DAMPING requires WITH_TANGENTIAL
 * lint: WITH_TRIANGLE requires WITH_WALLS
 * lint: WITH_JOINED requires WITH_WALLS
 * lint: WITH_MATERIALS requires WITH_SPIN */
#include "limit_element.h"
#include "contact/law_wall.h"
#include "wall_near.h"
#include "wall_pose.h"
#include "contact/contact_memory.h"
#include "contact/law_limit.h"

#define GROUP 64

/* D: from the centre to the partner's centre. */
LAW struct limit_sums limit_add_pair(struct limit_sums s, struct limit_element a,
    struct limit_element b, pvec3 D, struct contact_material c, real dt, real share)
{
    struct limit_ends ends;
    preal square = p3_dot(D, D), sum = (preal)a.r + (preal)b.r;
    preal distance = p_sqrt(square);
    real delta = (real)(sum - distance),
         inverse = distance > 0 ? (real)1 / (real)distance : (real)0;
    vec3 n = distance > 0 ? v3_scale(inverse, v3_of_p3(D)) : v3(1, 0, 0);
    ends.w_i = a.w;
    ends.w_j = WITH_SIZES ? b.w : a.w; /* what is the same for all contacts leaves the loop */
    ends.r_i = a.r;
    ends.r_j = WITH_SIZES ? b.r : a.r;
    if (!normal_acts(c, limit_r_star(ends), delta)) return s;
    return limit_sums_add(
        s, limit_contact_of(c, ends, delta, v3_dot(v3_sub(a.v, b.v), n), dt), ends, n, share);
}

#if WITH_WALLS
LAW struct limit_sums limit_add_wall(struct limit_sums s, struct limit_element a,
    struct wall_primitive w, struct fillet_plane other, __global const preal *pose,
    struct contact_material c, real dt, real share)
{
    struct limit_ends ends;
    struct wall_closest k;
    vec3 v = a.v, n;
    real delta;
#if WITH_MOVING
    k = wall_closest_moved(w, pose_frame(pose), a.x);
    v = v3_sub(v, wall_velocity(v3((real)pose[12], (real)pose[13], (real)pose[14]),
                      v3((real)pose[15], (real)pose[16], (real)pose[17]),
                      v3_of_p3(p3_sub(p3_add(a.x, k.D), p3(pose[18], pose[19], pose[20])))));
#else
    (void)pose;
    k = wall_closest(w, a.x);
#endif
    struct fillet_plane met =
        fillet_of(fillet_plane(k.n, k.distance, other.room), other, (preal)a.r);
    n = v3_of_p3(met.n);
    delta = (real)((preal)a.r - met.distance);
    ends.w_i = a.w;
    ends.r_i = a.r;
    ends.w_j = ends.r_j = 0;
    if (!normal_acts(c, limit_r_star(ends), delta)) return s;
    return limit_sums_add(s, limit_contact_of(c, ends, delta, v3_dot(v, n), dt), ends, n, share);
}
#endif

/* The smaller step, then the smaller id. */
LAW int limit_is_before(real dt, long id, real other_dt, long other_id)
{
    return dt < other_dt || (!(other_dt < dt) && id < other_id);
}

/* partial [n_group] the smallest bound of the elements that a group strides over, LIMIT_NONE
 * without any contact, and its element's global id. table [n_material][n_material][MATERIAL_WIDTH];
 * kind: the material of all elements where there is one; dt, share: see law_limit.h. */
__kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void step_limit(int n_owned,
    int n_group, int n_material, int kind, real dt, real share, __global const preal *position,
    __global const real *motion, __global const long *gid, __global const int *row_begin,
    __global const int *row,
#if WITH_PERIODIC
    preal period_x, preal period_y, preal period_z,
#endif
#if WITH_WALLS
    __global const int *wall_begin, __global const int *candidate, __global const preal *primitive,
    __global const int *wall_of, __global const int *wall_material, __global const preal *pose,
#endif
#if WITH_JOINED
    __global const real *keep, __global const int *partner, __global const preal *near,
#endif
    __global const real *table, __global real *partial, __global long *partial_gid)
{
    __local real best_dt[GROUP];
    __local long best_id[GROUP];
    int l = get_local_id(0), g = get_group_id(0);
    real least = LIMIT_NONE;
    long who = -1;
#if !WITH_PERIODIC
    const preal period_x = 0, period_y = 0, period_z = 0;
#endif
    for (int e = g * GROUP + l; e < n_owned && g < n_group; e += n_group * GROUP) {
        struct limit_element a = limit_element_load(position, motion, e, kind);
        struct limit_sums s = limit_sums_zero();
        for (int k = row_begin[e]; k < row_begin[e + 1]; k++) {
            struct limit_element b = limit_element_load(position, motion, row[k], kind);
            pvec3 D = nearest_images(p3_sub(b.x, a.x), period_x, period_y, period_z);
            s = limit_add_pair(s, a, b, D,
                material_load(table + MATERIAL_WIDTH * (a.kind * n_material + b.kind)), dt, share);
        }
#if WITH_WALLS
        for (int k = wall_begin[e]; k < wall_begin[e + 1]; k++) {
            int p = candidate[k], w = wall_of[p];
#if WITH_JOINED
            if (!(keep[k] > 0)) continue;
            struct fillet_plane other = wall_partner(near, partner[k]);
            other.room = r_min(other.room, wall_plane(near, k).room);
#else
            struct fillet_plane other = fillet_plane(p3(0, 0, 1), WALL_FAR, 0);
#endif
            s = limit_add_wall(s, a, WALL_PRIMITIVE(primitive, p), other, pose + w * POSE_WIDTH,
                material_load(table + MATERIAL_WIDTH * (a.kind * n_material + wall_material[w])),
                dt, share);
        }
#endif
        real bound = limit_of_sums(s, least);
        if (bound < LIMIT_NONE * LIMIT_ROUNDING &&
            (who < 0 || limit_is_before(bound, gid[e], least, who))) {
            least = bound;
            who = gid[e];
        }
    }
    best_dt[l] = least;
    best_id[l] = who;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (l == 0 && g < n_group) {
        for (int m = 1; m < GROUP; m++)
            if (best_id[m] >= 0 &&
                (who < 0 || limit_is_before(best_dt[m], best_id[m], least, who))) {
                least = best_dt[m];
                who = best_id[m];
            }
        partial[g] = least;
        partial_gid[g] = who;
    }
}
