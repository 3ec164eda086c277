/* Prefix sums in place, sizes at and around a block, and the empty one. */
#include "kernel_fixture.h"

#include "comm/fail.h"
#include "device/scan.h"

static struct device *dev;
static struct scan *scan;
static uint64_t seed = 1;

static void check(int64_t n, int largest)
{
    cl_int *value = fail_alloc(((size_t)n + 2) * sizeof *value),
           *got = fail_alloc(((size_t)n + 2) * sizeof *got);
    struct buffer data;
    for (int64_t i = 0; i < n + 2; i++) value[i] = (cl_int)scratch_random(&seed, 0, largest + 1);
    fixture_buffer(dev, &data, "data", ((size_t)n + 2) * sizeof *value, value);
    int64_t total = scan_total(scan, &data, n), sum = 0;
    buffer_read(&data, 0, ((size_t)n + 2) * sizeof *got, got);
    for (int64_t i = 0; i <= n; i++) {
        assert_int_equal(got[i], sum);
        if (i < n) sum += value[i];
    }
    assert_int_equal(total, sum);
    assert_int_equal(got[n + 1], value[n + 1]); /* what lies behind is left alone */
    buffer_free(&data);
    free(value);
    free(got);
}

static void sums_of_what_stood_before(void **state)
{
    static const int64_t size[] = {
        0, 1, 2, 7, 8, 9, 255, 256, 2047, 2048, 2049, 4096, 6145, 1000000};
    (void)state;
    for (size_t k = 0; k < sizeof size / sizeof *size; k++) check(size[k], 1000);
    for (int k = 0; k < 20; k++) check((int64_t)scratch_random(&seed, 0, 20000), k % 2);
    check(2049, 0);
}

int main(void)
{
    static const char *const sources[] = {"scan.cl", NULL};
    const struct CMUnitTest tests[] = {cmocka_unit_test(sums_of_what_stood_before)};
    struct features features = fixture_features();
    dev = fixture_device();
    struct program *program = fixture_program(dev, &features, FEATURES_LISTS, sources);
    scan = scan_create(dev, program);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    scan_free(scan);
    program_free(program);
    device_free(dev);
    return failed;
}
