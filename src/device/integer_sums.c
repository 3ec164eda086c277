#include "integer_sums.h"

#include <math.h>
#include <stdlib.h>

#include "comm/fail.h"

void integer_sums_add(struct sum *a, struct sum b, int sign)
{
    a->hi += sign * b.hi;
    a->mid += sign * b.mid;
    a->lo += sign * b.lo;
    a->bad += b.bad;
}

/* Shifts of negative numbers round down. */
void integer_sums_carry(struct sum *s)
{
    int64_t from_lo = s->lo >> 30;
    s->lo -= from_lo * ((int64_t)1 << 30);
    s->mid += from_lo;
    int64_t from_mid = s->mid >> 30;
    s->mid -= from_mid * ((int64_t)1 << 30);
    s->hi += from_mid;
}

/* The nearest double but for the last bit; a function of the sum alone, not of how it lies in its
 * three integers. */
static double value_of(struct sum s)
{
    integer_sums_carry(&s);
    double sign = s.hi < 0 ? -1 : 1;
    if (s.hi < 0) { /* by magnitude: a small negative number would lose its digits against 2^-20 */
        s = (struct sum){-s.hi, -s.mid, -s.lo, s.bad};
        integer_sums_carry(&s);
    }
    double rest = ldexp((double)(s.mid * ((int64_t)1 << 30) + s.lo), -80);
    return s.bad ? (double)NAN : sign * (ldexp((double)s.hi, -20) + rest);
}

void integer_sums_run(
    struct launch *launch, const struct buffer *partial, int n_sum, struct sum *sum)
{
    size_t bytes = (size_t)(SUMS_GROUPS * n_sum * SUMS_WIDTH) * sizeof(int64_t);
    int64_t *part = fail_alloc(bytes);
    launch_run(launch, SUMS_GROUPS * SUMS_GROUP);
    buffer_read(partial, 0, bytes, part);
    for (int k = 0; k < n_sum; k++) {
        for (int g = 0; g < SUMS_GROUPS; g++) {
            const int64_t *p = part + (g * n_sum + k) * SUMS_WIDTH;
            integer_sums_add(&sum[k], (struct sum){p[0], p[1], p[2], p[3]}, 1);
        }
        integer_sums_carry(&sum[k]);
    }
    free(part);
}

void integer_sums_all(const struct comm *comm, const struct sum *sum, int n, double *value)
{
    int64_t(*all)[SUMS_WIDTH] = fail_alloc((size_t)n * sizeof *all);
    for (int k = 0; k < n; k++) {
        struct sum s = sum[k];
        integer_sums_carry(&s);
        const int64_t one[SUMS_WIDTH] = {s.hi, s.mid, s.lo, s.bad};
        for (int i = 0; i < SUMS_WIDTH; i++) all[k][i] = one[i];
    }
    comm_sum_i64(comm, all[0], n * SUMS_WIDTH);
    for (int k = 0; k < n; k++)
        value[k] = value_of((struct sum){all[k][0], all[k][1], all[k][2], all[k][3]});
    free(all);
}
