/* The digest against the two elements worked out in advance, and what it must and must not
 * notice. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "results/digest.h"

static const int64_t gid[2] = {0, 1};
static const double x[2][3] = {{0, 0, 0}, {0.005, 0, -0.0}}, v[2][3] = {{1, -0.5, 0.25}, {0, 0, 0}};
static const double q[2][4] = {{1, 0, 0, 0}, {1, 0, 0, 0}}, w[2][3] = {{0, 0, 2}, {0, 0, 0}};
static const struct digest_part parts[4] = {{x, 0, 3, 3}, {v, 0, 3, 3}, {q, 0, 4, 4}, {w, 0, 3, 3}};

static void test_known_elements(void **state)
{
    (void)state;
    int64_t n_nan = 0;
    char text[17];
    assert_string_equal(
        digest_text(digest_of_rank(gid, 1, parts, 4, &n_nan), text), "824760a75253a07e");
    assert_string_equal(
        digest_text(digest_of_rank(gid, 2, parts, 4, &n_nan), text), "b5232e7dedb2aacc");
    const struct digest_part second[4] = {
        {x[1], 0, 3, 3}, {v[1], 0, 3, 3}, {q[1], 0, 4, 4}, {w[1], 0, 3, 3}};
    assert_string_equal(
        digest_text(digest_of_rank(gid + 1, 1, second, 4, &n_nan), text), "32dbcdd69b5f0a4e");
    assert_int_equal(n_nan, 0);
    assert_string_equal(
        digest_text(digest_of_rank(gid, 0, parts, 4, &n_nan), text), "0000000000000000");
}

/* Separate arrays, padded vectors, vectors stored x, y, z, w: the same words in the same order are
 * the same digest. */
static void test_layout_does_not_matter(void **state)
{
    (void)state;
    double padded[2][4] = {{0, 0, 0, 9}, {0.005, 0, -0.0, 9}}, vx[2] = {1, 0}, vy[2] = {-0.5, 0},
           vz[2] = {0.25, 0};
    double xyzw[2][4] = {{0, 0, 0, 1}, {0, 0, 0, 1}};
    const struct digest_part other[7] = {{padded, 0, 3, 4}, {vx, 0, 1, 1}, {vy, 0, 1, 1},
        {vz, 0, 1, 1}, {&xyzw[0][3], 0, 1, 4}, {xyzw, 0, 3, 4}, {w, 0, 3, 3}};
    int64_t n_nan = 0;
    assert_true(
        digest_of_rank(gid, 2, other, 7, &n_nan) == digest_of_rank(gid, 2, parts, 4, &n_nan));
}

static void test_order_of_storage_does_not_matter(void **state)
{
    (void)state;
    const int64_t swapped_gid[2] = {1, 0};
    double swapped[4][2][4];
    const double *const from[4] = {&x[0][0], &v[0][0], &q[0][0], &w[0][0]};
    struct digest_part part[4];
    for (int p = 0; p < 4; p++) {
        int width = parts[p].width;
        for (int i = 0; i < 2; i++)
            memcpy(swapped[p][1 - i], from[p] + i * width, (size_t)width * sizeof(double));
        part[p] = (struct digest_part){swapped[p], 0, width, 4};
    }
    int64_t n_nan = 0;
    assert_true(digest_of_rank(swapped_gid, 2, part, 4, &n_nan) ==
                digest_of_rank(gid, 2, parts, 4, &n_nan));
    part[0].data = x; /* the positions of the two exchanged */
    part[0].stride = 3;
    assert_true(digest_of_rank(swapped_gid, 2, part, 4, &n_nan) !=
                digest_of_rank(gid, 2, parts, 4, &n_nan));
}

/* Floats by their own 32 bits: not the digest of the same values as doubles. */
static void test_floats(void **state)
{
    (void)state;
    const float one = 1.0f;
    const double wide = 1.0;
    const struct digest_part part = {&one, 1, 1, 1}, wide_part = {&wide, 0, 1, 1};
    int64_t n_nan = 0;
    uint64_t expected = digest_mix((digest_mix(5 + DIGEST_G) ^ UINT64_C(0x3f800000)) + DIGEST_G);
    const int64_t five = 5;
    assert_true(digest_of_rank(&five, 1, &part, 1, &n_nan) == expected);
    assert_true(digest_of_rank(&five, 1, &wide_part, 1, &n_nan) != expected);
}

static void test_nan_is_counted_once_per_element(void **state)
{
    (void)state;
    const double nan = (double)__builtin_nanf("");
    const double a[3][2] = {{nan, nan}, {0, 1}, {1, nan}};
    const float b[3] = {0, __builtin_nanf(""), 0};
    const int64_t ids[3] = {0, 1, 2};
    const struct digest_part part[2] = {{a, 0, 2, 2}, {b, 1, 1, 1}};
    int64_t n_nan = 0;
    digest_of_rank(ids, 3, part, 1, &n_nan);
    assert_int_equal(n_nan, 2);
    n_nan = 0;
    digest_of_rank(ids, 3, part, 2, &n_nan);
    assert_int_equal(n_nan, 3);
}

/* -0 and +0 move alike, but are other bits: the digest sees the last bit of everything. */
static void test_every_bit_counts(void **state)
{
    (void)state;
    int64_t n_nan = 0;
    double other[2][3];
    uint64_t expected = digest_of_rank(gid, 2, parts, 4, &n_nan);
    for (int bit = 0; bit < 64; bit++) {
        uint64_t word;
        memcpy(other, x, sizeof x);
        memcpy(&word, &other[1][2], sizeof word);
        word ^= UINT64_C(1) << bit;
        memcpy(&other[1][2], &word, sizeof word);
        const struct digest_part part[4] = {{other, 0, 3, 3}, parts[1], parts[2], parts[3]};
        assert_true(digest_of_rank(gid, 2, part, 4, &n_nan) != expected);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_known_elements),
        cmocka_unit_test(test_layout_does_not_matter),
        cmocka_unit_test(test_order_of_storage_does_not_matter),
        cmocka_unit_test(test_floats),
        cmocka_unit_test(test_nan_is_counted_once_per_element),
        cmocka_unit_test(test_every_bit_counts),
    };
    return cmocka_run_group_tests_name("digest", tests, NULL, NULL);
}
