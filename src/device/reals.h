/* Numbers of the device, float or double as a program was built, as doubles of the host. Float bits
 * widen exactly, so a double that came from the device goes back with the same bits. */
#ifndef DEMOCLES_REALS_H
#define DEMOCLES_REALS_H

#include "buffer.h"

/* [byte] of one number. */
static inline size_t reals_size(bool is_float)
{
    return is_float ? sizeof(float) : sizeof(double);
}

/* Number k of `data`, which is aligned for it. */
static inline double reals_get(const void *data, bool is_float, size_t k)
{
    return is_float ? (double)((const float *)data)[k] : ((const double *)data)[k];
}

static inline void reals_set(void *data, bool is_float, size_t k, double value)
{
    if (is_float) ((float *)data)[k] = (float)value;
    else ((double *)data)[k] = value;
}

/* The n numbers of a buffer from number `first` on: blocking, as buffer_read and buffer_write. The
 * caller frees what is read. */
double *reals_read(const struct buffer *buffer, bool is_float, size_t first, size_t n);
void reals_write(struct buffer *buffer, bool is_float, size_t first, size_t n, const double *value);
/* Makes room for n numbers and writes them all. */
void reals_put(struct buffer *buffer, bool is_float, size_t n, const double *value);

#endif
