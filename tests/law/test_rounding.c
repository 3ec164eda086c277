/* What mixed precision asks of the compiler: a double that goes through float comes back rounded,
 * two side by side too. */
#include "law_test.h"

static __attribute__((noinline)) void through_float(double a, double b, double *out)
{
    out[0] = (double)(float)a;
    out[1] = (double)(float)b;
}

/* 1/3 and 1/7 to 24 bits, by hand: 11184811/2^25 and 9586981/2^26. */
static void two_conversions_round(void **state)
{
    volatile double a = 1.0 / 3, b = 1.0 / 7; /* not constants: those are converted before */
    double out[2];
    (void)state;
    through_float(a, b, out);
    assert_true(out[0] == 11184811.0 / 33554432 && out[1] == 9586981.0 / 67108864);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(two_conversions_round)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
