/* The ledger closes: kinetic + elastic energy + losses = what was there at first, to second order,
 * in each kind of impact. */
#include "impact.h"
#include "law_test.h"

#define PHASES 10

/* Worst relative gap at the end over the phase; losses of the last run in parts of the first
 * energy. */
static double gap_of(const struct impact *c, int n, double part[5])
{
    double worst = 0;
    for (int k = 0; k < PHASES; k++) {
        struct two_body s;
        double before, gap;
        impact_start(&s, c, n, 0);
        before = two_body_kinetic(&s);
        impact_run(&s, c, n, (double)k / PHASES);
        assert_int_equal(s.h.state, 0);
        gap = fabs(two_body_energy(&s) + two_body_lost(&s) - before) / before;
        worst = gap > worst ? gap : worst;
        for (int i = 0; i < 5; i++) part[i] = s.lost[i] / before;
    }
    return worst;
}

/* limit: of the gap at 100 steps per contact, where counting at the end of the step has some
 * 2e-2. */
static void check(const struct impact *c, double limit, const double least[5])
{
    double part[5], coarse = gap_of(c, 50, part), middle = gap_of(c, 100, part),
                    fine = gap_of(c, 800, part);
    assert_below(middle, limit);
    assert_true(law_order(coarse, 50, fine, 800) > 1.5);
    for (int i = 0; i < 5; i++) {
        if (least[i] > 0) assert_true(part[i] > least[i]);
        if (least[i] >= 0 && !(least[i] > 0)) assert_near(part[i], 0, 1e-12);
    }
}

static void dashpot(void **state)
{
    static const double least[5] = {0.1, 0, 0, 0, 0};
    (void)state;
    for (int k = 0; k < 4; k++) {
        struct impact c = {
            .hertz = k & 1, .no_attraction = k >> 1, .z_n = 0.2, .slant = 0.3, .spin = 0.3};
        check(&c, 3e-4, least);
    }
}

static void friction(void **state)
{
    static const double least[5] = {0, 0, 0.05, 0, 0};
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct impact c = {.hertz = k, .mu = 0.3, .slant = 2, .spin = 0.3};
        check(&c, 3e-4, least);
    }
}

static void friction_and_dashpots(void **state)
{
    static const double least[5] = {0.1, 1e-3, 0.05, 0, 0};
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct impact c = {.hertz = k, .z_n = 0.2, .z_t = 0.3, .mu = 0.3, .slant = 1, .spin = 0.3};
        check(&c, 3e-4, least);
    }
}

/* With other codes' friction; its spring may give energy, so nothing is asked of its share. */
static void choices_of_friction(void **state)
{
    static const double least[5] = {0.1, 1e-3, -1, 0, 0};
    (void)state;
    for (int k = 0; k < 8; k++) {
        struct impact c = {.hertz = k & 1,
            .z_n = 0.2,
            .z_t = 0.3,
            .mu = 0.3,
            .slant = k & 2 ? 1 : 0.5,
            .spin = 0.3,
            .choices = CONTACT_RADIUS_LEVER | CONTACT_CAP_MAGNITUDE};
        c.choices |= k & 4 ? CONTACT_UNDAMPED_SLIP : CONTACT_WHOLE_SLIP;
        c.choices |= c.hertz ? CONTACT_NO_RESCALE : 0;
        check(&c, 3e-4, least);
    }
}

static void breaking_bond(void **state)
{
    static const double least[5] = {0.1, 1e-3, 1e-4, 0, 0.02};
    (void)state;
    for (int k = 0; k < 2; k++) {
        struct impact c = {.hertz = k,
            .z_n = 0.05,
            .z_t = 0.1,
            .mu = 0.3,
            .slant = 0.3,
            .spin = 0.3,
            .f_b = 0.5,
            .duration = 3};
        check(&c, 3e-4, least);
    }
}

/* F_b^2/(2 k), and nothing else. */
static void breaking_bond_costs_its_energy(void **state)
{
    struct impact c = {.f_b = 0.5, .duration = 3};
    struct two_body s;
    (void)state;
    impact_run(&s, &c, 400, 0);
    /* the break is seen at a whole step; the ledger counts where it was */
    assert_near(s.lost[4] / (0.25 / (2 * IMPACT_K)), 1, 5e-2);
}

static void rolling(void **state)
{
    static const double least[5] = {0.1, 1e-3, 1e-3, 5e-3, 0};
    (void)state;
    for (int k = 0; k < 4; k++) {
        struct impact c = {.hertz = k & 1,
            .z_n = 0.05,
            .z_t = 0.1,
            .mu = 0.3,
            .slant = 0.3,
            .spin = 0.3,
            .mu_r = 0.1,
            .k_r = k >> 1 ? 2.25 : 0,
            .eta_r = 0.3};
        check(&c, 3e-4, least);
    }
}

/* A contact at rest loses nothing, to the last bit. */
static void rest_loses_nothing(void **state)
{
    struct contact_material c = contact_material_linear(1e4, 0.1, 0.8, 0.1);
    struct contact_parameters p;
    struct contact_history h = {.state = CONTACT_TOUCHING, .xi = {0, 1e-9, 2e-9}};
    struct contact_result x;
    vec3 zero = v3(0, 0, 0);
    (void)state;
    c.mu = 0.5;
    p = contact_parameters_of(c, contact_pair_of(500, 500, 5e-3, 5e-3), 1e-6);
    x = contact_law(contact_kinematics_pair(p3(0.99999e-2, 0, 0),
                        kinematics_free(zero, zero, zero, zero), 5e-3, 5e-3, 1e-6),
        p, 1e-6, &h);
    assert_true(x.loss_n == 0 && x.loss_t == 0 && x.loss_s == 0 && x.loss_r == 0 && x.loss_b == 0);
    assert_true(x.elastic > 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(dashpot),
        cmocka_unit_test(friction),
        cmocka_unit_test(friction_and_dashpots),
        cmocka_unit_test(choices_of_friction),
        cmocka_unit_test(breaking_bond),
        cmocka_unit_test(breaking_bond_costs_its_energy),
        cmocka_unit_test(rolling),
        cmocka_unit_test(rest_loses_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
