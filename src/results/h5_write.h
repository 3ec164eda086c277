/* Parallel HDF5, the part that democles needs: one file, written once by all ranks together, every
 * dataset with name, unit, description, checksum.
 *
 * Every rank calls every function with equal arguments (except for its own rows); all are
 * collective. Errors do not come back: the unfinished file is removed, one message gives rank and
 * HDF5's own words, and all ranks stop with EXIT_IO. Knows nothing of frames. */
#ifndef DEMOCLES_H5_WRITE_H
#define DEMOCLES_H5_WRITE_H

#include "comm/comm.h"
#include "column.h"

#include <hdf5.h>

struct h5_writer {
    const struct comm *comm;
    hid_t file, transfer; /* transfer: the property list of collective writes */
    char *path, *tmp;     /* final name, and name while it is written */
    /* rank 0: the file seen by POSIX, to reserve space and to sync; else -1 */
    int fd;
    int64_t n_dataset;       /* written so far, links too */
    size_t piece;            /* largest number of bytes per rank and H5Dwrite: MPI counts in int */
    H5E_auto2_t saved_print; /* the program's HDF5 error printing, restored at the end */
    void *saved_data;
};

/* Rows of one table over the ranks. */
struct h5_rows {
    int64_t mine, begin, total; /* rows of this rank; of lower ranks; of all */
};
struct h5_rows h5_rows_of(const struct comm *comm, int64_t mine);

/* Creates PATH.PID.tmp and reserves `bytes` (an estimate over all ranks) on disk, so that a full
 * disk shows before anything is written. */
struct h5_writer *h5_create(const struct comm *comm, const char *path, int64_t bytes);
/* Flush, close, fsync, rename, fsync of the folder; frees the writer. */
void h5_finish(struct h5_writer *writer);

/* Creates a group, which the caller closes with H5Gclose. */
hid_t h5_group(struct h5_writer *writer, hid_t parent, const char *name);

/* Writes column->name below `parent`, rank after rank: [total][width], or [total] where width is
 * 1. */
void h5_column(
    struct h5_writer *writer, hid_t parent, const struct column *column, struct h5_rows rows);
/* Text as a dataset of one fixed-length string, from rank 0. */
void h5_text(struct h5_writer *writer, hid_t parent, const char *name, const char *description,
    const char *text);
/* The dataset at `path` (from the file's root) under another name too: `name` below `to`. */
void h5_link(struct h5_writer *writer, const char *path, hid_t to, const char *name);

/* Attribute of a group: data [n] (a scalar where n is 0), or a fixed-length string of exactly
 * strlen bytes, ASCII where it can be. */
void h5_attribute(struct h5_writer *writer, hid_t object, const char *name, enum column_type type,
    int n, const void *data);
void h5_attribute_text(struct h5_writer *writer, hid_t object, const char *name, const char *text);

#endif
