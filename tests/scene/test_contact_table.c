/* From what a scene says of friction to numbers of the law: the definitions of its dashpot. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "kernels/contact/all_features.h"
#include "kernels/contact/law_parameters.h"
#include "particle/contact_table.h"

static struct contact_material of(struct contact c)
{
    struct material m = {.density = 2500, .young = 1e9, .poisson = 0.25};
    struct scene scene = {.material = &m, .n_material = 1, .contact = &c, .n_contact = 1};
    double row[MATERIAL_WIDTH];
    contact_table_material(&scene, 0, 0, row);
    return material_load(row);
}

static struct contact of_law(enum normal_law law)
{
    return (struct contact){.normal_law = law,
        .stiffness = 1e4,
        .damping_ratio = 0.2,
        .attraction = true,
        .has_tangential = true,
        .stiffness_ratio = law == NORMAL_LINEAR ? 0.8 : -1,
        .tangential_damping = 0.2,
        .damping_factor = -1,
        .friction = 0.3,
        .rescale = true};
}

/* gamma_t over gamma_n is (k_t/k_n)^(1/2) where the mass is m* and z the same, with Hertz by the
 * tangent k_n; a share of gamma_n is that share. k_t/k_n is 4 G*E*, 2 (1 - nu)/(2 - nu) for equal
 * materials. The default is smaller by (2/7)^(1/2), with Hertz by 1/1.708. */
static void dashpot_of_friction(void **state)
{
    const double ratio[2] = {0.8, 2 * 0.75 / 1.75}, share[2] = {sqrt(2.0 / 7), sqrt(12.0 / 35)};
    (void)state;
    for (int law = 0; law < 2; law++) {
        struct contact c = of_law(law ? NORMAL_HERTZ : NORMAL_LINEAR);
        struct contact_material surface = of(c);
        c.damping_mass = DAMPING_MASS_CENTRE;
        struct contact_material centre = of(c);
        assert_true(fabs(centre.gamma_t / centre.gamma_n - sqrt(ratio[law])) < 1e-14);
        assert_true(fabs(surface.gamma_t / centre.gamma_t - share[law]) < 1e-14);
        c.damping_factor = 0.5;
        assert_true(fabs(of(c).gamma_t / of(c).gamma_n - 0.5) < 1e-14);
        c.damping_factor = 0;
        assert_true(of(c).gamma_t == 0);
    }
}

/* Each choice is one bit; without friction there is none. */
static void bits_of_friction(void **state)
{
    struct contact c = of_law(NORMAL_HERTZ);
    (void)state;
    assert_int_equal(of(c).law, CONTACT_HERTZ);
    c.slip = SLIP_WHOLE;
    assert_int_equal(of(c).law, CONTACT_HERTZ | CONTACT_WHOLE_SLIP);
    c.slip = SLIP_UNDAMPED;
    assert_int_equal(of(c).law, CONTACT_HERTZ | CONTACT_UNDAMPED_SLIP);
    c.slip = SLIP_WHOLE;
    c.lever = LEVER_RADIUS;
    c.rescale = false;
    c.cap = CAP_MAGNITUDE;
    assert_int_equal(of(c).law, CONTACT_HERTZ | CONTACT_WHOLE_SLIP | CONTACT_RADIUS_LEVER |
                                    CONTACT_NO_RESCALE | CONTACT_CAP_MAGNITUDE);
    c.has_tangential = false;
    assert_int_equal(of(c).law, CONTACT_HERTZ);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dashpot_of_friction),
        cmocka_unit_test(bits_of_friction),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
