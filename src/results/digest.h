/* Digest of the state: 64 bits over id and bits of every element, independent of ranks, partition
 * and storage order.
 *
 * Sum modulo 2^64 over elements of h, where h starts as mix(gid + G) and takes each word b by h <-
 * mix((h xor b) + G). Words are the bits of the numbers as stored: a double's 64, a float's 32 zero
 * extended. For the state: x(3), v(3), q(w, x, y, z), angular velocity(3), in this order. */
#ifndef DEMOCLES_DIGEST_H
#define DEMOCLES_DIGEST_H

#include "comm/comm.h"

#define DIGEST_G UINT64_C(0x9e3779b97f4a7c15)

/* The finaliser of splitmix64. */
static inline uint64_t digest_mix(uint64_t z)
{
    z ^= z >> 30;
    z *= UINT64_C(0xbf58476d1ce4e5b9);
    z ^= z >> 27;
    z *= UINT64_C(0x94d049bb133111eb);
    z ^= z >> 31;
    return z;
}

/* `width` numbers of each element, from data[i * stride]: padded vectors and interleaved arrays are
 * read in place. */
struct digest_part {
    const void *data;
    int is_float;      /* float, else double */
    int width, stride; /* [numbers]; stride >= width */
};

/* Sum over the elements of this rank. `gid` [n]; `n_nan` is raised by the number of elements with a
 * NaN. */
uint64_t digest_of_rank(
    const int64_t *gid, int64_t n, const struct digest_part *part, int n_part, int64_t *n_nan);

/* Sum over all ranks, the same on all. Collective. Returns the number of elements with a NaN over
 * all ranks: if it is not 0 there is no digest. */
int64_t digest_of_all(const struct comm *comm, const int64_t *gid, int64_t n,
    const struct digest_part *part, int n_part, uint64_t *digest);

/* 16 hexadecimal digits. Returns `text`. */
char *digest_text(uint64_t digest, char text[17]);

#endif
