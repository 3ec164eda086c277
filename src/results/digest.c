#include "digest.h"

#include <stdio.h>
#include <string.h>

/* Takes one element's numbers of a part into h; reports whether one of them is NaN. */
static uint64_t add_part(uint64_t h, const struct digest_part *part, int64_t i, int *is_nan)
{
    for (int k = 0; k < part->width; k++) {
        int64_t at = i * part->stride + k;
        uint64_t bits;
        if (part->is_float) {
            float f = ((const float *)part->data)[at];
            uint32_t narrow;
            memcpy(&narrow, &f, sizeof narrow);
            bits = narrow;
            *is_nan |= f != f;
        } else {
            double d = ((const double *)part->data)[at];
            memcpy(&bits, &d, sizeof bits);
            *is_nan |= d != d;
        }
        h = digest_mix((h ^ bits) + DIGEST_G);
    }
    return h;
}

uint64_t digest_of_rank(
    const int64_t *gid, int64_t n, const struct digest_part *part, int n_part, int64_t *n_nan)
{
    uint64_t sum = 0;
    for (int64_t i = 0; i < n; i++) {
        uint64_t h = digest_mix((uint64_t)gid[i] + DIGEST_G);
        int is_nan = 0;
        for (int p = 0; p < n_part; p++) h = add_part(h, &part[p], i, &is_nan);
        sum += h;
        *n_nan += is_nan;
    }
    return sum;
}

int64_t digest_of_all(const struct comm *comm, const int64_t *gid, int64_t n,
    const struct digest_part *part, int n_part, uint64_t *digest)
{
    int64_t sum[2] = {0, 0}; /* digest, elements with NaN */
    uint64_t mine = digest_of_rank(gid, n, part, n_part, &sum[1]);
    /* two's complement: MPI's sum of int64 wraps modulo 2^64 as ours does */
    memcpy(&sum[0], &mine, sizeof mine);
    comm_sum_i64(comm, sum, 2);
    memcpy(digest, &sum[0], sizeof *digest);
    return sum[1];
}

char *digest_text(uint64_t digest, char text[17])
{
    snprintf(text, 17, "%016llx", (unsigned long long)digest);
    return text;
}
