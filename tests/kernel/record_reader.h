/* What the force kernels have written, read by the kernel that it is for: gather, once per record,
 * as if each were the only contact of an element. So that tests of forces do not depend on how a
 * record is laid out. */
#ifndef RECORD_READER_H
#define RECORD_READER_H

#include "kernel_fixture.h"

struct reader {
    struct device *dev;
    struct program *program;
    struct launch *gather;
    struct buffer buffer[11];
};

void reader_open(struct reader *r, struct device *dev, const struct features *features);
void reader_close(struct reader *r);

/* One force and torque [4] for each side of a contact. */
struct reading {
    real force[4], torque[4];
};

/* out [2 n_pair + n_wall]: lower (i) and higher id of each pair, then each wall contact. A buffer
 * may be NULL where its number is 0. The pairs' has n_pair + 1 records, the last of which is
 * zero. */
void reader_read(struct reader *r, struct buffer *pair_result, int n_pair,
    struct buffer *wall_result, int n_wall, struct reading *out);

#endif
