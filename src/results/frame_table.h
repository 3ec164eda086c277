/* Reads a table of a frame in parallel: each rank reads a share of the rows and sends them straight
 * to the ranks that need them. No rank ever holds the whole table. */
#ifndef DEMOCLES_FRAME_TABLE_H
#define DEMOCLES_FRAME_TABLE_H

#include "comm/comm.h"
#include "h5_read.h"

enum { FRAME_TABLE_COLUMNS = 12 };

struct frame_table {
    const char *name, *path; /* of the frame */
    int64_t begin, n;        /* rows here, and which is the first, as the frame has them */
    int64_t n_total;         /* in the frame */
    int n_column;
    struct frame_column {
        const char *name;
        enum column_type type;
        int width;
        void *data; /* [n][width], owned */
    } column[FRAME_TABLE_COLUMNS];
};

/* This rank's share of the rows of a table, of which columns are added one by one; `first` is any
 * of its columns. */
struct frame_table frame_table_begin(
    const struct comm *comm, const struct h5_reader *reader, const char *name, const char *first);
/* Reads one more column, of as many rows. The returned memory is the table's, until its rows are
 * sent. */
void *frame_table_add(struct frame_table *table, const struct h5_reader *reader, const char *column,
    enum column_type type, int width);
/* A column by name, NULL if it has not been added. */
void *frame_table_get(const struct frame_table *table, const char *column);
/* What is read is not trusted before it is checked: an index is in its range, a number is one. The
 * first row of any rank that is not as it has to be ends the run with EXIT_IO on all of them.
 * Before rows are sent; collective. */
void frame_table_check_range(const struct frame_table *table, const struct comm *comm,
    const char *column, int64_t low, int64_t high);
/* No number twice; they are 0 to n_global - 1, checked before. */
void frame_table_check_unique(
    const struct frame_table *table, const struct comm *comm, const char *column, int64_t n_global);
/* Every column of real numbers. */
void frame_table_check_finite(const struct frame_table *table, const struct comm *comm);
/* row: of this rank's that is wrong, or negative. */
void frame_table_check_row(const struct frame_table *table, const struct comm *comm,
    const char *column, int64_t row, const char *what);

/* Sends each row i to the ranks to[i * n_to + k], k < n_to: once to each; negative: to nobody. What
 * arrives, in the order of ranks and rows, takes the table's place. Collective. */
void frame_table_send(
    struct frame_table *table, const struct comm *comm, const int32_t *to, int n_to);
void frame_table_free(struct frame_table *table);

/* Who owns each of n_global ids, from what each rank says that it owns itself; -1: nobody. The
 * caller frees. Collective. */
int32_t *frame_table_owners(
    const struct comm *comm, const int64_t *own, int64_t n_own, int64_t n_global);

#endif
