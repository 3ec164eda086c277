/* pair_force against contact_law on the host, bit for bit, over several steps: pairs that touch,
 * part, are bonded, are far from each other or coincide; in both ways of going over a batch.
 * Compiled once for each set of features and each precision, see meson.build. */
#include "contact_scene.h"
#include "comm/fail.h"
#include "record_reader.h"

enum {
    N_PAIR = 700,
    N_INTERIOR = 333,
    FIRST_BOUNDARY = 384,
    N_ELEMENT = 2 * N_PAIR,
    CAPACITY = 720,
    N_STEP = 5
};
static const double radius = 2e-3, period[3] = {0.11, 0.12, 0.13};
static uint64_t seed = 20;

struct test {
    struct device *dev;
    struct contact_scene contacts;
    struct record element[N_ELEMENT];
    int pair_i[CAPACITY], pair_j[CAPACITY], state[CAPACITY];
    real history[(HISTORY_WIDTH + 1) * CAPACITY];
    double ledger[LEDGER_WIDTH * CAPACITY]; /* of the host */
    double row[N_MATERIAL * N_MATERIAL][TABLE_WIDTH];
    struct buffer buffer[8];
    struct launch *launch;
    struct reader reader;
    int n_touching, n_apart, n_ended, n_begun;
};

static double any(void)
{
    return scratch_random(&seed, -1, 1);
}

static bool is_pair(int p)
{
    return p < N_INTERIOR || p >= FIRST_BOUNDARY;
}

static void set_element(struct test *t, int e)
{
    struct record *r = &t->element[e];
    int material = WITH_MATERIALS && any() < 0;
    double own = WITH_SIZES ? radius * (2 + any()) / 2 : radius;
    memset(r, 0, sizeof *r);
    r->radius = (preal)own;
    r->inverse_m = (real)(1 / (t->contacts.material[material].density * 4.18879 * own * own * own));
    for (int a = 0; a < 3; a++) {
        r->x[a] = (preal)(period[a] * scratch_random(&seed, 0, 1));
        r->v[a] = (real)any();
#if WITH_SPIN
        r->w[a] = (real)(100 * any());
#endif
    }
#if WITH_SPIN
    r->material = (real)material;
#endif
}

/* Puts j where it touches i or nearly does; beyond a periodic boundary at times. */
static void place_pair(struct test *t, int p)
{
    struct record *i = &t->element[t->pair_i[p]], *j = &t->element[t->pair_j[p]];
    static const bool periodic[3] = {WITH_PERIODIC_X, WITH_PERIODIC_Y, WITH_PERIODIC_Z};
    double d[3], length, gap = p % 10 == 9 ? 0.5 * radius * any() : 2e-5 * any();
    do {
        for (int a = 0; a < 3; a++) d[a] = any();
        length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    } while (length < 0.1);
    /* a few coincide */
    double apart = p % 100 == 50 ? 0 : (double)i->radius + (double)j->radius + gap;
    for (int a = 0; a < 3; a++) {
        double x = (double)i->x[a] + apart * d[a] / length;
        if (periodic[a] && p % 3 == 0) x += x < 0.5 * period[a] ? period[a] : -period[a];
        j->x[a] = (preal)x;
    }
}

/* A third begins without a history, the others with one such as pairs may have. */
static void set_history(struct test *t, int p)
{
    t->state[p] = 0;
    if (!WITH_HISTORY || !is_pair(p) || p % 3 == 1) return;
    t->state[p] = CONTACT_TOUCHING | (WITH_BINDING ? CONTACT_BONDED : 0);
    for (int c = 0; c < 3; c++) {
        if (WITH_TANGENTIAL) t->history[(XI_AT + c) * CAPACITY + p] = (real)(1e-5 * any());
        if (WITH_ROLLING_EPSD) t->history[(THETA_AT + c) * CAPACITY + p] = (real)(1e-3 * any());
    }
}

static void set_state(struct test *t)
{
    int shuffled[N_PAIR];
    contact_scene_init(&t->contacts);
    for (int e = 0; e < N_ELEMENT; e++) set_element(t, e);
    for (int p = 0; p < N_PAIR; p++) shuffled[p] = p;
    for (int p = N_PAIR - 1; p > 0; p--) {
        int q = (int)scratch_random(&seed, 0, p + 1), swap = shuffled[p];
        shuffled[p] = shuffled[q];
        shuffled[q] = swap;
    }
    for (int p = 0; p < N_PAIR; p++) {
        t->pair_i[p] = 2 * shuffled[p];
        t->pair_j[p] = 2 * shuffled[p] + 1;
        place_pair(t, p);
        set_history(t, p);
    }
    /* somewhere else */
    for (int p = 0; p < N_PAIR; p += 20) t->pair_j[p] = (int)scratch_random(&seed, 0, N_ELEMENT);
    for (int a = 0; a < N_MATERIAL; a++)
        for (int b = 0; b < N_MATERIAL; b++)
            contact_scene_row(&t->contacts, a, b, false, radius,
                1 / (double)t->element[0].inverse_m, t->row[N_MATERIAL * a + b]);
}

static void set_arguments(struct test *t)
{
    struct device *dev = t->dev;
    struct launch *k = t->launch;
    static const char *const axis[3] = {"period_x", "period_y", "period_z"};
    real table[N_MATERIAL * N_MATERIAL][TABLE_WIDTH];
    for (int r = 0; r < N_MATERIAL * N_MATERIAL; r++)
        for (int c = 0; c < TABLE_WIDTH; c++) table[r][c] = (real)t->row[r][c];
    fixture_bind(dev, k, &t->buffer[0], "position", sizeof t->element, NULL);
    launch_bind_buffer(k, "motion", &t->buffer[0]);
    fixture_bind(dev, k, &t->buffer[1], "pair_i", sizeof t->pair_i, t->pair_i);
    fixture_bind(dev, k, &t->buffer[2], "pair_j", sizeof t->pair_j, t->pair_j);
    fixture_bind(dev, k, &t->buffer[3], "state", sizeof t->state, t->state);
    fixture_bind(dev, k, &t->buffer[4], "history", sizeof t->history, t->history);
    fixture_bind(dev, k, &t->buffer[5], "ledger", sizeof t->ledger, t->ledger);
    fixture_bind(dev, k, &t->buffer[6], "table", sizeof table, table);
    fixture_bind(
        dev, k, &t->buffer[7], "result", RESULT_WIDTH * (CAPACITY + 1) * sizeof(real), NULL);
    launch_set_int(k, "capacity", CAPACITY);
    launch_set_int_if(k, "n_material", N_MATERIAL);
    for (int a = 0; a < 3; a++) launch_set_real_if(k, axis[a], period[a]);
    if (!launch_has(k, "table")) contact_table_set(k, t->row[0]);
    launch_set_real_if(k, "radius", radius);
    launch_set_real(k, "dt", STEP);
}

struct host_pair {
    struct contact_kinematics k;
    struct contact_result r;
    struct contact_history h;
};

static struct host_pair law_of(const struct test *t, int p)
{
    const struct record *i = &t->element[t->pair_i[p]], *j = &t->element[t->pair_j[p]];
    struct host_pair host;
    vec3 w_i = v3(0, 0, 0), w_j = w_i;
    int row = 0;
#if WITH_SPIN
    w_i = v3(i->w[0], i->w[1], i->w[2]);
    w_j = v3(j->w[0], j->w[1], j->w[2]);
    row = WITH_MATERIALS ? N_MATERIAL * (int)i->material + (int)j->material : 0;
#endif
    pvec3 D = nearest_images(p3(j->x[0] - i->x[0], j->x[1] - i->x[1], j->x[2] - i->x[2]),
        (preal)period[0], (preal)period[1], (preal)period[2]);
    struct contact_parameters q;
    if (WITH_SIZES)
        q = contact_parameters_of(contact_scene_material(t->row[row]),
            contact_pair_of(i->inverse_m, j->inverse_m, (real)i->radius, (real)j->radius),
            (real)STEP);
    else q = contact_scene_parameters(t->row[row]);
    host.k = contact_kinematics_pair(D, v3(i->v[0], i->v[1], i->v[2]),
        v3(j->v[0], j->v[1], j->v[2]), w_i, w_j, (real)i->radius, (real)j->radius, (real)STEP);
    host.h = contact_scene_history(t->state, t->history, CAPACITY, (size_t)p);
    host.r = contact_law(host.k, q, (real)STEP, &host.h);
    return host;
}

/* What gather makes of the record, on both sides. Zeros are added, so that -0 is 0 as there. */
static void check_record(int p, const struct reading *side, struct host_pair host)
{
    vec3 zero = v3(0, 0, 0), f = host.r.force;
    vec3 ti = v3_fma(host.k.l_i, host.r.couple, host.r.moment),
         tj = v3_fma(host.k.l_j, host.r.couple, v3_neg(host.r.moment));
    contact_scene_same(
        "force on i", p, v3(side[0].force[0], side[0].force[1], side[0].force[2]), v3_add(zero, f));
    contact_scene_same(
        "force on j", p, v3(side[1].force[0], side[1].force[1], side[1].force[2]), v3_sub(zero, f));
    if (!WITH_ROTATION) return;
    contact_scene_same("torque on i", p,
        v3(side[0].torque[0], side[0].torque[1], side[0].torque[2]), v3_add(zero, ti));
    contact_scene_same("torque on j", p,
        v3(side[1].torque[0], side[1].torque[1], side[1].torque[2]), v3_add(zero, tj));
}

static void run(struct test *t, real *result)
{
    static const int range[2][2] = {{0, N_INTERIOR}, {FIRST_BOUNDARY, N_PAIR}};
    memset(result, 0x5a, RESULT_WIDTH * CAPACITY * sizeof *result);
    memset(result + RESULT_WIDTH * CAPACITY, 0, RESULT_WIDTH * sizeof *result); /* for the reader */
    buffer_write(t->dev, &t->buffer[7], 0, RESULT_WIDTH * (CAPACITY + 1) * sizeof *result, result);
    buffer_write(t->dev, &t->buffer[0], 0, sizeof t->element, t->element);
    for (int k = 0; k < 2; k++) {
        launch_set_int(t->launch, "first", range[k][0]);
        launch_set_int(t->launch, "end", range[k][1]);
        launch_run(t->launch, t->dev->compute, range[k][1] - range[k][0], 0, NULL, NULL);
    }
    buffer_read(t->dev, &t->buffer[7], 0, RESULT_WIDTH * CAPACITY * sizeof *result, result);
}

/* What lies between and behind the pairs is nobody's to touch. */
static void check_gap(const real *result, int p)
{
    const unsigned char *byte = (const unsigned char *)(result + RESULT_WIDTH * p);
    for (size_t k = 0; k < RESULT_WIDTH * sizeof *result; k++) assert_int_equal(byte[k], 0x5a);
}

static void check_step(struct test *t)
{
    static real result[RESULT_WIDTH * (CAPACITY + 1)], history[(HISTORY_WIDTH + 1) * CAPACITY];
    static double ledger[LEDGER_WIDTH * CAPACITY];
    static int state[CAPACITY];
    static struct reading reading[2 * CAPACITY];
    run(t, result);
    reader_read(&t->reader, &t->buffer[7], CAPACITY, NULL, 0, reading);
    buffer_read(t->dev, &t->buffer[3], 0, sizeof state, state);
    buffer_read(t->dev, &t->buffer[4], 0, sizeof history, history);
    buffer_read(t->dev, &t->buffer[5], 0, sizeof ledger, ledger);
    for (int p = 0; p < CAPACITY; p++) {
        if (p >= N_PAIR || !is_pair(p)) {
            check_gap(result, p);
            assert_int_equal(state[p], t->state[p]);
            continue;
        }
        struct host_pair host = law_of(t, p);
        double own[LEDGER_WIDTH];
        check_record(p, reading + 2 * p, host);
        contact_scene_check_history(state, history, CAPACITY, (size_t)p, host.h);
        for (int c = 0; c < LEDGER_WIDTH; c++) own[c] = t->ledger[c * CAPACITY + p];
        if (WITH_ENERGY) contact_scene_ledger(host.r, own);
        for (int c = 0; c < LEDGER_WIDTH; c++) {
            t->ledger[c * CAPACITY + p] = own[c];
            if (WITH_ENERGY) fixture_same("ledger", p, ledger[c * CAPACITY + p], own[c]);
        }
        t->n_touching += host.h.state != 0;
        t->n_apart += host.h.state == 0;
        t->n_ended += t->state[p] != 0 && host.h.state == 0;
        t->n_begun += t->state[p] == 0 && host.h.state != 0;
    }
    memcpy(t->state, state, sizeof state);
    memcpy(t->history, history, sizeof history);
}

static void move(struct test *t)
{
    for (int e = 0; e < N_ELEMENT; e++)
        for (int a = 0; a < 3; a++) {
            t->element[e].x[a] += (preal)STEP * (preal)t->element[e].v[a];
            t->element[e].v[a] += (real)(0.1 * any());
        }
}

static void check_law(bool one_lane)
{
    static const char *const sources[] = {"pair_force.cl", NULL};
    struct features features = fixture_features();
    struct test *t = fail_alloc(sizeof *t);
    t->dev = fixture_device();
    t->dev->one_lane = one_lane;
    struct program *program = fixture_program(t->dev, &features, FEATURES_PAIR, sources);
    t->launch = launch_create(program, "pair_force");
    launch_set_batch(t->launch, BATCH);
    reader_open(&t->reader, t->dev, &features);
    set_state(t);
    set_arguments(t);
    for (int step = 0; step < N_STEP; step++) {
        check_step(t);
        move(t);
    }
    /* all kinds were there */
    assert_true(t->n_touching > 500 && t->n_apart > 300 && t->n_begun > 20);
    if (WITH_HISTORY) assert_true(t->n_ended > 20);
    reader_close(&t->reader);
    launch_free(t->launch);
    program_free(program);
    for (int k = 0; k < 8; k++) buffer_free(t->dev, &t->buffer[k]);
    device_free(t->dev);
    free(t);
}

static void batch_by_one_lane(void **unused)
{
    (void)unused;
    check_law(true);
}

static void batch_by_many_lanes(void **unused)
{
    (void)unused;
    check_law(false);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(batch_by_one_lane), cmocka_unit_test(batch_by_many_lanes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
