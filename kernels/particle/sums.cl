/* Sums over elements and contacts for the account of energy and momentum, in integers (sums.h), so
 * that their order does not matter.
 *
 * lint: WITH_SUMS needs fp64 */
#include "element.h"
#include "contact/ledger.h"
#include "common/sums_group.h"

#if WITH_SUMS
/* SUMS_ELEMENT sums over owned elements. origin: where gravity's potential is zero. */
__kernel __attribute__((reqd_work_group_size(SUMS_GROUP, 1, 1))) void sums_elements(int n,
    __global const preal *position, __global const real *motion, double gravity_x, double gravity_y,
    double gravity_z, double origin_x, double origin_y, double origin_z, __global long *partial)
{
    __local long part[SUMS_ELEMENT * SUMS_WIDTH * SUMS_GROUP];
    struct sum sum[SUMS_ELEMENT];
    double gravity[3] = {gravity_x, gravity_y, gravity_z},
           origin[3] = {origin_x, origin_y, origin_z}, term[SUMS_ELEMENT];
    for (int k = 0; k < SUMS_ELEMENT; k++) sum[k] = sums_zero();
    for (int i = SUMS_FIRST; i < n; i += SUMS_STRIDE) {
        preal4 x = LOAD_POSITION(i);
        real4 v = LOAD_VELOCITY(i), w = (real4)(0);
        struct sums_element e;
#if WITH_SPIN
        w = LOAD_SPIN(i);
#endif
        e.x[0] = (double)x.s0;
        e.x[1] = (double)x.s1;
        e.x[2] = (double)x.s2;
        e.v[0] = (double)v.s0;
        e.v[1] = (double)v.s1;
        e.v[2] = (double)v.s2;
        e.w[0] = (double)w.s0;
        e.w[1] = (double)w.s1;
        e.w[2] = (double)w.s2;
        e.radius = (double)x.s3;
        e.mass = 1.0 / (double)v.s3;
        sums_element(e, gravity, origin, term);
        for (int k = 0; k < SUMS_ELEMENT; k++) sums_add(&sum[k], term[k]);
    }
    for (int k = 0; k < SUMS_ELEMENT; k++) sums_put(part, k, sum[k]);
    barrier(CLK_LOCAL_MEM_FENCE);
    sums_finish(part, SUMS_ELEMENT, partial);
}

/* LEDGER_WIDTH sums over contacts; all but the elastic energy begin anew afterwards. The n contacts
 * are 0 <= p < n_first, and those from `second` on. element [capacity]: contacts count where this
 * is below n_lower. */
__kernel __attribute__((reqd_work_group_size(SUMS_GROUP, 1, 1))) void sums_ledger(int n,
    int n_first, int second, int n_lower, int capacity, __global const int *element,
    __global double *ledger, __global long *partial)
{
    __local long part[LEDGER_WIDTH * SUMS_WIDTH * SUMS_GROUP];
    struct sum sum[LEDGER_WIDTH];
    for (int k = 0; k < LEDGER_WIDTH; k++) sum[k] = sums_zero();
    for (int i = SUMS_FIRST; i < n; i += SUMS_STRIDE) {
        int p = i < n_first ? i : i - n_first + second;
        if (element[p] >= n_lower) continue;
        for (int k = 0; k < LEDGER_WIDTH; k++) {
            size_t at = (size_t)k * capacity + p;
            sums_add(&sum[k], ledger[at]);
            if (k != LEDGER_ELASTIC) ledger[at] = 0.0;
        }
    }
    for (int k = 0; k < LEDGER_WIDTH; k++) sums_put(part, k, sum[k]);
    barrier(CLK_LOCAL_MEM_FENCE);
    sums_finish(part, LEDGER_WIDTH, partial);
}

LAW int sums_found(__global const long *sorted, int n, long key)
{
    int low = 0;
    while (n > 0) {
        int half_n = n / 2;
        int right = sorted[low + half_n] < key;
        low = right ? low + half_n + 1 : low;
        n = right ? n - half_n - 1 : half_n;
    }
    return low;
}

/* Elastic energy in contacts of elements that are gone: gone [n_gone] their ids, ascending.
 * element, partner: numbers into gid. The rest as above. */
__kernel __attribute__((reqd_work_group_size(SUMS_GROUP, 1, 1))) void sums_gone(int n, int n_first,
    int second, int n_lower, int capacity, __global const int *element, __global const int *partner,
    __global const long *gid, int n_gone, __global const long *gone, __global const double *ledger,
    __global long *partial)
{
    __local long part[SUMS_WIDTH * SUMS_GROUP];
    struct sum sum = sums_zero();
    for (int i = SUMS_FIRST; i < n; i += SUMS_STRIDE) {
        int p = i < n_first ? i : i - n_first + second, e = element[p];
        if (e >= n_lower) continue;
        long a = gid[e], b = gid[partner[p]];
        int at_a = sums_found(gone, n_gone, a), at_b = sums_found(gone, n_gone, b);
        if ((at_a < n_gone && gone[at_a] == a) || (at_b < n_gone && gone[at_b] == b))
            sums_add(&sum, ledger[(size_t)LEDGER_ELASTIC * capacity + p]);
    }
    sums_put(part, 0, sum);
    barrier(CLK_LOCAL_MEM_FENCE);
    sums_finish(part, 1, partial);
}

/* Elastic energy in contacts with walls that are gone (gone_wall [walls] not 0), which holds none
 * afterwards. */
__kernel __attribute__((reqd_work_group_size(SUMS_GROUP, 1, 1))) void sums_gone_walls(int n,
    int capacity, __global const int *candidate, __global const int *wall_of,
    __global const int *gone_wall, __global double *ledger, __global long *partial)
{
    __local long part[SUMS_WIDTH * SUMS_GROUP];
    struct sum sum = sums_zero();
    for (int p = SUMS_FIRST; p < n; p += SUMS_STRIDE) {
        size_t at = (size_t)LEDGER_ELASTIC * capacity + p;
        if (!gone_wall[wall_of[candidate[p]]]) continue;
        sums_add(&sum, ledger[at]);
        ledger[at] = 0.0;
    }
    sums_put(part, 0, sum);
    barrier(CLK_LOCAL_MEM_FENCE);
    sums_finish(part, 1, partial);
}
#endif
