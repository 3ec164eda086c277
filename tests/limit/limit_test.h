/* cmocka with its includes; random numbers; comparison that prints. */
#ifndef DEMOCLES_LIMIT_TEST_H
#define DEMOCLES_LIMIT_TEST_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#define assert_near(value, expected, limit)                                                        \
    do {                                                                                           \
        double value_ = (double)(value), expected_ = (double)(expected), limit_ = (double)(limit); \
        if (!(fabs(value_ - expected_) <= limit_))                                                 \
            fail_msg("%s is %.9g, not %.9g within %.3g (off by %.3g)", #value, value_, expected_,  \
                limit_, value_ - expected_);                                                       \
    } while (0)

/* value in [low, high] */
#define assert_between(value, low, high)                                                           \
    do {                                                                                           \
        double value_ = (double)(value), low_ = (double)(low), high_ = (double)(high);             \
        if (!(value_ >= low_ && value_ <= high_))                                                  \
            fail_msg("%s is %.9g, not in %.9g ... %.9g", #value, value_, low_, high_);             \
    } while (0)

#define assert_below(value, limit)                                                                 \
    do {                                                                                           \
        double value_ = (double)(value), limit_ = (double)(limit);                                 \
        if (!(value_ < limit_)) fail_msg("%s is %.9g, not below %.9g", #value, value_, limit_);    \
    } while (0)

static uint64_t limit_seed = 1;

/* Uniform in [low, high). */
static inline double uniform(double low, double high)
{
    limit_seed = limit_seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(limit_seed >> 11) / 9007199254740992.0;
}

#endif
