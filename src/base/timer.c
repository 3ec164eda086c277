#include "timer.h"

#include <time.h>

const char *const timer_label[TIMER_N] = {
    [TIMER_SETUP] = "setup",
    [TIMER_LOOP] = "loop",
    [TIMER_COMPUTE] = "compute",
    [TIMER_EXCHANGE] = "exchange",
    [TIMER_WAIT] = "wait",
    [TIMER_REGROUP] = "regroup",
    [TIMER_OUTPUT] = "output",
};

double timer_now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
