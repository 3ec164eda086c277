/* The laws in each precision: what rounding costs. Limits in units of the roundings that are made,
 * not of what was seen. */
#include "impact.h"
#include "law_test.h"

/* Roundings of velocity and position over an impact of n steps, as a random walk, five times over;
 * in `single` the overlap is the difference of coordinates near 1 cm and known to 1e-9 m of some
 * 1e-4 m. */
static double limit(int n)
{
    double velocity = (sizeof(real) == 4 ? 6e-8 : 1.1e-16) * sqrt(n),
           overlap = (sizeof(preal) == 4 ? 1e-5 : 2e-14);
    return 5 * (velocity + overlap);
}

/* Central impact, no dashpot: the speed comes back. */
static void elastic_impact(void **state)
{
    vec3 normal = v3((real)0.6, (real)0.48, (real)0.64);
    (void)state;
    for (int hertz = 0; hertz < 2; hertz++) {
        struct impact c = {.hertz = hertz};
        struct two_body s;
        impact_run(&s, &c, 400, 0);
        assert_near((double)v3_dot(v3_sub(s.b[1].v, s.b[0].v), normal) / IMPACT_SPEED, 1,
            3e-7 + limit(400));
    }
}

/* Linear momentum is kept to the rounding of the velocities. */
static void momentum(void **state)
{
    struct impact c = {.z_n = 0.1, .z_t = 0.1, .mu = 0.3, .slant = 1, .spin = 0.3};
    struct two_body s;
    vec3 first, last;
    (void)state;
    impact_start(&s, &c, 400, 0);
    first = v3_add(s.b[0].v, s.b[1].v);
    impact_run(&s, &c, 400, 0);
    last = v3_add(s.b[0].v, s.b[1].v);
    assert_near((double)last.x, (double)first.x, (sizeof(real) == 4 ? 6e-8 : 1.1e-16) * 2 * 760);
    assert_near((double)last.y, (double)first.y, (sizeof(real) == 4 ? 6e-8 : 1.1e-16) * 2 * 760);
    assert_near((double)last.z, (double)first.z, (sizeof(real) == 4 ? 6e-8 : 1.1e-16) * 2 * 760);
}

/* A sphere of 5 mm on another, 0.3 to 0.4 m from the origin, overlap 1.4 um: the error of one
 * overlap. In single four coordinates are rounded by half an ulp of 3e-8 m, in the worst direction
 * 2 2^(1/2) 1.5e-8 m together, 3 %; in mixed the overlap alone is rounded to float. */
static void overlap_far_from_the_origin(void **state)
{
    static const double known = sizeof(preal) == 4 ? 3.1e-2 : sizeof(real) == 4 ? 1e-7 : 1e-9;
    vec3 zero = v3(0, 0, 0);
    double r = 2.5e-3, delta = 1.4e-6;
    (void)state;
    for (int k = 0; k < 100; k++) {
        double a = 0.0628 * k, at = 0.3 + 1e-3 * k;
        pvec3 x_i = p3((preal)at, (preal)at, 0), x_j = p3((preal)(at + (2 * r - delta) * cos(a)),
                                                     (preal)(at + (2 * r - delta) * sin(a)), 0);
        struct contact_kinematics q = contact_kinematics_pair(p3_sub(x_j, x_i),
            kinematics_free(zero, zero, zero, zero), (real)r, (real)r, (real)1e-6);
        double rounded = 2 * (double)(real)r - 2 * r; /* the radius itself */
        assert_near(((double)q.delta - rounded) / delta, 1, known);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(elastic_impact),
        cmocka_unit_test(momentum),
        cmocka_unit_test(overlap_far_from_the_origin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
