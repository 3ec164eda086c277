/* How much device memory each array takes, by name; buffer.h keeps the account. */
#ifndef DEMOCLES_MEMORY_TABLE_H
#define DEMOCLES_MEMORY_TABLE_H

#include <stdint.h>

enum { MEMORY_TABLE_ROWS = 128 };

struct memory_row {
    const char *name; /* borrowed */
    int64_t bytes;    /* of all arrays of this name */
};

struct memory_table {
    int n;
    /* in the order of their first allocation; further names share the last row */
    struct memory_row row[MEMORY_TABLE_ROWS];
};

/* bytes < 0 where memory is freed. */
void memory_table_add(struct memory_table *table, const char *name, int64_t bytes);
/* Rows with the most bytes first. */
void memory_table_sort(struct memory_table *table);

#endif
