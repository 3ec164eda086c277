/* Histories: values and means against closed forms, also over corners and backwards; tables from
 * files. */
#include "../walls/scratch.h"

#include "scene/history.h"

static void constant(void **unused)
{
    (void)unused;
    const struct history h = {.kind = HISTORY_CONSTANT};
    assert_true(history_at(&h, -1) == 1 && history_at(&h, 3) == 1 && history_mean(&h, 0, 2) == 1);
}

/* Integral of the ramp from 0 to t. */
static double ramp_integral(double t, double length)
{
    return t <= 0 ? 0 : t < length ? t * t / (2 * length) : t - length / 2;
}

static void ramp(void **unused)
{
    (void)unused;
    const struct history h = {.kind = HISTORY_RAMP, .ramp = 0.4};
    assert_true(history_at(&h, -1) == 0 && history_at(&h, 0.1) == 0.1 / 0.4 &&
                history_at(&h, 0.4) == 1 && history_at(&h, 9) == 1);
    uint64_t state = 3;
    for (int k = 0; k < 1000; k++) {
        double a = scratch_random(&state, -0.5, 1), b = scratch_random(&state, -0.5, 1);
        double exact = (ramp_integral(b, 0.4) - ramp_integral(a, 0.4)) / (b - a);
        assert_true(fabs(history_mean(&h, a, b) - exact) < 1e-12);
        assert_true(history_mean(&h, a, b) == history_mean(&h, b, a) &&
                    history_mean(&h, a, a) == history_at(&h, a));
    }
}

static void sine(void **unused)
{
    (void)unused;
    const struct history h = {.kind = HISTORY_SINE, .frequency = 3, .phase = 0.7};
    double w = 6 * M_PI;
    uint64_t state = 5;
    assert_true(fabs(history_at(&h, 0.2) - sin(w * 0.2 + 0.7)) < 1e-14);
    for (int k = 0; k < 1000; k++) {
        double a = scratch_random(&state, 0, 1), b = a + scratch_random(&state, 0.01, 1);
        double exact = (cos(w * a + 0.7) - cos(w * b + 0.7)) / (w * (b - a));
        assert_true(fabs(history_mean(&h, a, b) - exact) < 1e-13);
        assert_true(history_mean(&h, a, b) == history_mean(&h, b, a));
        /* a very short step: the difference of cosines would have lost its digits */
        assert_true(fabs(history_mean(&h, a, a + 1e-9) - sin(w * (a + 0.5e-9) + 0.7)) < 1e-13);
    }
    const struct history still = {.kind = HISTORY_SINE, .phase = 0.5};
    assert_true(history_mean(&still, 0, 1) == sin(0.5));
}

/* The change over a time without corner in it is the mean of the rate. */
static void rates(void **unused)
{
    (void)unused;
    double point[3][2] = {{0.1, 2}, {0.2, -1}, {0.25, 4}};
    const struct history constant = {.kind = HISTORY_CONSTANT},
                         ramp = {.kind = HISTORY_RAMP, .ramp = 0.4},
                         sine = {.kind = HISTORY_SINE, .frequency = 3, .phase = 0.7},
                         table = {.kind = HISTORY_TABLE, .point = point, .n_point = 3};
    assert_true(history_rate(&constant, 1) == 0);
    assert_true(history_rate(&ramp, -1) == 0 && history_rate(&ramp, 0.2) == 2.5 &&
                history_rate(&ramp, 9) == 0);
    assert_true(history_rate(&ramp, 0) == 1.25 && history_rate(&ramp, 0.4) == 1.25);
    assert_true(fabs(history_rate(&sine, 0.2) - 6 * M_PI * cos(6 * M_PI * 0.2 + 0.7)) < 1e-12);
    assert_true(history_rate(&table, 0) == 0 && fabs(history_rate(&table, 0.15) + 30) < 1e-12 &&
                fabs(history_rate(&table, 0.22) - 100) < 1e-11);
    assert_true(history_rate(&table, 0.3) == 0 && fabs(history_rate(&table, 0.1) + 15) < 1e-12 &&
                fabs(history_rate(&table, 0.2) - 35) < 1e-11);
}

/* Integral of the table from its first time to t: area of the trapezia. */
static double table_integral(const struct history *h, double t)
{
    double sum = 0;
    if (t <= h->point[0][0]) return (t - h->point[0][0]) * h->point[0][1];
    for (int k = 1; k < h->n_point; k++) {
        const double *p = h->point[k - 1], *q = h->point[k];
        double end = fmin(t, q[0]);
        if (end <= p[0]) return sum;
        double f = p[1] + (q[1] - p[1]) * (end - p[0]) / (q[0] - p[0]);
        sum += 0.5 * (p[1] + f) * (end - p[0]);
    }
    return sum + fmax(0, t - h->point[h->n_point - 1][0]) * h->point[h->n_point - 1][1];
}

static void table(void **unused)
{
    (void)unused;
    double point[5][2] = {{0.1, 2}, {0.2, -1}, {0.25, 4}, {0.7, 4}, {0.71, 0.5}};
    const struct history h = {.kind = HISTORY_TABLE, .point = point, .n_point = 5},
                         one = {.kind = HISTORY_TABLE, .point = point, .n_point = 1};
    assert_true(history_at(&h, 0) == 2 && history_at(&h, 0.1) == 2 &&
                fabs(history_at(&h, 0.15) - 0.5) < 1e-14 && history_at(&h, 0.5) == 4);
    assert_true(history_at(&h, 0.71) == 0.5 && history_at(&h, 3) == 0.5 &&
                history_at(&one, -1) == 2 && history_mean(&one, -1, 1) == 2);
    uint64_t state = 9;
    for (int k = 0; k < 1000; k++) {
        double a = scratch_random(&state, -0.2, 1), b = scratch_random(&state, -0.2, 1);
        double exact = (table_integral(&h, b) - table_integral(&h, a)) / (b - a);
        assert_true(fabs(history_mean(&h, a, b) - exact) < 1e-11);
        assert_true(history_mean(&h, a, b) == history_mean(&h, b, a));
    }
}

static void expect_bytes(const char *text, size_t bytes, const char *problem, int n)
{
    char *path = scratch_file(text, bytes), *expected = NULL;
    struct history h = {0};
    char *found = history_read(&h, path);
    if (problem) {
        size_t size = strlen(path) + strlen(problem) + 2;
        expected = malloc(size);
        snprintf(expected, size, "%s:%s", path, problem);
        assert_non_null(found);
        assert_string_equal(found, expected);
    } else {
        assert_null(found);
        assert_int_equal(h.n_point, n);
        assert_true(h.point[0][0] == 0 && h.point[1][0] == 1e-3 && h.point[1][1] == -2.5);
    }
    free(expected);
    free(found);
    free(h.point);
    scratch_remove(path);
}

static void expect_file(const char *text, const char *problem, int n)
{
    expect_bytes(text, strlen(text), problem, n);
}

static void files(void **unused)
{
    (void)unused;
    expect_bytes("0,1\n\0\0\0\0", 8, "2:1: NUL byte: this is no text, or damaged", 0);
    expect_bytes("0,1\n1,2\0\n2,3\n", 13, "2:4: NUL byte: this is no text, or damaged", 0);
    expect_file("0,1\n1e-3,-2.5\n", NULL, 2);
    expect_file("time,factor\n\n 0 , 1 \r\n1e-3,-2.5\n2,0", NULL, 3);
    expect_file("time,factor\ntime,factor\n", "2: the time is not a number", 0);
    expect_file("0,1\n1,x\n", "2: the factor is not a number", 0);
    expect_file("0;1\n", "1: expected time, factor", 0);
    expect_file("0,1,2\n", "1: more than a time and a factor", 0);
    expect_file("0,1\n1,2\n1,3\n", "3: times must increase", 0);
    expect_file("0,inf\n", "1: the factor is not a number", 0);
    expect_file("time,factor\n", " no point", 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(constant), cmocka_unit_test(ramp),
        cmocka_unit_test(sine), cmocka_unit_test(rates), cmocka_unit_test(table),
        cmocka_unit_test(files)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
