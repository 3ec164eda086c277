/* Rows of stress to a tensor: one-sided axes, frames, von Mises. The patch test has the rest. */
#include "kernels/lattice/law_stress.h"
#include "tests/limit/limit_test.h"

static vec3 any3(void)
{
    double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
    return v3((real)x, (real)y, (real)z);
}

static void rows(void **state)
{
    const vec3 plus = v3(2, 4, 6), minus = v3(-2, -4, -6), none = v3(0, 0, 0);
    const int both = 3, lower = 1, upper = 2;
    (void)state;
    assert_true(stress_row(plus, minus, 0, both, 0, 1).y == 4 &&
                stress_row(plus, minus, 0, both, 1, 1).y == 4);
    assert_true(stress_row(plus, none, 0, upper, 0, 1).y == 2 &&
                stress_row(plus, none, 0, upper, 1, 1).y == 4);
    assert_true(stress_row(none, minus, 0, lower, 0, 1).z == 3 &&
                stress_row(none, minus, 0, lower, 1, 1).z == 6);
    assert_true(stress_row(plus, none, 1, upper << 2, 1, 0.25).x == 0.5 &&
                stress_row(plus, none, 2, upper << 4, 1, 0.25).x == 0.5);
}

/* An axis without faces takes the shear of the other axis whole. */
static void one_layer(void **state)
{
    struct stress_rows r = {v3(1, 2, 3), v3(4, 5, 6), v3(0, 0, 0)}; /* nothing along z */
    struct stress s = stress_parts(r, 0x0f), full = stress_parts(r, 0x1f);
    (void)state;
    assert_true(s.xx == 1 && s.yy == 5 && s.zz == 0 && s.xy == 3 && s.zx == 3 && s.yz == 6);
    assert_true(s.skew.x == 0 && s.skew.y == 0 && s.skew.z == -1);
    assert_true(
        full.zx == (real)1.5 && full.yz == 3 && full.skew.x == 3 && full.skew.y == (real)-1.5);
}

static void von_mises(void **state)
{
    struct stress tension = {.xx = -3}, shear = {.yz = 2}, pressure = {.xx = 5, .yy = 5, .zz = 5};
    (void)state;
    assert_near(stress_von_mises(tension), 3, 1e-15);
    assert_near(stress_von_mises(shear), 2 * sqrt(3), 1e-15);
    assert_near(stress_von_mises(pressure), 0, 1e-15);
    for (int k = 0; k < 1000; k++) { /* the same in any frame, and the way back */
        vec3 a = any3(), b = any3();
        struct quat q = quat_turn(quat_of(0.5, 0.1, -0.7, 0.5), p3_scale(0.1, p3_of_v3(any3())));
        struct stress s = {a.x, a.y, a.z, b.x, b.y, b.z, {0, 0, 0}};
        struct stress_rows there = stress_in_world(stress_symmetric(s), q);
        struct stress t = stress_parts(there, 63);
        assert_near(stress_von_mises(t), stress_von_mises(s), 1e-14);
        assert_near(t.xx + t.yy + t.zz, s.xx + s.yy + s.zz, 1e-14);
        assert_near(v3_dot(t.skew, t.skew), 0, 1e-28);
        /* Q^T S Q by rows: what cells report of a uniform stress after they turned */
        struct stress_rows turned = {v3_of_p3(quat_unrotate(q, p3_of_v3(there.x))),
            v3_of_p3(quat_unrotate(q, p3_of_v3(there.y))),
            v3_of_p3(quat_unrotate(q, p3_of_v3(there.z)))};
        struct stress_rows same = stress_in_cell(there, q);
        assert_memory_equal(&turned, &same, sizeof same);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows), cmocka_unit_test(one_layer), cmocka_unit_test(von_mises)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
