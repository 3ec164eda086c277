/* Growth, initial contents, copies and what they are counted as. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "device/buffer.h"

static struct device *dev;

static void all_bytes(const struct buffer *buffer, size_t n, unsigned char want)
{
    unsigned char *data = malloc(n);
    buffer_read(buffer, 0, n, data);
    for (size_t i = 0; i < n; i++) assert_int_equal(data[i], want);
    free(data);
}

static void growth(void **state)
{
    struct buffer b;
    (void)state;
    buffer_init(&b, dev, "test");
    int64_t before = dev->counters.n_alloc, now = dev->counters.now_bytes;

    assert_true(buffer_reserve(&b, 1000)); /* the first time as asked, in grains of 256 */
    assert_int_equal(b.capacity, 1024);
    all_bytes(&b, 1000, 0);
    int64_t serial = b.serial;
    assert_false(buffer_reserve(&b, 1024));
    assert_false(buffer_reserve(&b, 10));
    assert_int_equal(b.bytes, 10);
    assert_int_equal(b.serial, serial);

    assert_true(buffer_reserve(&b, 4096)); /* then with a quarter of room */
    assert_int_equal(b.capacity, 5120);
    assert_true(b.serial > serial);
    assert_false(buffer_reserve(&b, 5120));
    all_bytes(&b, 5120, 0);
    assert_int_equal(dev->counters.n_alloc, before + 2);
    assert_int_equal(dev->counters.now_bytes, now + 5120);
    assert_true(dev->counters.peak_bytes >= now + 5120);
    buffer_free(&b);
    buffer_free(&b);
    assert_int_equal(dev->counters.now_bytes, now);

    assert_true(buffer_reserve(&b, 0)); /* can be bound all the same */
    assert_non_null(b.mem);
    buffer_free(&b);
}

static void poison(void **state)
{
    struct buffer b, host;
    (void)state;
    buffer_init(&b, dev, "poisoned");
    buffer_init(&host, dev, "poisoned staging");
    setenv("DEMOCLES_POISON", "1", 1);
    buffer_reserve(&b, 5000);
    buffer_reserve_staging(&host, 100);
    unsetenv("DEMOCLES_POISON");
    all_bytes(&b, 5000, 0xff);
    for (int i = 0; i < 100; i++) assert_int_equal(((unsigned char *)host.host)[i], 0xff);
    buffer_zero(&b);
    all_bytes(&b, 5000, 0);
    buffer_free(&b);
    buffer_free(&host);
}

static void copies(void **state)
{
    struct buffer b;
    int32_t in[100], out[100] = {0};
    (void)state;
    buffer_init(&b, dev, "numbers");
    buffer_reserve(&b, sizeof in);
    for (int i = 0; i < 100; i++) in[i] = 3 * i;
    struct device_counters c = dev->counters;
    buffer_write(&b, 0, sizeof in, in);
    buffer_read(&b, 40, 20, out);
    for (int i = 0; i < 5; i++) assert_int_equal(out[i], 3 * (10 + i));
    buffer_write(&b, sizeof in, 0, in);
    buffer_read(&b, 0, 0, out);
    assert_int_equal(dev->counters.n_h2d - c.n_h2d, 1); /* nothing is not counted */
    assert_int_equal(dev->counters.n_d2h - c.n_d2h, 1);
    assert_int_equal(dev->counters.h2d_bytes - c.h2d_bytes, sizeof in);
    assert_int_equal(dev->counters.d2h_bytes - c.d2h_bytes, 20);
    buffer_free(&b);
}

/* Arrays of one name share a row; what is freed is taken off. */
static void memory_by_name(void **state)
{
    struct buffer a, b;
    struct memory_table table;
    (void)state;
    buffer_init(&a, dev, "twins");
    buffer_init(&b, dev, "twins");
    buffer_reserve(&a, 1000);
    buffer_reserve(&b, 100000);
    table = dev->memory;
    memory_table_sort(&table);
    assert_string_equal(table.row[0].name, "twins");
    assert_int_equal(table.row[0].bytes, 1024 + 100096);
    buffer_free(&b);
    for (int i = 0; i < dev->memory.n; i++)
        if (!strcmp(dev->memory.row[i].name, "twins"))
            assert_int_equal(dev->memory.row[i].bytes, 1024);
    buffer_free(&a);
    int64_t sum = 0;
    for (int i = 0; i < dev->memory.n; i++) sum += dev->memory.row[i].bytes;
    assert_int_equal(sum, dev->counters.now_bytes);
}

/* As an exchange does it: staging to device on one queue, back on the other, ordered by events,
 * also where there is nothing to copy. */
static void staging(void **state)
{
    struct buffer host, b;
    cl_event written, nothing, back;
    (void)state;
    buffer_init(&host, dev, "staging");
    buffer_init(&b, dev, "ghosts");
    assert_true(buffer_reserve_staging(&host, 2000));
    assert_false(buffer_reserve_staging(&host, 2000));
    buffer_reserve(&b, 1000);
    unsigned char *at = host.host;
    for (int i = 0; i < 1000; i++) at[i] = (unsigned char)(i * 7);
    buffer_write_begin(&b, dev->copy, 0, 1000, at, NULL, &written);
    buffer_write_begin(&b, dev->copy, 0, 0, NULL, NULL, &nothing);
    buffer_read_begin(&b, dev->compute, 0, 0, NULL, &nothing, NULL);
    buffer_read_begin(&b, dev->compute, 0, 1000, at + 1000, &written, &back);
    device_finish(dev);
    assert_true(device_event_done(back));
    assert_memory_equal(at, at + 1000, 1000);
    clReleaseEvent(written);
    clReleaseEvent(nothing);
    clReleaseEvent(back);
    assert_true(buffer_reserve_staging(&host, 9000));
    ((char *)host.host)[8999] = 1;
    buffer_free(&host);
    assert_null(host.host);
    buffer_free(&b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(growth), cmocka_unit_test(poison),
        cmocka_unit_test(copies), cmocka_unit_test(memory_by_name), cmocka_unit_test(staging)};
    dev = device_open(NULL, NULL, false, false);
    int failed = cmocka_run_group_tests_name("buffer", tests, NULL, NULL);
    device_free(dev);
    return failed;
}
