/* What one link does to the last bit, in every precision: features in or out, the three axes,
 * opposite forces; to rounding: angular momentum, and the link seen from its other end. */
#include "link_variant.h"
#include "tests/limit/limit_test.h"

#define TRIALS 20000
#define EPS (sizeof(real) == 4 ? 6e-8 : 1.2e-16)

struct features {
    int volume, shear, twist, damped;
};

static vec3 any3(double size)
{
    double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
    return v3((real)x, (real)y, (real)z);
}

static struct link_cell any_cell(struct quat start)
{
    struct link_cell c;
    c.u = p3_of_v3(any3(0.1));
    c.theta = p3_of_v3(any3(0.1));
    c.q = quat_turn(start, c.theta);
    c.v = any3(1);
    c.w = any3(1);
    return c;
}

static struct variant_input any_link(struct features f)
{
    struct variant_input in;
    struct quat start =
        quat_turn(quat_of((preal)0.5, (preal)0.1, (preal)-0.7, (preal)0.5), p3_of_v3(any3(0.1)));
    double share = f.shear ? uniform(0.5, 1.5) : 1;
    in.axis = (int)uniform(0, 3);
    in.lower = any_cell(start);
    in.upper = any_cell(start);
    in.k.kn = (real)uniform(1, 2);
    in.k.ks = f.shear ? (real)uniform(0.5, 1) : in.k.kn;
    in.k.kb = (real)uniform(0.1, 0.2);
    in.k.kt = f.twist ? (real)uniform(0.05, 0.1) : in.k.kb;
    in.k.r_i = (real)share;
    in.k.r_j = (real)(2 - share);
    in.k.h = (real)0.7;
    in.k.is_cut = 0;
    in.k.offset = v3(0, 0, 0);
    in.k.eta = f.damped ? (real)uniform(0, 0.3) : 0;
    in.p_i = f.volume ? (real)uniform(-1, 1) : 0;
    in.p_j = f.volume ? (real)uniform(-1, 1) : 0;
    return in;
}

/* Same value; +0 and -0 add alike. */
static void assert_same(vec3 a, vec3 b)
{
    if (!(a.x == b.x && a.y == b.y && a.z == b.z))
        fail_msg("(%a, %a, %a) is not (%a, %a, %a)", (double)a.x, (double)a.y, (double)a.z,
            (double)b.x, (double)b.y, (double)b.z);
}

static void check_variant(variant_link *all, variant_link *bare, struct features f)
{
    for (int k = 0; k < TRIALS; k++) {
        struct variant_input in = any_link(f);
        struct variant_output a = all(&in), b = bare(&in);
        assert_same(a.lower.force, b.lower.force);
        assert_same(a.lower.torque, b.lower.torque);
        assert_same(a.upper.force, b.upper.force);
        assert_same(a.upper.torque, b.upper.torque);
        assert_true(a.lower.force.x != 0);
    }
}

static void unused_features_leave_the_bits(void **state)
{
    (void)state;
    /* they cost nothing there */
    check_variant(small_all, small_bare, (struct features){.shear = 1, .twist = 1});
    check_variant(small_all, small_volume, (struct features){.volume = 1, .shear = 1, .twist = 1});
    check_variant(small_all, small_damped, (struct features){.damped = 1, .shear = 1, .twist = 1});
    check_variant(turn_all, turn_bare, (struct features){0});
    check_variant(turn_all, turn_volume, (struct features){.volume = 1});
    check_variant(turn_all, turn_shear, (struct features){.shear = 1});
    check_variant(turn_all, turn_twist, (struct features){.twist = 1});
    check_variant(turn_all, turn_damped, (struct features){.damped = 1});
}

static const struct features everything = {1, 1, 1, 1};

static struct link_cell uncycled(struct link_cell c, int axis)
{
    c.u = p3_uncycle(c.u, axis);
    c.theta = p3_uncycle(c.theta, axis);
    c.q.v = p3_uncycle(c.q.v, axis);
    c.v = v3_uncycle(c.v, axis);
    c.w = v3_uncycle(c.w, axis);
    return c;
}

static void axes_have_the_same_bits(void **state)
{
    variant_link *const law[2] = {small_all, turn_all};
    (void)state;
    for (int k = 0; k < TRIALS; k++) {
        struct variant_input in = any_link(everything), other = in;
        in.axis = 0;
        struct variant_output a = law[k % 2](&in);
        for (other.axis = 1; other.axis < 3; other.axis++) {
            other.lower = uncycled(in.lower, other.axis);
            other.upper = uncycled(in.upper, other.axis);
            struct variant_output b = law[k % 2](&other);
            assert_same(v3_uncycle(a.lower.force, other.axis), b.lower.force);
            assert_same(v3_uncycle(a.lower.torque, other.axis), b.lower.torque);
            assert_same(v3_uncycle(a.upper.torque, other.axis), b.upper.torque);
        }
    }
}

static double size(vec3 a)
{
    return sqrt((double)v3_dot(a, a));
}

static void momenta(void **state)
{
    variant_link *const law[2] = {small_all, turn_all};
    double worst = 0;
    (void)state;
    for (int k = 0; k < TRIALS; k++) {
        struct variant_input in = any_link(everything);
        struct variant_output a = law[k % 2](&in);
        vec3 D = v3_scale(in.k.h, v3_uncycle(v3(1, 0, 0), in.axis)), sum;
        if (k % 2) D = v3_add(D, v3_of_p3(p3_sub(in.upper.u, in.lower.u)));
        assert_same(a.lower.force, v3_neg(a.upper.force));
        sum = v3_sub(v3_add(a.lower.torque, a.upper.torque), v3_cross(D, a.lower.force));
        worst = fmax(worst, size(sum) / (size(a.lower.force) + size(a.lower.torque)));
    }
    printf("moment of a pair over its forces: %.2g\n", worst);
    assert_below(worst, 30 * EPS);
}

/* Half a turn about axis b: i and j change places. */
static pvec3 half_turn(pvec3 a, int axis)
{
    pvec3 s = p3_uncycle(p3(-1, 1, -1), axis);
    return p3(s.x * a.x, s.y * a.y, s.z * a.z);
}

static struct link_cell turned(struct link_cell c, int axis)
{
    c.u = half_turn(c.u, axis);
    c.theta = half_turn(c.theta, axis);
    c.q.v = half_turn(c.q.v, axis);
    c.v = v3_of_p3(half_turn(p3_of_v3(c.v), axis));
    c.w = v3_of_p3(half_turn(p3_of_v3(c.w), axis));
    return c;
}

static void other_end(void **state)
{
    variant_link *const law[2] = {small_all, turn_all};
    (void)state;
    for (int k = 0; k < TRIALS; k++) {
        struct variant_input in = any_link(everything), back = in;
        back.lower = turned(in.upper, in.axis);
        back.upper = turned(in.lower, in.axis);
        back.k.r_i = in.k.r_j;
        back.k.r_j = in.k.r_i;
        back.p_i = in.p_j;
        back.p_j = in.p_i;
        struct variant_output a = law[k % 2](&in), b = law[k % 2](&back);
        vec3 f = v3_of_p3(half_turn(p3_of_v3(b.upper.force), in.axis)),
             t = v3_of_p3(half_turn(p3_of_v3(b.upper.torque), in.axis));
        assert_below(size(v3_sub(f, a.lower.force)), 30 * EPS);
        assert_below(size(v3_sub(t, a.lower.torque)), 30 * EPS);
    }
}

/* Strain of a rigid turn: what a displacement form leaves of it, over the angle, is some units in
 * the last place. */
static void a_rigid_turn_leaves_no_strain(void **state)
{
    (void)state;
    for (int k = 0; k < 1000; k++) {
        double angle = pow(10, uniform(-9, 0));
        struct variant_input in = any_link((struct features){0});
        vec3 n = any3(1);
        struct quat q = quat_of(1, 0, 0, 0);
        pvec3 r = p3_scale((preal)(0.125 * angle / size(n)), p3_of_v3(n));
        for (int step = 0; step < 8; step++) q = quat_turn(q, r);
        in.lower.u = p3(0, 0, 0);
        in.upper.u = p3_scale((preal)in.k.h, quat_column(q, in.axis));
        in.lower.q = in.upper.q = q;
        struct variant_output a = turn_bare(&in);
        assert_below(size(a.lower.force), 4 * EPS * angle);
        assert_below(size(a.lower.torque), 4 * EPS * angle);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(unused_features_leave_the_bits),
        cmocka_unit_test(axes_have_the_same_bits), cmocka_unit_test(momenta),
        cmocka_unit_test(other_end), cmocka_unit_test(a_rigid_turn_leaves_no_strain)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
