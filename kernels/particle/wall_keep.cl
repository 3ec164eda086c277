/* Scenes with meshes, or with flat walls that are flush, only: of the primitives near an element,
 * which are contacts, how they act together, and the passing on of friction from one triangle to
 * the next (law_wall.h, law_fillet.h). One work-item per element, because the candidates of one
 * element decide about each other.
 *
 * near [n_candidate][NEAR_WIDTH]: unit vector to the closest point, the distance, the room of the
 * facet, and the distance in the valley [m]; partner [n_candidate]: the candidate with which it
 * forms a valley, -1 without one; keep [n_candidate]: share with which a contact acts, 0 where a
 * deeper one acts for it, -1 where it is no local minimum of the distance.
 *
 * lint: WITH_TRIANGLE requires WITH_WALLS
 * lint: WITH_JOINED requires WITH_WALLS */
#include "element.h"
#include "contact/contact_memory.h"
#include "wall_near.h"
#include "wall_pose.h"

/* Farther away, in radii, nothing takes part. */
#define IN_SIGHT ((preal)1.5)

/* One element and its candidates first <= k < end. */
struct wall_sight {
    __global const int *candidate, *features, *wall_of;
    __global const preal *primitive, *pose;
    __global preal *near;
    __global int *partner; /* the feature until all minima are known */
    __global real *keep;
    pvec3 x;
    preal radius;
    int first, end;
};

LAW struct wall_closest wall_seen(struct wall_sight w, int k, pvec3 x)
{
    int p = w.candidate[k];
    return wall_closest_moved(
        WALL_PRIMITIVE(w.primitive, p), pose_frame(w.pose + w.wall_of[p] * POSE_WIDTH), x);
}

/* The closest point, kept for the kernels after this one. */
LAW struct wall_closest wall_look(struct wall_sight w, int k)
{
    struct wall_closest c = wall_seen(w, k, w.x);
    int p = w.candidate[k];
    pvec3 q = wall_to_reference(pose_frame(w.pose + w.wall_of[p] * POSE_WIDTH), w.x);
    __global preal *row = w.near + (size_t)NEAR_WIDTH * k;
    row[0] = c.n.x;
    row[1] = c.n.y;
    row[2] = c.n.z;
    row[3] = c.distance;
    row[4] = wall_room(WALL_PRIMITIVE(w.primitive, p), q);
    return c;
}

LAW struct wall_features wall_features_of(struct wall_sight w, int k)
{
    return WALL_FEATURES(w.features, w.candidate[k]);
}

LAW int wall_kind(struct wall_sight w, int k)
{
    return (int)w.primitive[WALL_PRIMITIVE_WIDTH * w.candidate[k] + 11];
}

LAW int wall_is_same(struct wall_sight w, int s, int t)
{
    return w.wall_of[w.candidate[s]] == w.wall_of[w.candidate[t]];
}

LAW int wall_is_minimum(struct wall_sight w, int t)
{
    struct wall_closest c = wall_near(w.near, w.partner, t);
    pvec3 point = p3_add(w.x, c.D);
    preal size = r_max(r_max(fabs(point.x), fabs(point.y)), fabs(point.z));
    int kind = wall_kind(w, t);
    if (!(c.distance < w.radius * IN_SIGHT)) return 1;
    for (int s = w.first; s < w.end; s++) {
        if (s == t) continue;
        struct wall_closest d = wall_near(w.near, w.partner, s);
        if (wall_is_same(w, s, t)) {
            if (kind == WALL_TRIANGLE &&
                wall_hides(d, wall_features_of(w, s), c, wall_features_of(w, t), w.radius))
                return 0;
        } else if (c.feature != 0 && d.distance < c.distance - WALL_TIE * w.radius &&
                   wall_is_flush(wall_seen(w, s, point), size, w.radius)) {
            return 0;
        }
        if (s < t && wall_is_flat(kind) && wall_is_flat(wall_kind(w, s)) && w.keep[s] > 0 &&
            wall_coincides(d, c, w.radius))
            return 0;
    }
    return 1;
}

LAW int wall_may_join(struct wall_sight w, int t)
{
    return wall_kind(w, t) == WALL_TRIANGLE && w.keep[t] >= 0 &&
           wall_plane(w.near, t).distance < w.radius * IN_SIGHT;
}

/* Partner of a local minimum: who forms the deepest valley with it. */
LAW void wall_join(struct wall_sight w, int t)
{
    struct fillet_plane own = wall_plane(w.near, t);
    preal best = own.distance;
    int other = -1, joins = wall_may_join(w, t);
    for (int s = w.first; s < w.end && joins; s++) {
        if (s == t || w.keep[s] < 0 || !wall_is_same(w, s, t)) continue;
        struct fillet_plane valley = fillet_of(own, wall_plane(w.near, s), w.radius);
        if (valley.distance < best) {
            best = valley.distance;
            other = s;
        }
    }
    w.partner[t] = other;
    w.near[(size_t)NEAR_WIDTH * t + NEAR_VALLEY] = best;
}

/* Its share, when all valleys are known. */
LAW void wall_share(struct wall_sight w, int t)
{
    pvec3 n = wall_plane(w.near, t).n;
    preal share = 1;
    if (!wall_may_join(w, t)) return;
    for (int s = w.first; s < w.end; s++) {
        if (s == t || w.keep[s] < 0 || !wall_is_same(w, s, t)) continue;
        struct fillet_plane d = wall_plane(w.near, s);
        if (fillet_is_first(wall_valley(w.near, s), d.distance, s, wall_valley(w.near, t),
                wall_plane(w.near, t).distance, t))
            share *= (preal)1 - fillet_hides(p3_dot(n, d.n));
    }
    w.keep[t] = (real)share;
    if (share < (preal)1) w.partner[t] = -1;
}

#if WITH_HISTORY
/* Whose history goes to t, which has none; -1: nobody's. */
LAW int wall_giver(struct wall_sight w, __global const int *state, int t)
{
    int giver = -1;
    preal best = 0;
    struct wall_closest c = wall_near(w.near, w.partner, t);
    if (!wall_is_flat(wall_kind(w, t)) || !wall_acts(w.near, w.partner, w.keep, t, w.radius))
        return -1;
    for (int s = w.first; s < w.end; s++) {
        if (s == t || state[s] == 0 || !wall_is_flat(wall_kind(w, s)) ||
            wall_acts(w.near, w.partner, w.keep, s, w.radius))
            continue;
        struct wall_closest d = wall_near(w.near, w.partner, s);
        preal cosine = p3_dot(d.n, c.n);
        if (wall_hands_over(d, c, wall_is_same(w, s, t), w.radius) && cosine > best) {
            best = cosine;
            giver = s;
        }
    }
    return giver;
}
#endif

__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void wall_keep(int n_owned,
    __global const preal *position, __global const int *begin, __global const int *candidate,
    __global const preal *primitive, __global const int *features, __global const int *wall_of,
    __global const preal *pose,
#if WITH_HISTORY
    int capacity, __global int *state, __global real *history,
#endif
    __global preal *near, __global int *partner, __global real *keep)
{
    int e = get_global_id(0);
    if (e >= n_owned) return;
    preal4 p = LOAD_POSITION(e);
    struct wall_sight w = {candidate, features, wall_of, primitive, pose, near, partner, keep,
        XYZ(p), p.s3, begin[e], begin[e + 1]};
    for (int t = w.first; t < w.end; t++) partner[t] = wall_look(w, t).feature;
    for (int t = w.first; t < w.end; t++) keep[t] = wall_is_minimum(w, t) ? (real)1 : (real)-1;
    for (int t = w.first; t < w.end; t++) wall_join(w, t);
    for (int t = w.first; t < w.end; t++) wall_share(w, t);
#if WITH_HISTORY
    for (int t = w.first; t < w.end; t++) {
        int giver = state[t] == 0 ? wall_giver(w, state, t) : -1;
        if (giver < 0) continue;
        state[t] = state[giver];
        state[giver] = 0;
        for (int c = 0; c < HISTORY_WIDTH; c++) {
            history[(size_t)c * capacity + t] = history[(size_t)c * capacity + giver];
            history[(size_t)c * capacity + giver] = 0;
        }
    }
#endif
}
