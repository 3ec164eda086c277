/* The largest principal stress of a cell: when it fails, and which link then breaks. */
#include "kernels/lattice/lattice_through.h"
#include "tests/limit/limit_test.h"

static struct quat any_turn(void)
{
    struct quat q = quat_of(1, 0, 0, 0);
    for (int k = 0; k < 4; k++) {
        double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
        q = quat_turn(q, p3((preal)x, (preal)y, (preal)z));
    }
    return q;
}

/* Principal values first > second, third along the axes of q; the first axis. */
static struct stress stress_with(double first, double second, double third, struct quat q, vec3 *d)
{
    struct stress_rows rows = {
        v3((real)first, 0, 0), v3(0, (real)second, 0), v3(0, 0, (real)third)};
    *d = v3_of_p3(quat_rotate(q, p3(1, 0, 0)));
    return stress_parts(stress_in_world(rows, q), 63);
}

/* In any direction, whatever the others are: also large pressures. */
static void fails(void **state)
{
    (void)state;
    for (int k = 0; k < 3000; k++) {
        double limit = exp(uniform(-3, 20)), second = limit * uniform(-3, 0.99),
               third = limit * uniform(-3, 0.99);
        struct quat q = any_turn();
        vec3 d;
        assert_true(principal_fails(
            stress_with(limit * (1 + 1e-10), second, third, q, &d), (real)(1 / limit)));
        assert_false(principal_fails(
            stress_with(limit * (1 - 1e-10), second, third, q, &d), (real)(1 / limit)));
        assert_true(
            principal_fails(stress_with(limit * 2, limit * 1.5, third, q, &d), (real)(1 / limit)));
        assert_true(principal_fails(
            stress_with(limit * 3, limit * 2, limit * 1.5, q, &d), (real)(1 / limit)));
        assert_false(principal_fails(stress_with(limit, second, third, q, &d), 0));
    }
}

/* Pure shear fails where the shear stress is the limit: to the bit. */
static void shear(void **state)
{
    const double next = nextafter(8, 9);
    (void)state;
    assert_true(principal_fails((struct stress){.xy = 8}, (real)0.125));
    assert_true(principal_fails((struct stress){.zx = -8}, (real)0.125));
    assert_false(principal_fails((struct stress){.yz = 8}, (real)(1 / next)));
}

static void direction(void **state)
{
    (void)state;
    for (int k = 0; k < 3000; k++) {
        double size = exp(uniform(-3, 20));
        struct quat q = any_turn();
        vec3 d, found = principal_direction(
                    stress_with(size, size * uniform(-3, 0.98), size * uniform(-3, 0.98), q, &d));
        double along = (double)v3_dot(found, d), all = (double)v3_dot(found, found);
        assert_true(fabs(along * along / all - 1) < 1e-12);
    }
}

/* The strength rises by rise q^2: q is 0 along the grid, 1/2 across {110}, 2/3 across {111}, and
 * does not change as axes change places. */
static void rises(void **state)
{
    static const double axis[][4] = {
        {1, 0, 0, 0}, {0, 0, 1, 0}, {0, 1, 1, 0.25}, {1, 0, -1, 0.25}, {1, -1, 1, 4. / 9}};
    (void)state;
    for (int k = 0; k < 5; k++)
        for (int j = 0; j < 100; j++) {
            double rise = uniform(0.01, 2), limit = 1 + rise * axis[k][3];
            vec3 n = v3((real)axis[k][0], (real)axis[k][1], (real)axis[k][2]), d;
            double size = (double)v3_dot(n, n);
            vec3 r = v3_scale((real)(1 / size), n);
            struct stress s = {.xx = r.x * n.x,
                .yy = r.y * n.y,
                .zz = r.z * n.z,
                .yz = r.y * n.z,
                .zx = r.z * n.x,
                .xy = r.x * n.y};
            d = v3_scale((real)uniform(0.1, 10), n);
            assert_true(principal_runs(s, d, (real)(limit * (1 + 1e-12)), (real)rise));
            assert_false(principal_runs(s, d, (real)(limit * (1 - 1e-12)), (real)rise));
            assert_true(principal_runs(s, d, 0, 0));
        }
}

/* A strength that rises holds the link. */
static void holds(void **state)
{
    struct link_cell c = {.q = quat_of(1, 0, 0, 0)};
    struct stress_rows r = {v3(1, 1, 0), v3(1, 1, 0), v3(0, 0, 0)};
    struct lattice_through f = {
        {v3_scale(-1, r.x), r.x}, {v3_scale(-1, r.y), r.y}, {v3_scale(-1, r.z), r.z}};
    struct stress s = stress_parts(r, 63);
    (void)state;
    assert_int_equal(lattice_principal(f, s, c, 63, (real)0.52, (real)0.1, -1), 1);
    assert_int_equal(lattice_principal(f, s, c, 63, (real)0.51, (real)0.1, -1), 0);
}

/* In a uniform stress the link most normal to the crack, the first of two that are equal, and one
 * that exists. */
static void link(void **state)
{
    (void)state;
    for (int k = 0; k < 3000; k++) {
        struct quat q = any_turn();
        vec3 d;
        struct stress s = stress_with(2, uniform(-3, 1), uniform(-3, 1), q, &d);
        struct stress_rows r = stress_symmetric(s);
        struct link_cell c = {.q = quat_of(1, 0, 0, 0)};
        struct lattice_through f = {
            {v3_scale(-1, r.x), r.x}, {v3_scale(-1, r.y), r.y}, {v3_scale(-1, r.z), r.z}};
        double part[3] = {fabs((double)d.x), fabs((double)d.y), fabs((double)d.z)};
        int found = lattice_principal(f, s, c, 63, 1, 0, -1),
            upper = lattice_principal(f, s, c, 42, 1, 0, -1),
            axis = part[0] > part[1] ? (part[0] > part[2] ? 0 : 2) : (part[1] > part[2] ? 1 : 2);
        assert_true((found == 1 << (2 * axis)) || found == 2 << (2 * axis));
        assert_int_equal(upper, 2 << (2 * axis));
        assert_int_equal(lattice_principal(f, s, c, 0, 1, 0, -1), 0);
    }
}

/* In a uniform stress lots that fill [0, 1) evenly give each axis as many links as |d| has of it,
 * over the sum of the three, half of them on either side. */
static void drawn(void **state)
{
    (void)state;
    for (int k = 0; k < 100; k++) {
        const int n = 2000;
        struct quat q = any_turn();
        vec3 d;
        struct stress s = stress_with(2, 0, 0, q, &d);
        struct stress_rows r = stress_symmetric(s);
        struct link_cell c = {.q = quat_of(1, 0, 0, 0)};
        struct lattice_through f = {
            {v3_scale(-1, r.x), r.x}, {v3_scale(-1, r.y), r.y}, {v3_scale(-1, r.z), r.z}};
        double part[3] = {fabs((double)d.x), fabs((double)d.y), fabs((double)d.z)};
        int count[6] = {0};
        for (int i = 0; i < n; i++)
            for (int face = 0, link = lattice_principal(f, s, c, 63, 1, 0, (i + 0.5) / n); face < 6;
                 face++)
                count[face] += link >> face & 1;
        for (int face = 0; face < 6; face++)
            assert_true(
                fabs(count[face] - n * part[face / 2] / 2 / (part[0] + part[1] + part[2])) < 2);
        assert_int_equal(lattice_principal(f, s, c, 8, 1, 0, 0.999), 8);
        assert_int_equal(lattice_principal(f, s, c, 0, 1, 0, 0.5), 0);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(fails), cmocka_unit_test(shear),
        cmocka_unit_test(direction), cmocka_unit_test(rises), cmocka_unit_test(holds),
        cmocka_unit_test(link), cmocka_unit_test(drawn)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
