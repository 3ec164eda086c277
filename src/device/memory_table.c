#include "memory_table.h"

#include <stdlib.h>
#include <string.h>

void memory_table_add(struct memory_table *table, const char *name, int64_t bytes)
{
    int i = 0;
    while (i < table->n && strcmp(table->row[i].name, name) != 0) i++;
    if (i == MEMORY_TABLE_ROWS) {
        i--;
        table->row[i].name = "others";
    } else if (i == table->n) {
        table->row[table->n++] = (struct memory_row){name, 0};
    }
    table->row[i].bytes += bytes;
}

static int by_bytes(const void *a, const void *b)
{
    int64_t x = ((const struct memory_row *)a)->bytes, y = ((const struct memory_row *)b)->bytes;
    return (y > x) - (y < x);
}

void memory_table_sort(struct memory_table *table)
{
    qsort(table->row, (size_t)table->n, sizeof *table->row, by_bytes);
}
