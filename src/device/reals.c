#include "reals.h"

#include <stdlib.h>

#include "comm/fail.h"

double *reals_read(const struct buffer *buffer, bool is_float, size_t first, size_t n)
{
    double *value = fail_alloc(n * sizeof *value);
    if (is_float) {
        float *single = fail_alloc(n * sizeof *single);
        buffer_read(buffer, first * sizeof *single, n * sizeof *single, single);
        for (size_t i = 0; i < n; i++) value[i] = (double)single[i];
        free(single);
    } else {
        buffer_read(buffer, first * sizeof *value, n * sizeof *value, value);
    }
    return value;
}

void reals_write(struct buffer *buffer, bool is_float, size_t first, size_t n, const double *value)
{
    if (is_float) {
        float *single = fail_alloc(n * sizeof *single);
        for (size_t i = 0; i < n; i++) single[i] = (float)value[i];
        buffer_write(buffer, first * sizeof *single, n * sizeof *single, single);
        free(single);
    } else {
        buffer_write(buffer, first * sizeof *value, n * sizeof *value, value);
    }
}

void reals_put(struct buffer *buffer, bool is_float, size_t n, const double *value)
{
    buffer_reserve(buffer, n * reals_size(is_float));
    reals_write(buffer, is_float, 0, n, value);
}
