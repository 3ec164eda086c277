/* The walk through a frame that tells whether it is whole, and how its result gets from the process
 * that walks to the one that asks. */
#ifndef DEMOCLES_SNAPSHOT_WALK_H
#define DEMOCLES_SNAPSHOT_WALK_H

#include <stdint.h>

/* Datasets in the order of the walk, the same on every rank of a whole file. */
struct snapshot_walk {
    int part, n_part; /* of the rows of each dataset */
    int n_object;     /* looked at */
    int64_t n;
    char **path;
    uint64_t *sum, *expected; /* of the part, and of all parts together (h5_check.h) */
};

void snapshot_walk_add(
    struct snapshot_walk *walk, const char *path, uint64_t sum, uint64_t expected);
void snapshot_walk_free(struct snapshot_walk *walk);

/* Fills the walk. Returns what is wrong with the frame but for sums, in fresh memory, or NULL. HDF5
 * may crash. */
char *snapshot_walk(struct snapshot_walk *walk, const char *path);

#endif
