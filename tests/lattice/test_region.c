/* A column through a surface gives what each of its points gives alone: tetrahedra, nested and
 * turned, at random heights and at those of corners. */
#include "../walls/scratch.h"

#include "shape/region.h"

static void tetrahedron(uint64_t *state, double size, double *corner)
{
    static const int face[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    double p[4][3], turn[9];
    scratch_rotation(state, turn);
    for (int k = 0; k < 4; k++) {
        double q[3] = {size * (k == 1), size * (k == 2), size * (k == 3)};
        scratch_turn(turn, q, p[k]);
    }
    for (int k = 0; k < 4; k++)
        for (int n = 0; n < 3; n++) memcpy(corner + 9 * k + 3 * n, p[face[k][n]], sizeof p[0]);
}

static int by_size(const void *a, const void *b)
{
    const double *x = a, *y = b;
    return *x < *y ? -1 : *x > *y;
}

static void column_is_its_points(void **unused)
{
    (void)unused;
    uint64_t state = 7;
    int n_inside = 0;
    for (int k = 0; k < 20; k++) {
        double corner[8 * 9], z[64];
        tetrahedron(&state, 1, corner);
        tetrahedron(&state, 0.7, corner + 4 * 9);
        char *path = scratch_stl(corner, 8);
        struct region region = {.kind = REGION_STL, .stl = path, .scale = 1};
        struct region_shape shape;
        assert_null(region_open(&shape, &region));
        for (int line = 0; line < 50; line++) {
            uint8_t holds[64];
            double x[3] = {scratch_random(&state, -0.6, 0.6), scratch_random(&state, -0.6, 0.6), 0};
            if (line == 0) x[0] = x[1] = 0; /* through a corner of both */
            for (int n = 0; n < 64; n++)
                z[n] =
                    n < 24 ? corner[9 * (n % 8) + 3 * (n / 8) + 2] : scratch_random(&state, -1, 1);
            qsort(z, 64, sizeof *z, by_size);
            region_column(&shape, x[0], x[1], z, 64, 0, holds);
            for (int n = 0; n < 64; n++) {
                x[2] = z[n];
                assert_int_equal(holds[n], region_holds(&shape, x, 0));
                n_inside += holds[n];
            }
        }
        region_close(&shape);
        scratch_remove(path);
    }
    assert_true(n_inside > 1000);
}

/* An inset takes a layer off, a negative one adds one. */
static void insets(void **unused)
{
    (void)unused;
    const struct region region[] = {{.kind = REGION_BOX, .max = {2, 2, 2}},
        {.kind = REGION_SPHERE, .center = {1, 1, 1}, .radius = 1},
        {.kind = REGION_CYLINDER, .from = {1, 0, 1}, .to = {1, 2, 1}, .radius = 1}};
    for (int k = 0; k < 3; k++) {
        struct region_shape shape;
        assert_null(region_open(&shape, &region[k]));
        for (int a = 0; a < 3; a++) {
            double x[3] = {1, 1, 1};
            assert_true(fabs(shape.low[a]) < 1e-15 && fabs(shape.high[a] - 2) < 1e-15);
            x[a] = 1.9;
            assert_true(region_holds(&shape, x, 0) && region_holds(&shape, x, 0.09) &&
                        !region_holds(&shape, x, 0.11));
            x[a] = -0.1;
            assert_true(!region_holds(&shape, x, 0) && !region_holds(&shape, x, -0.09) &&
                        region_holds(&shape, x, -0.11));
        }
        region_close(&shape);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(column_is_its_points), cmocka_unit_test(insets)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
