/* Numbers as text: doubles that read back to the same bits, JSON, durations; and the checksum of
 * datasets. */
#define _GNU_SOURCE /* pipe2, O_DIRECT */
#include <fcntl.h>
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "comm/fail.h"
#include "results/digest.h"
#include "results/h5_check.h"
#include "results/log.h"
#include "results/report.h"
#include "results/series.h"

static void test_numbers_are_short(void **state)
{
    (void)state;
    char text[SERIES_NUMBER_SIZE];
    assert_string_equal(series_number(0.1, text), "0.1");
    assert_string_equal(series_number(10600, text), "10600");
    assert_string_equal(series_number(-0.0, text), "-0");
    assert_string_equal(series_number(1.0 / 3.0, text), "0.3333333333333333");
    assert_string_equal(series_number((double)__builtin_nanf(""), text), "nan");
    assert_string_equal(series_number(-HUGE_VAL, text), "-inf");
}

static void test_numbers_read_back_to_the_same_bits(void **state)
{
    (void)state;
    char text[SERIES_NUMBER_SIZE];
    uint64_t word = 1;
    const double extreme[] = {DBL_MAX, DBL_MIN, 5e-324, 9007199254740993.0, 1e23, -DBL_EPSILON};
    for (size_t k = 0; k < sizeof extreme / sizeof *extreme; k++)
        assert_true(strtod(series_number(extreme[k], text), NULL) == extreme[k]);
    for (int k = 0; k < 20000; k++) {
        double value, back;
        word = digest_mix(word + DIGEST_G);
        memcpy(&value, &word, sizeof value);
        if (value != value) continue;
        back = strtod(series_number(value, text), NULL);
        assert_memory_equal(&back, &value, sizeof value);
        assert_true(strlen(text) < SERIES_NUMBER_SIZE - 1);
    }
}

static void test_json(void **state)
{
    (void)state;
    struct report *report = report_create();
    report_text(report, "name", "a \"b\" \\ c\n\t\x01 µ");
    report_text(report, "none", NULL);
    report_number(report, "x", 0.1);
    report_number(report, "nan", (double)__builtin_nanf(""));
    report_number(report, "inf", HUGE_VAL);
    report_integer(report, "n", INT64_MIN);
    report_flag(report, "yes", true);
    report_numbers(report, "v", (const double[]){1, -2.5}, 2);
    report_begin(report, "inner");
    report_end(report);
    report_begin_list(report, "list");
    report_begin(report, NULL);
    report_integer(report, "k", 1);
    report_end(report);
    report_text(report, NULL, "two");
    report_end(report);
    const char *expected = "{\n"
                           "  \"name\": \"a \\\"b\\\" \\\\ c\\n\\t\\u0001 µ\",\n"
                           "  \"none\": null,\n"
                           "  \"x\": 0.1,\n"
                           "  \"nan\": null,\n"
                           "  \"inf\": null,\n"
                           "  \"n\": -9223372036854775808,\n"
                           "  \"yes\": true,\n"
                           "  \"v\": [1, -2.5],\n"
                           "  \"inner\": {},\n"
                           "  \"list\": [\n"
                           "    {\n"
                           "      \"k\": 1\n"
                           "    },\n"
                           "    \"two\"\n"
                           "  ]\n"
                           "}\n";
    assert_string_equal(report_json(report), expected);
    assert_string_equal(report_json(report), expected); /* asking twice does not close twice */
    report_free(report);
}

static void test_durations(void **state)
{
    (void)state;
    char text[LOG_DURATION_SIZE];
    assert_string_equal(log_duration(0, text), "0.0 s");
    assert_string_equal(log_duration(9.94, text), "9.9 s");
    assert_string_equal(log_duration(9.96, text), "10 s");
    assert_string_equal(log_duration(59.4, text), "59 s");
    assert_string_equal(log_duration(59.6, text), "1 min 00 s");
    assert_string_equal(log_duration(3725, text), "1 h 02 min");
    assert_string_equal(log_duration(-1, text), "?");
    assert_string_equal(log_duration((double)__builtin_nanf(""), text), "?");
    assert_string_equal(log_duration(HUGE_VAL, text), "?");
}

/* Parts of an array, summed with their begin, give the checksum of the whole; exchanged numbers
 * give another. */
static void test_checksum_of_parts(void **state)
{
    (void)state;
    double a[10];
    for (int i = 0; i < 10; i++) a[i] = 1.0 / (i + 1);
    uint64_t whole = h5_check_sum(COLUMN_F64, a, 10, 0);
    for (int cut = 0; cut <= 10; cut++) {
        assert_true(h5_check_sum(COLUMN_F64, a, cut, 0) +
                        h5_check_sum(COLUMN_F64, a + cut, 10 - cut, cut) ==
                    whole);
    }
    double kept = a[3];
    a[3] = a[4];
    a[4] = kept;
    assert_true(h5_check_sum(COLUMN_F64, a, 10, 0) != whole);
}

/* A pipe in packet mode hands over one write at a time. */
static void test_a_warning_is_one_write(void **state)
{
    (void)state;
    int end[2], screen = dup(STDERR_FILENO);
    assert_int_equal(pipe2(end, O_DIRECT), 0);
    dup2(end[1], STDERR_FILENO);
    fail_warn("%s of %d", "part", 7);
    dup2(screen, STDERR_FILENO);
    close(end[1]);
    char text[100] = "";
    assert_true(read(end[0], text, sizeof text - 1) > 0);
    assert_string_equal(text, "democles: warning: part of 7\n");
    close(end[0]);
    close(screen);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_numbers_are_short),
        cmocka_unit_test(test_numbers_read_back_to_the_same_bits),
        cmocka_unit_test(test_json),
        cmocka_unit_test(test_durations),
        cmocka_unit_test(test_checksum_of_parts),
        cmocka_unit_test(test_a_warning_is_one_write),
    };
    return cmocka_run_group_tests_name("text", tests, NULL, NULL);
}
