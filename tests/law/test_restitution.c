/* Restitution of a central impact: closed form, order in the time step, and the table of errors of
 * a good scheme. */
#include "impact.h"
#include "law_test.h"

#define PHASES 10

/* Exact restitution of both laws, with the attractive tail and without. */
static double exact(double z, int no_attraction)
{
    if (!no_attraction) return exp(-3.14159265358979 * z / sqrt(1 - z * z));
    if (z < 1) return exp(-2 * z * acos(z) / sqrt(1 - z * z));
    return z > 1 ? exp(-2 * z * acosh(z) / sqrt(z * z - 1)) : exp(-2.0);
}

static double restitution(const struct impact *c, int n, double phase)
{
    struct two_body s;
    vec3 normal = v3((real)0.6, (real)0.48, (real)0.64);
    impact_run(&s, c, n, phase);
    return (double)v3_dot(v3_sub(s.b[1].v, s.b[0].v), normal) / IMPACT_SPEED;
}

/* Worst and root mean square error over the phase of the onset and, as contact times are no whole
 * number of steps, over n to 1.2 n steps. */
static double error_of(const struct impact *c, int n, double *rms)
{
    double worst = 0, sum = 0;
    for (int k = 0; k < 4 * PHASES; k++) {
        int steps = n + n * (k / PHASES) / 15;
        double e = fabs(
            restitution(c, steps, (double)(k % PHASES) / PHASES) - exact(c->z_n, c->no_attraction));
        worst = e > worst ? e : worst;
        sum += e * e;
    }
    *rms = sqrt(sum / (4 * PHASES));
    return worst;
}

static struct impact impact_of(int hertz, int no_attraction, double z)
{
    struct impact c = {.hertz = hertz, .no_attraction = no_attraction, .z_n = z, .duration = 2.2};
    return c;
}

/* Linear: second order. Hertz: the dashpot starts like delta^(1/4), and what the onset weight
 * leaves of that is of order 1.25 in the end, but the error is smaller than the linear one at any
 * practical step. */
static void check_damped(int hertz, int no_attraction, double z)
{
    struct impact c = impact_of(hertz, no_attraction, z);
    double coarse, fine, worst = error_of(&c, 50, &coarse);
    assert_below(worst, 5e-4);
    assert_below(coarse, 2e-4);
    error_of(&c, 400, &fine);
    assert_below(fine, 3e-6);
    assert_true(law_order(coarse, 50, fine, 400) > (hertz ? 1.2 : 1.8));
    assert_below(fabs(restitution(&c, 2000, 0.3) - exact(z, no_attraction)), hertz ? 1e-5 : 1e-6);
}

static void linear_with_tail(void **state)
{
    (void)state;
    check_damped(0, 0, 0.1);
    check_damped(0, 0, 0.2154536); /* e = 0.5 */
    check_damped(0, 0, 0.7);
}

static void linear_without_attraction(void **state)
{
    const double z[] = {0.1, 0.2552763, 0.7, 1, 2, 5};
    (void)state;
    for (int k = 0; k < 6; k++) check_damped(0, 1, z[k]);
}

static void hertz_with_tail(void **state)
{
    (void)state;
    check_damped(1, 0, 0.1);
    check_damped(1, 0, 0.2154536);
    check_damped(1, 0, 0.7);
}

static void hertz_without_attraction(void **state)
{
    const double z[] = {0.1, 0.2552763, 0.7, 1, 2, 5};
    (void)state;
    for (int k = 0; k < 6; k++) check_damped(1, 1, z[k]);
}

/* Worst over the phase, at 20, 50, 100, 400 steps per contact; within a factor 2. */
static void elastic_errors_are_those_of_leapfrog(void **state)
{
    static const double known[2][4] = {
        {2.5e-4, 1.6e-5, 2.0e-6, 3.2e-8}, {4.3e-4, 4.1e-5, 7.1e-6, 2.1e-7}};
    static const int n[4] = {20, 50, 100, 400};
    (void)state;
    for (int hertz = 0; hertz < 2; hertz++) {
        struct impact c = impact_of(hertz, 0, 0);
        for (int k = 0; k < 4; k++) {
            double rms;
            assert_below(error_of(&c, n[k], &rms), 2 * known[hertz][k]);
        }
    }
}

/* e = 0.5, linear, with tail: known 2.2e-4, 5.8e-5, 3.8e-6 at 50, 100, 400 steps; within a factor
 * 2. */
static void damped_errors_are_as_known(void **state)
{
    struct impact c = impact_of(0, 0, 0.2154536);
    double rms;
    (void)state;
    assert_below(error_of(&c, 50, &rms), 4.4e-4);
    assert_below(error_of(&c, 100, &rms), 1.16e-4);
    assert_below(error_of(&c, 400, &rms), 7.6e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(linear_with_tail),
        cmocka_unit_test(linear_without_attraction),
        cmocka_unit_test(hertz_with_tail),
        cmocka_unit_test(hertz_without_attraction),
        cmocka_unit_test(elastic_errors_are_those_of_leapfrog),
        cmocka_unit_test(damped_errors_are_as_known),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
