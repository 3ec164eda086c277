/* From neighbour rows to pairs, to the index lists of the gather, and the histories from the lists
 * before.
 *
 * A pair belongs to the row of its lower global id (up entries). Rows whose up entries are all
 * owned, of owned elements, make the interior pairs; the rest are boundary pairs and wait for the
 * ghosts. Boundary pairs begin at the next multiple of PAIR_ALIGN. */
#include "common/types.h"
#include "incidence.h"
#include "particle_words.h"
#include "remember.h"
#include "row_find.h"

/* split [n_all]: first up entry of the row; interior, boundary [n_all + 1]: up entries, one of both
 * 0; incidence [n_owned + 1]: length of the row in the gather's list. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void pair_count(int n_owned, int n_all,
    __global const long *gid, __global const int *row_begin, __global const int *row,
    __global const long *row_gid, __global int *split, __global int *interior,
    __global int *boundary, __global int *incidence)
{
    int e = get_global_id(0);
    if (e >= n_all) return;
    int begin = row_begin[e], end = row_begin[e + 1], up = first_above(row_gid, begin, end, gid[e]);
    int inside = e < n_owned;
    for (int k = up; k < end; k++)
        if (row[k] >= n_owned) inside = 0;
    split[e] = up;
    interior[e] = inside ? end - up : 0;
    boundary[e] = inside ? 0 : end - up;
    if (e < n_owned)
        incidence[e] = (end - begin + INCIDENCE_ALIGN - 1) / INCIDENCE_ALIGN * INCIDENCE_ALIGN;
}

/* interior, boundary: scanned. up_begin [n_all]; pair_i, pair_j [n_pair]. first_boundary: interior
 * pairs rounded up to PAIR_ALIGN. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void pair_fill(int n_all,
    int first_boundary, __global const int *row_begin, __global const int *row,
    __global const int *split, __global const int *interior, __global const int *boundary,
    __global int *up_begin, __global int *pair_i, __global int *pair_j)
{
    int e = get_global_id(0);
    if (e >= n_all) return;
    int n = row_begin[e + 1] - split[e], is_interior = interior[e + 1] > interior[e];
    int p = is_interior ? interior[e] : first_boundary + boundary[e];
    up_begin[e] = p;
    for (int k = 0; k < n; k++) {
        pair_i[p + k] = e;
        pair_j[p + k] = row[split[e] + k];
    }
}

/* incidence_begin [n_owned + 1] scanned; incidence: see incidence.h. A pair stands in the row of
 * its lower element. blank: the pair of force zero. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void pair_link(int n_owned, int blank,
    __global const long *gid, __global const int *row_begin, __global const int *row,
    __global const long *row_gid, __global const int *split, __global const int *up_begin,
    __global const int *incidence_begin, __global int *incidence)
{
    int e = get_global_id(0);
    if (e >= n_owned) return;
    int at = incidence_begin[e], end = incidence_begin[e + 1];
    for (int k = row_begin[e]; k < row_begin[e + 1]; k++) {
        int is_down = k < split[e], lower = is_down ? row[k] : e, place = k;
        if (is_down) place = find(row_gid, split[lower], row_begin[lower + 1], gid[e]);
        incidence[at++] = 2 * (up_begin[lower] + place - split[lower]) + is_down;
    }
    while (at < end) incidence[at++] = 2 * blank;
}

/* Histories. The owned end of each pair knows where it was in the old lists (old_index: its old
 * number, or n_old + its place among the arrivals, whose contacts came along in the arrival_
 * arrays); there the pair is found by the partner's global id. Pairs that are new keep the zeros
 * they were given. A history is kept in the orientation lower to higher id, so it needs no turning.
 * Pairs p < end; those from n_interior to first_boundary are none. width planes of real and one int
 * state per pair. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void pair_carry(int end, int n_interior,
    int first_boundary, int n_owned, int n_old, __global const long *gid,
    __global const int *pair_i, __global const int *pair_j, __global const int *old_index,
    __global const int *old_row_begin, __global const long *old_row_gid,
    __global const int *old_incidence_begin, __global const int *old_incidence,
    __global const int *arrival_begin, __global const long *arrival_gid,
    __global const int *arrival_state, __global const real *arrival_history, int width,
    int capacity, int old_capacity, int arrival_capacity, __global const int *old_state,
    __global const real *old_history, __global int *state, __global real *history)
{
    int p = get_global_id(0);
    if (p >= end || (p >= n_interior && p < first_boundary)) return;
    int i = pair_i[p], j = pair_j[p], own = i < n_owned ? i : j, old = old_index[own];
    long partner = gid[i + j - own];
    if (old < n_old) {
        int k = find(old_row_gid, old_row_begin[old], old_row_begin[old + 1], partner);
        if (k < 0) return;
        int q = old_incidence[old_incidence_begin[old] + k - old_row_begin[old]] >> 1;
        state[p] = old_state[q];
        for (int c = 0; c < width; c++)
            history[(size_t)c * capacity + p] = old_history[(size_t)c * old_capacity + q];
    } else {
        int a = old - n_old, k = find(arrival_gid, arrival_begin[a], arrival_begin[a + 1], partner);
        if (k < 0) return;
        state[p] = arrival_state[k];
        for (int c = 0; c < width; c++)
            history[(size_t)c * capacity + p] = arrival_history[(size_t)c * arrival_capacity + k];
    }
}

/* Contacts with a history of the elements that leave (index [n]): counted into begin, then written
 * in ascending partner id. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void pair_leave(int n, int fill,
    __global const int *index, __global const int *row_begin, __global const long *row_gid,
    __global const int *incidence_begin, __global const int *incidence, __global const int *state,
    __global const real *history, int width, int capacity, int leave_capacity, __global int *begin,
    __global long *leave_gid, __global int *leave_state, __global real *leave_history)
{
    int i = get_global_id(0);
    if (i >= n) return;
    int e = index[i], at = fill ? begin[i] : 0;
    for (int k = row_begin[e]; k < row_begin[e + 1]; k++) {
        int p = incidence[incidence_begin[e] + k - row_begin[e]] >> 1;
        if (!contact_remembers(state[p], history, width, capacity, p)) continue;
        if (fill) {
            leave_gid[at] = row_gid[k];
            leave_state[at] = state[p];
            for (int c = 0; c < width; c++)
                leave_history[(size_t)c * leave_capacity + at] = history[(size_t)c * capacity + p];
        }
        at++;
    }
    if (!fill) begin[i] = at;
}
