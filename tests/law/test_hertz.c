/* Hertz impact against closed forms: Chung and Ooi 2011 (Granular Matter 13, 643), tests 1 to 3,
 * elastic. The limit is 0.1 %. */
#include <string.h>

#include "law_test.h"
#include "two_body.h"

struct bench {
    const char *name;
    int plane;                                /* rigid */
    double r, speed, young, poisson, density; /* SI; speed: of each sphere */
    double depth, force, time;                /* largest overlap [m], force [N], duration [s] */
};

static void check(const struct bench *c)
{
    struct two_body s;
    double m = 4.0 / 3 * 3.14159265358979 * c->r * c->r * c->r * c->density;
    double rigid = c->young / (1 - c->poisson * c->poisson), depth = 0, force = 0, time = 0;

    memset(&s, 0, sizeof s);
    s.plane = c->plane;
    s.dt = c->time / 1000;
    s.b[0] = two_body_sphere(m, c->r, p3(0, 0, c->r), v3(0, 0, -c->speed), v3(0, 0, 0));
    s.b[1] = two_body_sphere(m, c->r, p3(0, 0, -c->r), v3(0, 0, c->speed), v3(0, 0, 0));
    two_body_set(&s, contact_material_hertz(c->plane ? rigid : rigid / 2, 0, 0, 0, 0));
    for (int k = 0; k < 1200; k++) {
        two_body_step(&s);
        depth = s.k.delta > depth ? s.k.delta : depth;
        force = s.r.force.z > force ? s.r.force.z : force;
        time += s.k.delta > 0 ? s.dt : 0;
    }
    assert_near(depth / c->depth, 1, 1e-3);
    assert_near(force / c->force, 1, 1e-3);
    assert_near(time / c->time, 1, 2e-3); /* counted in whole steps */
    assert_near(
        (s.b[0].v.z - (c->plane ? 0 : s.b[1].v.z)) / (c->plane ? c->speed : 2 * c->speed), 1, 1e-6);
}

static void glass(void **state)
{
    static const struct bench c = {
        "glass", 0, 10e-3, 10, 4.8e10, 0.20, 2800, 274.113e-6, 10696.9, 40.3384e-6};
    (void)state;
    check(&c);
}

static void limestone(void **state)
{
    static const struct bench c = {
        "limestone", 0, 10e-3, 10, 2.0e10, 0.25, 2500, 368.304e-6, 7108.2, 54.1996e-6};
    (void)state;
    check(&c);
}

static void aluminium_alloy_on_plane(void **state)
{
    static const struct bench c = {
        "Al alloy", 1, 0.1, 0.2, 7.0e10, 0.30, 2699, 49.717e-6, 11370, 731.64e-6};
    (void)state;
    check(&c);
}

static void magnesium_alloy_on_plane(void **state)
{
    static const struct bench c = {
        "Mg alloy", 1, 0.1, 0.2, 4.0e10, 0.35, 1800, 52.123e-6, 7232.7, 767.05e-6};
    (void)state;
    check(&c);
}

static void aluminium_oxide_on_plane(void **state)
{
    static const struct bench c = {
        "Al oxide", 1, 2.5e-3, 3.9, 3.8e11, 0.23, 4000, 8.0888e-6, 615.35, 6.1044e-6};
    (void)state;
    check(&c);
}

static void cast_iron_on_plane(void **state)
{
    static const struct bench c = {
        "cast iron", 1, 2.5e-3, 3.9, 1.0e11, 0.25, 7000, 17.1887e-6, 506.76, 12.9717e-6};
    (void)state;
    check(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(glass),
        cmocka_unit_test(limestone),
        cmocka_unit_test(aluminium_alloy_on_plane),
        cmocka_unit_test(magnesium_alloy_on_plane),
        cmocka_unit_test(aluminium_oxide_on_plane),
        cmocka_unit_test(cast_iron_on_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
