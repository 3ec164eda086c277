#include "scan.h"

#include <stdlib.h>

#include "comm/fail.h"

/* entries per work-group and per work-item of kernels/common/scan.cl */
enum { SCAN_BLOCK = 2048, SCAN_ITEM = 8 };

struct scan *scan_create(struct device *dev, const struct program *lists)
{
    struct scan *scan = fail_alloc(sizeof *scan);
    buffer_init(&scan->block, dev, "scan");
    buffer_reserve(&scan->block, 0);
    scan->sums = launch_create(lists, "scan_sums");
    scan->blocks = launch_create(lists, "scan_blocks");
    scan->apply = launch_create(lists, "scan_apply");
    struct launch *all[] = {scan->sums, scan->blocks, scan->apply};
    for (int i = 0; i < 3; i++) launch_bind_buffer(all[i], "block", &scan->block);
    return scan;
}

void scan_free(struct scan *scan)
{
    if (!scan) return;
    launch_free(scan->sums);
    launch_free(scan->blocks);
    launch_free(scan->apply);
    buffer_free(&scan->block);
    free(scan);
}

void scan_run(struct scan *scan, struct buffer *data, int64_t n)
{
    int64_t n_block = (n + SCAN_BLOCK - 1) / SCAN_BLOCK;
    struct launch *all[] = {scan->sums, scan->blocks, scan->apply};
    int64_t items[] = {n_block * SCAN_BLOCK / SCAN_ITEM, 1, n_block * SCAN_BLOCK / SCAN_ITEM};
    buffer_reserve(&scan->block, (size_t)n_block * sizeof(cl_int));
    for (int i = 0; i < 3; i++) {
        launch_set_count(all[i], "n", n);
        launch_bind_buffer(all[i], "data", data);
        launch_run(all[i], items[i]);
    }
}

int64_t scan_total(struct scan *scan, struct buffer *data, int64_t n)
{
    cl_int total;
    scan_run(scan, data, n);
    buffer_read(data, (size_t)n * sizeof total, sizeof total, &total);
    return total;
}
