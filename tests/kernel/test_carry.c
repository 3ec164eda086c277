/* Histories of pairs through a list build: every pair that is in the old lists and in the new ones
 * keeps its own, whatever became of the order of elements;
 * those of elements that leave and arrive go with them. All others begin with zeros. */
#include "lists_fixture.h"

#include "comm/fail.h"
#include "particle/owners_message.h"

enum { N = 900, N_GHOST = 200, N_LEAVE = 150, N_GONE = 40, N_NEW = 30 };
static struct lists lists;
static uint64_t seed = 5;

static double uniform(double low, double high)
{
    return scratch_random(&seed, low, high);
}

/* What the pair of these two remembers: nothing, or its last plane alone (a dashpot that acts just
 * before the touch), or a state and all planes. */
static int kind_of(int64_t a, int64_t b)
{
    int64_t low = a < b ? a : b, high = a < b ? b : a;
    return (int)((7 * low + high) % 4);
}

static int state_of(int64_t a, int64_t b)
{
    return kind_of(a, b) < 2 ? 0 : kind_of(a, b);
}

static real history_of(int64_t a, int64_t b, int plane)
{
    int64_t low = a < b ? a : b, high = a < b ? b : a;
    bool kept =
        kind_of(a, b) > 1 || (kind_of(a, b) == 1 && plane == lists.pairs->layout.history - 1);
    return kept ? (real)(1 + (101 * low + 13 * high + plane) % 99991) : 0;
}

static void check_pair(
    int state, const real *history, int64_t capacity, int64_t p, int64_t a, int64_t b, bool known)
{
    assert_int_equal(state, known ? state_of(a, b) : 0);
    for (int c = 0; c < lists.pairs->layout.history; c++) {
        real wanted = known ? history_of(a, b, c) : 0;
        fixture_same("history", p, history[c * capacity + p], wanted);
    }
}

static void write_histories(const struct crowd *c)
{
    struct pair_list *l = &lists.pairs->now;
    int width = lists.pairs->layout.history;
    int64_t end = l->first_boundary + l->n_boundary;
    int *i = lists_ints(&l->pair_i, end), *j = lists_ints(&l->pair_j, end),
        *state = fail_alloc((size_t)l->capacity * sizeof *state);
    real *history = fail_alloc((size_t)(l->capacity * width) * sizeof *history);
    for (int64_t p = 0; p < end; p++) {
        if (p >= l->n_interior && p < l->first_boundary) continue;
        state[p] = state_of(c->gid[i[p]], c->gid[j[p]]);
        for (int k = 0; k < width; k++)
            history[k * l->capacity + p] = history_of(c->gid[i[p]], c->gid[j[p]], k);
    }
    buffer_write(&l->state, 0, (size_t)l->capacity * sizeof *state, state);
    buffer_write(&l->history, 0, (size_t)(l->capacity * width) * sizeof *history, history);
    free(i);
    free(j);
    free(state);
    free(history);
}

/* place[old number] -> new number, -1 if gone. Owned ones and ghosts are shuffled among themselves;
 * all move; the last N_NEW owned ones are new. */
static struct crowd next(const struct crowd *old, int *place)
{
    struct crowd c = crowd_create(N - N_GONE + N_NEW, old->n_all - N_GONE + N_NEW);
    int shuffled[N + N_GHOST];
    for (int e = 0; e < old->n_all; e++) shuffled[e] = e;
    for (int e = old->n_all - 1; e > 0; e--) {
        int first = e < N ? 0 : N, other = first + (int)uniform(0, e - first + 1),
            swap = shuffled[e];
        shuffled[e] = shuffled[other];
        shuffled[other] = swap;
    }
    for (int e = 0; e < old->n_all; e++) {
        int to = e < N - N_GONE ? e : e < N ? -1 : e - N_GONE + N_NEW;
        place[shuffled[e]] = to;
        if (to < 0) continue;
        c.element[to] = old->element[shuffled[e]];
        c.gid[to] = old->gid[shuffled[e]];
        c.reach[to] = old->reach[shuffled[e]];
        for (int a = 0; a < 3; a++) c.element[to].x[a] += (preal)(0.02 * uniform(-1, 1));
    }
    for (int e = N - N_GONE; e < N - N_GONE + N_NEW; e++) {
        c.element[e] = old->element[e];
        c.gid[e] = 1000000 - e;
        c.reach[e] = old->reach[e];
    }
    return c;
}

/* old_index: most owned elements stay; the first N_LEAVE old ones and the new ones come as if from
 * another rank, the former with their contacts. */
static void migrate(const struct crowd *c, const int *place, struct buffer *old_index)
{
    struct owners_contacts contacts;
    struct buffer leaving;
    int index[N_LEAVE], *from = fail_alloc((size_t)c->n_all * sizeof *from), n = N_LEAVE;
    for (int k = 0; k < N_LEAVE; k++) index[k] = k;
    for (int e = 0; e < c->n_all; e++) from[e] = -1;
    for (int e = 0; e < N; e++)
        if (place[e] >= 0) from[place[e]] = e < N_LEAVE ? N + e : e;
    fixture_buffer(lists.dev, &leaving, "leaving", sizeof index, index);
    owners_pick_pairs(&contacts, lists.scan, &leaving, N_LEAVE, lists.pairs);
    for (int e = 0; e < c->n_owned; e++)
        if (from[e] < 0) from[e] = N + n++;
    contacts.begin = fail_realloc(contacts.begin, ((size_t)n + 1) * sizeof *contacts.begin);
    /* new ones have none */
    for (int k = N_LEAVE + 1; k <= n; k++) contacts.begin[k] = contacts.begin[N_LEAVE];
    owners_store_pairs(lists.pairs, &contacts, n);
    fixture_buffer(lists.dev, old_index, "old_index", (size_t)c->n_all * sizeof *from, from);
    buffer_free(&leaving);
    free(contacts.begin);
    free(contacts.key);
    free(contacts.state);
    free(contacts.history);
    free(from);
}

static void check_histories(const struct crowd *old, const struct crowd *c, const int *place)
{
    const struct pair_list *l = &lists.pairs->now;
    int64_t end = l->first_boundary + l->n_boundary, n_kept = 0, n_new = 0;
    int *i = lists_ints(&l->pair_i, end), *j = lists_ints(&l->pair_j, end),
        *state = lists_ints(&l->state, l->capacity);
    int *before = fail_alloc((size_t)c->n_all * sizeof *before);
    real *history =
        fail_alloc((size_t)(l->capacity * lists.pairs->layout.history) * sizeof *history);
    buffer_read(&l->history, 0,
        (size_t)(l->capacity * lists.pairs->layout.history) * sizeof *history, history);
    for (int e = 0; e < c->n_all; e++) before[e] = -1;
    for (int e = 0; e < old->n_all; e++)
        if (place[e] >= 0) before[place[e]] = e;
    for (int64_t p = 0; p < end; p++) {
        if (p >= l->n_interior && p < l->first_boundary) continue;
        int a = before[i[p]], b = before[j[p]];
        bool known = a >= 0 && b >= 0 && crowd_meet(old, a, b);
        check_pair(state[p], history, l->capacity, p, c->gid[i[p]], c->gid[j[p]], known);
        n_kept += known;
        n_new += !known;
    }
    assert_true(n_kept > 1000 && n_new > 300);
    free(i);
    free(j);
    free(state);
    free(before);
    free(history);
}

static void histories_follow_their_pairs(void **unused)
{
    (void)unused;
    for (int k = 0; k < 3; k++) {
        struct crowd old = crowd_create(N, N + N_GHOST);
        struct buffer old_index;
        int place[N + N_GHOST];
        for (int e = 0; e < old.n_all; e++) {
            for (int a = 0; a < 3; a++) old.element[e].x[a] = (preal)uniform(0, 1);
            old.reach[e] = (preal)uniform(0.04, 0.08);
            old.gid[e] = 7919 * (int64_t)(e + 1) % 10007; /* a prime: all different, in no order */
        }
        lists_build(&lists, &old);
        write_histories(&old);
        struct crowd c = next(&old, place);
        migrate(&c, place, &old_index); /* before the build, as owners_move does */
        lists_build(&lists, &c);
        pairs_carry(lists.pairs, lists.particles, &old_index);
        check_histories(&old, &c, place);
        buffer_free(&old_index);
        crowd_free(&old);
        crowd_free(&c);
    }
}

/* Contacts that go with an element: those that remember something, by ascending gid of the partner,
 * with the history of that pair. */
static void leaving_contacts(void **unused)
{
    (void)unused;
    struct crowd c = crowd_create(300, 400);
    struct owners_contacts contacts;
    struct buffer leaving;
    int index[100], width = lists.pairs->layout.history, at = 0;
    for (int e = 0; e < c.n_all; e++) {
        for (int a = 0; a < 3; a++) c.element[e].x[a] = (preal)uniform(0, 0.4);
        c.reach[e] = (preal)0.05;
        c.gid[e] = 7919 * (int64_t)(e + 1) % 10007;
    }
    for (int k = 0; k < 100; k++) index[k] = 3 * k;
    lists_build(&lists, &c);
    write_histories(&c);
    fixture_buffer(lists.dev, &leaving, "leaving", sizeof index, index);
    owners_pick_pairs(&contacts, lists.scan, &leaving, 100, lists.pairs);
    for (int k = 0; k < 100; k++) {
        int n = 0;
        for (int b = 0; b < c.n_all; b++)
            n += b != index[k] && crowd_meet(&c, index[k], b) &&
                 kind_of(c.gid[index[k]], c.gid[b]) != 0;
        assert_int_equal(contacts.begin[k], at);
        assert_int_equal(contacts.begin[k + 1], at + n);
        for (int first = at; at < first + n; at++) {
            const real *history = (const real *)(const void *)(contacts.history +
                                                               (size_t)at * contacts.history_bytes);
            assert_true(at == first || contacts.key[at - 1] < contacts.key[at]);
            assert_int_equal(contacts.state[at], state_of(c.gid[index[k]], contacts.key[at]));
            for (int p = 0; p < width; p++) {
                real wanted = history_of(c.gid[index[k]], contacts.key[at], p);
                fixture_same("history that leaves", at, history[p], wanted);
            }
        }
    }
    assert_true(at > 300);
    buffer_free(&leaving);
    free(contacts.begin);
    free(contacts.key);
    free(contacts.state);
    free(contacts.history);
    crowd_free(&c);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(histories_follow_their_pairs), cmocka_unit_test(leaving_contacts)};
    lists_open(&lists);
    assert_true(lists.pairs->layout.remembers);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    lists_close(&lists);
    return failed;
}
