/* Named columns of numbers, and tables of them: the form in which the state reaches files. Knows
 * neither files nor what the numbers mean.
 *
 * All ranks describe the same tables (equal names, types and widths in equal order) and each holds
 * its own rows; nothing is owned here. */
#ifndef DEMOCLES_COLUMN_H
#define DEMOCLES_COLUMN_H

#include <stddef.h>
#include <stdint.h>

enum column_type { COLUMN_F64, COLUMN_F32, COLUMN_I64, COLUMN_I32, COLUMN_U8 };

struct column {
    const char *name;        /* of the dataset: velocity */
    const char *unit;        /* m/s; 1 for a pure number */
    const char *description; /* one sentence */
    enum column_type type;
    int width;        /* numbers per row: 1, 3, 9 ... */
    const void *data; /* [n_row][width], borrowed; may be NULL where n_row is 0 */
};

struct table {
    const char *name;            /* elements, pairs ... */
    int64_t n_row;               /* of this rank, may be 0 */
    const struct column *column; /* [n_column], borrowed */
    int n_column;
};

/* Bytes of one number. */
static inline size_t column_type_size(enum column_type type)
{
    switch (type) {
    case COLUMN_F64:
    case COLUMN_I64: return 8;
    case COLUMN_F32:
    case COLUMN_I32: return 4;
    case COLUMN_U8: break;
    }
    return 1;
}

#endif
