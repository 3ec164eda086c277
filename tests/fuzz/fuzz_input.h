/* What the fuzz targets share: bytes of the fuzzer as a file, and as numbers one after the other.
 *
 * A target is a program of libFuzzer: it calls LLVMFuzzerTestOneInput with ever other bytes, and a
 * report of a sanitizer, an abort or a time-out is a finding. */
#ifndef FUZZ_INPUT_H
#define FUZZ_INPUT_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Ends the process with a word to whoever reads the report. */
static inline void fuzz_expect(int holds, const char *what)
{
    if (holds) return;
    fprintf(stderr, "fuzz: this does not hold: %s\n", what);
    abort();
}

/* The path of a file in memory that holds these bytes, until the next call. */
static inline const char *fuzz_file(const uint8_t *data, size_t size)
{
    static int descriptor = -1;
    static char path[64], name[] = "/dev/shm/democles_fuzz_XXXXXX";
    if (descriptor < 0) {
        descriptor = mkstemp(name);
        unlink(name); /* its descriptor is all that is left of it */
    }
    snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
    fuzz_expect(ftruncate(descriptor, 0) == 0 && pwrite(descriptor, data, size, 0) == (ssize_t)size,
        "a file in memory can be written");
    return path;
}

/* Bytes that have not been used yet. */
struct fuzz_bytes {
    const uint8_t *at, *end;
};

/* The next number of a size of at most 8 bytes; zeros follow the last byte. */
static inline uint64_t fuzz_next(struct fuzz_bytes *bytes, size_t size)
{
    uint64_t value = 0;
    size_t left = (size_t)(bytes->end - bytes->at), n = size < left ? size : left;
    memcpy(&value, bytes->at, n);
    bytes->at += n;
    return value;
}

/* A number below n. */
static inline size_t fuzz_choose(struct fuzz_bytes *bytes, size_t n)
{
    return fuzz_next(bytes, 1) % n;
}

#endif
