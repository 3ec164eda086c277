/* Whole numbers of any real: those that fit as C has them, others the nearest that fits. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <limits.h>
#include <math.h>

#include "base/whole.h"

static void integers(void **state)
{
    static const struct {
        double x;
        int64_t cast, floor, round;
    } known[] = {{0, 0, 0, 0}, {2.5, 2, 2, 3}, {-2.5, -2, -3, -3}, {-0.4, 0, -1, 0},
        {0x1p62, (int64_t)1 << 62, (int64_t)1 << 62, (int64_t)1 << 62},
        {0x1p63, INT64_MAX, INT64_MAX, INT64_MAX}, {-0x1p63, INT64_MIN, INT64_MIN, INT64_MIN},
        {1e300, INT64_MAX, INT64_MAX, INT64_MAX}, {-1e300, INT64_MIN, INT64_MIN, INT64_MIN},
        {HUGE_VAL, INT64_MAX, INT64_MAX, INT64_MAX}, {-HUGE_VAL, INT64_MIN, INT64_MIN, INT64_MIN},
        {(double)NAN, 0, 0, 0}};
    (void)state;
    for (size_t k = 0; k < sizeof known / sizeof *known; k++) {
        if (whole_i64(known[k].x) != known[k].cast || whole_floor(known[k].x) != known[k].floor ||
            whole_round(known[k].x) != known[k].round)
            fail_msg("of %g", known[k].x);
    }
}

static void ints(void **state)
{
    (void)state;
    assert_int_equal(whole_int(-7.9), -7);
    assert_int_equal(whole_int(2147483647.0), INT_MAX);
    assert_int_equal(whole_int(2147483648.0), INT_MAX);
    assert_int_equal(whole_int(-1e10), INT_MIN);
    assert_int_equal(whole_int((double)NAN), 0);
}

static void steps(void **state)
{
    (void)state;
    assert_int_equal(whole_steps(1, 0.3), 3);
    assert_int_equal(whole_steps(1e-9, 1), 1);
    assert_int_equal(whole_steps(0, 1), 1);
    assert_int_equal(whole_steps(1e300, 1e-5), INT64_MAX);
    assert_int_equal(whole_steps(1e14, 1e-5), INT64_MAX); /* 1e19 steps, above 2^63 */
    assert_int_equal(whole_steps(HUGE_VAL, 1e-5), INT64_MAX);
    assert_int_equal(whole_steps(1e300, 1e-300), INT64_MAX); /* the quotient is infinite */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(integers), cmocka_unit_test(ints), cmocka_unit_test(steps)};
    return cmocka_run_group_tests_name("whole", tests, NULL, NULL);
}
