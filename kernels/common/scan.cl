/* Exclusive prefix sum of ints, in place, in two passes over blocks and one over the sums of
 * blocks. The tree depends on n alone. data [n + 1]: on return data[i] = sum of what stood before
 * i, data[n] the total (what stood at n does not count). */
#define SCAN_GROUP 256
#define SCAN_ITEM 8
#define SCAN_BLOCK (SCAN_GROUP * SCAN_ITEM)

/* Each group sums SCAN_BLOCK entries; block [number of blocks]. */
__kernel __attribute__((reqd_work_group_size(SCAN_GROUP, 1, 1))) void scan_sums(
    int n, __global const int *data, __global int *block)
{
    __local int part[SCAN_GROUP];
    int l = get_local_id(0), g = get_group_id(0), first = g * SCAN_BLOCK + l * SCAN_ITEM, sum = 0;
    for (int k = 0; k < SCAN_ITEM; k++)
        if (first + k < n) sum += data[first + k];
    part[l] = sum;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (l == 0 && g * SCAN_BLOCK < n) {
        int total = 0;
        for (int k = 0; k < SCAN_GROUP; k++) total += part[k];
        block[g] = total;
    }
}

/* One work-item turns the sums into offsets and stores the total: a few hundred entries even for a
 * million elements. */
__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void scan_blocks(
    int n, __global int *data, __global int *block)
{
    if (get_global_id(0) > 0) return;
    int sum = 0, n_block = (n + SCAN_BLOCK - 1) / SCAN_BLOCK;
    for (int k = 0; k < n_block; k++) {
        int here = block[k];
        block[k] = sum;
        sum += here;
    }
    data[n] = sum;
}

__kernel __attribute__((reqd_work_group_size(SCAN_GROUP, 1, 1))) void scan_apply(
    int n, __global int *data, __global const int *block)
{
    __local int part[SCAN_GROUP];
    int l = get_local_id(0), g = get_group_id(0), first = g * SCAN_BLOCK + l * SCAN_ITEM, sum = 0;
    for (int k = 0; k < SCAN_ITEM; k++)
        if (first + k < n) sum += data[first + k];
    part[l] = sum;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (l == 0) {
        int total = g * SCAN_BLOCK < n ? block[g] : 0;
        for (int k = 0; k < SCAN_GROUP; k++) {
            int here = part[k];
            part[k] = total;
            total += here;
        }
    }
    barrier(CLK_LOCAL_MEM_FENCE);
    sum = part[l];
    for (int k = 0; k < SCAN_ITEM; k++)
        if (first + k < n) {
            int here = data[first + k];
            data[first + k] = sum;
            sum += here;
        }
}
