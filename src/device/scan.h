/* Prefix sums of ints on the device (kernels/common/scan.cl), and the totals that the host needs to
 * size what comes next. */
#ifndef DEMOCLES_SCAN_H
#define DEMOCLES_SCAN_H

#include "launch.h"

struct scan {
    struct buffer block;
    struct launch *sums, *blocks, *apply;
};

struct scan *scan_create(struct device *dev, const struct program *lists);
void scan_free(struct scan *scan);

/* data [n + 1] int: exclusive prefix sums in place, the total in data[n]. */
void scan_run(struct scan *scan, struct buffer *data, int64_t n);
/* The same, and the total to the host: blocking. */
int64_t scan_total(struct scan *scan, struct buffer *data, int64_t n);

#endif
