/* HDF5 without MPI: checksum of a dataset, its comparison on reading, and HDF5's own words on an
 * error. */
#ifndef DEMOCLES_H5_CHECK_H
#define DEMOCLES_H5_CHECK_H

#include "column.h"

#include <hdf5.h>
#include <stdbool.h>

/* Sum mod 2^64 over numbers of mix(mix(k + G) xor bits): k the flat index from 0 over all ranks,
 * bits as stored and zero extended, mix and G of digest.h. Independent of how the rows are spread
 * over ranks. data [n]; `begin`: flat index of the first number. Text: its bytes as U8. */
uint64_t h5_check_sum(enum column_type type, const void *data, int64_t n, int64_t begin);
/* Takes such a sum of one more array [n] into the number that stands for several in their order. */
uint64_t h5_check_add(uint64_t all, enum column_type type, const void *data, int64_t n);

/* Reads one of n_part parts of the rows of a dataset (any of the column types, or a fixed-length
 * string) and gives its sum; those of all parts have to add up to `expected`, the attribute
 * `checksum`. finite: all numbers have to be. Not collective. Returns NULL, or why that cannot be
 * told, as static text. */
const char *h5_check_part(
    hid_t dataset, int part, int n_part, bool finite, uint64_t *sum, uint64_t *expected);
/* Whether n numbers are finite; integers always are. */
bool h5_check_finite(enum column_type type, const void *data, int64_t n);
/* What is said where they do not add up. */
extern const char h5_check_wrong[];

/* Reads an attribute of `object` below `at` that is a single number of the kind and size of
 * `memory`; returns false, and leaves `value`, where it is anything else, however long. */
bool h5_check_number(hid_t at, const char *object, const char *name, hid_t memory, void *value);

/* HDF5's error stack in short: what was tried, and the innermost reason. Static storage,
 * overwritten by the next call. */
const char *h5_check_error(void);

#endif
