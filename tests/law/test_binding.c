/* The bond: forms at touch, pulls up to F_b, breaks for good until the next touch. */
#include "impact.h"
#include "law_test.h"

static const double pi = 3.14159265358979;

/* Do two spheres that meet at speed v stay together? */
static int sticks(const struct contact_material *c, double v, double *leaving)
{
    struct two_body s = {.dt = (real)(pi * sqrt(IMPACT_M / 2 / IMPACT_K) / 400)};
    s.b[0] = two_body_sphere(
        (real)IMPACT_M, (real)IMPACT_R, p3(0, 0, 0), v3((real)(v / 2), 0, 0), v3(0, 0, 0));
    s.b[1] = two_body_sphere((real)IMPACT_M, (real)IMPACT_R,
        p3((preal)(2 * IMPACT_R) + (preal)2e-6, 0, 0), v3((real)(-v / 2), 0, 0), v3(0, 0, 0));
    two_body_set(&s, *c);
    /* break or not: at 3/4 of a period, 600 steps; with damping somewhat later */
    for (int k = 0; k < 1600; k++) two_body_step(&s);
    *leaving = (double)(s.b[1].v.x - s.b[0].v.x);
    return s.h.state != 0;
}

/* Elastic v = F_b/(k m*)^(1/2); with damping times exp(z (pi + acos z)/(1 - z^2)^(1/2)). */
static void check_threshold(double z, int no_attraction)
{
    struct contact_material c = contact_material_linear((real)IMPACT_K, (real)z, (real)0.8, 0);
    double f_b = 0.2, m = IMPACT_M / 2, leaving;
    double exact = f_b / sqrt(IMPACT_K * m) * exp(z * (pi + acos(z)) / sqrt(1 - z * z));
    c.f_b = (real)f_b;
    c.law |= no_attraction ? CONTACT_NO_ATTRACTION : 0;
    assert_true(sticks(&c, 0.999 * exact, &leaving));
    assert_false(sticks(&c, 1.001 * exact, &leaving));
}

static void threshold_elastic(void **state)
{
    (void)state;
    check_threshold(0, 0);
}

static void threshold_z_002(void **state)
{
    (void)state;
    check_threshold(0.02, 0);
}

static void threshold_z_01(void **state)
{
    (void)state;
    check_threshold(0.1, 0);
}

static void threshold_z_03(void **state)
{
    (void)state;
    check_threshold(0.3, 0);
}

/* Without dashpot the cut of attraction must not touch the bond. */
static void attraction_is_cut_but_not_the_bond(void **state)
{
    (void)state;
    check_threshold(0, 1);
}

/* Breaking takes F_b^2/(2 k): leaves with (v^2 - F_b^2/(k m*))^(1/2). */
static void leaving_speed(void **state)
{
    struct contact_material c = contact_material_linear((real)IMPACT_K, 0, (real)0.8, 0);
    double v = 0.1, f_b = 0.2, m = IMPACT_M / 2, leaving;
    (void)state;
    c.f_b = (real)f_b;
    assert_false(sticks(&c, v, &leaving));
    /* the break is seen at a whole step */
    assert_near(leaving / sqrt(v * v - f_b * f_b / (IMPACT_K * m)), 1, 1e-2);
}

/* Hertz pulls as it pushes: the bond of a central impact gives way where (2/5) K d^(5/2) = m* v^2/2
 * reaches F_b = K d^(3/2). */
static void threshold_hertz(void **state)
{
    struct contact_material c = contact_material_hertz((real)IMPACT_E, 0, 0, 0, 0);
    double f_b = 0.2, k = 4.0 / 3 * IMPACT_E * sqrt(IMPACT_R / 2), depth = pow(f_b / k, 2.0 / 3),
           leaving;
    double exact = sqrt(0.8 * k * pow(depth, 2.5) / (IMPACT_M / 2));
    (void)state;
    c.f_b = (real)f_b;
    assert_true(sticks(&c, 0.999 * exact, &leaving));
    assert_false(sticks(&c, 1.001 * exact, &leaving));
}

/* One call of the law at a given overlap, from a given history. */
static struct contact_result at(double delta, double f_b, double mu, struct contact_history *h)
{
    struct contact_material c = contact_material_linear((real)IMPACT_K, 0, (real)0.8, 0);
    struct contact_pair sizes =
        contact_pair_of((real)(1 / IMPACT_M), (real)(1 / IMPACT_M), (real)IMPACT_R, (real)IMPACT_R);
    vec3 zero = v3(0, 0, 0);
    pvec3 D = p3((preal)(2 * IMPACT_R - delta), 0, 0);
    struct contact_kinematics k = contact_kinematics_pair(
        D, kinematics_free(zero, zero, zero, zero), (real)IMPACT_R, (real)IMPACT_R, (real)1e-6);
    c.f_b = (real)f_b;
    c.mu = (real)mu;
    return contact_law(k, contact_parameters_of(c, sizes, (real)1e-6), (real)1e-6, h);
}

static void forms_at_touch_only(void **state)
{
    struct contact_history h = {.state = 0};
    (void)state;
    assert_near((double)at(-1e-6, 0.2, 0, &h).force.x, 0, 0);
    assert_int_equal(h.state, 0);
    at(1e-6, 0.2, 0, &h);
    assert_int_equal(h.state, CONTACT_TOUCHING | CONTACT_BONDED);
    /* i is pulled towards j */
    assert_near((double)at(-1e-6, 0.2, 0, &h).force.x, 1e-6 * IMPACT_K, 1e-9);
    assert_int_equal(h.state, CONTACT_BONDED);
}

static void breaking_drops_all_history(void **state)
{
    struct contact_history h = {.state = CONTACT_BONDED, .xi = {0, (real)1e-6, 0}};
    struct contact_result r;
    (void)state;
    at(-0.99 * 0.2 / IMPACT_K, 0.2, 0.3, &h);
    assert_int_equal(h.state, CONTACT_BONDED);
    assert_true(h.xi.y > 0);
    r = at(-1.01 * 0.2 / IMPACT_K, 0.2, 0.3, &h);
    assert_int_equal(h.state, 0);
    assert_true(h.xi.x == 0 && h.xi.y == 0 && h.xi.z == 0);
    assert_true(r.force.x == 0 && r.force.y == 0 && r.force.z == 0);
    r = at(-0.5 * 0.2 / IMPACT_K, 0.2, 0.3, &h); /* near again, but not touching */
    assert_true(r.force.x == 0 && h.state == 0);
}

/* Friction of a bonded pair is capped by mu (F_n + F_b), also in tension. */
static void friction_cap_counts_the_bond(void **state)
{
    struct contact_history h = {.state = CONTACT_BONDED, .xi = {0, (real)1e-3, 0}};
    double delta = -0.4 * 0.2 / IMPACT_K;
    (void)state;
    assert_near((double)at(delta, 0.2, 0.3, &h).force.y, -0.3 * 0.6 * 0.2, 1e-6);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(threshold_elastic),
        cmocka_unit_test(threshold_z_002),
        cmocka_unit_test(threshold_z_01),
        cmocka_unit_test(threshold_z_03),
        cmocka_unit_test(attraction_is_cut_but_not_the_bond),
        cmocka_unit_test(leaving_speed),
        cmocka_unit_test(threshold_hertz),
        cmocka_unit_test(forms_at_touch_only),
        cmocka_unit_test(breaking_drops_all_history),
        cmocka_unit_test(friction_cap_counts_the_bond),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
