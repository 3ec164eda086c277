/* gather and kick_drift: sums in the order of the lists, leapfrog against the host bit for bit, the
 * fused step equal to the observed one followed by kick_drift, and when the lists count as used up.
 * Compiled once for each set of features and each precision, see meson.build. */
#include "kernel_fixture.h"

#include "comm/fail.h"
#include "kernels/contact/contact_memory.h"
#include "kernels/particle/incidence.h"
#include "record_reader.h"

enum {
    N = 500,
    N_GHOST = 20,
    N_PAIR = 3000,
    N_INCIDENCE = 20000,
    N_AT_WALL = 800,
    ROOM = 16 /* real per record, or more */
};
static const double dt = 1e-3, radius = 0.01, inverse_m = 40, margin = 2e-3,
                    gravity[3] = {0.1, -0.2, -9.81};
static uint64_t seed = 8;

enum {
    POSITION,
    INCIDENCE_BEGIN,
    INCIDENCE,
    RESULT,
    WALL_BEGIN,
    WALL_RESULT,
    ORIENTATION,
    FORCE,
    TORQUE,
    REFERENCE,
    FLAGS,
    N_BUFFER
};
static const char *const buffer_name[N_BUFFER] = {"position", "incidence_begin", "incidence",
    "result", "wall_begin", "wall_result", "orientation", "force", "torque", "reference", "flags"};

struct test {
    struct record element[N + N_GHOST];
    int incidence_begin[N + 1], incidence[N_INCIDENCE], wall_begin[N + 1], flags[2];
    real result[N_PAIR + 1][RESULT_WIDTH], wall_result[N_AT_WALL][ROOM], orientation[N][4],
        force[N][4], torque[N][4];
    preal reference[N][4];
    struct buffer buffer[N_BUFFER];
};

static struct device *dev;
static struct launch *gather, *kick_drift;
static struct test *start;      /* written once, never changed */
static struct reading *reading; /* of its records: [2 N_PAIR + N_AT_WALL] */

static double any(void)
{
    return scratch_random(&seed, -1, 1);
}

/* Of many magnitudes, so that another order of a sum gives other bits. */
static real spread(void)
{
    return (real)(any() * pow(10, scratch_random(&seed, -4, 1)));
}

static void set_element(struct test *t, int e)
{
    struct record *r = &t->element[e];
    r->radius = (preal)(WITH_SIZES ? radius * (2 + any()) : radius);
    r->inverse_m = (real)(WITH_SIZES ? inverse_m * (2 + any()) : inverse_m);
    for (int a = 0; a < 3; a++) {
        r->x[a] = (preal)any();
        r->v[a] = (real)any();
#if WITH_SPIN
        r->w[a] = (real)(100 * any());
#endif
    }
#if WITH_SPIN
    r->material = (real)(e % 3);
#endif
}

/* Rows of any pairs, from either end; one element has hundreds, some have none, some just fill
 * their eights. */
static void set_lists(struct test *t)
{
    int at = 0, wall = 0;
    for (int e = 0; e < N; e++) {
        t->incidence_begin[e] = at;
        for (int k = e == 7 ? 299 : e == 9 ? 304 : (int)scratch_random(&seed, 0, 20); k > 0; k--)
            t->incidence[at++] = (int)scratch_random(&seed, 0, 2 * N_PAIR);
        while (at % INCIDENCE_ALIGN) t->incidence[at++] = 2 * N_PAIR;
        assert_true(at <= N_INCIDENCE);
        t->wall_begin[e] = wall;
        wall += (int)scratch_random(&seed, 0, 3);
        if (wall > N_AT_WALL) wall = N_AT_WALL;
    }
    t->incidence_begin[N] = at;
    t->wall_begin[N] = wall;
}

static struct test *make(void)
{
    struct test *t = fail_alloc(sizeof *t);
    for (int e = 0; e < N + N_GHOST; e++) set_element(t, e);
    set_lists(t);
    for (int p = 0; p < N_PAIR; p++)
        for (int c = 0; c < RESULT_WIDTH; c++) t->result[p][c] = spread(); /* but the blank one */
    for (int k = 0; k < N_AT_WALL; k++)
        for (int c = 0; c < ROOM; c++) t->wall_result[k][c] = spread();
    for (int e = 0; e < N; e++) {
        double square = 0, q[4];
        for (int c = 0; c < 4; c++) {
            q[c] = any();
            square += q[c] * q[c];
        }
        for (int c = 0; c < 4; c++) t->orientation[e][c] = (real)(q[c] / sqrt(square));
        for (int a = 0; a < 3; a++) t->reference[e][a] = t->element[e].x[a];
        t->reference[e][3] = 1; /* room enough */
    }
    return t;
}

static void to_device(struct test *t)
{
    const struct {
        size_t bytes;
        void *data;
    } array[N_BUFFER] = {{sizeof t->element, t->element},
        {sizeof t->incidence_begin, t->incidence_begin}, {sizeof t->incidence, t->incidence},
        {sizeof t->result, t->result}, {sizeof t->wall_begin, t->wall_begin},
        {sizeof t->wall_result, t->wall_result}, {sizeof t->orientation, t->orientation},
        {sizeof t->force, NULL}, {sizeof t->torque, NULL}, {sizeof t->reference, t->reference},
        {sizeof t->flags, t->flags}};
    struct launch *both[] = {gather, kick_drift};
    for (int b = 0; b < N_BUFFER; b++) {
        fixture_buffer(dev, &t->buffer[b], buffer_name[b], array[b].bytes, array[b].data);
        for (int k = 0; k < 2; k++) launch_bind_buffer_if(both[k], buffer_name[b], &t->buffer[b]);
    }
    for (int k = 0; k < 2; k++) {
        launch_bind_buffer(both[k], "motion", &t->buffer[POSITION]);
        launch_set_int(both[k], "n_owned", N);
        launch_set_real_if(both[k], "radius", radius);
        launch_set_real_if(both[k], "inverse_m", inverse_m);
        launch_set_vector(both[k], "gravity", gravity);
        launch_set_real(both[k], "dt", dt);
        launch_set_real(both[k], "half_dt", 0.5 * dt);
        launch_set_real(both[k], "margin_dt", margin);
    }
}

/* A copy of `from` with one step done: fused (0), observed (1), or observed and then kick_drift
 * (2). */
static struct test *step(const struct test *from, int how)
{
    struct test *t = fail_alloc(sizeof *t);
    memcpy(t, from, sizeof *t);
    to_device(t);
    launch_set_int(gather, "observe", how > 0);
    launch_run(gather, N);
    if (how == 2) launch_run(kick_drift, N);
    buffer_read(&t->buffer[POSITION], 0, sizeof t->element, t->element);
    buffer_read(&t->buffer[ORIENTATION], 0, sizeof t->orientation, t->orientation);
    buffer_read(&t->buffer[FORCE], 0, sizeof t->force, t->force);
    buffer_read(&t->buffer[TORQUE], 0, sizeof t->torque, t->torque);
    buffer_read(&t->buffer[FLAGS], 0, sizeof t->flags, t->flags);
    for (int b = 0; b < N_BUFFER; b++) buffer_free(&t->buffer[b]);
    return t;
}

static void read_records(const struct features *features)
{
    struct reader reader;
    struct buffer pair, wall;
    reading = fail_alloc((2 * N_PAIR + N_AT_WALL) * sizeof *reading);
    fixture_buffer(dev, &pair, "pair results", sizeof start->result, start->result);
    fixture_buffer(dev, &wall, "wall results", sizeof start->wall_result, start->wall_result);
    reader_open(&reader, dev, features);
    reader_read(&reader, &pair, N_PAIR, &wall, N_AT_WALL, reading);
    reader_close(&reader);
    buffer_free(&pair);
    buffer_free(&wall);
}

static void add(real f[3], real torque[3], const struct reading *r)
{
    for (int a = 0; a < 3; a++) {
        f[a] += r->force[a];
        torque[a] += r->torque[a];
    }
}

/* Force and torque of element e: pairs, walls; each in the order of its list. */
static void sums_of(int e, real f[3], real torque[3])
{
    for (int a = 0; a < 3; a++) f[a] = torque[a] = 0;
    for (int k = start->incidence_begin[e]; k < start->incidence_begin[e + 1]; k++)
        if (start->incidence[k] < 2 * N_PAIR) add(f, torque, &reading[start->incidence[k]]);
    for (int k = start->wall_begin[e]; k < start->wall_begin[e + 1] && WITH_WALLS; k++)
        add(f, torque, &reading[2 * N_PAIR + k]);
}

/* (dt/2) (F/m + g) */
static real kick_of(real force, real own_inverse_m, int axis)
{
    return (real)(0.5 * dt) * r_fma(force, own_inverse_m, (real)gravity[axis]);
}

#if WITH_SPIN
/* (dt/2) tau/I, I = 0.4 m r^2 */
static real spun_of(real torque, const struct record *r)
{
    real own = (real)r->radius, inverse_inertia = (real)2.5 * r->inverse_m / (own * own);
    return WITH_ROTATION ? (real)(0.5 * dt) * (inverse_inertia * torque) : (real)0;
}
#endif

static void check_element(const struct test *fused, const struct test *observed, int e)
{
    const struct record *r = &start->element[e], *seen = &observed->element[e],
                        *after = &fused->element[e];
    real f[3], torque[3];
    sums_of(e, f, torque);
    for (int a = 0; a < 3; a++) {
        real kick = kick_of(f[a], r->inverse_m, a), v = r->v[a] + kick, v_next = v + kick;
        preal x = p_fma((preal)dt, (preal)v_next, r->x[a]);
        fixture_same("force", e, observed->force[e][a], f[a]);
        fixture_same("velocity when observed", e, seen->v[a], v);
        fixture_same("velocity", e, after->v[a], v_next);
        fixture_same("place when observed", e, seen->x[a], r->x[a]);
        fixture_same("place", e, after->x[a], x);
#if WITH_SPIN
        real spun = spun_of(torque[a], r), w = r->w[a] + spun, w_next = w + spun;
        fixture_same("torque", e, observed->torque[e][a], torque[a]);
        fixture_same("spin when observed", e, seen->w[a], w);
        fixture_same("spin", e, after->w[a], w_next);
#endif
#if WITH_KICK
        float kept = (float)kick;
        fixture_same("kick", e, after->kick[a], kept);
#endif
#if WITH_SPIN_KICK
        float kept_spun = (float)spun;
        if (WITH_ROTATION) fixture_same("kick of the spin", e, after->spun[a], kept_spun);
#endif
    }
    fixture_same("radius", e, after->radius, r->radius);
    fixture_same("1/m", e, after->inverse_m, r->inverse_m);
#if WITH_SPIN
    fixture_same("material", e, after->material, r->material);
#endif
}

static void leapfrog_in_list_order(void **state)
{
    (void)state;
    struct test *fused = step(start, 0), *observed = step(start, 1);
    for (int e = 0; e < N; e++) check_element(fused, observed, e);
    for (int e = N; e < N + N_GHOST; e++)
        assert_memory_equal(&fused->element[e], &start->element[e], sizeof *fused->element);
    free(fused);
    free(observed);
}

static void fused_is_observed_and_kick_drift(void **state)
{
    (void)state;
    struct test *fused = step(start, 0), *split = step(start, 2);
    assert_memory_equal(fused->element, split->element, sizeof fused->element);
    assert_memory_equal(fused->orientation, split->orientation, sizeof fused->orientation);
    assert_memory_equal(fused->flags, split->flags, sizeof fused->flags);
    free(fused);
    free(split);
}

/* Turned by w dt, to the error |w dt|^3/48 that integrate.h claims, and of unit length. */
static void orientation_turns_with_the_spin(void **state)
{
    (void)state;
#if WITH_ORIENTATION
    double rounding = REAL_IS_FLOAT ? 1e-6 : 1e-15;
    struct test *fused = step(start, 0);
    for (int e = 0; e < N; e++) {
        double w[3], rate = 0, q[4], exact[4], error = 0, square = 0;
        for (int a = 0; a < 3; a++) {
            w[a] = (double)fused->element[e].w[a];
            rate += w[a] * w[a];
        }
        rate = sqrt(rate);
        for (int c = 0; c < 4; c++) q[c] = (double)start->orientation[e][c];
        double angle = rate * dt, s = cos(0.5 * angle), sine = sin(0.5 * angle) / rate;
        double d[3] = {sine * w[0], sine * w[1], sine * w[2]};
        exact[0] = s * q[0] - d[0] * q[1] - d[1] * q[2] - d[2] * q[3];
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            exact[1 + a] = s * q[1 + a] + q[0] * d[a] + d[b] * q[1 + c] - d[c] * q[1 + b];
        }
        for (int c = 0; c < 4; c++) {
            double now = (double)fused->orientation[e][c];
            error += (now - exact[c]) * (now - exact[c]);
            square += now * now;
        }
        /* half the angle in the quaternion; where it begins to differ by the fifth power, that is
         * less than a tenth of the third */
        assert_true(sqrt(error) <= 1.1 * pow(angle, 3) / 96 + 4 * rounding);
        assert_true(fabs(square - 1) < 10 * rounding);
    }
    free(fused);
#endif
}

/* Flags after a step that ends at `moved` of the reference's place and with speed `speed` at
 * element e, room 1. */
static void check_flags(double moved, double speed, bool stale, bool lost)
{
    for (int how = 0; how < 3; how += 2) {
        struct test *t = fail_alloc(sizeof *t);
        memcpy(t, start, sizeof *t);
        memset(t->element[42].v, 0, sizeof t->element[42].v);
        t->element[42].v[1] = (real)speed;
        t->reference[42][0] = t->element[42].x[0] + (preal)moved;
        memset(t->result, 0, sizeof t->result);
        memset(t->wall_result, 0, sizeof t->wall_result);
        for (int e = 0; e < N; e++)
            if (e != 42) t->reference[e][3] = 1e6;
        struct test *after = step(t, how);
        assert_int_equal(after->flags[0], stale);
        assert_int_equal(after->flags[1], lost);
        free(t);
        free(after);
    }
}

static void stale_when_the_room_is_used_up(void **state)
{
    (void)state;
    check_flags(0, 0, false, false);
    check_flags(0.99, 0, false, false);
    check_flags(-1.01, 0, true, false);
    check_flags(0, 320, false, false); /* (dt + margin) v = 0.96 */
    check_flags(0, 345, true, false);  /* 1.035 */
    check_flags((double)NAN, 0, true, false);
    check_flags(0, (double)NAN, true, true);
    check_flags(0, 1e32, true, true);
}

int main(void)
{
    static const char *const sources[] = {"gather.cl", NULL};
    const struct CMUnitTest tests[] = {cmocka_unit_test(leapfrog_in_list_order),
        cmocka_unit_test(fused_is_observed_and_kick_drift),
        cmocka_unit_test(orientation_turns_with_the_spin),
        cmocka_unit_test(stale_when_the_room_is_used_up)};
    struct features features = fixture_features();
    dev = fixture_device();
    struct program *program = fixture_program(dev, &features, FEATURES_BODY, sources);
    gather = launch_create(program, "gather");
    kick_drift = launch_create(program, "kick_drift");
    start = make();
    read_records(&features);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    free(start);
    free(reading);
    launch_free(gather);
    launch_free(kick_drift);
    program_free(program);
    device_free(dev);
    return failed;
}
