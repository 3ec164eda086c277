/* Moving records: rows of 4-byte words, whatever they mean. Packing of ghosts, reordering and
 * migration of every field go through here. */

/* to[i] = from[index[i]], records of `words` 4-byte words, i < n. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void record_gather(
    int n, int words, __global const int *index, __global const uint *from, __global uint *to)
{
    int i = get_global_id(0);
    if (i >= n) return;
    __global const uint *source = from + (size_t)index[i] * words;
    __global uint *target = to + (size_t)i * words;
    for (int k = 0; k < words; k++) target[k] = source[k];
}

/* to[i] = from[i] */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void record_copy(
    int n, __global const uint *from, __global uint *to)
{
    int i = get_global_id(0);
    if (i < n) to[i] = from[i];
}

/* index[count[i]] = i where flag[i] is set: compaction after a scan. */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void record_select(
    int n, __global const int *at, __global int *index)
{
    int i = get_global_id(0);
    if (i < n && at[i + 1] > at[i]) index[at[i]] = i;
}

/* value[i] = i + first */
__kernel __attribute__((reqd_work_group_size(64, 1, 1))) void record_number(
    int n, int first, __global int *value)
{
    int i = get_global_id(0);
    if (i < n) value[i] = i + first;
}
