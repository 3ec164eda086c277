/* The table of the physics sheet (section 3), inverses, and an impact integrated in small steps. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "laws/restitution.h"

#define ASSERT_NEAR(a, b, tolerance)                                                               \
    do {                                                                                           \
        double left = (a), right = (b);                                                            \
        if (!(fabs(left - right) <= (tolerance)))                                                  \
            fail_msg("%.17g and %.17g differ by %g", left, right, left - right);                   \
    } while (0)

/* Printed to six digits there: half a unit of the last. */
static void table_of_damping_ratios(void **state)
{
    (void)state;
    const double e[] = {0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.8, 0.9, 0.95, 0.99};
    const double tail[] = {0.690107, 0.591155, 0.455950, 0.357857, 0.215454, 0.112808, 0.070850,
        0.033518, 0.016325, 0.003199};
    const double none[] = {1.945346, 1.243188, 0.731247, 0.497239, 0.255276, 0.122215, 0.074355,
        0.034265, 0.016498, 0.003206};
    for (int k = 0; k < 10; k++) {
        ASSERT_NEAR(restitution_damping(e[k], true), tail[k], 5.1e-7);
        ASSERT_NEAR(restitution_damping(e[k], false), none[k], 5.1e-7);
    }
}

static void known_values(void **state)
{
    (void)state;
    ASSERT_NEAR(restitution_of_damping(0.02, true), 0.93909, 5.1e-6); /* of the reference solver */
    ASSERT_NEAR(restitution_of_damping(0.02, false), 0.93984, 5.1e-6);
    ASSERT_NEAR(restitution_of_damping(1, false), exp(-2), 1e-15);
    ASSERT_NEAR(restitution_of_damping(1, true), 0, 0);
    ASSERT_NEAR(restitution_of_damping(0, true), 1, 0);
    ASSERT_NEAR(restitution_of_damping(0, false), 1, 0);
    ASSERT_NEAR(restitution_damping(1, true), 0, 0);
    ASSERT_NEAR(restitution_damping(1, false), 0, 0);
    ASSERT_NEAR(restitution_damping(exp(-2), false), 1, 1e-14);
}

static void inverses(void **state)
{
    (void)state;
    for (int k = 1; k <= 1000; k++) {
        double e = k / 1000.0;
        ASSERT_NEAR(restitution_of_damping(restitution_damping(e, true), true), e, 4e-15);
        ASSERT_NEAR(restitution_of_damping(restitution_damping(e, false), false), e, 4e-15);
    }
    ASSERT_NEAR(restitution_of_damping(restitution_damping(1e-6, false), false), 1e-6, 1e-19);
}

/* The two branches meet at z = 1 without a jump. */
static void smooth_at_critical_damping(void **state)
{
    (void)state;
    for (int k = -400; k < 400; k++) {
        double z = 1 + k * 1e-6, slope = (restitution_of_damping(z + 1e-6, false) -
                                             restitution_of_damping(z, false)) /
                                         1e-6;
        ASSERT_NEAR(slope, -4.0 / 3 * exp(-2), 1e-3); /* de/dz = -e f', f' = 4/3 at z = 1 */
    }
}

/* Unit mass, unit spring, dashpot 2 z: leave when the force has fallen to zero. Classical
 * Runge-Kutta with a step of 1e-4. */
static double bounce(double z)
{
    const double h = 1e-4;
    double x = 0, v = 1;
    for (long n = 0; n < 1000000 && (n == 0 || x + 2 * z * v > 0); n++) {
        double a1 = -x - 2 * z * v, v2 = v + h / 2 * a1, a2 = -(x + h / 2 * v) - 2 * z * v2;
        double v3 = v + h / 2 * a2, a3 = -(x + h / 2 * v2) - 2 * z * v3, v4 = v + h * a3,
               a4 = -(x + h * v3) - 2 * z * v4;
        x += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
        v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    }
    return -v;
}

static void agrees_with_an_integrated_impact(void **state)
{
    (void)state;
    const double z[] = {0.02, 0.3, 0.9, 0.99999, 1.00001, 1.5, 3};
    /* The force is zero where the impact ends: one step changes v by O(h^2). */
    for (int k = 0; k < 7; k++)
        ASSERT_NEAR(bounce(z[k]), restitution_of_damping(z[k], false), 1e-7);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(table_of_damping_ratios),
        cmocka_unit_test(known_values),
        cmocka_unit_test(inverses),
        cmocka_unit_test(smooth_at_critical_damping),
        cmocka_unit_test(agrees_with_an_integrated_impact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
