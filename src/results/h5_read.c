#include "h5_read.h"

#include <stdio.h>
#include <stdlib.h>

#include "comm/fail.h"
#include "h5_check.h"

static _Noreturn void give_up(const struct h5_reader *reader, const char *table, const char *name)
{
    fail_stop(EXIT_IO, "cannot read '%s': %s%s%s: %s", reader->path, table, table[0] ? "/" : "",
        name, h5_check_error());
}

struct h5_reader *h5_open(const char *path)
{
    struct h5_reader *reader = fail_alloc(sizeof *reader);
    reader->path = fail_strdup(path);
    H5Eget_auto2(H5E_DEFAULT, &reader->saved_print, &reader->saved_data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    reader->file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    if (reader->file < 0) give_up(reader, "", "the file");
    return reader;
}

void h5_close(struct h5_reader *reader)
{
    if (!reader) return;
    H5Fclose(reader->file);
    H5Eset_auto2(H5E_DEFAULT, reader->saved_print, reader->saved_data);
    free(reader->path);
    free(reader);
}

static void read_attribute(
    const struct h5_reader *reader, const char *name, hid_t memory, void *value)
{
    if (!h5_check_number(reader->file, "democles", name, memory, value))
        fail_stop_together(EXIT_IO,
            "'%s' cannot be used: its attribute %s is not one number, or not there", reader->path,
            name);
}

int64_t h5_read_i64(const struct h5_reader *reader, const char *attribute)
{
    int64_t value;
    read_attribute(reader, attribute, H5T_NATIVE_INT64, &value);
    return value;
}

double h5_read_f64(const struct h5_reader *reader, const char *attribute)
{
    double value;
    read_attribute(reader, attribute, H5T_NATIVE_DOUBLE, &value);
    return value;
}

char *h5_read_text(const struct h5_reader *reader, const char *name)
{
    char *path = fail_format("democles/%s", name);
    hid_t dataset = H5Dopen2(reader->file, path, H5P_DEFAULT);
    if (dataset < 0) give_up(reader, "", name);
    hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
    if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) ||
        H5Sget_simple_extent_npoints(space) != 1)
        fail_stop_together(EXIT_IO, "'%s' cannot be used: %s is not one text", reader->path, name);
    char *text = fail_alloc(H5Tget_size(type) + 1);
    if (H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, text) < 0) give_up(reader, "", name);
    H5Sclose(space);
    H5Tclose(type);
    H5Dclose(dataset);
    free(path);
    return text;
}

bool h5_has(const struct h5_reader *reader, const char *table, const char *column)
{
    char *path = fail_format("democles/%s", table);
    bool has = H5Lexists(reader->file, path, H5P_DEFAULT) > 0;
    free(path);
    path = fail_format("democles/%s/%s", table, column);
    has = has && H5Lexists(reader->file, path, H5P_DEFAULT) > 0;
    free(path);
    return has;
}

static hid_t open_column(
    const struct h5_reader *reader, const char *table, const char *column, hsize_t shape[2])
{
    char *path = fail_format("democles/%s/%s", table, column);
    hid_t dataset = H5Dopen2(reader->file, path, H5P_DEFAULT);
    if (dataset < 0) give_up(reader, table, column);
    hid_t space = H5Dget_space(dataset);
    shape[1] = 1;
    int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 1 || rank > 2 || H5Sget_simple_extent_dims(space, shape, NULL) < 0)
        give_up(reader, table, column);
    H5Sclose(space);
    free(path);
    return dataset;
}

int64_t h5_read_size(const struct h5_reader *reader, const char *table, const char *column)
{
    hsize_t shape[2];
    H5Dclose(open_column(reader, table, column, shape));
    return (int64_t)shape[0];
}

void h5_read_rows(const struct h5_reader *reader, const char *table, const char *column,
    enum column_type type, int width, int64_t begin, int64_t n, void *data)
{
    const hid_t native[] = {
        H5T_NATIVE_DOUBLE, H5T_NATIVE_FLOAT, H5T_NATIVE_INT64, H5T_NATIVE_INT32, H5T_NATIVE_UINT8};
    hsize_t shape[2], start[2] = {(hsize_t)begin, 0}, count[2] = {(hsize_t)n, (hsize_t)width};
    hid_t dataset = open_column(reader, table, column, shape);
    if (shape[1] != (hsize_t)width || begin + n > (int64_t)shape[0])
        fail_stop_together(EXIT_IO, "'%s' cannot be used: %s/%s has %lld rows of %lld numbers",
            reader->path, table, column, (long long)shape[0], (long long)shape[1]);
    hid_t space = H5Dget_space(dataset),
          here = H5Screate_simple(H5Sget_simple_extent_ndims(space), count, NULL);
    if (n > 0) {
        H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL);
        if (H5Dread(dataset, native[type], here, space, H5P_DEFAULT, data) < 0)
            give_up(reader, table, column);
    }
    H5Sclose(here);
    H5Sclose(space);
    H5Dclose(dataset);
}
