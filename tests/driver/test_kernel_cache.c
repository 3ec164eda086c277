/* Who compiles waits for the same program in another process, and for no other program, and no
 * longer for what has been compiled. */
#include "../walls/scratch.h"

#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "comm/fail.h"
#include "device/kernel_cache.h"

enum { HELD_MS = 300 };
static struct device pocl = {.is_pocl = true};

static double seconds(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Another process, which says that it begins and then how long it has waited for the lock [ms];
 * exit code 0 if it has been right to lock. */
static _Noreturn void wait_in_child(int out, int inherited, uint64_t key, bool compiled)
{
    close(inherited); /* the parent has it still */
    double begin = seconds();
    bool told = write(out, "", 1) == 1;
    int lock = kernel_cache_lock(&pocl, key), ms = (int)(1000 * (seconds() - begin));
    told &= write(out, &ms, sizeof ms) == sizeof ms;
    kernel_cache_unlock(lock);
    _exit((lock < 0) != compiled || !told);
}

/* How long another process waits for the lock of `wanted` while this one holds that of `held`, for
 * HELD_MS or until the other one has ended. */
static int waited_ms(uint64_t held, uint64_t wanted, bool until_end)
{
    const struct timespec while_held = {0, HELD_MS * 1000000L};
    int lock = kernel_cache_lock(&pocl, held), status = -1, ms = -1, ends[2];
    char begun;
    assert_true(lock >= 0);
    assert_int_equal(pipe(ends), 0);
    pid_t child = fork();
    if (child == 0) wait_in_child(ends[1], lock, wanted, held == wanted);
    assert_int_equal(read(ends[0], &begun, 1), 1);
    if (!until_end) {
        nanosleep(&while_held, NULL);
        kernel_cache_unlock(lock);
    }
    assert_int_equal(waitpid(child, &status, 0), child);
    if (until_end) kernel_cache_unlock(lock);
    assert_int_equal(status, 0);
    assert_int_equal(read(ends[0], &ms, sizeof ms), sizeof ms);
    close(ends[0]);
    close(ends[1]);
    return ms;
}

static void keys(void **unused)
{
    (void)unused;
    uint64_t key = kernel_cache_key("-DWITH_SPIN=1", "kernel");
    assert_true(key == kernel_cache_key("-DWITH_SPIN=1", "kernel"));
    assert_true(key != kernel_cache_key("-DWITH_SPIN=0", "kernel"));
    assert_true(key != kernel_cache_key("-DWITH_SPIN=1", "kernel "));
}

static void same_program(void **unused)
{
    (void)unused;
    uint64_t key = kernel_cache_key("", "a");
    assert_true(waited_ms(key, key, false) >= HELD_MS);
    assert_int_equal(kernel_cache_lock(&pocl, key), -1); /* for ever */
    struct device newer = {.is_pocl = true, .driver = "newer"};
    int lock = kernel_cache_lock(&newer, key);
    assert_true(lock >= 0);
    close(lock); /* no success: the next one builds */
    lock = kernel_cache_lock(&newer, key);
    assert_true(lock >= 0);
    kernel_cache_unlock(lock);
}

static void same_launch(void **unused)
{
    (void)unused;
    uint64_t key = kernel_cache_launch_key(1, "gather", 64, 1000);
    assert_true(key == kernel_cache_launch_key(1, "gather", 64, 1001));
    assert_true(key != kernel_cache_launch_key(1, "gather", 64, 100000));
    assert_true(key != kernel_cache_launch_key(1, "gather", 128, 1000));
    assert_true(key != kernel_cache_launch_key(1, "gathe", 64, 1000));
    assert_true(key != kernel_cache_launch_key(2, "gather", 64, 1000));
}

static void other_program(void **unused)
{
    (void)unused;
    assert_true(waited_ms(kernel_cache_key("", "c"), kernel_cache_key("", "b"), true) >= 0);
}

static void other_driver(void **unused)
{
    (void)unused;
    struct device other = {.is_pocl = false};
    assert_int_equal(kernel_cache_lock(&other, 1), -1);
}

int main(void)
{
    char folder[] = "/tmp/democles_cache_XXXXXX";
    if (!mkdtemp(folder) || setenv("POCL_CACHE_DIR", folder, 1)) return 1;
    const struct CMUnitTest tests[] = {cmocka_unit_test(keys), cmocka_unit_test(same_program),
        cmocka_unit_test(same_launch), cmocka_unit_test(other_program),
        cmocka_unit_test(other_driver)};
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    char *command = fail_format("rm -r %s", folder);
    failed += system(command) != 0;
    free(command);
    return failed;
}
