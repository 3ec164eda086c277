/* Distances counted by hand, and which name is meant. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "base/nearest.h"

static void distances(void **state)
{
    (void)state;
    assert_int_equal(nearest_distance("", ""), 0);
    assert_int_equal(nearest_distance("", "abc"), 3);
    assert_int_equal(nearest_distance("abc", ""), 3);
    assert_int_equal(nearest_distance("kitten", "sitting"), 3);
    assert_int_equal(nearest_distance("stifness", "stiffness"), 1); /* insertion */
    assert_int_equal(nearest_distance("radiuss", "radius"), 1);     /* deletion */
    assert_int_equal(nearest_distance("raduis", "radius"), 1);      /* swap of neighbours */
    assert_int_equal(nearest_distance("Young", "young"), 0);        /* case does not matter */
}

static void nearest_of_several(void **state)
{
    (void)state;
    const char *const name[] = {"law", "stiffness", "damping_ratio", "restitution", "attraction"};
    assert_string_equal(nearest_name("stifness", name, 5), "stiffness");
    assert_string_equal(
        nearest_name("damping", (const char *const[]){"dampin", "dumping"}, 2), "dampin");
    assert_string_equal(nearest_name("lwa", name, 5), "law");
    assert_null(nearest_name("colour", name, 5));
    assert_null(nearest_name("stiffness", name, 0));
}

/* One letter in place of another is no hint. */
static void nothing_in_common_is_not_near(void **state)
{
    (void)state;
    const char *const axis[] = {"x", "y", "z"};
    assert_null(nearest_name("w", axis, 3));
    assert_string_equal(nearest_name("X", axis, 3), "x");
    assert_string_equal(nearest_name("xx", axis, 3), "x");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(distances),
        cmocka_unit_test(nearest_of_several), cmocka_unit_test(nothing_in_common_is_not_near)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
