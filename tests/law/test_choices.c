/* Friction as other codes have it, by choice: what slips, levers, the limit. Rescaling is in
 * test_slider.c, energy in test_energy.c. */
#include <string.h>

#include "law_test.h"
#include "two_body.h"

enum { M = 2 }; /* [g] */
static const double r = 5e-3, dt = 1e-6, k_n = 1e4, k_t = 8e3, mu = 0.3, z_t = 0.3;

/* Two equal spheres with this overlap. */
struct contact {
    struct contact_parameters p;
    struct contact_history h;
    double delta;
};

static struct contact contact_of(int choices, double z_n, double delta)
{
    struct contact_material c = contact_material_linear(k_n, z_n, k_t / k_n, z_t);
    struct contact s = {.h = {.state = CONTACT_TOUCHING}, .delta = delta};
    c.mu = mu;
    c.law |= choices;
    s.p = contact_parameters_of(c, contact_pair_of(1e3 / M, 1e3 / M, r, r), dt);
    return s;
}

/* A step with these velocities of i; the overlap stays. */
static struct contact_result step(struct contact *s, double v_n, double v_t)
{
    vec3 zero = v3(0, 0, 0);
    struct kinematics_motion m = kinematics_free(v3(v_n, v_t, 0), zero, zero, zero);
    m.radius_lever = parameters_radius_lever(s->p);
    return contact_law(
        contact_kinematics_pair(p3(2 * r - s->delta, 0, 0), m, r, r, dt), s->p, dt, &s->h);
}

/* Sliding at v, the force is mu F_n; the spring holds what the dashpot leaves of it, in one
 * direction or the other, and all that is there once the motion stops. */
static void whole_slip_leaves_the_dashpot_its_share(void **state)
{
    const double cap = mu * k_n * 1e-5, gamma = 2 * z_t * sqrt(k_t * 2 / 7 * 1e-3);
    (void)state;
    for (int k = 1; k <= 4; k++) {
        double v = 0.5 * k * cap / gamma, left = cap - gamma * v;
        struct contact s = contact_of(CONTACT_WHOLE_SLIP, 0, 1e-5);
        struct contact_result f = {.elastic = 0};
        for (int n = 0; n < 3000; n++) f = step(&s, 0, v);
        assert_near(f.force.y / -cap, 1, 1e-9);
        assert_near(k_t * s.h.xi.y / cap, left / cap, 1e-4); /* dt^2: the prediction */
        f = step(&s, 0, 0);
        assert_near(f.force.y / cap, -left / cap, 1e-4);
    }
    /* without the choice the spring is at the limit */
    struct contact s = contact_of(0, 0, 1e-5);
    for (int n = 0; n < 3000; n++) step(&s, 0, cap / gamma);
    assert_near(k_t * s.h.xi.y / cap, 1, 1e-9);
}

/* While the spring sticks the dashpot has no limit: the force is that without slip. Where it slips
 * the force is mu F_n, the spring's alone. Back within the limit both act as by default. */
static void undamped_slip_has_no_dashpot(void **state)
{
    const double cap = mu * k_n * 1e-5, gamma = 2 * z_t * sqrt(k_t * 2 / 7 * 1e-3);
    struct contact s = contact_of(CONTACT_UNDAMPED_SLIP, 0, 1e-5), rough = s;
    (void)state;
    rough.p.mu = 1e9;
    struct contact_result f = step(&s, 0, 3 * cap / gamma), g = step(&rough, 0, 3 * cap / gamma);
    assert_true(f.force.y < -2 * cap && memcmp(&f.force, &g.force, sizeof f.force) == 0);
    for (int n = 0; n < 3000; n++) f = step(&s, 0, 0.5 * cap / gamma);
    assert_near(f.force.y / -cap, 1, 1e-9);
    assert_near(k_t * s.h.xi.y / cap, 1, 1e-9);
    assert_near(f.loss_t, 0, 1e-30);
    struct contact plain = contact_of(0, 0, 1e-5);
    plain.h = s.h;
    f = step(&s, 0, -0.1 * cap / gamma);
    g = step(&plain, 0, -0.1 * cap / gamma);
    assert_true(f.force.y > -0.99 * cap && memcmp(&f.force, &g.force, sizeof f.force) == 0);
}

/* The dashpot pulls harder than the spring pushes: no friction, or mu |F_n|. */
static void limit_takes_the_magnitude(void **state)
{
    (void)state;
    for (int magnitude = 0; magnitude < 2; magnitude++) {
        struct contact s = contact_of(magnitude ? CONTACT_CAP_MAGNITUDE : 0, 0.5, 1e-6);
        struct contact_result f = {.elastic = 0};
        for (int n = 0; n < 100; n++) f = step(&s, -0.1, 1);
        assert_true(f.force.x > 0); /* i is pulled towards j */
        assert_near(f.force.y, magnitude ? -mu * f.force.x : 0, 1e-9 * f.force.x);
    }
}

/* Surfaces move with the radius, and the torque acts on it: l_i + l_j is r_i + r_j. */
static void lever_is_the_radius(void **state)
{
    const double r_j = 3e-3, delta = 1e-4;
    vec3 zero = v3(0, 0, 0), w_i = v3(0, 0, 7), w_j = v3(0, 0, -2);
    struct kinematics_motion m = kinematics_free(zero, zero, w_i, w_j);
    pvec3 D = p3(r + r_j - delta, 0, 0);
    struct contact_kinematics k = contact_kinematics_pair(D, m, r, r_j, dt);
    (void)state;
    assert_near(k.v_t.y, 7 * (r - delta / 2) - 2 * (r_j - delta / 2), 1e-15);
    m.radius_lever = 1;
    k = contact_kinematics_pair(D, m, r, r_j, dt);
    assert_true(k.l_i == r && k.l_j == r_j);
    assert_near(k.v_t.y, 7 * r - 2 * r_j, 1e-15);
    assert_near(k.v_t_end.y, 7 * r - 2 * r_j, 1e-15);
    k = contact_kinematics_wall(v3(1, 0, 0), v3(1, 0, 0), delta, delta, m, r);
    assert_true(k.l_i == r);
    assert_near(k.v_t.y, 7 * r, 1e-15);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whole_slip_leaves_the_dashpot_its_share),
        cmocka_unit_test(undamped_slip_has_no_dashpot),
        cmocka_unit_test(limit_takes_the_magnitude),
        cmocka_unit_test(lever_is_the_radius),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
