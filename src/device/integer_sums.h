/* Sums of kernels/common/sums.h on the host: what a kernel's groups have added up, over all ranks,
 * as doubles with the same bits however many there are. */
#ifndef DEMOCLES_INTEGER_SUMS_H
#define DEMOCLES_INTEGER_SUMS_H

#include "kernels/common/sums.h"
#include "launch.h"

/* a += sign b */
void integer_sums_add(struct sum *a, struct sum b, int sign);
/* Carries: 0 <= lo, mid < 2^30, so that integers stay small however often sums are added to
 * sums. */
void integer_sums_carry(struct sum *s);
/* Runs a kernel that leaves partial [SUMS_GROUPS][n_sum][SUMS_WIDTH] and adds its sums to `sum`
 * [n_sum]. */
void integer_sums_run(
    struct launch *launch, const struct buffer *partial, int n_sum, struct sum *sum);
/* The sums of all ranks as doubles [n], NaN if some term could not be added. Collective. */
void integer_sums_all(const struct comm *comm, const struct sum *sum, int n, double *value);

#endif
