/* Which elements are a neighbour's ghosts: by the box of its elements and its leaves in the tree of
 * cuts, which need not be one box. Compiled once for each precision and set of periodic directions,
 * see meson.build. */
#include "tree_fixture.h"

enum { N = 3000 };
static struct lists lists;

/* Distance of x from the box, of all its images the nearest: the Euclidean one, and the largest
 * over the axes. */
static double distance_to(
    const preal x[3], const double low[3], const double high[3], double *largest)
{
    double square = 0;
    *largest = 0;
    for (int a = 0; a < 3; a++) {
        double best = (double)INFINITY;
        for (int image = tree_periodic[a] ? -1 : 0; image <= (tree_periodic[a] ? 1 : 0); image++) {
            double y = (double)x[a] + image * LISTS_PERIOD;
            best = fmin(best, fmax(fmax(low[a] - y, y - high[a]), 0));
        }
        square += best * best;
        *largest = fmax(*largest, best);
    }
    return sqrt(square);
}

/* The leaves that c is or leads to, as boxes within the domain along periodic axes and without end
 * along others. Cuts are random: a box with low above high holds nothing, and its distance is still
 * that of the cuts. */
struct leaf_box {
    double low[3], high[3];
    int owner;
};

static int leaves_of(const struct tree *t, int c, struct leaf_box box, struct leaf_box *out)
{
    if (c < 0) {
        box.owner = -1 - c;
        *out = box;
        return 1;
    }
    struct leaf_box left = box, right = box;
    int a = t->axis[c];
    left.high[a] = fmin(left.high[a], t->cut[c]);
    right.low[a] = fmax(right.low[a], t->cut[c]);
    int n = leaves_of(t, t->left[c], left, out);
    return n + leaves_of(t, t->right[c], right, out + n);
}

/* Leaves are owned by half as many ranks, so that some have several, apart from each other. Returns
 * how many there are. */
static int grow_owned(struct tree *t, int n_leaf, struct leaf_box *leaf)
{
    struct leaf_box all = {{-9, -9, -9}, {9, 9, 9}, 0};
    int owner[TREE_LEAVES];
    tree_grow(t, n_leaf);
    for (int k = 0; k < n_leaf; k++) owner[k] = k * 5 % (n_leaf / 2 + 1);
    rcb_assign(&t->rcb, owner);
    for (int a = 0; a < 3; a++) {
        if (!tree_periodic[a]) continue;
        all.low[a] = 0;
        all.high[a] = LISTS_PERIOD;
    }
    return leaves_of(t, n_leaf > 1 ? 0 : -1, all, leaf);
}

static void set_box(struct launch *k, const double low[3], const double high[3])
{
    double period[3];
    for (int a = 0; a < 3; a++) period[a] = tree_periodic[a] ? LISTS_PERIOD : 0;
    launch_set_vector(k, "low", low);
    launch_set_vector(k, "high", high);
    launch_set_vector_if(k, "period", period);
}

/* All that a neighbour may need, whose elements are in the box and in its leaves, and none that is
 * further from the box, or along some axis from all leaves, by more than a thousandth. */
static void check_ghosts(
    struct launch *k, const struct buffer *at, int n_leaf, double far_reach, int *n_taken)
{
    struct crowd c = tree_crowd(N, 0);
    struct tree t;
    struct leaf_box leaf[TREE_LEAVES];
    struct buffer buffer[3];
    double low[3], high[3];
    int n_box = grow_owned(&t, n_leaf, leaf), rank = (int)tree_random(0, n_leaf / 2 + 1);
    for (int a = 0; a < 3; a++) {
        low[a] = (double)(preal)tree_random(0, 0.9);
        high[a] = tree_random(0, 1) < 0.2 ? low[a] : (double)(preal)tree_random(low[a], 1);
    }
    tree_bind(&lists, k, &t, buffer);
    set_box(k, low, high);
    tree_upload(&lists, &c);
    launch_bind_buffer(k, "position", &lists.particles->field[FIELD_STATE].now);
    launch_bind_buffer(k, "reach", &lists.particles->reach);
    launch_set_int(k, "n", N);
    launch_set_int(k, "rank", rank);
    launch_set_real(k, "far_reach", far_reach);
    launch_run(k, N);
    int *taken = lists_ints(at, N);
    for (int e = 0; e < N; e++) {
        double unused, along, reach = (double)c.reach[e] + far_reach,
                              from_box = distance_to(c.element[e].x, low, high, &unused);
        bool is_needed = false, is_near = false;
        for (int b = 0; b < n_box; b++) {
            double both_low[3], both_high[3];
            bool is_empty = false;
            if (leaf[b].owner != rank) continue;
            distance_to(c.element[e].x, leaf[b].low, leaf[b].high, &along);
            is_near |= along < 1.001 * reach;
            for (int a = 0; a < 3; a++) {
                both_low[a] = fmax(low[a], leaf[b].low[a]);
                both_high[a] = fmin(high[a], leaf[b].high[a]);
                is_empty |= both_low[a] > both_high[a];
            }
            is_needed |=
                !is_empty && distance_to(c.element[e].x, both_low, both_high, &along) < reach;
        }
        assert_in_range(taken[e], 0, 1);
        if (is_needed) assert_int_equal(taken[e], 1);
        if (from_box > 1.001 * reach || !is_near) assert_int_equal(taken[e], 0);
        *n_taken += taken[e];
    }
    for (int b = 0; b < 3; b++) buffer_free(&buffer[b]);
    free(taken);
    crowd_free(&c);
}

static void ghosts_within_reach_of_box_and_leaves(void **state)
{
    struct launch *k = launch_create(lists.program, "select_ghosts");
    struct buffer at;
    int n_taken = 0;
    (void)state;
    fixture_bind(lists.dev, k, &at, "at", (N + 1) * sizeof(int), NULL);
    for (int box = 0; box < 40; box++)
        check_ghosts(k, &at, box < 4 ? 1 : TREE_LEAVES, box % 2 ? 0.03 : 0.2, &n_taken);
    assert_true(n_taken > N / 2 && n_taken < 39 * N);
    buffer_free(&at);
    launch_free(k);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(ghosts_within_reach_of_box_and_leaves)};
    lists_open(&lists);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    lists_close(&lists);
    return failed;
}
