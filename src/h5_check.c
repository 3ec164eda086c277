#include "h5_check.h"
#include "digest.h"
#include "fail.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
    for (int64_t i = 0; i < n; i++) sum += digest_mix(digest_mix((uint64_t)(begin + i) + DIGEST_G) ^ bits_at(type, data, i));
    return sum;
}

/* Column type of a stored type, and the type to read it with (-1: none of ours). The caller closes `memory`. */
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

static const char *compare(hid_t dataset, hid_t stored, hid_t space, uint64_t expected)
{
    hid_t memory;
    enum column_type type = type_of(stored, &memory);
    hssize_t n = H5Sget_simple_extent_npoints(space);
    if (memory < 0 || n < 0) return "its type is none that democles writes";
    size_t size = H5Tget_size(memory);
    /* A damaged header may claim any size: never ask for more than the file can hold. */
    if ((hsize_t)n * size > H5Dget_storage_size(dataset)) {
        H5Tclose(memory);
        return "it is shorter than its header says";
    }
    void *data = fail_alloc((size_t)n * size);
    herr_t code = H5Dread(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data);
    uint64_t found = h5_check_sum(type, data, (int64_t)((size_t)n * size / column_type_size(type)), 0);
    free(data);
    H5Tclose(memory);
    if (code < 0) return "cannot be read";
    return found == expected ? NULL : "its checksum is wrong";
}

const char *h5_check_dataset(hid_t dataset)
{
    if (H5Aexists(dataset, "checksum") <= 0) return "it has no checksum";
    uint64_t expected = 0;
    hid_t attribute = H5Aopen(dataset, "checksum", H5P_DEFAULT);
    herr_t code = attribute < 0 ? -1 : H5Aread(attribute, H5T_NATIVE_UINT64, &expected);
    if (attribute >= 0) H5Aclose(attribute);
    if (code < 0) return "its checksum cannot be read";
    hid_t stored = H5Dget_type(dataset), space = H5Dget_space(dataset);
    const char *wrong = stored < 0 || space < 0 ? "its header cannot be read" : compare(dataset, stored, space, expected);
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
