/* A sphere on a plane: from sliding to rolling, and rolling resistance. */
#include <string.h>

#include "law_test.h"
#include "two_body.h"

static const double g = 9.81, r = 5e-3, m = 1e-3, k_n = 1e4;

/* At rest on the plane, spring and weight in balance. Gravity may be tilted by `slope` towards
 * x. */
static struct two_body on_plane(
    struct contact_material c, double speed, double spin, double slope, double dt)
{
    struct two_body s;
    double depth = m * g * cos(slope) / k_n;
    memset(&s, 0, sizeof s);
    s.plane = 1;
    s.dt = dt;
    s.gravity = v3(g * sin(slope), 0, -g * cos(slope));
    s.b[0] = two_body_sphere(m, r, p3(0, 0, r - depth), v3(speed, 0, 0), v3(0, spin, 0));
    s.b[1] = s.b[0];
    s.b[0].force = v3(m * g * sin(slope), 0, 0);
    two_body_set(&s, c);
    s.h.state = CONTACT_TOUCHING;
    return s;
}

static struct contact_material material(double mu, double z_t)
{
    struct contact_material c = contact_material_linear(k_n, 0.1, 0.8, z_t);
    c.mu = mu;
    return c;
}

/* v = v_0 - mu g t, w r = 2.5 mu g t, rolls from t_s = 2 v_0/(7 mu g) on at 5/7 v_0. */
static void sliding_to_rolling(void **state)
{
    const double mu = 0.3, v_0 = 1, t_s = 2 * v_0 / (7 * mu * g);
    struct two_body s = on_plane(material(mu, 0.3), v_0, 0, 0, 5e-6);
    double sliding = 0, half = 0.5 * t_s;
    (void)state;
    for (int k = 1; k * s.dt < 12 * v_0 / (49 * mu * g) * 2; k++) {
        double cap;
        two_body_step(&s);
        cap = mu * s.r.force.z;
        if (sliding == 0 && fabs(s.r.force.x) < 0.99 * cap) sliding = k * s.dt;
        if (k == (int)(half / s.dt)) {
            assert_near(s.b[0].v.x, v_0 - mu * g * k * s.dt, 1e-3);
            assert_near(s.b[0].w.y * r, 2.5 * mu * g * k * s.dt, 1e-3);
        }
    }
    assert_near(sliding / t_s, 1, 1e-3);
    assert_near(s.b[0].v.x / (5.0 / 7 * v_0), 1, 1e-3);
    assert_near(s.b[0].w.y * r / (5.0 / 7 * v_0), 1, 1e-3);
}

/* The undamped spring leaves a ripple of v of amplitude mu g (2 m/(7 k_t))^(1/2). */
static void ripple_of_the_undamped_spring(void **state)
{
    const double mu = 0.3, v_0 = 0.2, k_t = 0.8 * k_n, t_s = 2 * v_0 / (7 * mu * g);
    struct two_body s = on_plane(material(mu, 0), v_0, 0, 0, 2e-6);
    double low = 1, high = 0;
    (void)state;
    for (int k = 0; k < (int)(1.2 * t_s / s.dt); k++) two_body_step(&s);
    for (int k = 0; k < 1000; k++) {
        two_body_step(&s);
        low = s.b[0].v.x < low ? s.b[0].v.x : low;
        high = s.b[0].v.x > high ? s.b[0].v.x : high;
    }
    assert_near((high - low) / 2 / (mu * g * sqrt(2 * m / (7 * k_t))), 1, 1e-2);
}

/* a = (5/7) g sin th, no slip. */
static void rolls_down_an_incline(void **state)
{
    const double slope = 0.3, dt = 1e-5;
    struct two_body s = on_plane(material(0.5, 0.3), 0, 0, slope, dt);
    (void)state;
    for (int k = 0; k < 20000; k++) two_body_step(&s);
    assert_near(s.b[0].v.x / (5.0 / 7 * g * sin(slope) * 0.2), 1, 1e-3);
}

/* CDT: a = (5/7) g (sin th - mu_r cos th). */
static void cdt_on_an_incline(void **state)
{
    const double slope = 0.3, mu_r = 0.1, dt = 1e-5;
    struct two_body s =
        on_plane(contact_material_rolling(material(0.5, 0.3), mu_r, 0, 0), 0, 0, slope, dt);
    (void)state;
    for (int k = 0; k < 20000; k++) two_body_step(&s);
    assert_near(s.b[0].v.x / (5.0 / 7 * g * (sin(slope) - mu_r * cos(slope)) * 0.2), 1, 1e-3);
}

/* Without friction: w = w_0 - 2.5 mu_r g t/r, and then rest, without chatter about zero. */
static void cdt_stops_a_spin(void **state)
{
    const double mu_r = 0.05, w_0 = 50, dt = 1e-5, stop = w_0 * r / (2.5 * mu_r * g);
    struct two_body s =
        on_plane(contact_material_rolling(material(0, 0), mu_r, 0, 0), 0, w_0, 0, dt);
    (void)state;
    for (int k = 0; k < (int)(0.5 * stop / dt); k++) two_body_step(&s);
    assert_near(s.b[0].w.y / (0.5 * w_0), 1, 1e-3);
    for (int k = 0; k < (int)(0.6 * stop / dt); k++) two_body_step(&s);
    assert_near(s.b[0].w.y, 0, 1e-9 * w_0);
}

/* EPSD holds a sphere on an incline if mu_r > tan th, and lets it roll if not. */
static void epsd_rests_or_rolls(void **state)
{
    const double mu_r = 0.1, dt = 1e-5;
    struct contact_material c = contact_material_rolling(material(0.5, 0.3), mu_r, 2.25, 0.3);
    struct two_body s = on_plane(c, 0, 0, atan(0.8 * mu_r), dt);
    double at;
    (void)state;
    for (int k = 0; k < 50000; k++) two_body_step(&s);
    at = s.b[0].x.x;
    for (int k = 0; k < 10000; k++) two_body_step(&s);
    assert_near(s.b[0].x.x, at, 1e-9);
    assert_true(s.h.theta.y != 0);

    s = on_plane(c, 0, 0, 0.3, dt);
    for (int k = 0; k < 20000; k++) two_body_step(&s);
    /* the spring loads first */
    assert_near(s.b[0].v.x / (5.0 / 7 * g * (sin(0.3) - mu_r * cos(0.3)) * 0.2), 1, 2e-2);
}

/* M of a pair opposes the relative rolling, whatever the orientation, and does not touch
 * twisting. */
static void moment_opposes_rolling(void **state)
{
    (void)state;
    for (int epsd = 0; epsd < 2; epsd++) {
        struct contact_material c =
            contact_material_rolling(material(0, 0), 0.1, epsd ? 2.25 : 0, 0.3);
        struct contact_parameters p =
            contact_parameters_of(c, contact_pair_of(1 / m, 1 / m, r, r), 1e-5);
        struct contact_history h = {.state = CONTACT_TOUCHING};
        vec3 zero = v3(0, 0, 0), w_i = v3(7, 3, 0), w_j = v3(7, -1, 0);
        struct contact_result x =
            contact_law(contact_kinematics_pair(
                            p3(1.99 * r, 0, 0), kinematics_free(zero, zero, w_i, w_j), r, r, 1e-5),
                p, 1e-5, &h);
        assert_true(x.moment.y < 0);
        assert_near(x.moment.x, 0, 1e-20);
        assert_near(x.moment.z, 0, 1e-20);
        h = (struct contact_history){.state = CONTACT_TOUCHING};
        x = contact_law(contact_kinematics_pair(
                            p3(1.99 * r, 0, 0), kinematics_free(zero, zero, w_j, w_i), r, r, 1e-5),
            p, 1e-5, &h);
        assert_true(x.moment.y > 0);
        h = (struct contact_history){.state = CONTACT_TOUCHING};
        x = contact_law(contact_kinematics_pair(p3(1.99 * r, 0, 0),
                            kinematics_free(zero, zero, v3(5, 0, 0), zero), r, r, 1e-5),
            p, 1e-5, &h);
        assert_near(x.moment.x, 0, 0); /* pure twisting */
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sliding_to_rolling),
        cmocka_unit_test(ripple_of_the_undamped_spring),
        cmocka_unit_test(rolls_down_an_incline),
        cmocka_unit_test(cdt_on_an_incline),
        cmocka_unit_test(cdt_stops_a_spin),
        cmocka_unit_test(epsd_rests_or_rolls),
        cmocka_unit_test(moment_opposes_rolling),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
