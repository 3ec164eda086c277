/* Whether what stands in a table may be used. A frame whose checksums are right may still hold
 * anything. */
#include "frame_table.h"

#include <math.h>
#include <stdlib.h>

#include "comm/fail.h"

void frame_table_check_row(const struct frame_table *table, const struct comm *comm,
    const char *column, int64_t row, const char *what)
{
    int64_t first = row < 0 ? INT64_MAX : table->begin + row;
    comm_min_i64(comm, &first, 1);
    if (first == INT64_MAX) return;
    fail_stop_together(EXIT_IO,
        "'%s' cannot be used: %s/%s: row %lld %s; without this file the frame before it is taken",
        table->path, table->name, column, (long long)first, what);
}

static int64_t integer_at(const struct frame_column *c, int64_t k)
{
    return c->type == COLUMN_I64 ? ((const int64_t *)c->data)[k] : ((const int32_t *)c->data)[k];
}

static double real_at(const struct frame_column *c, int64_t k)
{
    return c->type == COLUMN_F64 ? ((const double *)c->data)[k]
                                 : (double)((const float *)c->data)[k];
}

static const struct frame_column *find(const struct frame_table *table, const char *column)
{
    const struct frame_column *c = table->column;
    while (c->data != frame_table_get(table, column)) c++;
    return c;
}

void frame_table_check_range(const struct frame_table *table, const struct comm *comm,
    const char *column, int64_t low, int64_t high)
{
    const struct frame_column *c = find(table, column);
    int64_t wrong = -1;
    for (int64_t k = table->n * c->width - 1; k >= 0; k--) {
        int64_t value = integer_at(c, k);
        if (value < low || value > high) wrong = k / c->width;
    }
    frame_table_check_row(table, comm, column, wrong, "is out of range");
}

void frame_table_check_unique(
    const struct frame_table *table, const struct comm *comm, const char *column, int64_t n_global)
{
    int64_t n_marked = 0;
    int32_t *owner = frame_table_owners(comm, frame_table_get(table, column), table->n, n_global);
    for (int64_t i = 0; i < n_global; i++) n_marked += owner[i] >= 0;
    free(owner);
    if (n_marked == table->n_total) return;
    fail_stop_together(EXIT_IO,
        "'%s' cannot be used: %s/%s has the same number twice; without this file the frame before "
        "it is taken",
        table->path, table->name, column);
}

void frame_table_check_finite(const struct frame_table *table, const struct comm *comm)
{
    for (int k = 0; k < table->n_column; k++) {
        const struct frame_column *c = &table->column[k];
        int64_t wrong = -1;
        if (c->type != COLUMN_F64 && c->type != COLUMN_F32) continue;
        for (int64_t i = table->n * c->width - 1; i >= 0; i--)
            if (!isfinite(real_at(c, i))) wrong = i / c->width;
        frame_table_check_row(table, comm, c->name, wrong, "is not a number");
    }
}
