/* Cells, neighbour rows and pairs against brute force: equal and very unequal sizes, clusters, one
 * huge element, ghosts, periodic directions. Compiled once for each set of periodic directions and
 * each precision, see meson.build. */
#include "lists_fixture.h"

#include "comm/fail.h"
#include "kernels/particle/incidence.h"

static struct lists lists;
static uint64_t seed = 12;

static double uniform(double low, double high)
{
    return scratch_random(&seed, low, high);
}

/* Global ids in no order, with holes. */
static void set_gids(struct crowd *c)
{
    for (int e = 0; e < c->n_all; e++) c->gid[e] = ((int64_t)1 << 33) + 3 * e;
    for (int e = c->n_all - 1; e > 0; e--) {
        int other = (int)uniform(0, e + 1);
        int64_t swap = c->gid[e];
        c->gid[e] = c->gid[other];
        c->gid[other] = swap;
    }
}

/* Positions within `box` about the middle of the unit cube, reaches from small to large (equal: all
 * alike). */
static struct crowd make(int n_owned, int n_all, double box, double small, double large)
{
    struct crowd c = crowd_create(n_owned, n_all);
    for (int e = 0; e < n_all; e++) {
        double reach = large > small ? small * pow(large / small, uniform(0, 1)) : small;
        for (int a = 0; a < 3; a++) c.element[e].x[a] = (preal)(0.5 + box * uniform(-0.5, 0.5));
        c.element[e].radius = (preal)(0.9 * reach);
        c.reach[e] = (preal)reach;
    }
    set_gids(&c);
    return c;
}

/* Every element is in exactly one cell, that of its level and place. */
static void check_cells(const struct crowd *c)
{
    int64_t n_cell = lists.cells->n_cell;
    int *begin = lists_ints(&lists.cells->begin, n_cell + 1),
        *member = lists_ints(&lists.cells->member, c->n_all);
    int *key = lists_ints(&lists.cells->key, c->n_all),
        *seen = fail_alloc((size_t)c->n_all * sizeof *seen);
    assert_int_equal(begin[0], 0);
    assert_int_equal(begin[n_cell], c->n_all);
    for (int64_t cell = 0; cell < n_cell; cell++)
        for (int m = begin[cell]; m < begin[cell + 1]; m++) {
            assert_in_range(member[m], 0, c->n_all - 1);
            assert_int_equal(key[member[m]], cell);
            assert_int_equal(seen[member[m]]++, 0);
        }
    free(begin);
    free(member);
    free(key);
    free(seen);
}

/* Exactly the neighbours, ascending in gid; a pair of two ghosts is nobody's here. Returns how many
 * entries there are. */
static int64_t check_rows(const struct crowd *c)
{
    const struct pair_list *l = &lists.pairs->now;
    int *begin = lists_ints(&l->row_begin, c->n_all + 1), *row = lists_ints(&l->row, l->n_row);
    int64_t *gid = fail_alloc((size_t)l->n_row * sizeof *gid);
    char *is_in = fail_alloc((size_t)c->n_all);
    buffer_read(&l->row_gid, 0, (size_t)l->n_row * sizeof *gid, gid);
    assert_int_equal(begin[c->n_all], l->n_row);
    for (int e = 0; e < c->n_all; e++) {
        memset(is_in, 0, (size_t)c->n_all);
        for (int k = begin[e]; k < begin[e + 1]; k++) {
            assert_in_range(row[k], 0, c->n_all - 1);
            assert_int_equal(is_in[row[k]]++, 0);
            assert_true(gid[k] == c->gid[row[k]] && (k == begin[e] || gid[k - 1] < gid[k]));
        }
        for (int b = 0; b < c->n_all; b++) {
            bool wanted = b != e && (e < c->n_owned || b < c->n_owned) && crowd_meet(c, e, b);
            if (is_in[b] != wanted)
                fail_msg("row of %d: %d is %sthere", e, b, is_in[b] ? "" : "not ");
        }
    }
    int64_t n = l->n_row;
    free(begin);
    free(row);
    free(gid);
    free(is_in);
    return n;
}

/* Pairs p of the list, lower gid first, ascending by the lower's storage and the partner's gid;
 * each once; interior ones have no ghost and boundary ones begin at a multiple of 64. */
static void check_pairs(const struct crowd *c, int64_t n_row)
{
    const struct pair_list *l = &lists.pairs->now;
    int64_t end = l->first_boundary + l->n_boundary;
    int *i = lists_ints(&l->pair_i, end), *j = lists_ints(&l->pair_j, end);
    int *up = lists_ints(&l->up_begin, c->n_all);
    int64_t n = 0;
    assert_int_equal(2 * (l->n_interior + l->n_boundary), n_row);
    assert_true(l->first_boundary % 64 == 0 && l->first_boundary >= l->n_interior &&
                l->first_boundary < l->n_interior + 64 && l->capacity >= end);
    for (int e = 0; e < c->n_all; e++) {
        bool interior = up[e] < l->first_boundary, has_ghost = e >= c->n_owned;
        int p = up[e];
        for (; p < (interior ? l->n_interior : end) && i[p] == e; p++, n++) {
            assert_true(c->gid[i[p]] < c->gid[j[p]] && crowd_meet(c, i[p], j[p]) &&
                        (e < c->n_owned || j[p] < c->n_owned));
            assert_true(p == up[e] || c->gid[j[p - 1]] < c->gid[j[p]]);
            has_ghost |= j[p] >= c->n_owned;
        }
        assert_true(p == up[e] || interior == !has_ghost);
    }
    assert_int_equal(n, l->n_interior + l->n_boundary); /* with n_row: each once */
    free(i);
    free(j);
    free(up);
}

/* The record of the blank pair is zero. */
static void check_blank(int64_t pair)
{
    size_t bytes = (size_t)lists.pairs->layout.result * sizeof(real);
    unsigned char *record = fail_alloc(bytes);
    memset(record, 0x5a, bytes);
    buffer_read(&lists.pairs->result, (size_t)pair * bytes, bytes, record);
    for (size_t k = 0; k < bytes; k++) assert_int_equal(record[k], 0);
    free(record);
}

/* The gather's row of an element: its pairs, all of them, ascending by the gid of the partner, then
 * blanks. */
static void check_links(const struct crowd *c)
{
    const struct pair_list *l = &lists.pairs->now;
    int64_t end = l->first_boundary + l->n_boundary;
    int *i = lists_ints(&l->pair_i, end), *j = lists_ints(&l->pair_j, end);
    int *begin = lists_ints(&l->incidence_begin, c->n_owned + 1),
        *incidence = lists_ints(&l->incidence, l->n_incidence);
    assert_int_equal(begin[c->n_owned], l->n_incidence);
    for (int e = 0; e < c->n_owned; e++) {
        int n = 0, n_padded = begin[e + 1] - begin[e];
        int64_t before = -1;
        for (int b = 0; b < c->n_all; b++) n += b != e && crowd_meet(c, e, b);
        assert_true(
            n_padded % INCIDENCE_ALIGN == 0 && n_padded >= n && n_padded < n + INCIDENCE_ALIGN);
        for (int k = 0; k < n_padded; k++) {
            int pair = incidence[begin[e] + k] / 2, is_down = incidence[begin[e] + k] % 2;
            if (k >= n) {
                assert_int_equal(incidence[begin[e] + k], 2 * (l->capacity - 1));
                continue;
            }
            assert_in_range(pair, 0, end - 1);
            int partner = is_down ? i[pair] : j[pair];
            assert_true((is_down ? j[pair] : i[pair]) == e && c->gid[partner] > before);
            before = c->gid[partner];
        }
    }
    check_blank(l->capacity - 1);
    free(i);
    free(j);
    free(begin);
    free(incidence);
}

static void check(struct crowd c, int64_t least)
{
    lists_build(&lists, &c);
    check_cells(&c);
    int64_t n_row = check_rows(&c);
    assert_true(n_row >= least);
    struct pair_list wrong = lists.pairs->now;
    assert_true(pairs_is_valid(&wrong));
    wrong.capacity = wrong.first_boundary + wrong.n_boundary; /* no room for the blank pair */
    assert_false(pairs_is_valid(&wrong));
    check_pairs(&c, n_row);
    check_links(&c);
    crowd_free(&c);
}

static void equal_sizes(void **state)
{
    (void)state;
    check(make(1000, 1000, 1, 0.04, 0.04), 1000);
    check(make(1500, 2000, 0.98, 0.03, 0.03), 1000);
}

static void one_to_twenty(void **state)
{
    (void)state;
    check(make(1500, 2000, 1, 0.005, 0.1), 2000);
}

/* All within a tenth of a reach: rows of hundreds, which are sorted by heap. */
static void a_point_like_cluster(void **state)
{
    (void)state;
    check(make(300, 400, 1e-4, 1e-3, 1e-3), 400 * 399 - 100 * 99);
    check(make(200, 200, 0, 1e-3, 4e-3), 200 * 199);
}

static void a_huge_one_among_thousands(void **state)
{
    (void)state;
    for (int ghost = 0; ghost < 2; ghost++) {
        struct crowd c = make(2000, 2100, 1, 0.005, 0.01);
        int e = ghost ? 2050 : 1234;
        for (int a = 0; a < 3; a++) c.element[e].x[a] = (preal)0.4;
        c.reach[e] = (preal)0.3;
        check(c, 300);
    }
}

/* Nobody, one, two apart, two alike but for the gid, all on a line or in a plane. */
static void few_and_flat(void **state)
{
    (void)state;
    check(make(0, 0, 1, 0.1, 0.1), 0);
    check(make(0, 5, 1, 0.1, 0.1), 0);
    check(make(1, 1, 1, 0.1, 0.1), 0);
    check(make(2, 2, 0, 0.1, 0.1), 2);
    struct crowd line = make(400, 500, 1, 0.01, 0.02), plane = make(900, 1000, 1, 0.02, 0.03);
    for (int e = 0; e < 500; e++) line.element[e].x[1] = line.element[e].x[2] = (preal)0.5;
    for (int e = 0; e < 1000; e++) plane.element[e].x[2] = (preal)0.25;
    check(line, 500);
    check(plane, 1000);
}

/* Between two builds elements leave the periodic domain by a little: up to half a radius here. */
static void beyond_the_boundary(void **state)
{
    (void)state;
    struct crowd c = make(1000, 1400, 1.04, 0.03, 0.05);
    check(c, 1000);
}

/* Reaches as large as periods allow: twice the sum below the period. */
static void thick_ones(void **state)
{
    (void)state;
    check(make(150, 200, 1, 0.2, 0.24), 5000);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(equal_sizes),
        cmocka_unit_test(one_to_twenty), cmocka_unit_test(a_point_like_cluster),
        cmocka_unit_test(a_huge_one_among_thousands), cmocka_unit_test(few_and_flat),
        cmocka_unit_test(beyond_the_boundary), cmocka_unit_test(thick_ones)};
    lists_open(&lists);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    lists_close(&lists);
    return failed;
}
