#include "h5_check.h"
#include "digest.h"
#include "comm/fail.h"

#include <math.h>
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

bool h5_check_finite(enum column_type type, const void *data, int64_t n)
{
    bool finite = true;
    if (type == COLUMN_F64)
        for (int64_t i = 0; i < n; i++) finite &= isfinite(((const double *)data)[i]) != 0;
    if (type == COLUMN_F32)
        for (int64_t i = 0; i < n; i++) finite &= isfinite(((const float *)data)[i]) != 0;
    return finite;
}

uint64_t h5_check_add(uint64_t all, enum column_type type, const void *data, int64_t n)
{
    return digest_mix((all ^ h5_check_sum(type, data, n, 0)) + DIGEST_G);
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
    const hsize_t shape[2], hsize_t begin, hsize_t end, bool finite, uint64_t *sum)
{
    enum { PIECE = 1 << 24 }; /* [byte] read at once */
    size_t row_bytes = shape[1] * H5Tget_size(memory), per_row = row_bytes / column_type_size(type);
    hsize_t step = row_bytes > 0 && PIECE / row_bytes > 0 ? PIECE / row_bytes : 1;
    hid_t space = H5Dget_space(dataset);
    int rank = H5Sget_simple_extent_ndims(space);
    void *data = fail_alloc((end - begin < step ? end - begin : step) * row_bytes);
    const char *wrong = NULL;
    bool good = true;
    for (hsize_t at = begin; good && !wrong && at < end; at += step) {
        hsize_t start[2] = {at, 0}, count[2] = {end - at < step ? end - at : step, shape[1]};
        hid_t here = H5Screate_simple(rank, count, NULL);
        good = H5Sselect_hyperslab(space, H5S_SELECT_SET, start, NULL, count, NULL) >= 0 &&
               H5Dread(dataset, memory, here, space, H5P_DEFAULT, data) >= 0;
        H5Sclose(here);
        int64_t n = (int64_t)(count[0] * per_row);
        if (good) *sum += h5_check_sum(type, data, n, (int64_t)(at * per_row));
        if (good && finite && !h5_check_finite(type, data, n)) wrong = "it holds NaN or infinity";
    }
    free(data);
    H5Sclose(space);
    return good ? wrong : "cannot be read";
}

bool h5_check_number(hid_t at, const char *object, const char *name, hid_t memory, void *value)
{
    hid_t attribute = H5Aopen_by_name(at, object, name, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute < 0) return false;
    hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    bool good =
        H5Tget_class(type) == H5Tget_class(memory) && H5Tget_size(type) == H5Tget_size(memory) &&
        H5Sget_simple_extent_type(space) == H5S_SCALAR && H5Aread(attribute, memory, value) >= 0;
    if (type >= 0) H5Tclose(type);
    if (space >= 0) H5Sclose(space);
    H5Aclose(attribute);
    return good;
}

/* Rows lie in one piece in this very file, where its headers say; n: their bytes. */
static bool lies_in_file(hid_t dataset, hsize_t n)
{
    hid_t layout = H5Dget_create_plist(dataset), file = H5Iget_file_id(dataset);
    hsize_t end = 0, stored = H5Dget_storage_size(dataset);
    haddr_t at = H5Dget_offset(dataset);
    bool good = H5Pget_layout(layout) == H5D_CONTIGUOUS && H5Pget_external_count(layout) == 0 &&
                H5Fget_filesize(file, &end) >= 0 && n <= stored &&
                (n == 0 || (at != HADDR_UNDEF && at <= end && stored <= end - at));
    if (layout >= 0) H5Pclose(layout);
    if (file >= 0) H5Fclose(file);
    return good;
}

static const char *sum_part(
    hid_t dataset, hid_t stored, hid_t space, int part, int n_part, bool finite, uint64_t *sum)
{
    hsize_t shape[2] = {0, 1};
    int rank = H5Sget_simple_extent_ndims(space);
    if (rank < 1 || rank > 2 || H5Sget_simple_extent_dims(space, shape, NULL) < 0)
        return "its shape is not one that democles writes";
    hid_t memory;
    enum column_type type = type_of(stored, &memory);
    if (memory < 0) return "its type is not one that democles writes";
    if (H5Tget_class(stored) == H5T_STRING && (rank != 1 || shape[0] != 1)) {
        H5Tclose(memory);
        return "it is not one text";
    }
    /* A damaged header may claim any size: never ask for more than the file can hold. */
    hsize_t stored_bytes = H5Dget_storage_size(dataset), row = shape[1] * H5Tget_size(memory);
    const char *wrong = (shape[0] > 0 && row == 0) || (row > 0 && shape[0] > stored_bytes / row) ||
                                row / H5Tget_size(memory) != shape[1] ||
                                !lies_in_file(dataset, shape[0] * row)
                            ? "it is shorter than its header says"
                            : NULL;
    hsize_t begin = shape[0] * (hsize_t)part / (hsize_t)n_part,
            end = shape[0] * ((hsize_t)part + 1) / (hsize_t)n_part;
    if (!wrong && begin < end)
        wrong = sum_rows(dataset, memory, type, shape, begin, end, finite, sum);
    H5Tclose(memory);
    return wrong;
}

const char *h5_check_part(
    hid_t dataset, int part, int n_part, bool finite, uint64_t *sum, uint64_t *expected)
{
    *sum = *expected = 0;
    if (H5Aexists(dataset, "checksum") <= 0) return "it has no checksum";
    if (!h5_check_number(dataset, ".", "checksum", H5T_NATIVE_UINT64, expected))
        return "its checksum cannot be read";
    hid_t stored = H5Dget_type(dataset), space = H5Dget_space(dataset);
    const char *wrong = stored < 0 || space < 0
                            ? "its header cannot be read"
                            : sum_part(dataset, stored, space, part, n_part, finite, sum);
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
