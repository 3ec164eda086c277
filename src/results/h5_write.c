#define _GNU_SOURCE /* fallocate */
#include "h5_write.h"
#include "comm/fail.h"
#include "base/files.h"
#include "h5_check.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/statvfs.h>
#include <unistd.h>

/* MPI says "input/output error" where the system said more: ": File too large", if its number is
 * still there and one that tells of a place where no more can be written; else nothing. */
static const char *system_reason(int number)
{
    static char text[64];
    bool is_known = number == EFBIG || number == ENOSPC || number == EDQUOT || number == EROFS;
    snprintf(text, sizeof text, "%s%s", is_known ? ": " : "", is_known ? strerror(number) : "");
    return text;
}

/* Ends the job if a call of HDF5 failed on this rank.
 *
 * At once and without asking the others: a rank whose MPI_File_write_at_all failed leaves out the
 * collective calls that follow it inside of HDF5 1.10, and the others wait there for ever (seen
 * with a full disk); only MPI_Abort is sure to end all of them. Where several ranks fail together,
 * the higher ones hold their tongue until the lowest has ended them. */
static void insist(const struct h5_writer *writer, bool ok, const char *call, const char *name)
{
    int number = errno;
    if (ok) return;
    /* before any other call of HDF5, which would forget it */
    const char *system = system_reason(number), *reason = h5_check_error();
    struct statvfs disk;
    double free_bytes = statvfs(writer->tmp, &disk) == 0
                            ? (double)disk.f_bavail * (double)disk.f_frsize
                            : (double)NAN;
    /* mpirun ends ranks by SIGTERM first, which would be a request to stop */
    signal(SIGTERM, SIG_DFL);
    sleep(writer->comm->rank < 10 ? (unsigned)writer->comm->rank : 10);
    unlink(writer->tmp);
    fail_stop(EXIT_IO, "cannot write '%s': %s%s: %s%s (%.1f MB are free there)", writer->path, call,
        name, reason, system, 1e-6 * free_bytes);
}

/* Outside of HDF5 rank 0 acts alone; its error text (empty: none) decides for all. */
static void agree_on_text(const struct h5_writer *writer, char text[FILES_ERROR_SIZE])
{
    comm_bcast(writer->comm, text, FILES_ERROR_SIZE, 0);
    if (text[0]) fail_stop_together(EXIT_IO, "%s", text);
}

/* Asks the file system for the room before HDF5 begins: a full disk is then a plain error, not a
 * half-done collective write. */
static void reserve(struct h5_writer *writer, int64_t bytes, char error[FILES_ERROR_SIZE])
{
    writer->fd = files_create(writer->tmp, error);
    if (writer->fd < 0) return;
    if (bytes <= 0 || fallocate(writer->fd, 0, 0, bytes) == 0) return;
    /* a file system that cannot reserve: the writes will tell */
    if (errno != ENOSPC && errno != EDQUOT && errno != EFBIG) return;
    snprintf(error, FILES_ERROR_SIZE, "cannot write '%s' (%.1f MB): %s", writer->path,
        1e-6 * (double)bytes, strerror(errno));
    unlink(writer->tmp);
}

static hid_t create_file(const struct h5_writer *writer)
{
    hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_fapl_mpio(access, writer->comm->world, MPI_INFO_NULL);
    H5Pset_coll_metadata_write(access, true);
    H5Pset_all_coll_metadata_ops(access, true);
    /* Object headers of version 2 carry checksums of their own: damage to attributes and shapes
     * shows on opening. HDF5 knows them since 1.8. */
    H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_V18);
    hid_t file = H5Fcreate(writer->tmp, H5F_ACC_TRUNC, H5P_DEFAULT, access);
    H5Pclose(access);
    return file;
}

struct h5_rows h5_rows_of(const struct comm *comm, int64_t mine)
{
    struct h5_rows rows = {.mine = mine, .begin = comm_exscan_i64(comm, mine), .total = mine};
    comm_sum_i64(comm, &rows.total, 1);
    return rows;
}

/* Rank 0's name for a file that is not whole yet. */
static char *name_of_all(const struct comm *comm, const char *path)
{
    char *name = comm->rank == 0 ? files_tmp(path) : NULL;
    size_t n = name ? strlen(name) + 1 : 0;
    comm_bcast(comm, &n, sizeof n, 0);
    if (!name) name = fail_alloc(n);
    comm_bcast(comm, name, n, 0);
    return name;
}

struct h5_writer *h5_create(const struct comm *comm, const char *path, int64_t bytes)
{
    struct h5_writer *writer = fail_alloc(sizeof *writer);
    writer->comm = comm;
    writer->path = fail_strdup(path);
    writer->tmp = name_of_all(comm, path);
    writer->fd = -1;
    writer->piece = (size_t)1 << 30;
    char error[FILES_ERROR_SIZE] = "";
    if (comm->rank == 0) reserve(writer, bytes, error);
    agree_on_text(writer, error);
    /* after MPI_Abort HDF5 must not try to save what failed; every file of ours is closed long
     * before an orderly end */
    H5dont_atexit();
    H5Eget_auto2(H5E_DEFAULT, &writer->saved_print, &writer->saved_data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    writer->file = create_file(writer);
    insist(writer, writer->file >= 0, "create", "");
    /* Creation has cut the file to nothing and given the room back; KEEP_SIZE leaves the length to
     * HDF5. */
    if (writer->fd >= 0 && bytes > 0 && fallocate(writer->fd, FALLOC_FL_KEEP_SIZE, 0, bytes))
        errno = 0;
    writer->transfer = H5Pcreate(H5P_DATASET_XFER);
    H5Pset_dxpl_mpio(writer->transfer, H5FD_MPIO_COLLECTIVE);
    return writer;
}

/* What only rank 0 does, when all ranks have closed: give back what was reserved too much, make it
 * last, make it visible. */
static void make_visible(struct h5_writer *writer, char error[FILES_ERROR_SIZE])
{
    off_t size = lseek(writer->fd, 0, SEEK_END);
    bool ok = size >= 0 && ftruncate(writer->fd, size) == 0 && fsync(writer->fd) == 0;
    ok = close(writer->fd) == 0 && ok;
    if (ok) {
        files_commit(writer->tmp, writer->path, error);
        return;
    }
    snprintf(error, FILES_ERROR_SIZE, "cannot write '%s': %s", writer->path, strerror(errno));
    unlink(writer->tmp);
}

void h5_finish(struct h5_writer *writer)
{
    H5Pclose(writer->transfer);
    insist(writer, H5Fflush(writer->file, H5F_SCOPE_GLOBAL) >= 0, "flush", "");
    insist(writer, H5Fclose(writer->file) >= 0, "close", "");
    H5Eset_auto2(H5E_DEFAULT, writer->saved_print, writer->saved_data);
    comm_barrier(writer->comm);
    char error[FILES_ERROR_SIZE] = "";
    if (writer->comm->rank == 0) make_visible(writer, error);
    agree_on_text(writer, error);
    free(writer->path);
    free(writer->tmp);
    free(writer);
}

hid_t h5_group(struct h5_writer *writer, hid_t parent, const char *name)
{
    hid_t group = H5Gcreate2(parent, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    insist(writer, group >= 0, "group ", name);
    return group;
}

/* What a type is in memory and, the same on every machine, in the file. */
static hid_t memory_type(enum column_type type)
{
    const hid_t native[] = {
        H5T_NATIVE_DOUBLE, H5T_NATIVE_FLOAT, H5T_NATIVE_INT64, H5T_NATIVE_INT32, H5T_NATIVE_UINT8};
    return native[type];
}

static hid_t stored_type(enum column_type type)
{
    const hid_t stored[] = {
        H5T_IEEE_F64LE, H5T_IEEE_F32LE, H5T_STD_I64LE, H5T_STD_I32LE, H5T_STD_U8LE};
    return stored[type];
}

/* Fixed length, no terminator: what every reader of VTKHDF accepts. HDF5 knows no string of length
 * 0: the empty text is one NUL. */
static hid_t text_type(const char *text)
{
    bool is_ascii = true;
    for (const char *c = text; *c; c++) is_ascii &= (unsigned char)*c < 0x80;
    hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, text[0] ? strlen(text) : 1);
    H5Tset_strpad(type, H5T_STR_NULLPAD);
    H5Tset_cset(type, is_ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8);
    return type;
}

static void put_attribute(const struct h5_writer *writer, hid_t object, const char *name,
    hid_t stored, hid_t memory, int n, const void *data)
{
    hsize_t size = (hsize_t)n;
    hid_t space = n > 0 ? H5Screate_simple(1, &size, NULL) : H5Screate(H5S_SCALAR);
    hid_t attribute = H5Acreate2(object, name, stored, space, H5P_DEFAULT, H5P_DEFAULT);
    insist(writer, attribute >= 0, "attribute ", name);
    insist(writer, H5Awrite(attribute, memory, data) >= 0, "attribute ", name);
    H5Aclose(attribute);
    H5Sclose(space);
}

void h5_attribute(struct h5_writer *writer, hid_t object, const char *name, enum column_type type,
    int n, const void *data)
{
    put_attribute(writer, object, name, stored_type(type), memory_type(type), n, data);
}

void h5_attribute_text(struct h5_writer *writer, hid_t object, const char *name, const char *text)
{
    hid_t type = text_type(text);
    put_attribute(writer, object, name, type, type, 0, text);
    H5Tclose(type);
}

/* One collective H5Dwrite of rows [begin, begin + n) of a dataset; n may be 0, the rank takes part
 * all the same. */
static void write_rows(const struct h5_writer *writer, hid_t dataset, hid_t memory, int width,
    int64_t begin, int64_t n, const void *data)
{
    const char nothing = 0;
    hid_t in_file = H5Dget_space(dataset);
    int rank = H5Sget_simple_extent_ndims(in_file);
    hsize_t start[2] = {(hsize_t)begin, 0}, count[2] = {(hsize_t)n, (hsize_t)width};
    hid_t here = H5Screate_simple(rank, count, NULL);
    if (n > 0) {
        H5Sselect_hyperslab(in_file, H5S_SELECT_SET, start, NULL, count, NULL);
    } else {
        H5Sselect_none(in_file);
        H5Sselect_none(here);
    }
    insist(writer,
        H5Dwrite(dataset, memory, here, in_file, writer->transfer, data ? data : &nothing) >= 0,
        "write", "");
    H5Sclose(here);
    H5Sclose(in_file);
}

/* All rows, in as many collective writes as the rank with most of them needs. */
static void write_pieces(const struct h5_writer *writer, hid_t dataset, hid_t memory, int width,
    struct h5_rows rows, const void *data)
{
    size_t row_bytes = (size_t)width * H5Tget_size(memory);
    int64_t step =
        (int64_t)(writer->piece / row_bytes) > 0 ? (int64_t)(writer->piece / row_bytes) : 1;
    int64_t n_piece = (rows.mine + step - 1) / step;
    comm_max_i64(writer->comm, &n_piece, 1);
    for (int64_t p = 0; p < n_piece; p++) {
        int64_t first = p * step < rows.mine ? p * step : rows.mine;
        int64_t n = rows.mine - first < step ? rows.mine - first : step;
        write_rows(writer, dataset, memory, width, rows.begin + first, n,
            data ? (const char *)data + (size_t)first * row_bytes : NULL);
    }
}

/* [total][width], or [total] where width is 1. */
static hid_t create_dataset(const struct h5_writer *writer, hid_t parent, const char *name,
    hid_t stored, int width, int64_t total)
{
    hsize_t size[2] = {(hsize_t)total, (hsize_t)width};
    hid_t space = H5Screate_simple(width > 1 ? 2 : 1, size, NULL),
          layout = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_layout(layout, H5D_CONTIGUOUS);
    H5Pset_fill_time(layout, H5D_FILL_TIME_NEVER);
    hid_t dataset = H5Dcreate2(parent, name, stored, space, H5P_DEFAULT, layout, H5P_DEFAULT);
    insist(writer, dataset >= 0, "dataset ", name);
    H5Pclose(layout);
    H5Sclose(space);
    return dataset;
}

static void describe(struct h5_writer *writer, hid_t dataset, const char *name, const char *unit,
    const char *description, uint64_t checksum)
{
    h5_attribute_text(writer, dataset, "name", name);
    h5_attribute_text(writer, dataset, "unit", unit);
    h5_attribute_text(writer, dataset, "description", description);
    put_attribute(writer, dataset, "checksum", H5T_STD_U64LE, H5T_NATIVE_UINT64, 0, &checksum);
}

static uint64_t sum_of_ranks(const struct comm *comm, uint64_t mine)
{
    int64_t sum;
    memcpy(&sum, &mine, sizeof sum);
    comm_sum_i64(comm, &sum, 1); /* wraps modulo 2^64 */
    memcpy(&mine, &sum, sizeof mine);
    return mine;
}

void h5_column(
    struct h5_writer *writer, hid_t parent, const struct column *column, struct h5_rows rows)
{
    int width = column->width;
    writer->n_dataset++;
    hid_t dataset =
        create_dataset(writer, parent, column->name, stored_type(column->type), width, rows.total);
    write_pieces(writer, dataset, memory_type(column->type), width, rows, column->data);
    uint64_t mine = h5_check_sum(column->type, column->data, rows.mine * width, rows.begin * width);
    describe(writer, dataset, column->name, column->unit, column->description,
        sum_of_ranks(writer->comm, mine));
    H5Dclose(dataset);
}

void h5_text(struct h5_writer *writer, hid_t parent, const char *name, const char *description,
    const char *text)
{
    writer->n_dataset++;
    struct h5_rows rows = {
        .mine = writer->comm->rank == 0, .begin = writer->comm->rank > 0, .total = 1};
    hid_t type = text_type(text),
          dataset = create_dataset(writer, parent, name, type, 1, rows.total);
    write_pieces(writer, dataset, type, 1, rows, text);
    describe(writer, dataset, name, "1", description,
        h5_check_sum(COLUMN_U8, text, (int64_t)H5Tget_size(type), 0));
    H5Dclose(dataset);
    H5Tclose(type);
}

void h5_link(struct h5_writer *writer, const char *path, hid_t to, const char *name)
{
    writer->n_dataset++;
    insist(writer, H5Lcreate_hard(writer->file, path, to, name, H5P_DEFAULT, H5P_DEFAULT) >= 0,
        "link ", name);
}
