#include "whole.h"

#include <limits.h>
#include <math.h>

int64_t whole_i64(double x)
{
    if (isnan(x)) return 0;
    /* 2^63 is the first real that is too large; -2^63 fits. */
    if (x >= 0x1p63) return INT64_MAX;
    if (x < -0x1p63) return INT64_MIN;
    return (int64_t)x;
}

int whole_int(double x)
{
    int64_t n = whole_i64(x);
    return n > INT_MAX ? INT_MAX : n < INT_MIN ? INT_MIN : (int)n;
}

int64_t whole_floor(double x)
{
    return whole_i64(floor(x));
}

int64_t whole_round(double x)
{
    return whole_i64(round(x));
}

int64_t whole_steps(double period, double dt)
{
    int64_t n = whole_round(period / dt);
    return n < 1 ? 1 : n;
}
