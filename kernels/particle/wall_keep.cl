/* Meshes only: of the triangles near an element, which are contacts, and the passing on of friction
 * from one triangle to the next (law_wall.h). One work-item per element, because the candidates of
 * one element decide about each other.
 *
 * lint: WITH_TRIANGLE requires WITH_WALLS */
#include "element.h"
#include "contact/law_wall.h"
#include "wall_pose.h"
#include "contact/contact_memory.h"

#define CLOSEST(k)                                                                                 \
    wall_closest_moved(WALL_PRIMITIVE(primitive, candidate[k]),                                    \
        pose_frame(pose + wall_of[candidate[k]] * POSE_WIDTH), x)
#define FEATURES(k) WALL_FEATURES(features, candidate[k])

/* keep [n_candidate]: 1 unless hidden by, or the same point as, another triangle of the same
 * wall. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void wall_keep(int n_owned,
    __global const preal *position, __global const int *begin, __global const int *candidate,
    __global const preal *primitive, __global const int *features, __global const int *wall_of,
    __global const preal *pose,
#if WITH_HISTORY
    int capacity, __global int *state, __global real *history,
#endif
    __global int *keep)
{
    int e = get_global_id(0);
    if (e >= n_owned) return;
    preal4 p = LOAD_POSITION(e);
    pvec3 x = XYZ(p);
    preal radius = p.s3;
    int first = begin[e], end = begin[e + 1];
    for (int t = first; t < end; t++) {
        int count = 1;
        if (primitive[12 * candidate[t] + 11] == (preal)WALL_TRIANGLE) {
            struct wall_closest c = CLOSEST(t);
            struct wall_features f = FEATURES(t);
            if (c.distance < radius * (preal)1.5)
                for (int s = first; s < end && count; s++) {
                    if (s == t || wall_of[candidate[s]] != wall_of[candidate[t]]) continue;
                    struct wall_closest d = CLOSEST(s);
                    if (wall_hides(d, FEATURES(s), c, f, radius)) count = 0;
                    if (s < t && keep[s] && wall_coincides(d, c, radius)) count = 0;
                }
        }
        keep[t] = count;
    }
#if WITH_HISTORY
    for (int t = first; t < end; t++) {
        if (state[t] != 0 || !keep[t] || primitive[12 * candidate[t] + 11] != (preal)WALL_TRIANGLE)
            continue;
        struct wall_closest c = CLOSEST(t);
        if (!(c.distance < radius)) continue;
        int giver = -1;
        preal best = 0;
        for (int s = first; s < end; s++) {
            if (s == t || state[s] == 0 || wall_of[candidate[s]] != wall_of[candidate[t]]) continue;
            struct wall_closest d = CLOSEST(s);
            int ended = !keep[s] || !(d.distance < radius);
            preal cosine = p3_dot(d.n, c.n);
            if (wall_hands_over(ended, 1, wall_is_neighbour(FEATURES(s), FEATURES(t)),
                    v3_of_p3(d.n), v3_of_p3(c.n)) &&
                cosine > best) {
                best = cosine;
                giver = s;
            }
        }
        if (giver < 0) continue;
        state[t] = state[giver];
        state[giver] = 0;
        for (int c2 = 0; c2 < HISTORY_WIDTH; c2++) {
            history[(size_t)c2 * capacity + t] = history[(size_t)c2 * capacity + giver];
            history[(size_t)c2 * capacity + giver] = 0;
        }
    }
#endif
}
