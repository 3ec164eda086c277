/* Pairs that a border cuts, each computed on one of its two ranks: on which, where they are then in
 * the list, and what travels in what order.
 *
 * With B(i) the rank of element i and L(i, P) the number of its neighbours on rank P, a pair (i,
 * j), i the lower id, is computed on B(i) if L(i, B(j)) <= L(j, B(i)), else on B(j): the end with
 * more neighbours on the other side is the one whose state travels. (Rule of the parallel solver
 * Iris, National Taiwan University.) The row of a ghost lists all owned elements that it may touch,
 * so both ranks know both numbers and decide alike.
 *
 * Ghosts lie behind the n_owned elements in segments, one per rank that sends some: those of
 * segment s are segment[s] <= ghost < segment[s + 1], counted from the first ghost. Boundary pairs
 * are first <= p < first + n; those computed here come first, then those computed elsewhere. */
#include "common/types.h"
#include "row_find.h"

/* The s with segment[s] <= at < segment[s + 1]. */
LAW int segment_of(__global const int *segment, int n_segment, int at)
{
    int low = 0;
    for (int high = n_segment; high - low > 1;) {
        int middle = low + (high - low) / 2;
        if (segment[middle] <= at) low = middle;
        else high = middle;
    }
    return low;
}

/* Of boundary pair first + k: theirs [n + 1] whether it is computed elsewhere; copy [n] both
 * elements. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void assign_rule(int n, int first,
    int n_owned, int n_segment, __global const int *segment, __global const int *row_begin,
    __global const int *row, __global const int *pair_i, __global const int *pair_j,
    __global int2 *copy, __global int *theirs)
{
    int k = get_global_id(0);
    if (k >= n) return;
    int i = pair_i[first + k], j = pair_j[first + k], own = min(i, j), ghost = max(i, j),
        is_theirs = 0;
    if (ghost >= n_owned) {
        int s = segment_of(segment, n_segment, ghost - n_owned), low = n_owned + segment[s],
            high = n_owned + segment[s + 1];
        /* L(own, that rank), L(ghost, this rank) */
        int n_there = 0, n_here = row_begin[ghost + 1] - row_begin[ghost];
        for (int m = row_begin[own]; m < row_begin[own + 1]; m++)
            n_there += row[m] >= low && row[m] < high;
        is_theirs = i == own ? n_there > n_here : n_here <= n_there;
    }
    copy[k] = (int2)(i, j);
    theirs[k] = is_theirs;
}

/* theirs: scanned. place [n]: new place of pair first + k. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void assign_place(int n, int first,
    int n_mine, __global const int *theirs, __global const int2 *copy, __global int *place,
    __global int *pair_i, __global int *pair_j)
{
    int k = get_global_id(0);
    if (k >= n) return;
    int before = theirs[k],
        p = theirs[k + 1] > before ? first + n_mine + before : first + k - before;
    place[k] = p;
    pair_i[p] = copy[k].s0;
    pair_j[p] = copy[k].s1;
}

/* The gather's list (incidence.h) with the new places. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void assign_link(
    int n_incidence, int n, int first, __global const int *place, __global int *incidence)
{
    int k = get_global_id(0);
    if (k >= n_incidence) return;
    int p = incidence[k] >> 1;
    if (p >= first && p < first + n) incidence[k] = 2 * place[p - first] + (incidence[k] & 1);
}

/* The pairs whose results travel, in an order that both ranks know: by the elements of the rank
 * that receives, as it sends them as ghosts, and within each by the id of the partner. There they
 * are element [n_element] with is_theirs 1, in segments of `segment` by rank, the partners of
 * segment s being ghosts with.s0 <= ghost < with.s1, with = range[s]; on the rank that computes
 * they are ghosts, in one segment, with owned partners. fill 0: counted into begin; fill 1: begin
 * [n_element + 1] from the scan, places of pairs into `list`. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void assign_list(int n_element, int fill,
    int n_owned, int first_theirs, int is_theirs, int n_segment, __global const int *segment,
    __global const int2 *range, __global const int *element, __global const long *gid,
    __global const int *row_begin, __global const int *row, __global const long *row_gid,
    __global const int *incidence_begin, __global const int *incidence, __global int *begin,
    __global int *list)
{
    int k = get_global_id(0);
    if (k >= n_element) return;
    int e = element[k], at = fill ? begin[k] : 0;
    int2 with = range[segment_of(segment, n_segment, k)];
    for (int m = row_begin[e]; m < row_begin[e + 1]; m++) {
        int other = row[m], own = e < n_owned ? e : other;
        if (other < with.s0 || other >= with.s1) continue;
        int at_own =
            find(row_gid, row_begin[own], row_begin[own + 1], e < n_owned ? row_gid[m] : gid[e]) -
            row_begin[own];
        int p = incidence[incidence_begin[own] + at_own] >> 1;
        if ((p >= first_theirs) != is_theirs) continue;
        if (fill) list[at] = p;
        at++;
    }
    if (!fill) begin[k] = at;
}

/* begin [n + 1] scanned; used [n + 1]: whether element k has a pair in the list. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void assign_use(
    int n, __global const int *begin, __global int *used)
{
    int k = get_global_id(0);
    if (k < n) used[k] = begin[k + 1] > begin[k];
}

/* used: scanned. list: the elements that are used. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void assign_pick(
    int n, __global const int *used, __global const int *element, __global int *list)
{
    int k = get_global_id(0);
    if (k < n && used[k + 1] > used[k]) list[used[k]] = element[k];
}

/* Between planes [width][capacity] of numbers of `words` 4-byte words and records [n][width] of
 * them: record i is that of place index[i]. (Records are one plane of long numbers.) is_pack: from
 * planes to records, else back. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void assign_move(int n, int is_pack,
    int width, int words, int capacity, __global const int *index, __global uint *plane,
    __global uint *record)
{
    int i = get_global_id(0);
    if (i >= n) return;
    for (int c = 0; c < width; c++) {
        __global uint *there = plane + ((size_t)c * capacity + index[i]) * words,
                      *here = record + ((size_t)i * width + c) * words;
        for (int w = 0; w < words; w++) {
            if (is_pack) here[w] = there[w];
            else there[w] = here[w];
        }
    }
}
