/* What holds to the last bit, in every precision: third law, orientation, features in or out. */
#include <string.h>

#include "law_test.h"
#include "law_variant.h"

#define TRIALS 20000

static uint64_t seed;

/* Uniform in [-1, 1). splitmix64 */
static double any(void)
{
    uint64_t z = (seed += 0x9e3779b97f4a7c15u);
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    z ^= z >> 31;
    return (double)(z >> 11) / 4503599627370496.0 - 1;
}

static vec3 any3(double scale)
{
    double x = scale * any(), y = scale * any(), z = scale * any();
    return v3((real)x, (real)y, (real)z);
}

#define CHOICES                                                                                    \
    (CONTACT_WHOLE_SLIP | CONTACT_RADIUS_LEVER | CONTACT_NO_RESCALE | CONTACT_CAP_MAGNITUDE)

struct features {
    int hertz, no_attraction, friction, damped, bond, cdt, epsd;
    int choices; /* CONTACT_ bits of friction */
};

/* A pair near touching, sizes within 1:3, with a history that such a pair may have. */
static struct variant_input any_pair(struct features f)
{
    struct variant_input in;
    double r_i = 2e-3 * (2 + any()), r_j = 2e-3 * (2 + any()), z = 0.3 * (1 + any());
    struct contact_material c =
        f.hertz ? contact_material_hertz((real)1e7, (real)2e6, (real)z, -1, f.damped ? (real)z : 0)
                : contact_material_linear((real)1e4, (real)z, (real)0.8, f.damped ? (real)z : 0);
    vec3 x = any3(1);
    double wish = (r_i + r_j - 2e-5 * any()) / sqrt((double)v3_dot(x, x));
    vec3 n;

    memset(&in, 0, sizeof in);
    in.r_i = (real)r_i;
    in.r_j = (real)r_j;
    in.dt = (real)1e-5;
    in.D =
        p3((preal)(wish * (double)x.x), (preal)(wish * (double)x.y), (preal)(wish * (double)x.z));
    in.m.v = any3(2);
    in.m.kick = any3(0.1);
    in.m.w_i = any3(100);
    in.m.w_j = any3(100);
    in.m.spun_i = any3(10);
    in.m.spun_j = any3(10);
    c.mu = f.friction ? (real)(0.3 * (1 + any())) : 0;
    c.f_b = f.bond ? (real)0.1 : 0;
    if (f.cdt || f.epsd)
        c = contact_material_rolling(c, (real)0.1, f.epsd ? (real)2.25 : 0, (real)0.2);
    c.law |= (f.no_attraction ? CONTACT_NO_ATTRACTION : 0) | f.choices;
    in.p = contact_parameters_of(c,
        contact_pair_of(
            (real)(1e-6 / (r_i * r_i * r_i)), (real)(1e-6 / (r_j * r_j * r_j)), in.r_i, in.r_j),
        in.dt);
    in.m.radius_lever = parameters_radius_lever(in.p);
    n = v3_scale(1 / r_sqrt(v3_dot(x, x)), x);
    if (any() > -0.5) {
        in.h.state = CONTACT_TOUCHING | (f.bond ? CONTACT_BONDED : 0);
        if (f.friction) in.h.xi = v3_tangent(any3(1e-5), n);
        if (f.epsd) in.h.theta = v3_tangent(any3(1e-3), n);
    }
    return in;
}

/* Same value; +0 and -0 are the same here: added to a force they differ in no bit. */
static void assert_same(vec3 a, vec3 b)
{
    if (!(a.x == b.x && a.y == b.y && a.z == b.z))
        fail_msg("(%a, %a, %a) is not (%a, %a, %a)", (double)a.x, (double)a.y, (double)a.z,
            (double)b.x, (double)b.y, (double)b.z);
}

static void assert_same_result(struct variant_output a, struct variant_output b)
{
    assert_same(a.r.force, b.r.force);
    assert_same(a.r.couple, b.r.couple);
    assert_same(a.r.moment, b.r.moment);
    assert_same(a.h.xi, b.h.xi);
    assert_same(a.h.theta, b.h.theta);
}

/* The bare variant against the one with every feature, on pairs that use only what the bare one
 * has. */
static void check_variant(variant_law *bare, struct features f)
{
    int pushed = 0;
    seed = 1;
    for (int k = 0; k < TRIALS; k++) {
        struct variant_input in = any_pair(f);
        struct variant_output full = variant_all(&in), out = bare(&in);
        assert_same_result(full, out);
        pushed += full.r.force.x != 0;
    }
    assert_true(pushed > TRIALS / 8); /* else little was compared */
}

static void unused_features_leave_the_bits_linear(void **state)
{
    (void)state;
    check_variant(variant_linear, (struct features){.hertz = 0});
    check_variant(variant_linear_friction, (struct features){.friction = 1});
    check_variant(variant_linear_damped, (struct features){.friction = 1, .damped = 1});
    check_variant(variant_linear_bond, (struct features){.friction = 1, .damped = 1, .bond = 1});
    check_variant(variant_linear_cdt, (struct features){.friction = 1, .cdt = 1});
    check_variant(variant_linear_epsd, (struct features){.friction = 1, .epsd = 1});
    check_variant(variant_linear_cut, (struct features){.no_attraction = 1});
}

static void unused_features_leave_the_bits_hertz(void **state)
{
    (void)state;
    check_variant(variant_hertz, (struct features){.hertz = 1});
    check_variant(variant_hertz_damped, (struct features){.hertz = 1, .friction = 1, .damped = 1});
    check_variant(variant_hertz_choices,
        (struct features){.hertz = 1, .friction = 1, .damped = 1, .choices = CHOICES});
}

/* A pair seen from the other side: everything negated, exactly; n x F_t is the same. */
static void swapped(struct features f)
{
    seed = 2;
    for (int k = 0; k < TRIALS; k++) {
        struct variant_input in = any_pair(f), back = in;
        struct variant_output a, b;
        back.D = p3(-in.D.x, -in.D.y, -in.D.z);
        back.m.v = v3_neg(in.m.v);
        back.m.kick = v3_neg(in.m.kick);
        back.m.w_i = in.m.w_j;
        back.m.w_j = in.m.w_i;
        back.m.spun_i = in.m.spun_j;
        back.m.spun_j = in.m.spun_i;
        back.r_i = in.r_j;
        back.r_j = in.r_i;
        back.h.xi = v3_neg(in.h.xi);
        back.h.theta = v3_neg(in.h.theta);
        a = variant_all(&in);
        b = variant_all(&back);
        assert_same(a.r.force, v3_neg(b.r.force));
        assert_same(a.r.couple, b.r.couple);
        assert_same(a.r.moment, v3_neg(b.r.moment));
        assert_same(a.h.xi, v3_neg(b.h.xi));
        assert_same(a.h.theta, v3_neg(b.h.theta));
        assert_true(a.l_i == b.l_j && a.l_j == b.l_i && a.h.state == b.h.state);
        assert_true(
            a.r.elastic == b.r.elastic && a.r.loss_n == b.r.loss_n && a.r.loss_s == b.r.loss_s);
    }
}

static void swap_negates_the_bits(void **state)
{
    (void)state;
    swapped((struct features){.friction = 1, .damped = 1, .bond = 1});
    swapped((struct features){.hertz = 1, .friction = 1, .damped = 1, .epsd = 1});
    swapped((struct features){.friction = 1, .cdt = 1, .no_attraction = 1});
    swapped((struct features){.hertz = 1, .friction = 1, .damped = 1, .choices = CHOICES});
}

/* Lever arms add up to the distance: no angular momentum from the pair, beyond rounding. */
static void angular_momentum(void **state)
{
    const double eps = sizeof(real) == 4 ? 6e-8 : 1.2e-16;
    (void)state;
    seed = 3;
    for (int k = 0; k < TRIALS; k++) {
        struct variant_input in = any_pair((struct features){.friction = 1, .damped = 1});
        struct variant_output a = variant_all(&in);
        /* torques (l_i + l_j) n x F_t, and x_i x F - x_j x F = -D x F */
        vec3 sum = v3_sub(v3_scale(a.l_i + a.l_j, a.r.couple), v3_cross(v3_of_p3(in.D), a.r.force));
        double size = (double)(in.r_i + in.r_j) * sqrt((double)v3_dot(a.r.force, a.r.force));
        assert_below(sqrt((double)v3_dot(sum, sum)), 20 * eps * size + 1e-30);
    }
}

/* All history is +0 once there is no contact. */
static void no_contact_no_history(void **state)
{
    static const struct contact_history none;
    int ended = 0;
    (void)state;
    seed = 4;
    for (int k = 0; k < TRIALS; k++) {
        struct variant_input in =
            any_pair((struct features){.friction = 1, .damped = 1, .epsd = 1});
        struct variant_output a = variant_all(&in);
        if (a.h.state) continue;
        assert_memory_equal(&a.h.xi, &none.xi, sizeof none.xi);
        assert_memory_equal(&a.h.theta, &none.theta, sizeof none.theta);
        ended += in.h.state != 0;
    }
    assert_true(ended > TRIALS / 20);
}

/* Pairs of a list that are apart: no force, no history, finite. */
static void apart(void **state)
{
    (void)state;
    seed = 5;
    for (int k = 0; k < TRIALS; k++) {
        struct variant_input in =
            any_pair((struct features){.hertz = k & 1, .friction = 1, .damped = 1, .epsd = 1});
        struct variant_output a;
        in.h.state = 0;
        in.h.xi = in.h.theta = v3(0, 0, 0);
        in.D = p3_scale((preal)1.05, in.D);
        a = variant_all(&in);
        assert_same(a.r.force, v3(0, 0, 0));
        assert_same(a.r.couple, v3(0, 0, 0));
        assert_same(a.r.moment, v3(0, 0, 0));
        assert_true(a.h.state == 0 && a.r.elastic == 0 && a.r.loss_n == 0 && a.r.loss_s == 0);
    }
}

/* Coincident and nearly coincident centres: a fixed direction, the force of the whole overlap,
 * nothing infinite. */
static void coincident_centres(void **state)
{
    static const double apart_by[] = {0, 1e-30, 1e-15, 1e-9, 1e-6};
    (void)state;
    for (int k = 0; k < 20; k++) {
        struct features f = {.hertz = k & 1, .friction = 1, .damped = 1, .epsd = (k & 2) != 0};
        struct variant_input in = any_pair(f);
        struct variant_output a;
        double d = apart_by[k / 4], force;
        in.D = p3((preal)d, 0, 0);
        memset(&in.m, 0, sizeof in.m); /* no dashpot */
        in.h = (struct contact_history){.state = CONTACT_TOUCHING};
        a = variant_all(&in);
        force = (double)in.r_i + (double)in.r_j - d;
        force = (double)in.p.k_n * force * (f.hertz ? sqrt(force) : 1);
        assert_near((double)a.r.force.x / -force, 1, 1e-6);
        assert_true(a.r.force.x < 0 && a.r.force.y == 0 && a.r.force.z == 0 &&
                    isfinite((double)a.r.force.x));
        in = any_pair(f); /* and moving any way */
        in.D = p3(0, (preal)d, 0);
        a = variant_all(&in);
        assert_true(isfinite((double)(a.r.force.x + a.r.force.y + a.r.force.z)) &&
                    isfinite((double)(a.h.xi.x + a.h.xi.y + a.h.xi.z)));
        assert_true(isfinite((double)(a.r.couple.x + a.r.moment.y + a.r.elastic + a.r.loss_n +
                                      a.r.loss_s + a.r.loss_t)));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(unused_features_leave_the_bits_linear),
        cmocka_unit_test(unused_features_leave_the_bits_hertz),
        cmocka_unit_test(swap_negates_the_bits),
        cmocka_unit_test(angular_momentum),
        cmocka_unit_test(no_contact_no_history),
        cmocka_unit_test(apart),
        cmocka_unit_test(coincident_centres),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
