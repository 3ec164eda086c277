/* A signal leaves a mark, ends nothing, and does not cut a read short. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#include "base/signals.h"

static void marks(void **state)
{
    static const int number[] = {SIGTERM, SIGINT, SIGUSR1};
    (void)state;
    for (int k = 0; k < 3; k++) {
        signals_install();
        assert_int_equal(signals_seen(), 0);
        raise(number[k]);
        assert_int_equal(signals_seen(), number[k]);
        raise(number[k]); /* again: the handler is still there */
        assert_int_equal(signals_seen(), number[k]);
    }
}

/* Held as often as passed; the handlers are ours again afterwards, whoever has had them. */
static void held(void **state)
{
    static const int number[] = {SIGTERM, SIGINT, SIGUSR1};
    (void)state;
    for (int k = 0; k < 3; k++) {
        signals_install();
        signals_hold();
        signals_hold();
        assert_false(signals_wait());
        signal(number[k], SIG_IGN);
        signal(number[k], SIG_DFL);
        raise(number[k]);
        assert_true(signals_wait());
        signals_pass();
        assert_int_equal(signals_seen(), 0);
        signals_pass();
        assert_int_equal(signals_seen(), number[k]);
        assert_false(signals_wait());
    }
}

/* The signal comes while read() waits; the byte comes later. */
static void read_goes_on(void **state)
{
    int pipe_end[2], status;
    char byte = 0;
    (void)state;
    signals_install();
    assert_int_equal(pipe(pipe_end), 0);
    pid_t parent = getpid(), child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        usleep(100000);
        kill(parent, SIGTERM);
        usleep(100000);
        _exit(write(pipe_end[1], "x", 1) == 1 ? 0 : 1);
    }
    assert_int_equal(read(pipe_end[0], &byte, 1), 1);
    assert_int_equal(byte, 'x');
    assert_int_equal(signals_seen(), SIGTERM);
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(marks), cmocka_unit_test(held), cmocka_unit_test(read_goes_on)};
    return cmocka_run_group_tests_name("signals", tests, NULL, NULL);
}
