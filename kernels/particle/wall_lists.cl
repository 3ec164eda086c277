/* Wall candidates of each owned element: the primitives within reach, in ascending order; which
 * triangle contacts count; histories from the lists before.
 *
 * pose [n_wall][POSE_WIDTH] preal of the step: as particle_words.h says. room [n_wall]: how far the
 * wall may move until the next build [m], negative for walls that are not there. */
#include "element.h"
#include "remember.h"
#include "contact/law_fillet.h"
#include "contact/law_wall.h"
#include "wall_pose.h"

/* Whether the box b, low and high in the wall's frame, is farther from q than `far` along an
 * axis. */
LAW int wall_is_beyond(__global const preal *b, pvec3 q, preal far)
{
    return q.x < b[0] - far || q.y < b[1] - far || q.z < b[2] - far || q.x > b[3] + far ||
           q.y > b[4] + far || q.z > b[5] + far;
}

/* fill 0: begin[e] = number of candidates; fill 1: candidate (primitive) and owner element of each.
 * block_begin [n_block + 1]: primitives of the blocks, each of one wall; bounds [n_primitive][6],
 * block_bounds [n_block][6]: low and high in the wall's frame. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void wall_rows(int n_owned, int n_block,
    int fill, __global const preal *position, __global const preal *reach,
    __global const preal *primitive, __global const preal *bounds, __global const int *block_begin,
    __global const preal *block_bounds, __global const int *wall_of, __global const preal *pose,
    __global const preal *room, __global int *begin, __global int *candidate,
    __global int *candidate_element)
{
    int e = get_global_id(0);
    if (e >= n_owned) return;
    preal4 p = LOAD_POSITION(e);
    pvec3 x = XYZ(p);
    /* a triangle takes part in a valley a little beyond the radius */
    preal own = reach[e], valley = (FILLET_REACH - (preal)1) * p.s3;
    int at = fill ? begin[e] : 0;
    for (int b = 0; b < n_block; b++) {
        int w = wall_of[block_begin[b]];
        if (room[w] < 0) continue;
        pvec3 q = wall_to_reference(pose_frame(pose + w * POSE_WIDTH), x);
        preal most = own + room[w];
        if (wall_is_beyond(block_bounds + 6 * b, q, most + valley)) continue;
        for (int k = block_begin[b]; k < block_begin[b + 1]; k++) {
            preal far = primitive[12 * k + 11] == (preal)WALL_TRIANGLE ? most + valley : most;
            if (wall_is_beyond(bounds + 6 * k, q, far)) continue;
            if (!(wall_closest(WALL_PRIMITIVE(primitive, k), q).distance < far)) continue;
            if (fill) {
                candidate[at] = k;
                candidate_element[at] = e;
            }
            at++;
        }
    }
    if (!fill) begin[e] = at;
}

/* Histories, as pair_carry does it; arrival_begin etc. hold the wall contacts that came with
 * elements from other ranks. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void wall_carry(int n_owned, int n_old,
    __global const int *begin, __global const int *candidate, __global const int *old_index,
    __global const int *old_begin, __global const int *old_candidate,
    __global const int *arrival_begin, __global const int *arrival_candidate,
    __global const int *arrival_state, __global const real *arrival_history, int width,
    int capacity, int old_capacity, int arrival_capacity, __global const int *old_state,
    __global const real *old_history, __global int *state, __global real *history)
{
    int e = get_global_id(0);
    if (e >= n_owned) return;
    int old = old_index[e], came = old >= n_old;
    int a = came ? old - n_old : old;
    int q = came ? arrival_begin[a] : old_begin[a],
        q_end = came ? arrival_begin[a + 1] : old_begin[a + 1];
    for (int k = begin[e]; k < begin[e + 1]; k++) {
        while (q < q_end && (came ? arrival_candidate[q] : old_candidate[q]) < candidate[k]) q++;
        if (q >= q_end || (came ? arrival_candidate[q] : old_candidate[q]) != candidate[k])
            continue;
        state[k] = came ? arrival_state[q] : old_state[q];
        for (int c = 0; c < width; c++)
            history[(size_t)c * capacity + k] =
                came ? arrival_history[(size_t)c * arrival_capacity + q]
                     : old_history[(size_t)c * old_capacity + q];
    }
}

/* Wall contacts with a history of the elements that leave (index [n]), ascending. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void wall_leave(int n, int fill,
    __global const int *index, __global const int *wall_begin, __global const int *candidate,
    __global const int *state, __global const real *history, int width, int capacity,
    int leave_capacity, __global int *begin, __global int *leave_candidate,
    __global int *leave_state, __global real *leave_history)
{
    int i = get_global_id(0);
    if (i >= n) return;
    int e = index[i], at = fill ? begin[i] : 0;
    for (int k = wall_begin[e]; k < wall_begin[e + 1]; k++) {
        if (!contact_remembers(state[k], history, width, capacity, k)) continue;
        if (fill) {
            leave_candidate[at] = candidate[k];
            leave_state[at] = state[k];
            for (int c = 0; c < width; c++)
                leave_history[(size_t)c * leave_capacity + at] = history[(size_t)c * capacity + k];
        }
        at++;
    }
    if (!fill) begin[i] = at;
}

/* The poses of one step out of a batch; n numbers from `first` on. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void pose_copy(
    int n, int first, __global const preal *batch, __global preal *pose)
{
    int i = get_global_id(0);
    if (i < n) pose[i] = batch[first + i];
}
