/* The largest eigenvalue without trigonometry: never below, hardly above, whatever the
 * multiplicity; and the fifth root. */
#include "limit_test.h"

#include "jacobi.h"
#include "kernels/contact/law_limit.h"

#if REAL_IS_FLOAT
#define EPS 2e-4
#define REST 0.024 /* 3 LIMIT_NOISE^(1/3), see law_limit.h */
#else
#define EPS 1e-7
#define REST 3e-4
#endif

/* Sum of n random contacts of orders of magnitude between 1 and 10^-spread. */
static struct limit_matrix random_matrix(int n, double spread, double scale)
{
    struct limit_matrix a = limit_matrix_zero();
    for (int k = 0; k < n; k++) {
        double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1),
               r = sqrt(x * x + y * y + z * z), f = scale * pow(10, -uniform(0, spread));
        a = limit_matrix_add(a, (real)f, (real)(k % 3 ? 0 : 0.7 * f),
            v3((real)(x / r), (real)(y / r), (real)(z / r)));
    }
    return a;
}

static double truth(struct limit_matrix a)
{
    double m[9] = {(double)a.xx, (double)a.xy, (double)a.xz, (double)a.xy, (double)a.yy,
        (double)a.yz, (double)a.xz, (double)a.yz, (double)a.zz};
    double smallest, largest;
    jacobi(m, 3, &smallest, &largest);
    return largest;
}

static void random_matrices(void **state)
{
    (void)state;
    for (int k = 0; k < 20000; k++) {
        struct limit_matrix a = random_matrix(1 + k % 12, k % 5, pow(10, uniform(-6, 14)));
        double ratio = (double)limit_largest(a, LIMIT_STEPS) / truth(a);
        assert_between(ratio, 1 - EPS, 1 + REST);
        assert_between((double)limit_largest(a, 0) / truth(a), 1 - EPS, pow(3, 0.125) + EPS);
    }
}

static void special_matrices(void **state)
{
    (void)state;
    const double diagonal[][3] = {{1, 1, 1}, {1, 1, 0}, {1, 0, 0}, {1, 1, 0.5}, {1, 0.999, 0.998},
        {3, 2, 1}, {1, 1e-6, 1e-6}};
    for (size_t k = 0; k < sizeof diagonal / sizeof *diagonal; k++) {
        struct limit_matrix a = limit_matrix_zero();
        a.xx = (real)diagonal[k][2];
        a.yy = (real)diagonal[k][0];
        a.zz = (real)diagonal[k][1];
        assert_between(
            limit_largest(a, LIMIT_STEPS), diagonal[k][0] * (1 - EPS), diagonal[k][0] * (1 + REST));
    }
    assert_true((double)limit_largest(limit_matrix_zero(), LIMIT_STEPS) <= 0);
    assert_true((double)limit_of_sums(limit_sums_zero(), 0) > 0.99e30);
}

static void fifth_root(void **state)
{
    (void)state;
    for (int k = 0; k < 2000; k++) {
        double y = pow(10, uniform(-6.5, 3)), q = y * y * y * y * y;
        assert_between((double)normal_fifth_root((real)q) / y, 1 - EPS, 1 + 1e-3);
    }
    assert_true((double)normal_fifth_root(0) <= 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(random_matrices),
        cmocka_unit_test(special_matrices), cmocka_unit_test(fifth_root)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
