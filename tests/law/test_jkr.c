/* JKR against closed forms: what Johnson, Kendall and Roberts (1971) say of two spheres, and what
 * an impact of theirs loses. */
#include "impact.h"
#include "law_test.h"

static const double pi = 3.14159265358979323846, work = 0.2 /* J/m2 */;
static const double r_star = IMPACT_R / 2, m_star = IMPACT_M / 2;

static struct contact_material adhesive(double z_n)
{
    struct contact_material c =
        contact_material_hertz((real)IMPACT_E, (real)(0.2 * IMPACT_E), (real)z_n, -1, 0);
    c.jkr = (real)pow(2 * pi * work / IMPACT_E, 2.0 / 3);
    return c;
}

static struct contact_parameters parameters(double z_n, double dt)
{
    struct contact_pair pair =
        contact_pair_of((real)(1 / IMPACT_M), (real)(1 / IMPACT_M), (real)IMPACT_R, (real)IMPACT_R);
    return contact_parameters_of(adhesive(z_n), pair, (real)dt);
}

/* Overlap and force of a contact radius a, as in the paper. */
static double overlap_of(double a)
{
    return a * a / r_star - sqrt(2 * pi * work * a / IMPACT_E);
}

static double force_of(double a)
{
    return 4 * IMPACT_E * a * a * a / (3 * r_star) - sqrt(8 * pi * work * IMPACT_E * a * a * a);
}

static double unit(void)
{
    return pow(2 * pi * work * sqrt(r_star) / IMPACT_E, 2.0 / 3);
}

/* The whole branch from its end on, by contact radius. */
static void curve(void **state)
{
    struct contact_parameters p = parameters(0, 1e-6);
    double least = sqrt(unit() * r_star) * pow(0.25, 2.0 / 3), pull = 1.5 * pi * work * r_star;
    (void)state;
    assert_near((double)p.jkr / unit(), 1, 1e-14);
    for (int k = 1; k < 2000; k++) {
        double a = least * (1 + 0.01 * k);
        struct normal_spring n = normal_spring_of((real)overlap_of(a), p);
        assert_near((double)n.s * sqrt(r_star) / a, 1, 1e-12);
        assert_near(((double)n.force - force_of(a)) / (fabs(force_of(a)) + pull), 0, 1e-12);
    }
}

/* Pull-off (3/2) pi w R*; rest where a^3 = 9 pi w R*^2/(2 E*); end of the contact. */
static void pull_off_and_rest(void **state)
{
    struct contact_parameters p = parameters(0, 1e-6);
    double rest = overlap_of(cbrt(4.5 * pi * work * r_star * r_star / IMPACT_E)), pull = 0;
    double end = -0.75 * pow(pi * pi * work * work * r_star / (IMPACT_E * IMPACT_E), 1.0 / 3);
    (void)state;
    for (int k = 0; k <= 100000; k++)
        pull = fmax(pull, -(double)normal_spring_of((real)(end * k / 100000), p).force);
    assert_near(pull / (1.5 * pi * work * r_star), 1, 1e-8);
    assert_near((double)normal_spring_of((real)rest, p).force / pull, 0, 1e-12);
    assert_true(normal_holds(1, (real)(0.999999 * end), 0, p));
    assert_false(normal_holds(1, (real)(1.000001 * end), 0, p));
    assert_false(normal_holds(0, (real)-1e-12, 0, p)); /* it forms at the touch alone */
    assert_true(normal_holds(0, (real)1e-12, 0, p));
}

/* The energy is the integral of the force, and 0 at the touch. */
static void energy_is_work(void **state)
{
    struct contact_parameters p = parameters(0, 1e-6);
    double sum = 0, step = unit() / 1e4;
    (void)state;
    assert_near((double)normal_energy(normal_spring_of(0, p), 0, p) / (step * 1e4), 0, 1e-16);
    for (int k = 0; k < 30000; k++) {
        double middle = (k + 0.5) * step, there = (k + 1) * step;
        sum += (double)normal_spring_of((real)middle, p).force * step;
        assert_near(
            ((double)normal_energy(normal_spring_of((real)there, p), (real)there, p) - sum) /
                (1.5 * pi * work * r_star * unit()),
            0, 1e-7);
    }
}

/* Two spheres that meet at speed v; returns the steps until they have parted, or -1 if they stick.
 * worst: largest gap of the budget [J]. */
static int meet(double v, double dt, double phase, struct two_body *s, double *worst)
{
    struct two_body start = {.dt = (real)dt};
    double gap = 2e-7 + phase * v * dt, before;
    *s = start;
    s->b[0] = two_body_sphere(
        (real)IMPACT_M, (real)IMPACT_R, p3(0, 0, 0), v3((real)(v / 2), 0, 0), v3(0, 0, 0));
    s->b[1] = two_body_sphere((real)IMPACT_M, (real)IMPACT_R, p3(2 * IMPACT_R + gap, 0, 0),
        v3((real)(-v / 2), 0, 0), v3(0, 0, 0));
    two_body_set(s, adhesive(0));
    before = two_body_kinetic(s);
    *worst = 0;
    for (int k = 0, met = 0; k < 400000; k++) {
        two_body_step(s);
        *worst = fmax(*worst, fabs(two_body_energy(s) + two_body_lost(s) - before));
        if (met && s->h.state == 0) return k;
        met |= s->h.state != 0;
    }
    return -1;
}

/* Parting costs what is left of the energy at the end, K L^(5/2) (0.0375 4^(-1/3) + 9/40), whatever
 * the speed: below that they stick. */
static double cost(void)
{
    return 4.0 / 3 * IMPACT_E * sqrt(r_star) * pow(unit(), 2.5) * (0.0375 * cbrt(0.25) + 0.225);
}

static void work_of_separation(void **state)
{
    double least = sqrt(2 * cost() / m_star), dt = 2e-6, worst;
    struct two_body s;
    (void)state;
    assert_int_equal(meet(0.98 * least, dt, 0, &s, &worst), -1);
    for (int k = 2; k < 5; k++) {
        double v = k * least, out;
        assert_true(meet(v, dt, 0.3, &s, &worst) > 0);
        out = (double)(s.b[1].v.x - s.b[0].v.x);
        assert_near(out / sqrt(v * v - least * least), 1, 2e-3);
        assert_near(s.lost[4] / cost(), 1, 2e-2); /* seen at a whole step */
    }
}

/* The budget closes as the step gets smaller; the worst of some phases. */
static void budget(void **state)
{
    double v = 3 * sqrt(2 * cost() / m_star), gap[2] = {0, 0};
    (void)state;
    for (int fine = 0; fine < 2; fine++)
        for (int k = 0; k < 10; k++) {
            struct two_body s;
            double worst;
            assert_true(meet(v, fine ? 1e-6 : 8e-6, k / 10.0, &s, &worst) > 0);
            gap[fine] = fmax(gap[fine], fabs(worst) / cost());
        }
    print_message("gap of the budget %g and %g of the cost of parting\n", gap[0], gap[1]);
    assert_below(gap[1], gap[0] / 4);
    assert_below(gap[0], 0.02);
}

/* The stiffness in the bound of the time step is above every tangent that an impact passes. */
static void bound(void **state)
{
    (void)state;
    for (int k = 0; k < 4; k++) {
        struct contact_parameters p = parameters(0, 1e-6);
        double v = k * 0.1 * pow(4, k), delta = k ? 0 : 0.3 * unit(), u = 0, step = unit() / 200;
        double s = (double)normal_deepest(adhesive(0), r_star, m_star, (real)delta, (real)v);
        double deepest = delta, energy = 0.5 * m_star * v * v;
        while (energy - u > 0 && deepest < IMPACT_R) { /* as deep as the energy reaches */
            u += (double)normal_spring_of((real)(deepest + step / 2), p).force * step;
            deepest += step;
        }
        double tangent = ((double)normal_spring_of((real)deepest, p).force -
                             (double)normal_spring_of((real)(deepest - step), p).force) /
                         step;
        assert_true(tangent < 1.5 * (double)p.k_n * s);
        assert_true(s < 1.6 * (double)normal_spring_of((real)deepest, p).s); /* and not far above */
    }
}

/* Friction may use F_n + 3 pi w R*, also while the contact is pulled. */
static void friction_counts_adhesion(void **state)
{
    struct contact_parameters p = parameters(0, 1e-6);
    double pull = 1.5 * pi * work * r_star;
    (void)state;
    p.mu = (real)0.3;
    assert_near((double)tangential_cap((real)(-0.5 * pull), 1, p) / (0.3 * 1.5 * pull), 1, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(curve),
        cmocka_unit_test(pull_off_and_rest),
        cmocka_unit_test(energy_is_work),
        cmocka_unit_test(work_of_separation),
        cmocka_unit_test(budget),
        cmocka_unit_test(bound),
        cmocka_unit_test(friction_counts_adhesion),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
