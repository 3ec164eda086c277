/* Records moved by index, owners by a tree of cuts, bounds, room: each against the host. Compiled
 * once for each precision and set of periodic directions, see meson.build. */
#include "tree_fixture.h"

enum { N = 3000 };
static struct lists lists;

static void records_follow_an_index(void **state)
{
    (void)state;
    struct crowd c = tree_crowd(N, 0), got = crowd_create(N, N);
    struct buffer index;
    int from[N];
    for (int e = 0; e < N; e++) from[e] = (int)tree_random(0, N); /* any, some twice */
    fixture_buffer(lists.dev, &index, "index", sizeof from, from);
    tree_upload(&lists, &c);
    particles_reserve_spare(lists.particles, N);
    particles_permute(lists.particles, &index, N);
    particles_swap(lists.particles);
    buffer_read(&lists.particles->field[FIELD_STATE].now, 0, N * sizeof *got.element, got.element);
    buffer_read(&lists.particles->field[FIELD_GID].now, 0, N * sizeof *got.gid, got.gid);
    for (int e = 0; e < N; e++) {
        assert_memory_equal(&got.element[e], &c.element[from[e]], sizeof *got.element);
        assert_true(got.gid[e] == c.gid[from[e]]);
    }
    buffer_free(&index);
    crowd_free(&c);
    crowd_free(&got);
}

/* Flags, scanned, make the list of those that are set. Behind them nothing is written. Numbers
 * count from where they shall. */
static void selected_and_numbered(void **state)
{
    (void)state;
    int flag[N + 1] = {0}, got[N], n_set = 0;
    struct buffer at, index;
    struct launch *select = launch_create(lists.program, "record_select"),
                  *number = launch_create(lists.program, "record_number");
    for (int e = 0; e < N; e++) n_set += flag[e] = e == 0 || e == N - 1 || tree_random(0, 1) < 0.3;
    fixture_buffer(lists.dev, &at, "at", sizeof flag, flag);
    fixture_buffer(lists.dev, &index, "index", sizeof got, NULL);
    buffer_zero(&index);
    assert_int_equal(scan_total(lists.scan, &at, N), n_set);
    launch_set_int(select, "n", N);
    launch_bind_buffer(select, "at", &at);
    launch_bind_buffer(select, "index", &index);
    launch_run(select, N);
    buffer_read(&index, 0, sizeof got, got);
    for (int e = 0, k = 0; e < N; e++)
        if (flag[e]) assert_int_equal(got[k++], e);
    for (int k = n_set; k < N; k++) assert_int_equal(got[k], 0);
    launch_set_int(number, "n", N - 10);
    launch_set_int(number, "first", 1000);
    launch_bind_buffer(number, "value", &index);
    launch_run(number, N - 10);
    buffer_read(&index, 0, sizeof got, got);
    for (int k = 0; k < N - 10; k++) assert_int_equal(got[k], 1000 + k);
    for (int k = N - 10; k < N; k++) assert_int_equal(got[k], 0);
    launch_free(select);
    launch_free(number);
    buffer_free(&at);
    buffer_free(&index);
}

struct owned {
    int owner[N], stay[N], leave[N];
    struct record element[N];
};

static void run_owner(
    const struct crowd *c, const struct tree *t, int rank, bool remove, struct owned *out)
{
    struct launch *k = launch_create(lists.program, "select_owner");
    struct buffer buffer[6];
    static const char *const axis[] = {"period_x", "period_y", "period_z"};
    tree_upload(&lists, c);
    launch_bind_buffer(k, "position", &lists.particles->field[FIELD_STATE].now);
    tree_bind(&lists, k, t, buffer);
    fixture_bind(lists.dev, k, &buffer[3], "owner", sizeof out->owner, NULL);
    fixture_bind(lists.dev, k, &buffer[4], "stay", sizeof out->stay, NULL);
    fixture_bind(lists.dev, k, &buffer[5], "leave", sizeof out->leave + sizeof(int), NULL);
    launch_set_int(k, "n", N);
    launch_set_int(k, "rank", rank);
    launch_set_int(k, "remove", remove);
    for (int a = 0; a < 3; a++) launch_set_real_if(k, axis[a], tree_periodic[a] ? LISTS_PERIOD : 0);
    launch_run(k, N);
    buffer_read(&buffer[3], 0, sizeof out->owner, out->owner);
    buffer_read(&buffer[4], 0, sizeof out->stay, out->stay);
    buffer_read(&buffer[5], 0, sizeof out->leave, out->leave);
    buffer_read(&lists.particles->field[FIELD_STATE].now, 0, sizeof out->element, out->element);
    for (int b = 0; b < 6; b++) buffer_free(&buffer[b]);
    launch_free(k);
}

static void check_owner(int n_rank, double beyond, bool remove)
{
    static struct owned got;
    struct crowd c = tree_crowd(N, beyond);
    struct tree t;
    int n_out = 0, n_wrapped = 0;
    tree_grow(&t, n_rank);
    c.element[0].x[0] = 0; /* on the boundary */
    c.element[1].x[0] = 1;
    c.element[2].x[t.axis[0]] = (preal)t.cut[0];
    run_owner(&c, &t, n_rank / 2, remove, &got);
    for (int e = 0; e < N; e++) {
        double x[3];
        bool outside = false;
        for (int a = 0; a < 3; a++) {
            preal own = c.element[e].x[a];
            if (tree_periodic[a] && own < 0) own += (preal)LISTS_PERIOD;
            if (tree_periodic[a] && own >= (preal)LISTS_PERIOD) own -= (preal)LISTS_PERIOD;
            n_wrapped += own < c.element[e].x[a] || own > c.element[e].x[a];
            fixture_same("wrapped coordinate", e, got.element[e].x[a], own);
            x[a] = (double)own;
            outside |= x[a] < 0 || x[a] > LISTS_PERIOD;
        }
        int owner = outside && remove ? -1 : rcb_owner(&t.rcb, x);
        assert_int_equal(got.owner[e], owner);
        assert_int_equal(got.stay[e], owner == n_rank / 2);
        assert_int_equal(got.leave[e], owner != n_rank / 2);
        n_out += outside;
    }
    bool all = tree_periodic[0] && tree_periodic[1] && tree_periodic[2],
         none = !tree_periodic[0] && !tree_periodic[1] && !tree_periodic[2];
    if (beyond > 0)
        assert_true((all ? n_out == 0 : n_out > 10) && (none ? n_wrapped == 0 : n_wrapped > 10));
    crowd_free(&c);
}

static void owners_by_the_tree(void **state)
{
    (void)state;
    for (int remove = 0; remove < 2; remove++) {
        check_owner(1, 0, remove);
        check_owner(2, 0.02, remove);
        check_owner(TREE_LEAVES, 0, remove);
        check_owner(TREE_LEAVES, 0.02, remove);
    }
}

static void bounds_of_all(void **state)
{
    static const int size[] = {1, 2, 63, 64, 65, 2999, 3000};
    (void)state;
    for (size_t k = 0; k < sizeof size / sizeof *size; k++) {
        struct crowd c = tree_crowd(size[k], 0.5);
        double low[3] = {9, 9, 9}, high[3] = {-9, -9, -9}, reach[2] = {9, -9};
        real fastest = 0;
        tree_upload(&lists, &c);
        struct cells_bounds b = cells_bounds(lists.cells, lists.particles, size[k]);
        for (int e = 0; e < size[k]; e++) {
            const real *v = c.element[e].v;
            for (int a = 0; a < 3; a++) {
                low[a] = fmin(low[a], (double)c.element[e].x[a]);
                high[a] = fmax(high[a], (double)c.element[e].x[a]);
            }
            reach[0] = fmin(reach[0], (double)c.reach[e]);
            reach[1] = fmax(reach[1], (double)c.reach[e]);
            fastest = r_max(fastest, v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        }
        for (int a = 0; a < 3; a++) assert_true(b.low[a] == low[a] && b.high[a] == high[a]);
        assert_true(b.reach_min == reach[0] && b.reach_max == reach[1] && !b.has_nan);
        assert_true(b.speed == sqrt((double)(preal)fastest));
        /* one number of one element, the first, a middle or the last one */
        for (int bad = 0; bad < 4; bad++) {
            struct record *r = &c.element[bad == 0   ? 0
                                          : bad == 1 ? size[k] - 1
                                                     : size[k] / 2],
                          good = *r;
            if (bad % 2) r->x[bad % 3] = bad == 1 ? (preal)NAN : (preal)INFINITY;
            else r->v[bad % 3] = bad == 0 ? (real)NAN : (real)-INFINITY;
            tree_upload(&lists, &c);
            assert_true(cells_bounds(lists.cells, lists.particles, size[k]).has_nan);
            *r = good;
        }
        crowd_free(&c);
    }
    struct cells_bounds none = cells_bounds(lists.cells, lists.particles, 0);
    assert_true(none.low[0] > none.high[0] && !none.has_nan);
}

/* Room: skin + horizon |v|; reach: radius + room + half the range of bonds. */
static void room_to_move(void **state)
{
    static preal reference[N][4], reach[N];
    struct crowd c = tree_crowd(N, 0);
    struct launch *k = launch_create(lists.program, "select_room");
    struct particles *p = lists.particles;
    (void)state;
    tree_upload(&lists, &c);
    buffer_reserve(&p->reference, sizeof reference);
    launch_bind_buffer(k, "position", &p->field[FIELD_STATE].now);
    launch_bind_buffer(k, "motion", &p->field[FIELD_STATE].now);
    launch_bind_buffer(k, "reference", &p->reference);
    launch_bind_buffer(k, "reach", &p->reach);
    launch_set_int(k, "n", N);
    launch_set_real(k, "skin", 3e-3);
    launch_set_real(k, "horizon", 2e-3);
    launch_set_real(k, "bond_range", 1e-3);
    launch_run(k, N);
    buffer_read(&p->reference, 0, sizeof reference, reference);
    buffer_read(&p->reach, 0, sizeof reach, reach);
    for (int e = 0; e < N; e++) {
        const real *v = c.element[e].v;
        preal room =
            (preal)r_fma((real)2e-3, r_sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]), (real)3e-3);
        preal wanted = c.element[e].radius + room + (preal)0.5 * (preal)(real)1e-3;
        fixture_same("reach", e, reach[e], wanted);
        fixture_same("room", e, reference[e][3], room);
        for (int a = 0; a < 3; a++)
            fixture_same("reference", e, reference[e][a], c.element[e].x[a]);
    }
    launch_free(k);
    crowd_free(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(records_follow_an_index),
        cmocka_unit_test(selected_and_numbered), cmocka_unit_test(owners_by_the_tree),
        cmocka_unit_test(bounds_of_all), cmocka_unit_test(room_to_move)};
    lists_open(&lists);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    lists_close(&lists);
    return failed;
}
