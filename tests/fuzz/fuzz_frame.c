/* A frame that HDF5 can read, but whose content somebody has made up: each input is a list of
 * changes of its datasets, attributes and links, most with checksums that are right. The walk
 * refuses it, or it is read as a run that goes on does, which ends with a message or has what it
 * needs. */
#include "fuzz_input.h"
#include "results/h5_check.h"
#include "results/snapshot.h"
#include "results/snapshot_walk.h"
#include "whole_frame.h"

#include <hdf5.h>

#define CHOICES(list) (sizeof list / sizeof *list)

static const char *const dataset_name[] = {"democles/elements/id", "democles/elements/position",
    "democles/elements/velocity", "democles/elements/displacement", "democles/pairs/partner",
    "democles/resolved", "democles/rows/elements", "VTKHDF/Points", "VTKHDF/PointData/radius",
    "democles/elements", "democles/pairs", "VTKHDF/Connectivity"};
static const char *const attribute_name[] = {
    "step", "time", "index", "dt", "n_removed", "n_element", "n_dataset", "format_version"};

static const char *choose(struct fuzz_bytes *bytes, const char *const *list, size_t n)
{
    return list[fuzz_choose(bytes, n)];
}

/* A type of numbers or text, to be closed. */
static hid_t choose_type(struct fuzz_bytes *bytes, enum column_type *column)
{
    const hid_t type[] = {H5T_IEEE_F64LE, H5T_STD_I64LE, H5T_STD_I32LE, H5T_IEEE_F32LE,
        H5T_STD_U8LE, H5T_IEEE_F64BE, H5T_STD_U16LE, H5T_C_S1};
    static const enum column_type like[] = {COLUMN_F64, COLUMN_I64, COLUMN_I32, COLUMN_F32,
        COLUMN_U8, COLUMN_F64, COLUMN_U8, COLUMN_U8};
    size_t k = fuzz_choose(bytes, CHOICES(type));
    hid_t chosen = H5Tcopy(type[k]);
    if (type[k] == H5T_C_S1) {
        size_t length = fuzz_choose(bytes, 40);
        H5Tset_size(chosen, length ? length : H5T_VARIABLE);
    }
    *column = like[k];
    return chosen;
}

static hid_t choose_space(struct fuzz_bytes *bytes)
{
    hsize_t shape[3] = {1, 1, 1};
    size_t rank = fuzz_choose(bytes, 4);
    for (size_t k = 0; k < rank; k++)
        shape[k] = k == 1 ? fuzz_choose(bytes, 5) : fuzz_choose(bytes, 9);
    return rank == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple((int)rank, shape, NULL);
}

static void set_number(hid_t object, const char *name, hid_t type, hid_t space, const void *data)
{
    if (H5Aexists(object, name) > 0) H5Adelete(object, name);
    hid_t attribute = H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute < 0) return;
    H5Awrite(attribute, type, data);
    H5Aclose(attribute);
}

/* Numbers for anything that has at most 9 * 5 * 9 of them, 8 bytes each, or a text of 40. */
struct numbers {
    union {
        uint8_t byte[9 * 5 * 9 * 40];
        uint64_t word[9 * 5 * 5 * 9];
    };
};

/* Some of them from the input, others odd or small. */
static void fill(struct numbers *numbers, struct fuzz_bytes *bytes)
{
    static const uint64_t odd[] = {0, 1, UINT64_MAX, INT64_MAX, (uint64_t)INT64_MIN,
        0x7ff8000000000000u, 0x7ff0000000000000u, 0x4000000000000000u};
    size_t kind = fuzz_choose(bytes, 4);
    for (size_t k = 0; k < CHOICES(numbers->word); k++)
        numbers->word[k] = kind == 0   ? fuzz_next(bytes, 8)
                           : kind == 1 ? odd[fuzz_choose(bytes, CHOICES(odd))]
                           : kind == 2 ? k
                                       : 0;
}

/* The checksum of what a dataset holds. */
static void sign(hid_t dataset, enum column_type type, size_t n, const struct numbers *numbers)
{
    hid_t space = H5Screate(H5S_SCALAR);
    uint64_t sum = h5_check_sum(type, numbers->byte, (int64_t)n, 0);
    set_number(dataset, "checksum", H5T_NATIVE_UINT64, space, &sum);
    H5Sclose(space);
}

/* Another dataset under one of the names: type, shape, layout, content. */
static void put_dataset(hid_t file, struct fuzz_bytes *bytes)
{
    static struct numbers numbers;
    enum column_type column;
    const char *name = choose(bytes, dataset_name, CHOICES(dataset_name));
    hid_t type = choose_type(bytes, &column), space = choose_space(bytes),
          how = H5Pcreate(H5P_DATASET_CREATE);
    size_t layout = fuzz_choose(bytes, 16), bytes_each = H5Tget_size(type);
    if (layout == 1) H5Pset_layout(how, H5D_COMPACT);
    if (layout == 2) H5Pset_external(how, "/dev/zero", 0, H5F_UNLIMITED);
    H5Ldelete(file, name, H5P_DEFAULT);
    hid_t dataset = H5Dcreate2(file, name, type, space, H5P_DEFAULT, how, H5P_DEFAULT);
    if (dataset >= 0) {
        size_t n = (size_t)H5Sget_simple_extent_npoints(space);
        if (layout == 2) memset(&numbers, 0, sizeof numbers);
        else fill(&numbers, bytes);
        if (H5Tis_variable_str(type) <= 0 && layout != 2)
            H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.byte);
        if (layout != 3) sign(dataset, column, n * bytes_each / column_type_size(column), &numbers);
        H5Dclose(dataset);
    }
    H5Pclose(how);
    H5Sclose(space);
    H5Tclose(type);
}

/* What a column of numbers of this type would be; of anything else its bytes. */
static enum column_type column_of(hid_t type)
{
    size_t each = H5Tget_size(type);
    bool is_real = H5Tget_class(type) == H5T_FLOAT;
    if (H5Tget_class(type) == H5T_STRING || (each != 4 && each != 8)) return COLUMN_U8;
    if (each == 8) return is_real ? COLUMN_F64 : COLUMN_I64;
    return is_real ? COLUMN_F32 : COLUMN_I32;
}

/* One number of a dataset that stays as it is otherwise. */
static void put_number(hid_t file, struct fuzz_bytes *bytes)
{
    static struct numbers numbers;
    hid_t dataset = H5Dopen2(file, choose(bytes, dataset_name, CHOICES(dataset_name)), H5P_DEFAULT);
    if (dataset < 0) return;
    hid_t type = H5Dget_type(dataset), space = H5Dget_space(dataset);
    size_t each = H5Tget_size(type), n = (size_t)H5Sget_simple_extent_npoints(space);
    enum column_type column = column_of(type);
    if (n > 0 && n * each <= sizeof numbers && H5Tis_variable_str(type) <= 0 &&
        H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.byte) >= 0) {
        uint64_t value = fuzz_next(bytes, 8);
        memcpy(numbers.byte + fuzz_choose(bytes, n) * each, &value, each < 8 ? each : 8);
        H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, numbers.byte);
        sign(dataset, column, n * each / column_type_size(column), &numbers);
    }
    H5Sclose(space);
    H5Tclose(type);
    H5Dclose(dataset);
}

static void put_attribute(hid_t file, struct fuzz_bytes *bytes)
{
    static struct numbers numbers;
    enum column_type column;
    const char *name = choose(bytes, attribute_name, CHOICES(attribute_name));
    hid_t type = choose_type(bytes, &column), space = choose_space(bytes),
          group = H5Oopen(file, "democles", H5P_DEFAULT);
    fill(&numbers, bytes);
    if (group >= 0 && H5Tis_variable_str(type) <= 0)
        set_number(group, name, type, space, numbers.byte);
    if (group >= 0) H5Oclose(group);
    H5Sclose(space);
    H5Tclose(type);
}

/* A name that leads elsewhere, or nowhere. */
static void put_link(hid_t file, struct fuzz_bytes *bytes)
{
    const char *name = choose(bytes, dataset_name, CHOICES(dataset_name)),
               *other = choose(bytes, dataset_name, CHOICES(dataset_name));
    size_t kind = fuzz_choose(bytes, 6);
    H5Ldelete(file, name, H5P_DEFAULT);
    if (kind == 1) H5Lcreate_hard(file, other, file, name, H5P_DEFAULT, H5P_DEFAULT);
    if (kind == 2) H5Lcreate_hard(file, "democles", file, name, H5P_DEFAULT, H5P_DEFAULT);
    if (kind == 3) H5Lcreate_soft(other, file, name, H5P_DEFAULT, H5P_DEFAULT);
    if (kind == 4) H5Lcreate_external("/dev/zero", "/x", file, name, H5P_DEFAULT, H5P_DEFAULT);
    if (kind != 5) return;
    hid_t group = H5Gcreate2(file, name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    if (group >= 0) H5Gclose(group);
}

static void change(struct fuzz_bytes *bytes)
{
    static void (*const kind[])(hid_t, struct fuzz_bytes *) = {
        put_number, put_dataset, put_attribute, put_link};
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    hid_t file = H5Fopen(whole_frame_path(), H5F_ACC_RDWR, H5P_DEFAULT);
    fuzz_expect(file >= 0, "the frame can be opened");
    for (int k = 0; k < 8 && bytes->at < bytes->end; k++)
        kind[fuzz_choose(bytes, CHOICES(kind))](file, bytes);
    H5Fclose(file);
}

/* Whether the rows of a dataset lie in this file. */
static bool is_inside(hid_t file, const char *path)
{
    hid_t dataset = H5Dopen2(file, path, H5P_DEFAULT), layout = H5Dget_create_plist(dataset);
    bool inside = H5Pget_layout(layout) == H5D_CONTIGUOUS && H5Pget_external_count(layout) == 0;
    H5Pclose(layout);
    H5Dclose(dataset);
    return inside;
}

static void expect_inside(const struct snapshot_walk *walk)
{
    hid_t file = H5Fopen(whole_frame_path(), H5F_ACC_RDONLY, H5P_DEFAULT);
    for (int64_t k = 0; k < walk->n; k++)
        fuzz_expect(is_inside(file, walk->path[k]), "a frame has its rows in its own file");
    H5Fclose(file);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct fuzz_bytes bytes = {data, data + size};
    struct snapshot_walk walk = {.n_part = 1};
    whole_frame_put();
    change(&bytes);
    char *wrong = snapshot_walk(&walk, whole_frame_path());
    bool good = !wrong;
    for (int64_t k = 0; k < walk.n && good; k++) good = walk.sum[k] == walk.expected[k];
    if (good) expect_inside(&walk);
    if (good) whole_frame_read();
    snapshot_walk_free(&walk);
    free(wrong);
    return 0;
}
