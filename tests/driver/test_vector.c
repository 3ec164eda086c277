/* Directions of any length: a power of two changes no digit of the unit vector, however far. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include <float.h>
#include <math.h>
#include <string.h>

#include "base/vector.h"

/* The same digits at every length that doubles have, and those of the plain formula near one. */
static void lengths(void **state)
{
    static const double known[][3] = {{0, 0, 1}, {0, -1, 0}, {1, 1, 1}, {0.3, -0.4, 1.7}, {3, 4, 0},
        {1e-9, 1, -1e-3}, {-0.1, 0.2, 1.999}};
    (void)state;
    for (size_t n = 0; n < sizeof known / sizeof *known; n++) {
        const double *v = known[n];
        double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]),
               unit[3] = {v[0] / length, v[1] / length, v[2] / length};
        for (int e = -980; e <= 1021; e++) {
            double w[3] = {ldexp(v[0], e), ldexp(v[1], e), ldexp(v[2], e)};
            assert_true(vector_is_direction(w));
            assert_true(vector_normalise(w) == ldexp(length, e));
            assert_memory_equal(w, unit, sizeof w);
        }
    }
}

/* Along an axis nothing is rounded at all. */
static void axes(void **state)
{
    static const double known[] = {1e-200, 1e200, 1e-307, 1.7e308, 3, DBL_MIN, DBL_MAX, 0.1};
    (void)state;
    for (size_t n = 0; n < sizeof known / sizeof *known; n++) {
        double v[3] = {0, 0, known[n]};
        assert_true(vector_is_direction(v));
        assert_true(vector_normalise(v) == known[n]);
        assert_true(v[0] == 0 && v[1] == 0 && v[2] == 1);
    }
}

static void none(void **state)
{
    (void)state;
    assert_false(vector_is_direction((const double[3]){0, 0, 0}));
    assert_false(vector_is_direction((const double[3]){0, 1e-310, 0}));
    assert_false(vector_is_direction((const double[3]){1, HUGE_VAL, 0}));
    assert_false(vector_is_direction((const double[3]){1, 0, (double)NAN}));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lengths), cmocka_unit_test(axes), cmocka_unit_test(none)};
    return cmocka_run_group_tests_name("vector", tests, NULL, NULL);
}
