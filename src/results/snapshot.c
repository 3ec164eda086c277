#include "snapshot.h"
#include "comm/fail.h"
#include "h5_check.h"
#include "h5_write.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char *snapshot_path(const char *dir, int64_t index)
{
    return fail_format("%s/frame_%06lld.hdf", dir, (long long)index);
}

int64_t snapshot_index(const char *name)
{
    enum { DIGITS_MOST = 15 }; /* the next numbers are numbers too */
    long long index;
    if (strlen(name) > sizeof "frame_.hdf" - 1 + DIGITS_MOST ||
        sscanf(name, "frame_%lld", &index) != 1 || index < 0)
        return -1;
    char *own = fail_format("frame_%06lld.hdf", index);
    bool same = !strcmp(name, own);
    free(own);
    return same ? index : -1;
}

bool snapshot_is_finite(const struct comm *comm, const struct frame *frame)
{
    const struct table *table[] = {&frame->points, frame->state};
    int32_t wrong = 0;
    for (int t = 0; t < 2; t++)
        for (int k = 0; k < (t == 0 ? 1 : table[t]->n_column); k++) {
            const struct column *c = &table[t]->column[k];
            wrong |= !h5_check_finite(c->type, c->data, table[t]->n_row * c->width);
        }
    comm_or_i32(comm, &wrong, 1);
    return !wrong;
}

static int64_t row_bytes(const struct table *table)
{
    int64_t sum = 0;
    for (int k = 0; k < table->n_column; k++)
        sum += (int64_t)column_type_size(table->column[k].type) * table->column[k].width;
    return sum;
}

/* An upper estimate of the file's size, over all ranks: data, and room for headers and attributes
 * of every dataset. */
static int64_t estimate(const struct comm *comm, const struct frame *frame)
{
    enum { PER_POINT = 3 * 8 + 1, PER_DATASET = 4096, FIXED = 65536 };
    int64_t sum = frame->points.n_row * (row_bytes(&frame->points) + PER_POINT) +
                  frame->cells.n_row * row_bytes(&frame->cells);
    int64_t n_dataset = frame->points.n_column + frame->cells.n_column + frame->n_state;
    for (int t = 0; t < frame->n_state; t++) {
        sum += frame->state[t].n_row * row_bytes(&frame->state[t]);
        n_dataset += frame->state[t].n_column;
    }
    sum += 8 * (5 + frame->n_state); /* this rank's part of the counts, and its last offset */
    comm_sum_i64(comm, &sum, 1);
    return sum + n_dataset * PER_DATASET + FIXED + (int64_t)strlen(frame->resolved);
}

static void write_i64(struct h5_writer *writer, hid_t group, const char *name,
    const char *description, const int64_t *data, int64_t n)
{
    struct column column = {name, "1", description, COLUMN_I64, 1, data};
    h5_column(writer, group, &column, h5_rows_of(writer->comm, n));
}

/* n points, `corners` of them per cell: connectivity 0..n-1 and offsets 0, corners, ... n count
 * within the rank's own part. */
static void write_cells(struct h5_writer *writer, hid_t group, int64_t n, int corners)
{
    enum { VTK_VERTEX = 1, VTK_HEXAHEDRON = 12 };
    int64_t n_cell = n / corners, *count = fail_alloc((size_t)(n + 1) * sizeof *count),
            *offset = fail_alloc((size_t)(n_cell + 1) * sizeof *offset);
    unsigned char *kind = fail_alloc((size_t)n_cell);
    for (int64_t i = 0; i <= n; i++) count[i] = i;
    for (int64_t i = 0; i <= n_cell; i++) offset[i] = corners * i;
    memset(kind, corners == 1 ? VTK_VERTEX : VTK_HEXAHEDRON, (size_t)n_cell);
    struct column types = {"Types", "1",
        corners == 1 ? "VTK cell type: vertex" : "VTK cell type: hexahedron", COLUMN_U8, 1, kind};
    write_i64(writer, group, "NumberOfPoints", "points of each rank's part", &n, 1);
    write_i64(writer, group, "NumberOfCells", "cells of each rank's part", &n_cell, 1);
    write_i64(writer, group, "NumberOfConnectivityIds", "point indices of each rank's part", &n, 1);
    write_i64(
        writer, group, "Connectivity", "points of each cell, counted within its part", count, n);
    write_i64(writer, group, "Offsets",
        "begin of each cell in Connectivity, and the end, within each part", offset, n_cell + 1);
    h5_column(writer, group, &types, h5_rows_of(writer->comm, n_cell));
    free(kind);
    free(count);
    free(offset);
}

/* Group `name` with the columns of the table from `first` on. */
static void write_fields(
    struct h5_writer *writer, hid_t grid, const char *name, const struct table *table, int first)
{
    struct h5_rows rows = h5_rows_of(writer->comm, table->n_row);
    hid_t data = h5_group(writer, grid, name);
    for (int k = first; k < table->n_column; k++) h5_column(writer, data, &table->column[k], rows);
    H5Gclose(data);
}

static void write_grid(struct h5_writer *writer, const struct frame *frame, struct h5_rows rows)
{
    const struct table *points = &frame->points;
    const int64_t version[2] = {1, 0};
    /* 16 bytes, no NUL, ASCII: else ParaView 5.11 refuses the file */
    const char type[] = "UnstructuredGrid";
    hid_t grid = h5_group(writer, writer->file, "VTKHDF");
    h5_attribute(writer, grid, "Version", COLUMN_I64, 2, version);
    h5_attribute_text(writer, grid, "Type", type);
    struct column position = points->column[0];
    position.name = "Points";
    h5_column(writer, grid, &position, rows);
    write_cells(writer, grid, rows.mine, frame->hexahedra ? 8 : 1);
    hid_t field = h5_group(writer, grid, "FieldData");
    struct column time = {"TimeValue", "s", "simulated time", COLUMN_F64, 1, &frame->time};
    h5_column(writer, field, &time, h5_rows_of(writer->comm, writer->comm->rank == 0));
    H5Gclose(field);
    write_fields(writer, grid, "PointData", points, 1);
    if (frame->cells.n_column > 0) write_fields(writer, grid, "CellData", &frame->cells, 0);
    H5Gclose(grid);
}

/* Index of the column of `shown` that is this column of the state (the same memory under the same
 * name on every rank), or -1. */
static int64_t same_column(const struct comm *comm, const struct table *shown,
    const struct table *table, const struct column *column)
{
    /* smallest and, negated, largest over the ranks agree where all found the same */
    int64_t found[2] = {-1, 1};
    for (int k = 0; k < shown->n_column; k++) {
        const struct column *other = &shown->column[k];
        if (strcmp(other->name, column->name) || other->type != column->type ||
            other->width != column->width)
            continue;
        if (shown->n_row == table->n_row && (other->data == column->data || table->n_row == 0))
            found[0] = k;
    }
    found[1] = -found[0];
    comm_min_i64(comm, found, 2);
    return found[0] == -found[1] ? found[0] : -1;
}

static void write_table(struct h5_writer *writer, hid_t state, hid_t counts,
    const struct frame *frame, const struct table *table)
{
    struct h5_rows rows = h5_rows_of(writer->comm, table->n_row);
    hid_t group = h5_group(writer, state, table->name);
    for (int k = 0; k < table->n_column; k++) {
        const struct column *column = &table->column[k];
        int64_t point = same_column(writer->comm, &frame->points, table, column),
                cell = same_column(writer->comm, &frame->cells, table, column);
        if (point < 0 && cell < 0) {
            h5_column(writer, group, column, rows);
            continue;
        }
        char *path = point == 0 ? fail_strdup("/VTKHDF/Points")
                                : fail_format("/VTKHDF/%s/%s", point > 0 ? "PointData" : "CellData",
                                      column->name);
        h5_link(writer, path, group, column->name);
        free(path);
    }
    H5Gclose(group);
    write_i64(writer, counts, table->name, "rows of each rank", &table->n_row, 1);
}

static void write_state(struct h5_writer *writer, const struct frame *frame, struct h5_rows points)
{
    const int64_t version = SNAPSHOT_FORMAT_VERSION;
    hid_t state = h5_group(writer, writer->file, "democles");
    h5_attribute(writer, state, "format_version", COLUMN_I64, 0, &version);
    h5_attribute(writer, state, "step", COLUMN_I64, 0, &frame->step);
    h5_attribute(writer, state, "time", COLUMN_F64, 0, &frame->time);
    h5_attribute(writer, state, "index", COLUMN_I64, 0, &frame->index);
    h5_attribute(writer, state, "n_element", COLUMN_I64, 0, &points.total);
    for (int k = 0; k < frame->n_scalar; k++) {
        const struct frame_scalar *scalar = &frame->scalar[k];
        const void *value = scalar->type == COLUMN_F64 ? (const void *)&scalar->f64 : &scalar->i64;
        h5_attribute(writer, state, scalar->name, scalar->type, 0, value);
    }
    h5_text(writer, state, "resolved", "the scene with all defaults, as YAML", frame->resolved);
    hid_t counts = h5_group(writer, state, "rows");
    for (int t = 0; t < frame->n_state; t++)
        write_table(writer, state, counts, frame, &frame->state[t]);
    H5Gclose(counts);
    h5_attribute(writer, state, "n_dataset", COLUMN_I64, 0, &writer->n_dataset);
    H5Gclose(state);
}

void snapshot_write(const struct comm *comm, const char *dir, const struct frame *frame)
{
    char *path = snapshot_path(dir, frame->index);
    struct h5_writer *writer = h5_create(comm, path, estimate(comm, frame));
    struct h5_rows points = h5_rows_of(comm, frame->points.n_row);
    write_grid(writer, frame, points);
    write_state(writer, frame, points);
    h5_finish(writer);
    free(path);
}
