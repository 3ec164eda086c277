/* Ghosts of the lattice: gathers the planes of the cells that others need into records, and spreads
 * records that have arrived. Words, not numbers, so that one text serves any precision and records
 * need no padding: X_NUMBERS places and rotations, then velocities where links are damped, and with
 * WITH_BREAK the cell's own word: a ghost has lost the links that its owner's cell has lost, and
 * those are due that are due there. */
#include "lattice_words.h"
#include "common/types.h"

#define X_NUMBERS LATTICE_X(WITH_TURN)
#define V_NUMBERS (WITH_LINK_DAMPING ? LATTICE_V : 0)
#define X_WORDS (int)(sizeof(preal) / sizeof(int))
#define V_WORDS (int)(sizeof(real) / sizeof(int))
#define RECORD (X_NUMBERS * X_WORDS + V_NUMBERS * V_WORDS + WITH_BREAK)
/* Word b of number k of cell i; `of`: X or V. */
#define WORD(of, set, k, b, i)                                                                     \
    ((size_t)(set) + (k) * (size_t)plane + (size_t)(i)) * of##_WORDS + (b)
#define FOR_WORDS(of, k, b)                                                                        \
    for (int k = 0; k < of##_NUMBERS; k++)                                                         \
        for (int b = 0; b < of##_WORDS; b++)

/* index [n]: cells; record [n][RECORD]. x_in, v_in: first number of the set of planes. */
__kernel void lattice_pack(int n, __global const int *index, long plane, __global const int *x,
    long x_in, __global const int *v, long v_in,
#if WITH_BREAK
    __global const int *word,
#endif
    __global int *restrict record)
{
    int e = get_global_id(0);
    if (e >= n) return;
    int i = index[e];
    __global int *to = record + (size_t)e * RECORD;
    FOR_WORDS(X, k, b) to[k * X_WORDS + b] = x[WORD(X, x_in, k, b, i)];
    FOR_WORDS(V, k, b) to[X_NUMBERS * X_WORDS + k * V_WORDS + b] = v[WORD(V, v_in, k, b, i)];
#if WITH_BREAK
    to[RECORD - 1] = word[i];
#endif
    (void)v;
}

__kernel void lattice_unpack(int n, __global const int *index, long plane, __global int *restrict x,
    long x_in, __global int *restrict v, long v_in,
#if WITH_BREAK
    __global int *restrict word,
#endif
    __global const int *record)
{
    int e = get_global_id(0);
    if (e >= n) return;
    int i = index[e];
    __global const int *from = record + (size_t)e * RECORD;
    FOR_WORDS(X, k, b) x[WORD(X, x_in, k, b, i)] = from[k * X_WORDS + b];
    FOR_WORDS(V, k, b) v[WORD(V, v_in, k, b, i)] = from[X_NUMBERS * X_WORDS + k * V_WORDS + b];
#if WITH_BREAK
    int links = 63, due = 63 << WORD_DUE_AT, sent = from[RECORD - 1];
    word[i] = (word[i] & ~due & (sent | ~links)) | (sent & due);
#endif
    (void)v;
}
