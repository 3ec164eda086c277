/* Programs from joined sources, arguments by name, padded ranges, buffers that grow and swap under
 * a launch. Argument: folder of the test kernels. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "device/launch.h"

static struct device *dev;
static const char *const sources[] = {"scale.cl", NULL};

static struct program *build(const char *options)
{
    return program_build(dev, NULL, "test", options, sources);
}

static int occurrences(const char *text, const char *what)
{
    int n = 0;
    for (; (text = strstr(text, what)); text++) n++;
    return n;
}

static void joined(void **state)
{
    (void)state;
    char *text = program_source(sources);
    assert_int_equal(occurrences(text, "#define INNER"), 1); /* asked for by two files */
    assert_int_equal(occurrences(text, "#define OUTER"), 1);
    assert_int_equal(occurrences(text, "#include"), 0);
    assert_true(strstr(text, "#define INNER") < strstr(text, "#define OUTER"));
    assert_non_null(strstr(text, "#line 4 \"scale.cl\"\n"));
    assert_non_null(strstr(text, "#line 1 \"inner.h\"\n"));
    free(text);
}

static void embedded(void **state)
{
    static const char *const types[] = {"types.h", NULL};
    char *folder = strdup(getenv("DEMOCLES_KERNELS"));
    (void)state;
    unsetenv("DEMOCLES_KERNELS");
    char *text = program_source(types);
    assert_non_null(strstr(text, "#define DEMOCLES_TYPES_H"));
    assert_int_equal(text[strlen(text) - 1], '\n');
    free(text);
    setenv("DEMOCLES_KERNELS", folder, 1);
    free(folder);
}

/* y = factor x + bias [+ shift] for both features and the reals that the device has. */
static void by_name(void **state)
{
    enum { N = 1000 };
    (void)state;
    for (int k = 0; k < 4; k++) {
        bool shifted = k & 1, single = k & 2;
        size_t size = single ? 4 : 8;
        if (!single && !dev->fp64) continue;
        char options[64];
        snprintf(options, sizeof options, "-DWITH_SHIFT=%d -DREAL_IS_FLOAT=%d", shifted, single);
        struct program *program = build(options);
        assert_int_equal(program->real_is_float, single);
        struct launch *launch = launch_create(program, "scale");
        struct buffer x, y, shift;
        buffer_init(&x, dev, "x");
        buffer_init(&y, dev, "y");
        buffer_init(&shift, dev, "shift");
        buffer_reserve(&x, N * size);
        buffer_reserve(&y, N * size);
        buffer_reserve(&shift, N * size);
        double d[N];
        float f[N];
        for (int i = 0; i < N; i++) f[i] = (float)(d[i] = i);
        buffer_write(&x, 0, N * size, single ? (void *)f : (void *)d);
        buffer_write(&shift, 0, N * size, single ? (void *)f : (void *)d);

        assert_int_equal(launch->n_arg, shifted ? 6 : 5);
        launch_bind_all(launch, (const struct launch_binding[]){{"x", &x}, {0}});
        launch_bind(launch, "y", y.mem);
        assert_int_equal(launch_has(launch, "shift"), shifted);
        launch_bind_all_if(
            launch, (const struct launch_binding[]){{"no_such", &x}, {"shift", &shift}, {0}});
        assert_false(launch_set_int_if(launch, "no_such", 1));
        assert_false(launch_set_real_if(launch, "no_such", 1));
        launch_set_real(launch, "factor", 0.5);
        launch_set_long(launch, "bias", 1000000);
        launch_set_count(launch, "n", N);
        launch_check(launch);
        launch_run(launch, N);
        buffer_read(&y, 0, N * size, single ? (void *)f : (void *)d);
        for (int i = 0; i < N; i++)
            assert_true((single ? (double)f[i] : d[i]) == 0.5 * i + 1e6 + (shifted ? i : 0));

        launch_free(launch);
        buffer_free(&x);
        buffer_free(&y);
        buffer_free(&shift);
        program_free(program);
    }
}

static void padded(void **state)
{
    (void)state;
    assert_int_equal(launch_padded(1, 64), 64);
    assert_int_equal(launch_padded(64, 64), 64);
    assert_int_equal(launch_padded(65, 64), 128);
    assert_int_equal(launch_padded(128 * 64, 64), 128 * 64);
    assert_int_equal(launch_padded(128 * 64 + 1, 64), 130 * 64);
    size_t last = 0;
    int sizes = 0;
    for (int64_t n = 1; n < 3000000; n += 17) {
        size_t global = launch_padded(n, 64);
        assert_true(global % 64 == 0 && (int64_t)global >= n && (int64_t)global < n + 64 + n / 63 &&
                    global >= last);
        sizes += global != last;
        last = global;
    }
    assert_true(sizes < 1200); /* of 47,000 groups: sizes that pocl has to remember */
}

static void grows_and_swaps(void **state)
{
    struct program *program = build("-DWITH_SHIFT=0 -DREAL_IS_FLOAT=1");
    struct launch *launch = launch_create(program, "count");
    struct buffer a, b;
    int32_t seen[256];
    (void)state;
    assert_int_equal(launch->local, LAUNCH_LOCAL);
    buffer_init(&a, dev, "a");
    buffer_init(&b, dev, "b");
    launch_bind_buffer(launch, "seen", &a); /* no memory yet */
    buffer_reserve(&a, 256);
    buffer_zero(&a);
    launch_run(launch, 64);
    buffer_read(&a, 0, 256, seen);
    assert_int_equal(seen[63], 1);

    buffer_reserve(&a, 1024); /* new memory */
    buffer_zero(&a);
    launch_run(launch, 129);
    buffer_read(&a, 0, 1024, seen);
    for (int i = 0; i < 256; i++) assert_int_equal(seen[i], i < 192); /* padded to three groups */

    buffer_reserve(&b, 1024);
    buffer_zero(&b);
    struct buffer swap = a;
    a = b;
    b = swap;
    launch_run(launch, 256);
    buffer_read(&a, 0, 1024, seen);
    for (int i = 0; i < 256; i++) assert_int_equal(seen[i], 1);
    assert_int_equal(launch->n_run, 3);
    launch_free(launch);

    launch = launch_create(program, "width"); /* declares its own size */
    launch_bind_buffer(launch, "local_size", &a);
    launch_run(launch, 1);
    buffer_read(&a, 0, 4, seen);
    assert_int_equal(seen[0], 32);
    launch_free(launch);
    buffer_free(&a);
    buffer_free(&b);
    program_free(program);
}

/* Nothing to do still orders the queues; repeated launches allocate and copy nothing; with
 * profiling there are times. */
static void empty_and_counted(void **state)
{
    struct device *timed = device_open(NULL, NULL, false, true);
    struct program *program =
        program_build(timed, NULL, "test", "-DWITH_SHIFT=0 -DREAL_IS_FLOAT=1", sources);
    struct launch *launch = launch_create(program, "count");
    struct buffer seen;
    cl_event first, second;
    int32_t value[64];
    (void)state;
    buffer_init(&seen, timed, "seen");
    buffer_reserve(&seen, sizeof value);
    buffer_zero(&seen);
    launch_bind_buffer(launch, "seen", &seen);
    launch_run_on(launch, timed->compute, 64, NULL, &first);
    launch_run_on(launch, timed->copy, 0, &first, &second);
    launch_run_on(launch, timed->copy, -5, NULL, NULL);
    struct device_counters c = timed->counters;
    for (int i = 0; i < 200; i++) launch_run(launch, 64);
    device_finish(timed);
    assert_true(device_event_done(first) && device_event_done(second));
    clReleaseEvent(first);
    clReleaseEvent(second);
    assert_int_equal(timed->counters.n_launch - c.n_launch, 200);
    c.n_launch = timed->counters.n_launch;
    assert_memory_equal(&c, &timed->counters, sizeof c);
    buffer_read(&seen, 0, sizeof value, value);
    assert_int_equal(value[17], 201);
    double seconds = launch_seconds(launch);
    assert_true(seconds > 0 && seconds < 10 && seconds == launch_seconds(launch));
    launch_free(launch);
    buffer_free(&seen);
    program_free(program);
    device_free(timed);
}

int main(int argc, char **argv)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(joined), cmocka_unit_test(embedded),
        cmocka_unit_test(by_name), cmocka_unit_test(padded), cmocka_unit_test(grows_and_swaps),
        cmocka_unit_test(empty_and_counted)};
    if (argc != 2) return 2;
    setenv("DEMOCLES_KERNELS", argv[1], 1);
    dev = device_open(NULL, NULL, false, false);
    int failed = cmocka_run_group_tests_name("launch", tests, NULL, NULL);
    device_free(dev);
    launch_free(NULL);
    program_free(NULL);
    return failed;
}
