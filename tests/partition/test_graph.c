/* Graphs whose best cuts are known: grids, paths, pieces apart; unlike shares and weights; what
 * METIS itself would not bear. */
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "partition/graph.h"

enum { MOST = 4096 };

struct made {
    struct graph graph;
    int64_t weight[MOST], link[6 * MOST];
    int begin[MOST + 1], to[6 * MOST], part[MOST];
};

/* Grid of side[0] x side[1] x side[2]; where all sides are 1 but the first: a path. */
static struct made *grid(const int *side)
{
    struct made *m = calloc(1, sizeof *m);
    int n = side[0] * side[1] * side[2], n_edge = 0;
    for (int v = 0; v < n; v++) {
        int at[3] = {v % side[0], v / side[0] % side[1], v / (side[0] * side[1])},
            step[3] = {1, side[0], side[0] * side[1]};
        m->weight[v] = 1;
        for (int a = 0; a < 3; a++)
            for (int d = -1; d <= 1; d += 2) {
                if (at[a] + d < 0 || at[a] + d >= side[a]) continue;
                m->to[n_edge] = v + d * step[a];
                m->link[n_edge++] = 1;
            }
        m->begin[v + 1] = n_edge;
    }
    m->graph = (struct graph){n, m->weight, m->begin, m->to, m->link};
    return m;
}

static int64_t cut_of(const struct made *m)
{
    int64_t cut = 0;
    for (int v = 0; v < m->graph.n; v++)
        for (int k = m->begin[v]; k < m->begin[v + 1]; k++)
            cut += m->part[m->to[k]] != m->part[v] ? m->link[k] : 0;
    return cut / 2;
}

/* Cuts twice, the same both times, and adds up the weights of parts. */
static void run(struct made *m, int n_part, const int64_t *share, int64_t *sum)
{
    static int again[MOST];
    memset(m->part, 0xff, sizeof m->part);
    graph_partition(&m->graph, n_part, share, m->part);
    graph_partition(&m->graph, n_part, share, again);
    memset(sum, 0, (size_t)n_part * sizeof *sum);
    for (int v = 0; v < m->graph.n; v++) {
        assert_in_range(m->part[v], 0, n_part - 1);
        assert_int_equal(m->part[v], again[v]);
        sum[m->part[v]] += m->weight[v];
    }
}

static const int64_t equal[128] = {[0 ... 127] = 1};

/* 16^3 into 2, 4, 8: parts of equal size within a hundredth, and a cut no worse than half as much
 * again as that by planes. */
static void grid_of_a_power_of_two(void **state)
{
    (void)state;
    static const int64_t planes[] = {256, 512, 768};
    int64_t sum[8];
    for (int k = 0; k < 3; k++) {
        struct made *m = grid((int[]){16, 16, 16});
        int n_part = 2 << k;
        run(m, n_part, equal, sum);
        for (int p = 0; p < n_part; p++)
            assert_in_range(sum[p], 4096 / n_part * 99 / 100, 4096 / n_part * 102 / 100);
        assert_in_range(cut_of(m), planes[k] * 9 / 10, planes[k] * 3 / 2);
        free(m);
    }
}

/* n vertices in a row: n_part - 1 edges are cut, no fewer can be. */
static void path(void **state)
{
    (void)state;
    int64_t sum[8];
    struct made *m = grid((int[]){800, 1, 1});
    for (int n_part = 2; n_part <= 8; n_part++) {
        run(m, n_part, equal, sum);
        for (int p = 0; p < n_part; p++)
            assert_in_range(sum[p], 800 / n_part * 97 / 100, 800 / n_part * 103 / 100 + 1);
        assert_in_range(cut_of(m), n_part - 1, n_part + 1);
    }
    free(m);
}

/* Shares and weights that are not alike, over 2^31 together. */
static void shares(void **state)
{
    (void)state;
    static const int64_t share[3] = {500, 300, 200};
    int64_t sum[3], all = 0;
    struct made *m = grid((int[]){20, 20, 5});
    for (int v = 0; v < 2000; v++) all += m->weight[v] = 2000000 + 1000 * (v % 7) * (v % 11);
    run(m, 3, share, sum);
    for (int p = 0; p < 3; p++)
        assert_in_range(
            sum[p], all / 1000 * share[p] * 97 / 100, all / 1000 * share[p] * 103 / 100);
    assert_true(all > INT32_MAX);
    free(m);
}

/* Pieces without an edge between them; a graph without edges. */
static void apart(void **state)
{
    (void)state;
    int64_t sum[16];
    struct made *m = grid((int[]){10, 10, 8});
    int n_edge = 0;
    for (int v = 0; v < 800; v++) { /* layers of z stand alone */
        int first = m->begin[v];
        m->begin[v] = n_edge;
        for (int k = first; k < m->begin[v + 1]; k++)
            if (abs(m->to[k] - v) < 100) m->to[n_edge++] = m->to[k];
    }
    m->begin[800] = n_edge;
    run(m, 4, equal, sum);
    for (int p = 0; p < 4; p++) assert_in_range(sum[p], 196, 204);
    assert_in_range(cut_of(m), 0, 40); /* 0 is possible: two layers each */
    memset(m->begin, 0, sizeof m->begin);
    run(m, 16, equal, sum);
    for (int p = 0; p < 16; p++) assert_int_equal(sum[p], 50);
    free(m);
}

/* One part, no vertices, fewer vertices than parts, as many, a few more: nobody without, and
 * nothing dies. */
static void tiny(void **state)
{
    (void)state;
    int64_t sum[128];
    for (int n = 0; n <= 40; n++)
        for (int n_part = 1; n_part <= 128; n_part = n_part < 20 ? n_part + 1 : 2 * n_part) {
            struct made *m = grid((int[]){n, 1, 1});
            int n_used = 0;
            run(m, n_part, equal, sum);
            for (int p = 0; p < n_part; p++) n_used += sum[p] > 0;
            assert_int_equal(n_used, n < n_part ? n : n_part);
            free(m);
        }
}

/* SIGTERM finds its handler in place afterwards. */
static volatile sig_atomic_t n_term;
static void note(int number)
{
    n_term += number == SIGTERM;
}

static void signals_are_left_alone(void **state)
{
    (void)state;
    int64_t sum[4];
    struct made *m = grid((int[]){8, 8, 8});
    signal(SIGTERM, note);
    run(m, 4, equal, sum);
    raise(SIGTERM);
    assert_int_equal(n_term, 1);
    signal(SIGTERM, SIG_DFL);
    free(m);
}

/* Parts are named so that they keep most of what they have; who has nothing gets what is left. */
static void names_that_move_little(void **state)
{
    (void)state;
    int name[4];
    graph_names(
        4, (int64_t[]){0, 9, 1, 0, /**/ 7, 8, 0, 0, /**/ 0, 0, 0, 0, /**/ 0, 0, 0, 5}, name);
    assert_memory_equal(name, ((int[]){1, 0, 2, 3}), sizeof name);
    graph_names(4, (int64_t[16]){0}, name);
    assert_memory_equal(name, ((int[]){0, 1, 2, 3}), sizeof name);
    graph_names(
        4, (int64_t[]){0, 0, 0, 3, /**/ 0, 0, 0, 4, /**/ 0, 2, 0, 0, /**/ 0, 0, 0, 0}, name);
    assert_memory_equal(name, ((int[]){0, 3, 1, 2}), sizeof name);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(grid_of_a_power_of_two),
        cmocka_unit_test(path), cmocka_unit_test(shares), cmocka_unit_test(apart),
        cmocka_unit_test(tiny), cmocka_unit_test(signals_are_left_alone),
        cmocka_unit_test(names_that_move_little)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
