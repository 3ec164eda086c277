/* pair_force against contact_law on the host, bit for bit, over several steps: pairs that touch,
 * part, are bonded, are far from each other or coincide; in both ways of going over a batch.
 * Compiled once for each set of features and each precision, see meson.build. */
#include "force_fixture.h"

enum {
    N_PAIR = 700,
    N_INTERIOR = 333,
    FIRST_BOUNDARY = 384,
    N_ELEMENT = 2 * N_PAIR,
    CAPACITY = 720
};
static const double radius = 2e-3, period[3] = {0.11, 0.12, 0.13};

struct test {
    struct force_run f;
    struct record element[N_ELEMENT];
    int pair_i[CAPACITY], pair_j[CAPACITY], state[CAPACITY];
    real history[(HISTORY_WIDTH + 1) * CAPACITY];
    double ledger[LEDGER_WIDTH * CAPACITY]; /* of the host */
};

static bool is_pair(int p)
{
    return p < N_INTERIOR || p >= FIRST_BOUNDARY;
}

/* Puts j where it touches i or nearly does; beyond a periodic boundary at times. */
static void place_pair(struct test *t, int p)
{
    struct record *i = &t->element[t->pair_i[p]], *j = &t->element[t->pair_j[p]];
    static const bool periodic[3] = {WITH_PERIODIC_X, WITH_PERIODIC_Y, WITH_PERIODIC_Z};
    double d[3], length, gap = p % 10 == 9 ? 0.5 * radius * force_any() : 2e-5 * force_any();
    do {
        for (int a = 0; a < 3; a++) d[a] = force_any();
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

/* Elements anywhere, then pairs of them in any order. */
static void set_state(struct test *t)
{
    int shuffled[N_PAIR];
    for (int e = 0; e < N_ELEMENT; e++) {
        force_element(&t->f, &t->element[e], radius);
        for (int a = 0; a < 3; a++) t->element[e].x[a] = (preal)(period[a] * force_between(0, 1));
    }
    for (int p = 0; p < N_PAIR; p++) shuffled[p] = p;
    for (int p = N_PAIR - 1; p > 0; p--) {
        int q = (int)force_between(0, p + 1), swap = shuffled[p];
        shuffled[p] = shuffled[q];
        shuffled[q] = swap;
    }
    for (int p = 0; p < N_PAIR; p++) {
        t->pair_i[p] = 2 * shuffled[p];
        t->pair_j[p] = 2 * shuffled[p] + 1;
        place_pair(t, p);
        if (is_pair(p)) force_history(t->state, t->history, CAPACITY, (size_t)p);
    }
    /* somewhere else */
    for (int p = 0; p < N_PAIR; p += 20) t->pair_j[p] = (int)force_between(0, N_ELEMENT);
}

static void set_arguments(struct test *t)
{
    static const char *const axis[3] = {"period_x", "period_y", "period_z"};
    struct force_run *f = &t->f;
    const struct {
        const char *name;
        size_t bytes;
        const void *data;
    } array[] = {{"position", sizeof t->element, NULL}, {"pair_i", sizeof t->pair_i, t->pair_i},
        {"pair_j", sizeof t->pair_j, t->pair_j}, {"state", sizeof t->state, t->state},
        {"history", sizeof t->history, t->history}, {"ledger", sizeof t->ledger, t->ledger},
        {"table", sizeof f->table, f->table},
        {"result", RESULT_WIDTH * (CAPACITY + 1) * sizeof(real), NULL}};
    for (size_t b = 0; b < sizeof array / sizeof *array; b++)
        fixture_bind(
            f->dev, f->launch, &f->buffer[b], array[b].name, array[b].bytes, array[b].data);
    launch_bind_buffer(f->launch, "motion", &f->buffer[0]);
    launch_set_int(f->launch, "capacity", CAPACITY);
    for (int a = 0; a < 3; a++) launch_set_real_if(f->launch, axis[a], period[a]);
    launch_set_real_if(f->launch, "radius", radius);
}

static void set(struct force_run *f)
{
    struct test *t = (struct test *)f;
    set_state(t);
    force_parameters(f, false, radius, 1 / (double)t->element[0].inverse_m);
    set_arguments(t);
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
    int row = 0;
#if WITH_SPIN
    row = WITH_MATERIALS ? N_MATERIAL * (int)i->material + (int)j->material : 0;
#endif
    pvec3 D = nearest_images(p3(j->x[0] - i->x[0], j->x[1] - i->x[1], j->x[2] - i->x[2]),
        (preal)period[0], (preal)period[1], (preal)period[2]);
    struct contact_parameters q;
    if (WITH_SIZES)
        q = contact_parameters_of(material_load(t->f.row[row]),
            contact_pair_of(i->inverse_m, j->inverse_m, (real)i->radius, (real)j->radius),
            (real)STEP);
    else q = parameters_load(t->f.row[row]);
    struct kinematics_motion m = force_motion(i, j);
    m.radius_lever = parameters_radius_lever(q);
    host.k = contact_kinematics_pair(D, m, (real)i->radius, (real)j->radius, (real)STEP);
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
    struct force_run *f = &t->f;
    static const int range[2][2] = {{0, N_INTERIOR}, {FIRST_BOUNDARY, N_PAIR}};
    memset(result, 0x5a, RESULT_WIDTH * CAPACITY * sizeof *result);
    memset(result + RESULT_WIDTH * CAPACITY, 0, RESULT_WIDTH * sizeof *result); /* for the reader */
    buffer_write(&f->buffer[7], 0, RESULT_WIDTH * (CAPACITY + 1) * sizeof *result, result);
    buffer_write(&f->buffer[0], 0, sizeof t->element, t->element);
    for (int k = 0; k < 2; k++) {
        launch_set_int(f->launch, "first", range[k][0]);
        launch_set_int(f->launch, "end", range[k][1]);
        launch_run(f->launch, range[k][1] - range[k][0]);
    }
    buffer_read(&f->buffer[7], 0, RESULT_WIDTH * CAPACITY * sizeof *result, result);
}

/* What lies between and behind the pairs is nobody's to touch. */
static void check_gap(const real *result, int p)
{
    const unsigned char *byte = (const unsigned char *)(result + RESULT_WIDTH * p);
    for (size_t k = 0; k < RESULT_WIDTH * sizeof *result; k++) assert_int_equal(byte[k], 0x5a);
}

static void check(struct force_run *f)
{
    static real result[RESULT_WIDTH * (CAPACITY + 1)], history[(HISTORY_WIDTH + 1) * CAPACITY];
    static double ledger[LEDGER_WIDTH * CAPACITY];
    static int state[CAPACITY];
    static struct reading reading[2 * CAPACITY];
    struct test *t = (struct test *)f;
    run(t, result);
    reader_read(&f->reader, &f->buffer[7], CAPACITY, NULL, 0, reading);
    buffer_read(&f->buffer[3], 0, sizeof state, state);
    buffer_read(&f->buffer[4], 0, sizeof history, history);
    buffer_read(&f->buffer[5], 0, sizeof ledger, ledger);
    for (int p = 0; p < CAPACITY; p++) {
        if (p >= N_PAIR || !is_pair(p)) {
            check_gap(result, p);
            assert_int_equal(state[p], t->state[p]);
            continue;
        }
        struct host_pair host = law_of(t, p);
        check_record(p, reading + 2 * p, host);
        contact_scene_check_history(state, history, CAPACITY, (size_t)p, host.h);
        force_check_ledger(ledger, t->ledger, CAPACITY, (size_t)p, host.r, 0);
        force_count(f, t->state[p], host.h.state);
    }
    memcpy(t->state, state, sizeof state);
    memcpy(t->history, history, sizeof history);
}

static void move(struct force_run *f)
{
    force_move(((struct test *)f)->element, N_ELEMENT);
}

int main(int argc, char **argv)
{
    static const struct force_test test = {
        "pair_force.cl", "pair_force", FEATURES_PAIR, sizeof(struct test), 20, set, check, move};
    return force_main(&test, argc, argv);
}
