/* Oblique impacts with friction: order in the time step, closed forms of gross slip, and no energy
 * from grazing. */
#include <string.h>

#include "impact.h"
#include "law_test.h"

#define PHASES 8

/* Errors of all velocities against a run with far smaller steps [m/s]: worst, and mean over the
 * phase of the onset. */
static double error_of(const struct impact *c, const double reference[12], int n, double *mean)
{
    double worst = 0, sum = 0;
    for (int k = 0; k < PHASES; k++) {
        struct two_body s;
        double v[12], e;
        impact_run(&s, c, n, (double)k / PHASES);
        impact_velocities(&s, v);
        e = impact_difference(v, reference);
        worst = e > worst ? e : worst;
        sum += e;
    }
    *mean = sum / PHASES;
    return worst;
}

/* known: worst errors at 50, 100, 400 steps that must be reached [m/s]; order of the mean from 50
 * to 400. */
static void check(const struct impact *c, const double known[3], double order)
{
    static const int n[3] = {50, 100, 400};
    struct two_body s;
    double reference[12], mean[3];
    impact_run(&s, c, 20000, 0);
    impact_velocities(&s, reference);
    assert_int_equal(s.h.state, 0);
    for (int k = 0; k < 3; k++) assert_below(error_of(c, reference, n[k], &mean[k]), known[k]);
    assert_true(law_order(mean[0], 50, mean[2], 400) > order);
}

/* The limits are the errors of a consistent scheme from the literature: half-step normal and onset
 * fraction. The usual scheme has 6.1e-3, 3.0e-3, 7.6e-4 and is of first order. */
static void friction_is_second_order(void **state)
{
    static const double known[3] = {4.5e-4, 1.3e-4, 7.8e-6};
    struct impact c = {.mu = 0.3, .slant = 0.1, .spin = 0.3};
    (void)state;
    check(&c, known, 1.7);
}

static void one_to_ten_is_second_order(void **state)
{
    static const double known[3] = {8.0e-3, 2.0e-3, 1.3e-4};
    struct impact c = {.mu = 0.5, .slant = 0.1, .spin = 0.3, .ratio = 10};
    (void)state;
    check(&c, known, 1.7);
}

static void slip_is_second_order(void **state)
{
    static const double known[3] = {4.5e-4, 1.3e-4, 7.8e-6};
    struct impact c = {.mu = 0.3, .slant = 2};
    (void)state;
    check(&c, known, 1.7);
}

static void damped_friction_is_second_order(void **state)
{
    static const double known[3] = {4.5e-4, 1.3e-4, 7.8e-6};
    struct impact c = {.z_n = 0.1, .z_t = 0.1, .mu = 0.3, .slant = 0.1, .spin = 0.3};
    (void)state;
    check(&c, known, 1.7);
}

/* Slip of spring and dashpot together, where the force has no jump: a linear dashpot that starts
 * beyond the limit winds up the spring at once, which is of first order. */
static void whole_slip_is_second_order(void **state)
{
    static const double known[3] = {4.5e-4, 1.3e-4, 7.8e-6};
    struct impact c = {.hertz = 1, .z_n = 0.1, .z_t = 0.3, .mu = 0.3, .slant = 0.1, .spin = 0.3};
    (void)state;
    c.choices = CONTACT_WHOLE_SLIP;
    check(&c, known, 1.7);
    c.slant = 1;
    check(&c, known, 1.7);
}

/* Mindlin's stiffness starts with an infinite slope: between 1.5 and 2. */
static void mindlin_is_nearly_second_order(void **state)
{
    static const double known[3] = {4.5e-4, 1.3e-4, 7.8e-6};
    struct impact elastic = {.hertz = 1, .mu = 0.3, .slant = 0.1, .spin = 0.3};
    struct impact damped = {
        .hertz = 1, .z_n = 0.1, .z_t = 0.1, .mu = 0.3, .slant = 0.1, .spin = 0.3};
    (void)state;
    check(&elastic, known, 1.4);
    check(&damped, known, 1.4);
}

/* Stiff contacts here: the lever arm is r - delta, so that delta/r shows in the spin.
 *
 * A sphere slips over a plane all through the impact: v_t' = v_t - mu (1 + e) v_n, w' = 2.5 mu (1 +
 * e) v_n/r. */
static void gross_slip(int hertz)
{
    struct two_body s;
    double mu = 0.2, z = 0.1, e = exp(-3.14159265358979 * z / sqrt(1 - z * z)), v_n = 0.5, v_t = 2,
           r = 5e-3;
    struct contact_material c = hertz
                                    ? contact_material_hertz((real)1e10, (real)2e9, (real)z, -1, 0)
                                    : contact_material_linear((real)1e6, (real)z, (real)0.8, 0);
    memset(&s, 0, sizeof s);
    s.plane = 1;
    s.dt = (real)2e-7;
    s.b[0] = s.b[1] = two_body_sphere((real)2e-3, (real)r, p3(0, 0, (preal)(1.001 * r)),
        v3((real)v_t, 0, (real)-v_n), v3(0, 0, 0));
    c.mu = (real)mu;
    two_body_set(&s, c);
    for (int k = 0; k < 3000; k++) two_body_step(&s);
    assert_int_equal(s.h.state, 0);
    assert_near((double)s.b[0].v.z / v_n, e, 1e-4);
    assert_near(((double)s.b[0].v.x - v_t) / (mu * (1 + e) * v_n), -1, 1e-2);
    assert_near((double)s.b[0].w.y * r / (2.5 * mu * (1 + e) * v_n), 1, 1e-2);
}

static void gross_slip_linear(void **state)
{
    (void)state;
    gross_slip(0);
}

static void gross_slip_hertz(void **state)
{
    (void)state;
    gross_slip(1);
}

/* A ball with backspin w_0 dropped straight down: leaves with speed mu (1 + e) v_n sideways. */
static void spinning_drop(void **state)
{
    struct two_body s;
    double mu = 0.1, v_n = 0.5, r = 5e-3, spin = 400;
    struct contact_material c = contact_material_linear((real)1e6, 0, (real)0.8, 0);
    (void)state;
    memset(&s, 0, sizeof s);
    s.plane = 1;
    s.dt = (real)2e-7;
    s.b[0] = s.b[1] = two_body_sphere((real)2e-3, (real)r, p3(0, 0, (preal)(1.001 * r)),
        v3(0, 0, (real)-v_n), v3(0, (real)spin, 0));
    c.mu = (real)mu;
    two_body_set(&s, c);
    for (int k = 0; k < 3000; k++) two_body_step(&s);
    assert_near((double)s.b[0].v.x / (2 * mu * v_n), 1, 1e-2);
    assert_near(((double)s.b[0].w.y - spin) / (5 * mu * v_n / r), -1, 1e-2);
}

/* Kinetic energy after is never above that before, from central to 89.9 degrees; z = 0.02. At the
 * touch the centres lie along x; the flight starts t_0 earlier. */
static void grazing_gives_no_energy(void **state)
{
    static const double angle[] = {0, 10, 30, 45, 60, 75, 85, 89, 89.5, 89.9};
    const double t_0 = 2e-5, d = 0.01;
    (void)state;
    for (int k = 0; k < 20; k++) {
        double a = angle[k % 10] * 3.14159265358979 / 180, before;
        struct two_body s;
        struct contact_material c =
            contact_material_linear((real)1e4, (real)0.02, (real)0.8, (real)(k < 10 ? 0 : 0.1));
        int touched = 0;
        memset(&s, 0, sizeof s);
        s.dt = (real)1e-6;
        s.b[0] = two_body_sphere((real)2e-3, (real)(d / 2),
            p3((preal)(-t_0 * cos(a)), (preal)(-t_0 * sin(a)), 0),
            v3((real)cos(a), (real)sin(a), 0), v3(0, 0, 0));
        s.b[1] = two_body_sphere(
            (real)2e-3, (real)(d / 2), p3((preal)d, 0, 0), v3(0, 0, 0), v3(0, 0, 0));
        c.mu = (real)0.3;
        two_body_set(&s, c);
        before = two_body_kinetic(&s);
        for (int n = 0; n < 1500; n++) {
            two_body_step(&s);
            touched |= s.h.state;
        }
        assert_true(touched && s.h.state == 0);
        assert_below(two_body_kinetic(&s), before);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(friction_is_second_order),
        cmocka_unit_test(one_to_ten_is_second_order),
        cmocka_unit_test(slip_is_second_order),
        cmocka_unit_test(damped_friction_is_second_order),
        cmocka_unit_test(whole_slip_is_second_order),
        cmocka_unit_test(mindlin_is_nearly_second_order),
        cmocka_unit_test(gross_slip_linear),
        cmocka_unit_test(gross_slip_hertz),
        cmocka_unit_test(spinning_drop),
        cmocka_unit_test(grazing_gives_no_energy),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
