/* Reading of frames that have been checked (snapshot_check): attributes of /democles, and rows of
 * its tables.
 *
 * Every rank opens the file by itself and reads what it asks for; nothing here is collective. What
 * is not there, or cannot be read, ends the run with EXIT_IO; what is another shape or type than it
 * has to be is so on every rank, which all have to ask then. Knows nothing of what the numbers
 * mean. */
#ifndef DEMOCLES_H5_READ_H
#define DEMOCLES_H5_READ_H

#include "column.h"

#include <hdf5.h>
#include <stdbool.h>

struct h5_reader {
    hid_t file;
    char *path;
    H5E_auto2_t saved_print; /* the program's HDF5 error printing, restored at the end */
    void *saved_data;
};

struct h5_reader *h5_open(const char *path);
void h5_close(struct h5_reader *reader); /* NULL is fine */

int64_t h5_read_i64(const struct h5_reader *reader, const char *attribute);
double h5_read_f64(const struct h5_reader *reader, const char *attribute);
/* The text of /democles/NAME, in fresh memory owned by the caller. */
char *h5_read_text(const struct h5_reader *reader, const char *name);

/* Whether the table has the column; how many rows all ranks together have written of it. */
bool h5_has(const struct h5_reader *reader, const char *table, const char *column);
int64_t h5_read_size(const struct h5_reader *reader, const char *table, const char *column);
/* Rows begin to begin + n of a column, [n][width], as numbers of `type`: floats widen to doubles
 * exactly. The width has to be that of the file. */
void h5_read_rows(const struct h5_reader *reader, const char *table, const char *column,
    enum column_type type, int width, int64_t begin, int64_t n, void *data);

#endif
