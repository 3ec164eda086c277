#include "frame_table.h"

#include <stdlib.h>
#include <string.h>

#include "comm/migrate.h"
#include "comm/fail.h"

/* First row of a rank's share. */
static int64_t share_begin(int64_t n, int rank, int n_rank)
{
    return n * rank / n_rank;
}

struct frame_table frame_table_begin(
    const struct comm *comm, const struct h5_reader *reader, const char *name, const char *first)
{
    int64_t n = h5_read_size(reader, name, first), begin = share_begin(n, comm->rank, comm->n_rank);
    return (struct frame_table){.name = name,
        .path = reader->path,
        .begin = begin,
        .n = share_begin(n, comm->rank + 1, comm->n_rank) - begin,
        .n_total = n};
}

static size_t bytes_of(const struct frame_column *c)
{
    return (size_t)c->width * column_type_size(c->type);
}

void *frame_table_add(struct frame_table *table, const struct h5_reader *reader, const char *column,
    enum column_type type, int width)
{
    int64_t n = h5_read_size(reader, table->name, column);
    if (n != table->n_total)
        fail_stop_together(EXIT_IO, "'%s' cannot be used: %s/%s has %lld rows, other columns %lld",
            table->path, table->name, column, (long long)n, (long long)table->n_total);
    struct frame_column *c = &table->column[table->n_column++];
    *c = (struct frame_column){column, type, width, NULL};
    c->data = fail_alloc((size_t)table->n * bytes_of(c));
    h5_read_rows(reader, table->name, column, type, width, table->begin, table->n, c->data);
    return c->data;
}

void *frame_table_get(const struct frame_table *table, const char *column)
{
    for (int k = 0; k < table->n_column; k++)
        if (!strcmp(table->column[k].name, column)) return table->column[k].data;
    return NULL;
}

static size_t row_bytes(const struct frame_table *table)
{
    size_t bytes = 0;
    for (int k = 0; k < table->n_column; k++) bytes += bytes_of(&table->column[k]);
    return bytes;
}

/* Whether row i goes to its rank number k, and does not go there already. */
static bool goes(const int32_t *to, int64_t i, int n_to, int k)
{
    const int32_t *own = to + i * n_to;
    for (int j = 0; j < k; j++)
        if (own[j] == own[k]) return false;
    return own[k] >= 0;
}

static char *pack(const struct frame_table *table, const struct comm *comm, const int32_t *to,
    int n_to, int64_t *bytes_to)
{
    size_t row = row_bytes(table);
    char **at = fail_alloc((size_t)comm->n_rank * sizeof *at);
    int64_t total = 0;
    memset(bytes_to, 0, (size_t)comm->n_rank * sizeof *bytes_to);
    for (int64_t i = 0; i < table->n; i++)
        for (int k = 0; k < n_to; k++)
            if (goes(to, i, n_to, k)) bytes_to[to[i * n_to + k]] += (int64_t)row;
    for (int r = 0; r < comm->n_rank; r++) total += bytes_to[r];
    char *send = fail_alloc((size_t)total), *end = send;
    for (int r = 0; r < comm->n_rank; end += bytes_to[r++]) at[r] = end;
    for (int64_t i = 0; i < table->n; i++)
        for (int k = 0; k < n_to; k++) {
            if (!goes(to, i, n_to, k)) continue;
            char **out = &at[to[i * n_to + k]];
            for (int c = 0; c < table->n_column; c++) {
                size_t bytes = bytes_of(&table->column[c]);
                memcpy(*out, (const char *)table->column[c].data + (size_t)i * bytes, bytes);
                *out += bytes;
            }
        }
    free(at);
    return send;
}

void frame_table_send(
    struct frame_table *table, const struct comm *comm, const int32_t *to, int n_to)
{
    int64_t *bytes_to = fail_alloc((size_t)comm->n_rank * sizeof *bytes_to),
            *bytes_from = fail_alloc((size_t)comm->n_rank * sizeof *bytes_from);
    char *send = pack(table, comm, to, n_to, bytes_to),
         *recv = migrate_bytes(comm, send, bytes_to, bytes_from);
    int64_t total = 0;
    for (int r = 0; r < comm->n_rank; r++) total += bytes_from[r];
    free(send);
    table->n = total / (int64_t)row_bytes(table);
    for (int c = 0; c < table->n_column; c++) {
        free(table->column[c].data);
        table->column[c].data = fail_alloc((size_t)table->n * bytes_of(&table->column[c]));
    }
    const char *from = recv;
    for (size_t i = 0; i < (size_t)table->n; i++)
        for (int c = 0; c < table->n_column; c++) {
            size_t bytes = bytes_of(&table->column[c]);
            memcpy((char *)table->column[c].data + i * bytes, from, bytes);
            from += bytes;
        }
    free(recv);
    free(bytes_to);
    free(bytes_from);
}

void frame_table_free(struct frame_table *table)
{
    for (int k = 0; k < table->n_column; k++) free(table->column[k].data);
}

int32_t *frame_table_owners(
    const struct comm *comm, const int64_t *own, int64_t n_own, int64_t n_global)
{
    int32_t *owner = fail_alloc((size_t)n_global * sizeof *owner);
    /* one rank alone says something of each id: or is all of it */
    for (int64_t i = 0; i < n_own; i++) owner[own[i]] = comm->rank + 1;
    comm_or_i32(comm, owner, (int)n_global);
    for (int64_t i = 0; i < n_global; i++) owner[i]--;
    return owner;
}
