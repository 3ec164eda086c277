/* The account of a made-up state: right against the host, to the bit the same however it is dealt
 * out, and whole when elements and walls leave. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../mpi_check.h"
#include "account_fixture.h"
#include "comm/fail.h"

static struct device *dev;
static struct comm *comm, alone;
static struct account_state state;

/* kinetic, rotational, gravity, elastic, losses, work, removed; momentum; angular momentum: the
 * order of struct energy_sums */
enum {
    N_NUMBER = sizeof(struct energy_sums) / sizeof(double),
    FIRST_MOMENTUM = 11,
    FIRST_ANGULAR = 14
};

static void numbers(const struct energy_sums *e, double out[N_NUMBER])
{
    memcpy(out, e, sizeof *e);
}

static bool same(const struct energy_sums *a, const struct energy_sums *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

/* In long double, each with the sum of magnitudes of what it is made of. */
struct reference {
    long double sum[N_NUMBER], size[N_NUMBER];
};

static void refer(struct reference *r, int k, long double x)
{
    r->sum[k] += x;
    r->size[k] += fabsl(x);
}

static void refer_contact(struct reference *r, const double *ledger)
{
    static const int at[LEDGER_WIDTH] = {4, 5, 6, 7, 8, 3, 9};
    for (int k = 0; k < LEDGER_WIDTH; k++) refer(r, at[k], ledger[k]);
}

static struct reference reference(const struct account_state *a, bool spin)
{
    struct reference r = {0};
    for (int i = 0; i < N_ELEMENT; i++) {
        if (a->taken[i]) continue;
        long double m = 1 / (long double)a->inverse_m[i],
                    inertia = 0.4L * m * a->radius[i] * a->radius[i];
        for (int k = 0; k < 3; k++) {
            int p = (k + 1) % 3, q = (k + 2) % 3;
            const double *x = a->x[i], *v = a->v[i];
            long double w = spin ? a->w[i][k] : 0;
            refer(&r, 0, m * v[k] * v[k] / 2);
            refer(&r, 1, inertia * w * w / 2);
            refer(&r, 2, -m * a->gravity[k] * ((long double)x[k] - a->domain[k]));
            refer(&r, FIRST_MOMENTUM + k, m * v[k]);
            refer(&r, FIRST_ANGULAR + k, m * x[p] * v[q]);
            refer(&r, FIRST_ANGULAR + k, -m * x[q] * v[p]);
            refer(&r, FIRST_ANGULAR + k, inertia * w);
        }
        refer_contact(&r, a->at_wall[i]);
    }
    for (int p = 0; p < N_PAIR; p++)
        if (!a->taken[a->lower[p]] && !a->taken[a->upper[p]]) refer_contact(&r, a->pair[p]);
    return r;
}

/* Each term has a handful of roundings. */
static void check_reference(const struct energy_sums *e, const struct reference *r)
{
    double got[N_NUMBER];
    numbers(e, got);
    for (int k = 0; k < N_NUMBER; k++)
        CHECK(fabsl(got[k] - r->sum[k]) <= 8 * (long double)DBL_EPSILON * r->size[k] + 1e-20L);
}

static struct features features_like(int precision, bool spin)
{
    struct features f = {.energy = true, .spin = spin, .walls = true, .timed = true};
    f.real_is_float = precision > 0;
    f.position_is_float = precision > 1;
    return f;
}

static struct sim *dealt(const struct features *f)
{
    return account_sim(dev, comm, &state, f, comm->rank, comm->n_rank);
}
static struct sim *undivided(const struct features *f)
{
    return account_sim(dev, &alone, &state, f, 0, 1);
}

/* Sums against the host's; dealt out or not; asked for once or twice. */
static void check_sums(int precision, bool spin)
{
    struct features f = features_like(precision, spin);
    struct energy_sums e, again, one;
    account_random(&state, precision > 0);
    if (precision == 2)
        for (int i = 0; i < N_ELEMENT; i++)
            state.domain[i % 3] = (double)(float)state.domain[i % 3];
    struct reference r = reference(&state, spin);
    struct sim *s = dealt(&f), *whole = undivided(&f);
    energy_now(s, &e);
    check_reference(&e, &r);
    energy_now(whole, &one);
    CHECK(same(&e, &one));
    energy_now(s, &again); /* losses are in the totals now, and not in the ledgers any more */
    CHECK(same(&e, &again));
    for (int k = 0; k < 3; k++) energy_collect(s);
    energy_now(s, &again);
    CHECK(same(&e, &again));
    account_free(s);
    account_free(whole);
}

/* Losses of three generations of lists add up; a small negative sum keeps its digits. */
static void check_totals(void)
{
    struct features f = features_like(0, true);
    struct energy_sums e;
    account_random(&state, false);
    memset(state.pair, 0, sizeof state.pair);
    memset(state.at_wall, 0, sizeof state.at_wall);
    for (int p = 0; p < N_PAIR; p++) {
        state.pair[p][LEDGER_SLIDING] = p % 2 ? -0.1 : 0.1;
        state.pair[p][LEDGER_NORMAL] = 1024;
    }
    state.pair[17][LEDGER_ROLLING] = -0x1.23456789p-40;
    state.pair[18][LEDGER_BONDS] = -0x1p-80;
    struct sim *s = dealt(&f);
    size_t bytes = (size_t)s->particle->pairs->now.capacity * LEDGER_WIDTH * sizeof(double);
    double *ledger = fail_alloc(bytes);
    buffer_read(&s->particle->pairs->ledger, 0, bytes, ledger);
    for (int k = 0; k < 3; k++) {
        buffer_write(&s->particle->pairs->ledger, 0, bytes, ledger);
        energy_collect(s);
    }
    energy_now(s, &e);
    CHECK(e.dashpot_normal == 3 * 1024.0 * N_PAIR);
    CHECK(e.sliding == 0); /* exactly, in whatever order */
    CHECK(e.rolling == 3 * -0x1.23456789p-40);
    CHECK(e.bonds == -0x1.8p-79);
    CHECK(e.wall_work == 0 && e.dashpot_tangential == 0 && e.elastic == 0 && e.removed == 0);
    free(ledger);
    account_free(s);
}

static double account_size(const struct reference *r)
{
    double size = 0;
    for (int k = 0; k < FIRST_MOMENTUM; k++) size += (double)r->size[k];
    return size;
}

/* What elements and a wall take with them is in `removed`; nothing is counted twice, whoever owns
 * the two of a pair. */
static void check_leaving(bool wall_goes)
{
    struct features f = features_like(0, true);
    struct energy_sums before[2], after[2];
    account_random(&state, false);
    struct reference r = reference(&state, true);
    struct sim *both[2] = {dealt(&f), undivided(&f)};
    for (int k = 0; k < 2; k++) energy_now(both[k], &before[k]);
    for (int i = 0; i < N_ELEMENT; i++) state.taken[i] = mpi_check_random((uint64_t)i) % 7 == 0;
    for (int k = 0; k < 2; k++) {
        struct sim *s = both[k];
        s->step = wall_goes ? 7 : 6;
        energy_collect(s);
        account_leave(s, &state);
        int64_t n = s->particle->owners->n_removed;
        comm_sum_i64(s->comm, &n, 1);
        energy_moved(s, n);
    }
    if (wall_goes)
        for (int i = 1; i < N_ELEMENT; i += N_WALL) state.at_wall[i][LEDGER_ELASTIC] = 0;
    struct reference left = reference(&state, true);
    for (int k = 0; k < 2; k++) {
        /* lists as they are after the build */
        struct sim *s = both[k], *fresh = k ? undivided(&f) : dealt(&f);
        struct energy_sums elastic;
        energy_now(fresh, &elastic);
        energy_now(s, &after[k]);
        after[k].elastic = elastic.elastic;
        CHECK(
            fabs(after[k].elastic - (double)left.sum[3]) <= 8 * DBL_EPSILON * (double)left.size[3]);
        CHECK(
            fabs(after[k].kinetic - (double)left.sum[0]) <= 8 * DBL_EPSILON * (double)left.size[0]);
        CHECK(fabs(energy_balance(&before[k], &after[k])) <= 32 * DBL_EPSILON * account_size(&r));
        CHECK(fabs(after[k].removed) > 1e-3 * account_size(&r));
        account_free(fresh);
        account_free(s);
    }
    CHECK(same(&after[0], &after[1]));
}

/* Elements that go round a period along gravity keep their potential; one that leaves as well takes
 * its own place's with it. */
static void check_wrapping(void)
{
    struct features f = features_like(0, false);
    struct energy_sums before, after;
    f.periodic[1] = f.periodic[2] = true;
    account_random(&state, false);
    struct sim *s = dealt(&f);
    energy_now(s, &before);
    energy_collect(s);
    double jump = 0, size = 0;
    for (int i = 0; i < N_ELEMENT; i += 3) {
        state.x[i][2] += i % 2 ? 2.5 : -2.5;
        jump += 2.5 * 9.81 / state.inverse_m[i] * (i % 2 ? 1 : -1);
        size += 2.5 * 9.81 / state.inverse_m[i];
    }
    account_write_elements(s, &state);
    energy_moved(s, 0);
    energy_now(s, &after);
    CHECK(fabs(jump) > 1e-3 * size); /* else this shows nothing */
    CHECK(fabs(after.gravity - before.gravity) <= 8 * DBL_EPSILON * size);
    state.taken[3] = 1;
    energy_collect(s);
    account_leave(s, &state);
    int64_t n = s->particle->owners->n_removed;
    comm_sum_i64(comm, &n, 1);
    CHECK(n == 1);
    energy_moved(s, n);
    energy_now(s, &after);
    double change = after.kinetic + after.gravity + after.removed - before.kinetic - before.gravity;
    double springs = 0;
    for (int p = 0; p < N_PAIR; p++)
        springs += state.lower[p] == 3 || state.upper[p] == 3 ? state.pair[p][LEDGER_ELASTIC] : 0;
    CHECK(fabs(change - springs - state.at_wall[3][LEDGER_ELASTIC]) <= 64 * DBL_EPSILON * size);
    account_free(s);
}

/* Half a step of gravity is still to come when an element leaves. */
static void check_half_kick(void)
{
    struct features f = features_like(0, false);
    struct energy_sums e;
    account_random(&state, false);
    memset(state.pair, 0, sizeof state.pair);
    memset(state.at_wall, 0, sizeof state.at_wall);
    struct sim *s = dealt(&f);
    s->dt = 0.25;
    state.taken[5] = 1;
    energy_collect(s);
    account_leave(s, &state);
    energy_moved(s, 1);
    energy_now(s, &e);
    double expected = 0;
    for (int k = 0; k < 3; k++) {
        double v = state.v[5][k] + 0.125 * state.gravity[k];
        expected += (0.5 * v * v - state.gravity[k] * (state.x[5][k] - state.domain[k])) /
                    state.inverse_m[5];
    }
    CHECK(fabs(e.removed - expected) <= 1e-14 * fabs(expected));
    account_free(s);
}

/* What cannot be known is NaN, and only that. */
static void check_unknown(void)
{
    struct features f = features_like(0, true);
    struct energy_sums e;
    double got[N_NUMBER];
    account_random(&state, false);
    f.energy = false;
    struct sim *s = dealt(&f);
    energy_now(s, &e);
    numbers(&e, got);
    for (int k = 0; k < N_NUMBER; k++) CHECK(isnan(got[k]) == (k >= 3 && k < FIRST_MOMENTUM));
    account_free(s);
    state.v[11][1] = NAN; /* on one rank */
    s = dealt(&f);
    energy_now(s, &e);
    CHECK(isnan(e.kinetic) && isnan(e.momentum[1]) && isnan(e.angular[0]) && isnan(e.angular[2]));
    CHECK(isfinite(e.gravity) && isfinite(e.rotational) && isfinite(e.momentum[0]) &&
          isfinite(e.angular[1]));
    account_free(s);
    dev->fp64 = false;
    f.real_is_float = f.position_is_float = true;
    s = dealt(&f);
    energy_now(s, &e);
    numbers(&e, got);
    for (int k = 0; k < N_NUMBER; k++) CHECK(isnan(got[k]));
    account_free(s);
    dev->fp64 = true;
}

int main(int argc, char **argv)
{
    comm = comm_create(&argc, &argv);
    dev = device_open(comm, NULL, true, false);
    alone =
        (struct comm){.world = MPI_COMM_SELF, .node = MPI_COMM_SELF, .n_rank = 1, .n_node_rank = 1};
    for (int precision = 0; precision < 3; precision++) check_sums(precision, precision != 1);
    check_totals();
    check_leaving(false);
    check_leaving(true);
    check_wrapping();
    check_half_kick();
    check_unknown();
    device_free(dev);
    comm_free(comm);
    return 0;
}
