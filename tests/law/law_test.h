/* cmocka with its includes, and assertions on numbers that print them. */
#ifndef DEMOCLES_LAW_TEST_H
#define DEMOCLES_LAW_TEST_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

#include <cmocka.h>

/* value within limit of expected. */
#define assert_near(value, expected, limit)                                                        \
    do {                                                                                           \
        double value_ = (value), expected_ = (expected), limit_ = (limit);                         \
        if (!(fabs(value_ - expected_) <= limit_))                                                 \
            fail_msg("%s is %.9g, not %.9g within %.3g (off by %.3g)", #value, value_, expected_,  \
                limit_, value_ - expected_);                                                       \
    } while (0)

#define assert_below(value, limit)                                                                 \
    do {                                                                                           \
        double value_ = (value), limit_ = (limit);                                                 \
        if (!(value_ < limit_)) fail_msg("%s is %.9g, not below %.9g", #value, value_, limit_);    \
    } while (0)

/* Order of convergence from two errors at n_1 and n_2 steps. */
static inline double law_order(double error_1, double n_1, double error_2, double n_2)
{
    return log(error_1 / error_2) / log(n_2 / n_1);
}

#endif
