/* Integer sums: exact down to 2^-80, the same in any order, and honest about what does not fit. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "../mpi_check.h"
#include "kernels/common/sums.h"

/* All of a sum in units of 2^-80. */
static __int128 whole(struct sum s)
{
    return ((__int128)s.hi << 60) + ((__int128)s.mid << 30) + s.lo;
}

static double random_term(uint64_t key)
{
    uint64_t r = mpi_check_random(key);
    double mantissa = (double)(r >> 11) * 0x1p-53 + 0.5;
    return ldexp(r & 1 ? mantissa : -mantissa, (int)(r >> 1 & 63) - 32);
}

/* x is a multiple of 2^-80 or rounds to one: compared with x 2^80, computed by shifts of its
 * mantissa. */
static __int128 exact(double x)
{
    int exponent;
    __int128 mantissa = (__int128)ldexp(frexp(x, &exponent), 53);
    int shift = exponent - 53 + 80;
    if (shift >= 0) return mantissa * ((__int128)1 << shift);
    if (shift < -60) return 0; /* far below */
    __int128 half = (__int128)1 << (-shift - 1), magnitude = mantissa < 0 ? -mantissa : mantissa;
    __int128 floor = magnitude >> -shift, rest = magnitude - (floor << -shift);
    if (rest > half || (rest == half && (floor & 1))) floor++;
    return mantissa < 0 ? -floor : floor;
}

static void terms_are_exact(void **state)
{
    static const double edge[] = {0, -0.0, 1, -1, 0x1p-80, -0x1p-80, 0x1p-81, 0x1.8p-80, -0x1.8p-80,
        0x1p-200, 0x1.fffffffffffffp32, -0x1.fffffffffffffp32, 0x1p-20, -0x1p-20,
        0x1.fffffffffffffp-21, 0x1p-50, -0x1.fffffffffffffp-51, 5e-324};
    (void)state;
    for (size_t i = 0; i < 20000 + sizeof edge / sizeof *edge; i++) {
        double x = i < sizeof edge / sizeof *edge ? edge[i] : random_term(i);
        struct sum s = {0};
        sums_add(&s, x);
        assert_true(whole(s) == exact(x));
        assert_int_equal(s.bad, 0);
        assert_true(llabs(s.mid) < (1 << 30) && llabs(s.lo) <= (1 << 30));
    }
}

static void order_does_not_matter(void **state)
{
    enum { N = 3000 };
    __int128 expected = 0;
    double term[2 * N + 1];
    (void)state;
    for (size_t i = 0; i < N; i++) {
        term[i] = random_term(i + 77);
        term[2 * N - i] = -term[i]; /* cancels, thousands of terms away */
    }
    term[N] = 0x1.4p-70;
    expected = exact(term[N]);
    for (int turn = 0; turn < 3; turn++) {
        struct sum s = {0};
        for (size_t i = 2 * N; i > 0 && turn > 0; i--) {
            size_t j = mpi_check_random(i + 10000 * (uint64_t)turn) % (i + 1);
            double t = term[i];
            term[i] = term[j];
            term[j] = t;
        }
        for (size_t i = 0; i <= 2 * N; i++) sums_add(&s, term[i]);
        assert_true(whole(s) == expected);
    }
}

static void what_does_not_fit_is_counted(void **state)
{
    static const double bad[] = {NAN, INFINITY, -INFINITY, 0x1p33, -0x1p33, 1e300};
    struct sum s = {0};
    (void)state;
    sums_add(&s, 3);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        sums_add(&s, bad[i]);
        assert_int_equal(s.bad, i + 1);
        assert_true(whole(s) == exact(3));
    }
}

/* A ball of m = 2, r = 0.5 (I = 0.2) at (1, 2, 3) with v = (1, 0, -2), w = (0, 4, 0); by hand. */
static void one_element(void **state)
{
    const double g[3] = {0, 1, -10}, origin[3] = {1, 1, 1};
    const double expected[SUMS_ELEMENT] = {
        5, 1.6, -2 * (1 - 20), 2, 0, -4, -8, 2 * (3 * 1 - 1 * -2) + 0.8, -4};
    struct sums_element e = {{1, 2, 3}, {1, 0, -2}, {0, 4, 0}, 0.5, 2};
    double term[SUMS_ELEMENT];
    (void)state;
    sums_element(e, g, origin, term);
    for (int k = 0; k < SUMS_ELEMENT; k++) assert_true(fabs(term[k] - expected[k]) < 1e-14);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(terms_are_exact),
        cmocka_unit_test(order_does_not_matter), cmocka_unit_test(what_does_not_fit_is_counted),
        cmocka_unit_test(one_element)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
