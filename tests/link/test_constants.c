/* Constants of links against the homogenised moduli, the limits of mixed links, and what is
 * refused. */
#include "laws/link_constants.h"
#include "tests/limit/limit_test.h"

#include <string.h>

static const struct link_material steel = {7900, 210e9, 0.3, 1e-8}, soft = {1200, 3e9, 0.4, 3e-8};

static void moduli(void **state)
{
    const double h = 0.01;
    struct link_stiffness k = link_constants_between(LINK_ISOTROPIC, steel, steel, h);
    double G = link_constants_shear(steel), lambda = link_constants_lambda(LINK_ISOTROPIC, steel);
    (void)state;
    assert_near(G / 80.7692307692e9, 1, 1e-11);
    assert_near(lambda / 121.153846154e9, 1, 1e-11);
    /* C11 = kn/h + lambda, C44 = ks/(2 h) */
    assert_near((k.kn / h + lambda) / (steel.young * 0.7 / (1.3 * 0.4)), 1, 1e-14);
    assert_near(k.ks / (2 * h * G), 1, 1e-14);
    assert_near(k.kt / (G * h * h * h / 6), 1, 1e-14);
    assert_near(k.kb / (steel.young * h * h * h / 12), 1, 1e-14);
    assert_true(k.r_i == 1 && k.r_j == 1 && k.eta == steel.damping);
    assert_true(!link_constants_shear_apart(k) && link_constants_twist_apart(k));
    assert_near(link_constants_mass(steel, h), 7.9e-3, 1e-15);
    assert_near(link_constants_inertia(steel, h), 7.9e-3 * 1e-4 / 6, 1e-20);
}

static void without_poisson(void **state)
{
    struct link_material a = steel, b = soft;
    (void)state;
    a.poisson = b.poisson = 0;
    struct link_stiffness k = link_constants_between(LINK_ISOTROPIC, a, b, 0.1),
                          seed = link_constants_between(LINK_REFERENCE, a, a, 0.1);
    assert_true(!link_constants_shear_apart(k) && !link_constants_twist_apart(k));
    /* two springs in series */
    assert_near(k.kn / (0.1 * 2 * a.young * b.young / (a.young + b.young)), 1, 1e-14);
    assert_true(seed.kn == seed.ks && seed.kt == seed.kb);
    assert_near(seed.kn / (a.young * 0.1), 1, 1e-14);
    assert_near(seed.kb / (a.young * 1e-3), 1, 1e-14);
}

static void mixed(void **state)
{
    struct link_stiffness k = link_constants_between(LINK_ISOTROPIC, steel, soft, 0.01),
                          back = link_constants_between(LINK_ISOTROPIC, soft, steel, 0.01);
    struct link_material rigid = steel;
    (void)state;
    assert_true(k.kn == back.kn && k.ks == back.ks && k.kt == back.kt && k.kb == back.kb &&
                k.r_i == back.r_j && k.r_j == back.r_i);
    assert_near(k.r_i + k.r_j, 2, 1e-15);
    assert_true(link_constants_shear_apart(k) && k.kn > k.ks);
    assert_near(k.eta, 2e-8, 1e-22);
    rigid.young *= 1e9; /* a wall is the limit */
    struct link_stiffness wall = link_constants_wall(LINK_ISOTROPIC, steel, 0.01),
                          near = link_constants_between(LINK_ISOTROPIC, steel, rigid, 0.01);
    assert_near(near.kn / wall.kn, 1, 1e-8);
    assert_near(near.ks / wall.ks, 1, 1e-8);
    assert_near(near.kt / wall.kt, 1, 1e-8);
    assert_near(near.kb / wall.kb, 1, 1e-8);
    assert_near(near.r_i, wall.r_i, 1e-8);
    assert_near(near.r_j, wall.r_j, 1e-8);
    assert_near(wall.kn / (4 * link_constants_shear(steel) * 0.01), 1, 1e-14);
}

static void strength(void **state)
{
    const struct link_strength a = {2, 5, 1, 0, 0, 0}, b = {3, HUGE_VAL, 0, 0, 0, 0},
                               c = {3, HUGE_VAL, 2, 0, 0, 0};
    (void)state;
    assert_true(link_constants_weaker(a, b).tension == 2 && link_constants_weaker(b, a).shear == 5);
    assert_true(
        link_constants_weaker(a, b).criterion == 1 && link_constants_weaker(b, a).criterion == 1);
    assert_true(
        link_constants_weaker(b, c).criterion == 0 && link_constants_weaker(c, b).criterion == 0);
    /* glass: E = 70 GPa, G_c = 8 J/m2, h = 1 mm */
    const struct link_material glass = {2500, 70e9, 0.22, 0};
    assert_near(link_constants_tension(glass, 8, 1e-3, false) / 17.748239e6, 1, 1e-7);
    assert_near(link_constants_tension(glass, 8, 1e-3, true) /
                    link_constants_tension(glass, 8, 1e-3, false),
        1 / sqrt(1 - 0.22 * 0.22), 1e-14);
    assert_near(link_constants_tension(glass, 8, 0.25e-3, true) /
                    link_constants_tension(glass, 8, 1e-3, true),
        2, 1e-14);
}

static void refused(enum link_set set, double density, double young, double poisson, double damping,
    const char *word)
{
    const char *text =
        link_constants_refusal(set, (struct link_material){density, young, poisson, damping});
    if (!text || !strstr(text, word))
        fail_msg("not refused for %s: %s", word, text ? text : "accepted");
}

static void refusals(void **state)
{
    (void)state;
    assert_null(link_constants_refusal(LINK_ISOTROPIC, steel));
    assert_null(link_constants_refusal(LINK_ISOTROPIC, (struct link_material){1, 1, -0.99, 0}));
    assert_null(link_constants_refusal(LINK_REFERENCE, (struct link_material){1, 1, 0, 0}));
    refused(LINK_ISOTROPIC, 1, 1, 0.5, 0, "poisson");
    refused(LINK_ISOTROPIC, 1, 1, -1, 0, "poisson");
    refused(LINK_ISOTROPIC, 1, 1, NAN, 0, "poisson");
    refused(LINK_ISOTROPIC, 0, 1, 0, 0, "density");
    refused(LINK_ISOTROPIC, 1, -1, 0, 0, "young");
    refused(LINK_ISOTROPIC, 1, 1, 0, -1, "damping");
    refused(LINK_REFERENCE, 1, 1, 0.3, 0, "poisson must be 0");
    refused(LINK_REFERENCE, 1, 1, -1e-9, 0, "poisson must be 0");
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(moduli), cmocka_unit_test(without_poisson),
        cmocka_unit_test(mixed), cmocka_unit_test(strength), cmocka_unit_test(refusals)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
