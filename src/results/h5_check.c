#include "h5_check.h"
#include "digest.h"
#include "comm/fail.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const char h5_check_wrong[] = "its checksum is wrong";

static uint64_t bits_at(enum column_type type, const void *data, int64_t i)
{
    uint64_t wide;
    uint32_t narrow;
    switch (type) {
    case COLUMN_F64:
    case COLUMN_I64: memcpy(&wide, (const char *)data + 8 * i, 8); return wide;
    case COLUMN_F32:
    case COLUMN_I32: memcpy(&narrow, (const char *)data + 4 * i, 4); return narrow;
    case COLUMN_U8: break;
    }
    return ((const unsigned char *)data)[i];
}

uint64_t h5_check_sum(enum column_type type, const void *data, int64_t n, int64_t begin)
{
    uint64_t sum = 0;
    for (int64_t i = 0; i < n; i++)
        sum += digest_mix(digest_mix((uint64_t)(begin + i) + DIGEST_G) ^ bits_at(type, data, i));
    return sum;
}

/* Column type of a stored type, and the type to read it with (-1: none of ours). The caller closes
 * `memory`. */
static enum column_type type_of(hid_t stored, hid_t *memory)
{
    size_t size = H5Tget_size(stored);
    H5T_class_t class = H5Tget_class(stored);
    hid_t native = -1;
    enum column_type type = COLUMN_U8;
    if (class == H5T_STRING && !H5Tis_variable_str(stored)) {
        *memory = H5Tcopy(stored);
        return COLUMN_U8;
    }
    if (class == H5T_FLOAT && size == 8) type = COLUMN_F64, native = H5T_NATIVE_DOUBLE;
    else if (class == H5T_FLOAT && size == 4) type = COLUMN_F32, native = H5T_NATIVE_FLOAT;
    else if (class == H5T_INTEGER && size == 8) type = COLUMN_I64, native = H5T_NATIVE_INT64;
    else if (class == H5T_INTEGER && size == 4) type = COLUMN_I32, native = H5T_NATIVE_INT32;
    else if (class == H5T_INTEGER && size == 1) type = COLUMN_U8, native = H5T_NATIVE_UINT8;
    *memory = native < 0 ? -1 : H5Tcopy(native);
    return type;
}

/* Adds up rows [begin, end) of a dataset, some at a time. NULL, or what is wrong. */
static const char *sum_rows(hid_t dataset, hid_t memory, enum column_type type,
    const hsize_t shape[2], hsize_t begin, hsize_t end, uint64_t *sum)
{
    enum { PIECE = 1 << 24 }; /* [byte] read at once */
    size_t row_bytes = shape[1] * H5Tget_size(memory), per_row = row_bytes / column_type_size(type);
    hsize_t step = row_bytes > 0 && PIECE / row_bytes > 0 ? PIECE / row_bytes : 1;
    hid_t space = H5Dget_space(dataset);
    int rank = H5Sget_simple_extent_ndims(space);
    void *data = fail_alloc((end - begin < step ? end - begin : step) * row_bytes);
    bool good = true;
    for (hsize_t at = begin; good && at < end; at += step) {
        hsize_t start[2] = {at, 0}, count[2] = {end - at < step ? end - at : step, shape[1]};
        hid_t here = H5Screate_simple(rank, count, NULL);
        good = H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
               H5Dread(dataset, memory, here, space, H5P_DEFAULT, data) >= 0;
        H5Sclose(here);
        if (good)
            *sum +=
                h5_check_sum(type, data, (int64_t)(count[0] * per_row), (int64_t)(at * per_row));
    }
    free(data);
    H5Sclose(space);
    return good ? NULL : "cannot be read";
}

static const char *sum_part(
    hid_t dataset, hid_t stored, hid_t space, int part, int n_part, uint64_t *sum)
{
    hsize_t shape[2] = {0, 1};
    int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 1 || rank > 2 || H5Sget_simple_extent_dims(space, shape, NULL) < 0)
        return "its shape is not one that democles writes";
    hid_t memory;
    enum column_type type = type_of(stored, &memory);
    if (memory < 0) return "its type is not one that democles writes";
    /* A damaged header may claim any size: never ask for more than the file can hold. */
    hsize_t stored_bytes = H5Dget_storage_size(dataset), row = shape[1] * H5Tget_size(memory);
    const char *wrong =
        row == 0 || shape[0] > stored_bytes / row ? "it is shorter than its header says" : NULL;
    hsize_t begin = shape[0] * (hsize_t)part / (hsize_t)n_part,
            end = shape[0] * ((hsize_t)part + 1) / (hsize_t)n_part;
    if (shape[0] == 0) wrong = NULL;
    else if (!wrong && begin < end) wrong = sum_rows(dataset, memory, type, shape, begin, end, sum);
    H5Tclose(memory);
    return wrong;
}

const char *h5_check_part(hid_t dataset, int part, int n_part, uint64_t *sum, uint64_t *expected)
{
    *sum = *expected = 0;
    if (H5Aexists(dataset, "checksum") <= 0) return "it has no checksum";
    hid_t attribute = H5Aopen(dataset, "checksum", H5P_DEFAULT);
    herr_t code = attribute < 0 ? -1 : H5Aread(attribute, H5T_NATIVE_UINT64, expected);
    if (attribute >= 0) H5Aclose(attribute);
    if (code < 0) return "its checksum cannot be read";
    hid_t stored = H5Dget_type(dataset), space = H5Dget_space(dataset);
    const char *wrong = stored < 0 || space < 0
                            ? "its header cannot be read"
                            : sum_part(dataset, stored, space, part, n_part, sum);
    if (stored >= 0) H5Tclose(stored);
    if (space >= 0) H5Sclose(space);
    return wrong;
}

struct words {
    char inner[256], outer[256];
};

/* Upward walk: the first entry is the innermost, the last is the call that we made. */
static herr_t take_words(unsigned n, const H5E_error2_t *error, void *data)
{
    struct words *words = data;
    const char *text = error->desc && error->desc[0] ? error->desc : error->func_name;
    snprintf(n == 0 ? words->inner : words->outer, sizeof words->inner, "%s", text ? text : "");
    return 0;
}

const char *h5_check_error(void)
{
    static char text[600];
    struct words words = {"", ""};
    H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_words, &words);
    if (!words.inner[0]) snprintf(text, sizeof text, "HDF5 gives no reason");
    else if (!words.outer[0]) snprintf(text, sizeof text, "%s", words.inner);
    else snprintf(text, sizeof text, "%s: %s", words.outer, words.inner);
    return text;
}
