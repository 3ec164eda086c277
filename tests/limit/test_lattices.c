/* Regular packings, whose true limits are known by formula, and damping: the numbers of the table
 * in the physics notes. Unit stiffness and mass; true = 2/w_max of the undamped lattice. */
#include "limit_test.h"

#include "kernels/contact/law_limit.h"

static const double dimer[] = {1, 0, 0},
                    cubic[] = {1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 1, 0, 0, -1};
static const double fcc[] = {1, 1, 0, 1, -1, 0, -1, 1, 0, -1, -1, 0, 1, 0, 1, 1, 0, -1, -1, 0, 1,
    -1, 0, -1, 0, 1, 1, 0, 1, -1, 0, -1, 1, 0, -1, -1};

/* Contacts of equal spheres of mass 1 and radius 1 in the directions n [count][3]. */
static double bound(const double *n, int count, double kappa, double z, double dt, double share)
{
    struct contact_material m = contact_material_linear(1, z, kappa, 0);
    struct limit_ends ends = {1, 1, 1, 1};
    struct limit_sums s = limit_sums_zero();
    struct limit_contact c = limit_contact_of(m, ends, 1e-3, 0, dt);
    for (int k = 0; k < count; k++) {
        double r =
            sqrt(n[3 * k] * n[3 * k] + n[3 * k + 1] * n[3 * k + 1] + n[3 * k + 2] * n[3 * k + 2]);
        s = limit_sums_add(s, c, ends, v3(n[3 * k] / r, n[3 * k + 1] / r, n[3 * k + 2] / r), share);
    }
    return limit_of_sums(s, LIMIT_NONE);
}

static double true_fcc(double kappa)
{
    return 2 / sqrt(fmax(8 + 8 * kappa, 40 * kappa));
}

static void without_damping(void **state)
{
    (void)state;
    assert_near(bound(dimer, 1, 0, 0, 0, 1), 2 / sqrt(2), 1e-6);
    assert_near(bound(dimer, 1, 0.8, 0, 0, 1), 2 / sqrt(5.6), 1e-4);
    assert_near(bound(cubic, 6, 0, 0, 0, 1), 2 / sqrt(4), 1e-6);
    assert_near(bound(cubic, 6, 0.8, 0, 0, 1) / (2 / sqrt(16)), 0.778, 5e-4);
    assert_near(bound(fcc, 12, 0, 0, 0, 1), true_fcc(0), 1e-6);
    assert_near(bound(fcc, 12, 2.0 / 7, 0, 0, 1) / true_fcc(2.0 / 7), 0.690, 5e-4);
    assert_near(bound(fcc, 12, 0.8, 0, 0, 1) / true_fcc(0.8), 0.778, 5e-4);
    assert_near(bound(fcc, 12, 1, 0, 0, 1) / true_fcc(1), 0.791, 5e-4);
}

/* The share that balances translation and rotation. */
static void shared(void **state)
{
    (void)state;
    assert_near(
        bound(fcc, 12, 2.0 / 7, 0, 0, limit_share(2.0 / 7)) / true_fcc(2.0 / 7), 0.770, 6e-4);
    assert_near(bound(fcc, 12, 0.8, 0, 0, limit_share(0.8)) / true_fcc(0.8), 0.822, 5e-4);
    assert_near(limit_share(1e9), 1, 1e-6);
    for (double s = 0.3; s < 1.01; s += 0.05) /* none is better than that one */
        assert_true(bound(fcc, 12, 0.8, 0, 0, s) <=
                    bound(fcc, 12, 0.8, 0, 0, limit_share(0.8)) * (1 + 1e-9));
}

/* Dashpots on the plainly predicted velocity, p = q = 1, as for a step of almost nothing:
 * h^2 + 8 z h = 4, h = w dt; in the bed's top mode with twice w and 2 z. */
static void predicted_dashpots(void **state)
{
    (void)state;
    static const double z[] = {0.02, 0.1, 0.3, 0.5, 1, 2, 5};
    for (int k = 0; k < 7; k++) {
        double pair = sqrt(1 + 4 * z[k] * z[k]) - 2 * z[k],
               bed = sqrt(1 + 16 * z[k] * z[k]) - 4 * z[k];
        assert_near(bound(dimer, 1, 0, z[k], 0, 1) / bound(dimer, 1, 0, 0, 0, 1), pair, 1e-6);
        assert_near(bound(fcc, 12, 0, z[k], 0, 1) / bound(fcc, 12, 0, 0, 0, 1), bed, 1e-6);
    }
}

/* How much a pair swings after many steps of h = w dt over how much it did at first, with dashpots
 * gamma (p v + q (dt/2) a). */
static double growth(double z, double h, double p, double q)
{
    double x = 1, v = 0, before = 0, first = 0, last = 0;
    for (int k = 0; k < 20000; k++) {
        double change = -h * h * x - 2 * z * h * (p * v + 0.5 * q * (v - before));
        before = v;
        v += change;
        x += v;
        if (k < 100) first = fmax(first, fabs(x));
        if (k >= 19900) last = fmax(last, fabs(x));
        if (!(fabs(x) < 1e100)) return HUGE_VAL;
    }
    return last / first;
}

/* That limit is the scheme's own: below it a pair comes to rest, above it does not. */
static void limit_of_the_prediction_is_sharp(void **state)
{
    (void)state;
    static const double z[] = {0.02, 0.1, 0.3, 1, 5};
    for (int k = 0; k < 5; k++) {
        double h = 2 * (sqrt(1 + 4 * z[k] * z[k]) - 2 * z[k]);
        assert_true(growth(z[k], 0.995 * h, 1, 1) < 1e-2);
        assert_true(growth(z[k], 1.005 * h, 1, 1) > 1e10);
    }
}

/* From 0 up to where the step that the dashpots are centred for is the bound itself. */
static double centred(const double *n, int count, double z)
{
    double dt = 0, before = -1;
    for (int k = 0; k < 400 && dt > before * (1 + 1e-7); k++) {
        before = dt;
        dt = bound(n, count, 0, z, dt, 1);
        assert_true(dt >= before * (1 - 1e-9)); /* safe all the way: it only rises */
    }
    return dt;
}

/* Dashpots as they are, p <= 1, q = max(1 - c, 0)/(1 + c) with c = z h:
 * h^2 + 4 z h max(2/(1 + c), 1) = 4 for a pair, 1 for FCC, h = dt (2 k/m)^(1/2). A pair alone, for
 * which they are the trapezoidal rule, is stable up to h = 2 where c <= 1, so at this bound too. */
static void centred_dashpots(void **state)
{
    (void)state;
    static const double z[] = {0.02, 0.1, 0.3, 1, 2, 5};
    for (int k = 0; k < 6; k++) {
        double pair = centred(dimer, 1, z[k]) * sqrt(2), bed = centred(fcc, 12, z[k]) * sqrt(2);
        double c = z[k] * pair, c_bed = z[k] * bed;
        assert_near(pair * pair + 4 * c * fmax(2 / (1 + c), 1), 4, 1e-4);
        assert_near(bed * bed + 4 * c_bed * fmax(2 / (1 + c_bed), 1), 1, 1e-4);
        double p = fmax(1 - 0.5 * pair * pair / (1 + c), 0), q = fmax(1 - c, 0) / (1 + c);
        assert_true(growth(z[k], 0.999 * pair, p, q) < 1e-2);
    }
}

/* Hertz: stiffness where the pair would come to rest; mass ratios; a bond's longer levers. */
static void ends_and_depth(void **state)
{
    (void)state;
    struct contact_material hertz = contact_material_hertz(1e6, 1e5, 0, -1, 0),
                            bond = contact_material_linear(100, 0, 0.5, 0);
    struct limit_ends ends = {2, 2, 0.01, 0.01}, wall = {2, 0, 0.01, 0};
    double m_star = 0.25, v = 0.3, K = hertz.k_n * sqrt(0.005),
           deepest = pow(1.25 * m_star * v * v / K, 0.4);
    struct limit_contact still = limit_contact_of(hertz, ends, 1e-5, -v, 0),
                         fast = limit_contact_of(hertz, ends, 1e-9, v, 0);
    assert_near(still.k_n / (1.5 * K * sqrt(1e-5)), 1, 1e-5);
    assert_between(fast.k_n / (1.5 * K * sqrt(deepest)), 1, 1 + 2e-4);
    assert_near(limit_contact_of(hertz, wall, 1e-5, 0, 0).k_n / still.k_n, sqrt(2), 1e-5);
    bond.f_b = 1e-3;
    assert_true(normal_acts(bond, limit_r_star(ends), 1e-9));
    assert_true(normal_acts(bond, limit_r_star(ends), -0.99e-5));
    assert_false(normal_acts(bond, limit_r_star(ends), -1.01e-5));
    assert_near(limit_contact_of(bond, wall, -1e-5, 0, 0).stretch, 1.001 * 1.001, 1e-12);
    bond.f_b = 0;
    assert_false(normal_acts(bond, limit_r_star(ends), -1e-9));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(without_damping), cmocka_unit_test(shared),
        cmocka_unit_test(predicted_dashpots), cmocka_unit_test(limit_of_the_prediction_is_sharp),
        cmocka_unit_test(centred_dashpots), cmocka_unit_test(ends_and_depth)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
