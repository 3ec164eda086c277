/* Numbers with units: right values to the last bit, and a reason where there is none. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <cmocka.h>

#include "scene/units.h"

static double value_of(const char *text, enum unit_kind kind)
{
    double value = -12345;
    char problem[256] = "";
    if (!units_parse(text, kind, &value, problem, sizeof problem))
        fail_msg("%s: %s", text, problem);
    return value;
}

static void assert_problem(const char *text, enum unit_kind kind, const char *expected)
{
    double value;
    char problem[256] = "";
    assert_false(units_parse(text, kind, &value, problem, sizeof problem));
    assert_string_equal(problem, expected);
}

/* Bits, not nearness: a scene in millimetres is the same scene as one in metres. */
static void assert_same(double a, double b)
{
    uint64_t x, y;
    memcpy(&x, &a, sizeof x);
    memcpy(&y, &b, sizeof y);
    assert_int_equal(x, y);
}

static void bare_numbers_are_si(void **state)
{
    (void)state;
    assert_same(value_of("1e3", UNIT_STIFFNESS), 1000);
    assert_same(value_of("-9.81", UNIT_ACCELERATION), -9.81);
    assert_same(value_of(".5", UNIT_NONE), 0.5);
    assert_same(value_of("+5.", UNIT_NONE), 5);
    assert_same(value_of("0", UNIT_TIME), 0);
}

static void powers_of_ten_are_exact(void **state)
{
    (void)state;
    assert_same(value_of("5 mm", UNIT_LENGTH), 0.005);
    assert_same(value_of("3mm", UNIT_LENGTH), 0.003);
    assert_same(value_of("20 us", UNIT_TIME), 2e-5);
    assert_same(value_of("20 \xc2\xb5s", UNIT_TIME), 2e-5);
    assert_same(value_of("20 \xce\xbcs", UNIT_TIME), 2e-5);
    assert_same(value_of("2e-6 s", UNIT_TIME), 2e-6);
    assert_same(value_of("0.7e1 nm", UNIT_LENGTH), 7e-9);
    assert_same(value_of("210 GPa", UNIT_PRESSURE), 210e9);
    assert_same(value_of("2 %", UNIT_NONE), 0.02);
}

static void compound_units(void **state)
{
    (void)state;
    assert_same(value_of("7.85 g/cm3", UNIT_DENSITY), 7850);
    assert_same(value_of("2200 kg/m^3", UNIT_DENSITY), 2200);
    assert_same(value_of("2.2 t/m3", UNIT_DENSITY), 2200);
    assert_same(value_of("2200 kg m^-3", UNIT_DENSITY), 2200);
    assert_same(value_of("1e3 N/m", UNIT_STIFFNESS), 1000);
    assert_same(value_of("1 kN/m", UNIT_STIFFNESS), 1000);
    assert_same(value_of("9.81 m/s2", UNIT_ACCELERATION), 9.81);
    assert_same(value_of("9.81 m/s/s", UNIT_ACCELERATION), 9.81);
    assert_same(value_of("5e-3 kg*m/s2", UNIT_FORCE), 5e-3);
    assert_same(value_of("120 1/s", UNIT_FREQUENCY), 120);
    assert_same(value_of("50 Hz", UNIT_FREQUENCY), 50);
    assert_same(value_of("3 rad/s", UNIT_ANGULAR_VELOCITY), 3);
    assert_same(value_of("1 N s/m", UNIT_DAMPING), 1);
}

static void other_factors(void **state)
{
    (void)state;
    assert_same(value_of("1.5 h", UNIT_TIME), 5400);
    assert_same(value_of("2 min", UNIT_TIME), 120);
    assert_same(value_of("90 deg", UNIT_ANGLE), 90 * (3.14159265358979323846 / 180));
    assert_same(value_of("30 \xc2\xb0", UNIT_ANGLE), 30 * (3.14159265358979323846 / 180));
    assert_same(value_of("60 rpm", UNIT_ANGULAR_VELOCITY), 60 * (3.14159265358979323846 / 30));
    assert_same(value_of("36 km/h", UNIT_VELOCITY), 36e3 * (1.0 / 3600));
    assert_same(value_of("1 bar", UNIT_PRESSURE), 1e5);
}

static void wrong_kinds_are_named(void **state)
{
    (void)state;
    assert_problem("5 mm", UNIT_TIME, "'mm' is the unit of a length; expected a time, as in '1 s'");
    assert_problem(
        "5 m", UNIT_STIFFNESS, "'m' is the unit of a length; expected a stiffness, as in '1 N/m'");
    assert_problem("5 m/s2", UNIT_VELOCITY,
        "'m/s2' is the unit of an acceleration; expected a velocity, as in '1 m/s'");
    assert_problem(
        "5 s", UNIT_NONE, "'s' is the unit of a time; expected a plain number, without unit");
    /* A frequency could mean f or 2 pi f. */
    assert_problem("5 Hz", UNIT_ANGULAR_VELOCITY,
        "'Hz' is the unit of a frequency; expected an angular velocity, as in '1 rad/s'");
    assert_problem("5 m9", UNIT_LENGTH, "'m9' is the wrong unit; expected a length, as in '1 m'");
    assert_problem("5 %", UNIT_LENGTH, "'%' is the wrong unit; expected a length, as in '1 m'");
}

static void unknown_units_are_refused(void **state)
{
    (void)state;
    assert_problem("5 sec", UNIT_TIME, "unknown unit 'sec'; expected a time, as in '1 s'");
    assert_problem("5 MM", UNIT_LENGTH, "unknown unit 'MM'; expected a length, as in '1 m'");
    assert_problem("5 m/", UNIT_VELOCITY, "unknown unit 'm/'; expected a velocity, as in '1 m/s'");
    assert_problem("5 m0", UNIT_LENGTH, "unknown unit 'm0'; expected a length, as in '1 m'");
    /* J/kg K: a product behind a slash is ambiguous. */
    assert_problem("5 N/m s", UNIT_DAMPING,
        "unknown unit 'N/m s'; expected a damping coefficient, as in '1 N s/m'");
    assert_problem("5 kmin", UNIT_TIME, "unknown unit 'kmin'; expected a time, as in '1 s'");
}

static void what_is_no_number_is_refused(void **state)
{
    (void)state;
    assert_problem(
        "fast", UNIT_NONE, "'fast' is not a number; expected a plain number, without unit");
    assert_problem("", UNIT_LENGTH, "'' is not a number; expected a length, as in '1 m'");
    assert_problem(
        ".inf", UNIT_NONE, "'.inf' is not a number; expected a plain number, without unit");
    assert_problem(
        "nan", UNIT_NONE, "'nan' is not a number; expected a plain number, without unit");
    assert_problem("0x10", UNIT_NONE, "unknown unit 'x10'; expected a plain number, without unit");
    assert_problem(
        "1,5", UNIT_NONE, "'1,5' is not a number; expected a plain number, without unit");
    assert_problem(
        "1..5", UNIT_NONE, "'1..5' is not a number; expected a plain number, without unit");
    assert_problem("1e999", UNIT_NONE, "'1e999' is too large for a double");
    assert_problem("1e300 Tm", UNIT_LENGTH, "'1e300 Tm' is too large for a double");
}

static void printed_numbers_read_back(void **state)
{
    (void)state;
    const double value[] = {0, 0.1, 1e-5, 2200, 1.0 / 3, 3.14159265358979323846, 5e-324,
        1.7976931348623157e308, -0.005, 0.1 + 0.2};
    for (size_t k = 0; k < sizeof value / sizeof *value; k++) {
        char text[32];
        units_print(value[k], text);
        assert_same(value_of(text, UNIT_NONE), value[k]);
    }
    char text[32];
    units_print(0.005, text);
    assert_string_equal(text, "0.005");
    units_print(2200, text);
    assert_string_equal(text, "2200");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bare_numbers_are_si),
        cmocka_unit_test(powers_of_ten_are_exact),
        cmocka_unit_test(compound_units),
        cmocka_unit_test(other_factors),
        cmocka_unit_test(wrong_kinds_are_named),
        cmocka_unit_test(unknown_units_are_refused),
        cmocka_unit_test(what_is_no_number_is_refused),
        cmocka_unit_test(printed_numbers_read_back),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
