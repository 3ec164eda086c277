/* Which of its two ranks computes a pair that a border cuts, where such pairs are then, and in what
 * order their results travel, by brute force. */
#include "lists_fixture.h"

#include "comm/fail.h"

enum { N_SEGMENT = 3 };
static struct lists lists;
static struct program *program;
static uint64_t seed = 31;
static const int n_of_segment[N_SEGMENT] = {170, 1, 229};

struct state {
    struct crowd c;
    int segment[N_SEGMENT + 1];
    int n, first, n_mine; /* boundary pairs */
    int *i, *j;           /* [first + n] as they were before */
    int *theirs;          /* [first + n] by brute force */
    struct buffer buffer[5];
};

static struct crowd make(int n_owned, double reach)
{
    struct crowd c =
        crowd_create(n_owned, n_owned + n_of_segment[0] + n_of_segment[1] + n_of_segment[2]);
    for (int e = 0; e < c.n_all; e++) {
        for (int a = 0; a < 3; a++) c.element[e].x[a] = (preal)scratch_random(&seed, 0, 1);
        c.reach[e] = (preal)(reach * scratch_random(&seed, 0.5, 1));
        c.gid[e] = 7919 * (int64_t)(e + 1) % 10007;
    }
    return c;
}

/* Neighbours of e among elements begin <= b < end. */
static int neighbours(const struct crowd *c, int e, int begin, int end)
{
    int n = 0;
    for (int b = begin; b < end; b++) n += b != e && crowd_meet(c, e, b);
    return n;
}

/* L(i, B(j)) <= L(j, B(i)), i the lower id: on B(i). */
static int is_theirs(const struct state *s, int i, int j)
{
    const struct crowd *c = &s->c;
    int begin[2], end[2], here[2] = {i < c->n_owned, j < c->n_owned}, e[2] = {i, j};
    if (here[0] && here[1]) return 0;
    for (int k = 0; k < 2; k++) {
        int segment = 0;
        while (!here[k] && e[k] - c->n_owned >= s->segment[segment + 1]) segment++;
        begin[k] = here[k] ? 0 : c->n_owned + s->segment[segment];
        end[k] = here[k] ? c->n_owned : c->n_owned + s->segment[segment + 1];
    }
    bool by_lower = neighbours(c, i, begin[1], end[1]) <= neighbours(c, j, begin[0], end[0]);
    return by_lower ? !here[0] : !here[1];
}

static void run_rule(struct state *s)
{
    struct pair_list *l = &lists.pairs->now;
    struct launch *k = launch_create(program, "assign_rule");
    launch_set_int(k, "n", s->n);
    launch_set_int(k, "first", s->first);
    launch_set_int(k, "n_owned", s->c.n_owned);
    launch_set_int(k, "n_segment", N_SEGMENT);
    launch_bind_buffer(k, "row_begin", &l->row_begin);
    launch_bind_buffer(k, "row", &l->row);
    launch_bind_buffer(k, "pair_i", &l->pair_i);
    launch_bind_buffer(k, "pair_j", &l->pair_j);
    fixture_bind(lists.dev, k, &s->buffer[0], "segment", sizeof s->segment, s->segment);
    fixture_bind(lists.dev, k, &s->buffer[1], "copy", (size_t)s->n * sizeof(cl_int2), NULL);
    fixture_bind(lists.dev, k, &s->buffer[2], "theirs", ((size_t)s->n + 1) * sizeof(int), NULL);
    launch_run(k, s->n);
    launch_free(k);
    int *theirs = lists_ints(&s->buffer[2], s->n);
    for (int p = 0; p < s->n; p++) assert_int_equal(theirs[p], s->theirs[s->first + p]);
    free(theirs);
}

static void run_order(struct state *s)
{
    struct pair_list *l = &lists.pairs->now;
    struct launch *place = launch_create(program, "assign_place"),
                  *link = launch_create(program, "assign_link");
    s->n_mine = s->n - (int)scan_total(lists.scan, &s->buffer[2], s->n);
    launch_set_int(place, "n", s->n);
    launch_set_int(place, "first", s->first);
    launch_set_int(place, "n_mine", s->n_mine);
    launch_bind_buffer(place, "copy", &s->buffer[1]);
    launch_bind_buffer(place, "theirs", &s->buffer[2]);
    launch_bind_buffer(place, "pair_i", &l->pair_i);
    launch_bind_buffer(place, "pair_j", &l->pair_j);
    fixture_bind(lists.dev, place, &s->buffer[3], "place", (size_t)s->n * sizeof(int), NULL);
    launch_run(place, s->n);
    launch_set_count(link, "n_incidence", l->n_incidence);
    launch_set_int(link, "n", s->n);
    launch_set_int(link, "first", s->first);
    launch_bind_buffer(link, "place", &s->buffer[3]);
    launch_bind_buffer(link, "incidence", &l->incidence);
    launch_run(link, l->n_incidence);
    launch_free(place);
    launch_free(link);
}

/* Pairs of this rank first, both kinds in the order that they had; and the gather's list still
 * names the same pairs. */
static void check_order(const struct state *s, const int *incidence_before)
{
    const struct pair_list *l = &lists.pairs->now;
    int *i = lists_ints(&l->pair_i, s->first + s->n), *j = lists_ints(&l->pair_j, s->first + s->n),
        at[2] = {s->first, s->first + s->n_mine};
    for (int p = s->first; p < s->first + s->n; p++) {
        int to = at[s->theirs[p]]++;
        assert_true(i[to] == s->i[p] && j[to] == s->j[p]);
    }
    assert_true(at[0] == s->first + s->n_mine && at[1] == s->first + s->n);
    int *incidence = lists_ints(&l->incidence, l->n_incidence);
    for (int k = 0; k < l->n_incidence; k++) {
        int before = incidence_before[k] / 2, now = incidence[k] / 2;
        assert_int_equal(incidence[k] % 2, incidence_before[k] % 2);
        if (before == l->capacity - 1) assert_int_equal(now, before);
        else assert_true(i[now] == s->i[before] && j[now] == s->j[before]);
    }
    free(i);
    free(j);
    free(incidence);
}

/* Of these elements, in segments with partners of their own: pairs of one kind, by the partner's
 * id. */
static void check_list(
    struct state *s, const int *element, const int *begin, const cl_int2 *range, int theirs)
{
    const struct pair_list *l = &lists.pairs->now;
    int n = begin[N_SEGMENT], at = 0, *i = lists_ints(&l->pair_i, s->first + s->n),
        *j = lists_ints(&l->pair_j, s->first + s->n);
    struct launch *k = launch_create(program, "assign_list");
    struct buffer buffer[5];
    fixture_bind(lists.dev, k, &buffer[0], "segment", (N_SEGMENT + 1) * sizeof *begin, begin);
    fixture_bind(lists.dev, k, &buffer[1], "range", N_SEGMENT * sizeof *range, range);
    fixture_bind(lists.dev, k, &buffer[2], "element", (size_t)n * sizeof *element, element);
    fixture_bind(lists.dev, k, &buffer[3], "begin", ((size_t)n + 1) * sizeof(int), NULL);
    fixture_bind(lists.dev, k, &buffer[4], "list", (size_t)s->n * sizeof(int), NULL);
    launch_bind_buffer(k, "gid", &lists.particles->field[FIELD_GID].now);
    launch_bind_buffer(k, "row_begin", &l->row_begin);
    launch_bind_buffer(k, "row", &l->row);
    launch_bind_buffer(k, "row_gid", &l->row_gid);
    launch_bind_buffer(k, "incidence_begin", &l->incidence_begin);
    launch_bind_buffer(k, "incidence", &l->incidence);
    const struct {
        const char *name;
        int value;
    } set[] = {{"n_element", n}, {"n_owned", s->c.n_owned}, {"first_theirs", s->first + s->n_mine},
        {"is_theirs", theirs}, {"n_segment", N_SEGMENT}};
    for (size_t m = 0; m < sizeof set / sizeof *set; m++)
        launch_set_int(k, set[m].name, set[m].value);
    for (int fill = 0; fill < 2; fill++) {
        launch_set_int(k, "fill", fill);
        launch_run(k, n);
        if (!fill) scan_total(lists.scan, &buffer[3], n);
    }
    int *list = lists_ints(&buffer[4], s->n), *count = lists_ints(&buffer[3], n + 1);
    for (int m = 0; m < n; m++) {
        int segment = 0, e = element[m];
        while (m >= begin[segment + 1]) segment++;
        int64_t before = -1;
        for (; at < count[m + 1]; at++) {
            int p = list[at], other = i[p] == e ? j[p] : i[p];
            assert_true((i[p] == e || j[p] == e) && (p >= s->first + s->n_mine) == theirs &&
                        s->c.gid[other] > before);
            assert_in_range(other, range[segment].s[0], range[segment].s[1] - 1);
            before = s->c.gid[other];
        }
    }
    int n_wanted = 0; /* none is missing */
    for (int p = s->first; p < s->first + s->n; p++)
        for (int m = 0, segment = 0; m < n; m++) {
            while (m >= begin[segment + 1]) segment++;
            int other = i[p] == element[m] ? j[p] : j[p] == element[m] ? i[p] : -1;
            n_wanted += other >= range[segment].s[0] && other < range[segment].s[1] &&
                        (p >= s->first + s->n_mine) == theirs;
        }
    assert_int_equal(at, n_wanted);
    for (int b = 0; b < 5; b++) buffer_free(&buffer[b]);
    launch_free(k);
    void *own[] = {i, j, list, count};
    for (int b = 0; b < 4; b++) free(own[b]);
}

/* Ghosts, each with owned partners; and every third owned element for each segment, with the ghosts
 * of it. */
static void check_lists(struct state *s)
{
    int n_ghost = s->c.n_all - s->c.n_owned, each = s->c.n_owned / 3,
        *element = fail_alloc((size_t)s->c.n_all * sizeof *element);
    int begin[N_SEGMENT + 1] = {0};
    cl_int2 range[N_SEGMENT];
    for (int k = 0; k < n_ghost; k++) element[k] = s->c.n_owned + k;
    for (int k = 0; k < N_SEGMENT; k++) range[k] = (cl_int2){{0, s->c.n_owned}};
    check_list(s, element, s->segment, range, 0);
    check_list(s, element, s->segment, range, 1);
    for (int k = 0; k < N_SEGMENT; k++) {
        for (int m = 0; m < each; m++) element[k * each + m] = 3 * m + k;
        begin[k + 1] = (k + 1) * each;
        range[k] = (cl_int2){{s->c.n_owned + s->segment[k], s->c.n_owned + s->segment[k + 1]}};
    }
    check_list(s, element, begin, range, 1);
    free(element);
}

static void check(int n_owned, double reach, int least)
{
    struct state s = {.c = make(n_owned, reach)};
    const struct pair_list *l = &lists.pairs->now;
    lists_build(&lists, &s.c);
    s.n = (int)l->n_boundary;
    s.first = (int)l->first_boundary;
    s.i = lists_ints(&l->pair_i, s.first + s.n);
    s.j = lists_ints(&l->pair_j, s.first + s.n);
    s.theirs = fail_alloc((size_t)(s.first + s.n) * sizeof *s.theirs);
    for (int k = 0; k < N_SEGMENT; k++) s.segment[k + 1] = s.segment[k] + n_of_segment[k];
    for (int p = s.first; p < s.first + s.n; p++) s.theirs[p] = is_theirs(&s, s.i[p], s.j[p]);
    int *incidence = lists_ints(&l->incidence, l->n_incidence);
    run_rule(&s);
    run_order(&s);
    assert_true(s.n_mine >= least && s.n - s.n_mine >= least);
    check_order(&s, incidence);
    check_lists(&s);
    for (int b = 0; b < 4; b++) buffer_free(&s.buffer[b]);
    void *own[] = {s.i, s.j, s.theirs, incidence};
    for (int b = 0; b < 4; b++) free(own[b]);
    crowd_free(&s.c);
}

static void pairs_are_assigned(void **unused)
{
    (void)unused;
    check(900, 0.06, 100);
    check(120, 0.1, 100); /* most pairs are cut */
    check(0, 0.1, 0);
}

int main(void)
{
    static const char *const sources[] = {"assign.cl", NULL};
    const struct CMUnitTest tests[] = {cmocka_unit_test(pairs_are_assigned)};
    lists_open(&lists);
    program = fixture_program(lists.dev, &lists.features, FEATURES_LISTS, sources);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    program_free(program);
    lists_close(&lists);
    return failed;
}
