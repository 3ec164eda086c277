/* Ghosts of the lattice: gathers the planes of the cells that others need into records, and spreads records that have arrived. Words, not numbers, so
 * that one text serves any precision: a record has n_x numbers of x_words words, then n_v of v_words. With WITH_BREAK the cell's own word follows:
 * a ghost has lost the links that its owner's cell has lost. */

/* index [n]: cells; record [n][n_x * x_words + n_v * v_words + WITH_BREAK]. x_in, v_in: first number of the set of planes. */
__kernel void lattice_pack(int n, __global const int *index, long plane, __global const int *x, long x_in, int n_x, int x_words,
                           __global const int *v, long v_in, int n_v, int v_words,
#if WITH_BREAK
                           __global const int *word,
#endif
                           __global int *restrict record)
{
    int e = get_global_id(0);
    if (e >= n) return;
    __global int *to = record + (size_t)e * (size_t)(n_x * x_words + n_v * v_words + WITH_BREAK);
    for (int k = 0; k < n_x; k++)
        for (int b = 0; b < x_words; b++) *to++ = x[((size_t)x_in + k * (size_t)plane + (size_t)index[e]) * x_words + b];
    for (int k = 0; k < n_v; k++)
        for (int b = 0; b < v_words; b++) *to++ = v[((size_t)v_in + k * (size_t)plane + (size_t)index[e]) * v_words + b];
#if WITH_BREAK
    *to = word[index[e]];
#endif
}

__kernel void lattice_unpack(int n, __global const int *index, long plane, __global int *restrict x, long x_in, int n_x, int x_words,
                             __global int *restrict v, long v_in, int n_v, int v_words,
#if WITH_BREAK
                             __global int *restrict word,
#endif
                             __global const int *record)
{
    int e = get_global_id(0);
    if (e >= n) return;
    __global const int *from = record + (size_t)e * (size_t)(n_x * x_words + n_v * v_words + WITH_BREAK);
    for (int k = 0; k < n_x; k++)
        for (int b = 0; b < x_words; b++) x[((size_t)x_in + k * (size_t)plane + (size_t)index[e]) * x_words + b] = *from++;
    for (int k = 0; k < n_v; k++)
        for (int b = 0; b < v_words; b++) v[((size_t)v_in + k * (size_t)plane + (size_t)index[e]) * v_words + b] = *from++;
#if WITH_BREAK
    word[index[e]] &= *from | ~63;
#endif
}
