/* wall_force against contact_law on the host, bit for bit, over several steps: every kind of
 * primitive that the flags have, at rest or in motion, touching, parting, bonded, far away.
 * Compiled once for each set of features and each precision, see meson.build. */
#include "contact_scene.h"
#include "comm/fail.h"
#include "kernels/contact/law_wall.h"
#include "record_reader.h"

/* The geometry of walls in motion is written for tables in device memory; everything it includes
 * has been included, for the host. */
#define __OPENCL_VERSION__ 120
#define __global
#include "kernels/particle/wall_geometry.h"
#undef __OPENCL_VERSION__

enum {
    N_ELEMENT = 600,
    N_CANDIDATE = 900,
    CAPACITY = 912,
    N_WALL = 6,
    N_PRIMITIVE = 40,
    N_STEP = 5,
    RESULT_ROOM = 16
};
static const double radius = 2e-3;
static uint64_t seed = 4;

struct test {
    struct device *dev;
    struct contact_scene contacts;
    struct record element[N_ELEMENT];
    preal primitive[N_PRIMITIVE][WALL_PRIMITIVE_WIDTH], pose[N_WALL][POSE_WIDTH];
    int wall_of[N_PRIMITIVE], wall_material[N_WALL], candidate[N_CANDIDATE],
        of_element[N_CANDIDATE], keep[N_CANDIDATE], state[CAPACITY];
    real history[(HISTORY_WIDTH + 1) * CAPACITY];
    double ledger[LEDGER_WIDTH * CAPACITY]; /* of the host */
    double row[N_MATERIAL * N_MATERIAL][TABLE_WIDTH];
    struct buffer buffer[13];
    struct launch *launch;
    struct reader reader;
    int n_touching, n_apart, n_ended, n_begun;
};

static double any(void)
{
    return scratch_random(&seed, -1, 1);
}

/* Two perpendicular unit vectors into b and c. */
static void set_axes(preal *b, preal *c)
{
    double r[9];
    scratch_rotation(&seed, r);
    for (int a = 0; a < 3; a++) {
        b[a] = (preal)r[a];
        c[a] = (preal)r[3 + a];
    }
}

static void set_primitive(struct test *t, int k)
{
    int kinds[5], n_kind = 0;
    if (WITH_PLANE) kinds[n_kind++] = WALL_PLANE;
    if (WITH_RECTANGLE) kinds[n_kind++] = WALL_RECTANGLE;
    if (WITH_CYLINDER) kinds[n_kind++] = WALL_PIPE;
    if (WITH_CYLINDER) kinds[n_kind++] = WALL_ROD;
    if (WITH_TRIANGLE) kinds[n_kind++] = WALL_TRIANGLE;
    preal *row = t->primitive[k];
    int kind = kinds[k % n_kind];
    for (int a = 0; a < 3; a++) row[a] = (preal)(0.05 * any());
    set_axes(row + 3, row + 6);
    for (int a = 3; a < 9 && kind == WALL_TRIANGLE; a++) row[a] = (preal)(0.05 * any());
    row[9] = (preal)(0.01 + 0.005 * any());
    row[10] = (preal)(0.02 + 0.01 * any());
    row[11] = (preal)kind;
    t->wall_of[k] = k % N_WALL;
}

static void set_poses(struct test *t)
{
    for (int w = 0; w < N_WALL; w++) {
        double turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        if (WITH_MOVING) scratch_rotation(&seed, turn);
        for (int c = 0; c < 9; c++) t->pose[w][c] = (preal)turn[c];
        for (int c = 9; c < POSE_WIDTH; c++) t->pose[w][c] = WITH_MOVING ? (preal)any() : 0;
        for (int a = 9; a < 12; a++) t->pose[w][a] *= (preal)0.1;
        for (int a = 15; a < 18; a++) t->pose[w][a] *= (preal)100;
        t->pose[w][21] = 1;
        t->wall_material[w] = WITH_TABLE ? w % N_MATERIAL : 0;
    }
}

static struct wall_primitive primitive_of(const struct test *t, int k)
{
    return WALL_PRIMITIVE(&t->primitive[0][0], k);
}

/* Somewhere near a primitive, then along the normal to where it touches or nearly does. */
static void set_element(struct test *t, int e)
{
    struct record *r = &t->element[e];
    int k = (int)scratch_random(&seed, 0, N_PRIMITIVE), material = WITH_MATERIALS && any() < 0;
    double own = WITH_SIZES ? radius * (2 + any()) / 2 : radius,
           gap = e % 10 == 9 ? 0.3 * radius * any() : 2e-5 * any();
    struct wall_frame frame = pose_frame(t->pose[t->wall_of[k]]);
    pvec3 q = p3((preal)(t->primitive[k][0] + (preal)(0.02 * any())),
        (preal)(t->primitive[k][1] + (preal)(0.02 * any())),
        (preal)(t->primitive[k][2] + (preal)(0.02 * any())));
    struct wall_closest c = wall_closest(primitive_of(t, k), q);
    pvec3 x = wall_to_world(frame, p3_fma(c.distance - (preal)(own + gap), c.n, q));
    memset(r, 0, sizeof *r);
    r->radius = (preal)own;
    r->inverse_m = (real)(1 / (t->contacts.material[material].density * 4.18879 * own * own * own));
    r->x[0] = x.x;
    r->x[1] = x.y;
    r->x[2] = x.z;
    for (int a = 0; a < 3; a++) {
        r->v[a] = (real)(any() + (double)t->pose[t->wall_of[k]][12 + a]);
#if WITH_SPIN
        r->w[a] = (real)(100 * any());
#endif
    }
#if WITH_SPIN
    r->material = (real)material;
#endif
    t->candidate[e] = k;
    t->of_element[e] = e;
}

static void set_candidate(struct test *t, int k)
{
    if (k >= N_ELEMENT) { /* further ones, mostly far away */
        t->of_element[k] = (int)scratch_random(&seed, 0, N_ELEMENT);
        t->candidate[k] = (int)scratch_random(&seed, 0, N_PRIMITIVE);
    }
    t->keep[k] = any() > -0.8;
    if (!WITH_HISTORY || k % 3 == 1) return;
    t->state[k] = CONTACT_TOUCHING | (WITH_BINDING ? CONTACT_BONDED : 0);
    for (int c = 0; c < 3; c++) {
        if (WITH_TANGENTIAL) t->history[(XI_AT + c) * CAPACITY + k] = (real)(1e-5 * any());
        if (WITH_ROLLING_EPSD) t->history[(THETA_AT + c) * CAPACITY + k] = (real)(1e-3 * any());
        if (WITH_WALL_WORK) t->history[(WALL_FORCE_AT + c) * CAPACITY + k] = (real)(0.1 * any());
    }
}

static void set_state(struct test *t)
{
    contact_scene_init(&t->contacts);
    set_poses(t);
    for (int k = 0; k < N_PRIMITIVE; k++) set_primitive(t, k);
    for (int e = 0; e < N_ELEMENT; e++) set_element(t, e);
    for (int k = 0; k < N_CANDIDATE; k++) set_candidate(t, k);
    for (int a = 0; a < N_MATERIAL; a++)
        for (int b = 0; b < N_MATERIAL; b++)
            contact_scene_row(&t->contacts, a, b, true, radius, 1 / (double)t->element[0].inverse_m,
                t->row[N_MATERIAL * a + b]);
}

static void set_arguments(struct test *t)
{
    struct device *dev = t->dev;
    struct launch *k = t->launch;
    real table[N_MATERIAL * N_MATERIAL][TABLE_WIDTH];
    for (int r = 0; r < N_MATERIAL * N_MATERIAL; r++)
        for (int c = 0; c < TABLE_WIDTH; c++) table[r][c] = (real)t->row[r][c];
    const struct {
        const char *name;
        size_t bytes;
        const void *data;
    } array[] = {{"position", sizeof t->element, NULL},
        {"candidate", sizeof t->candidate, t->candidate},
        {"candidate_element", sizeof t->of_element, t->of_element},
        {"primitive", sizeof t->primitive, t->primitive},
        {"wall_of", sizeof t->wall_of, t->wall_of}, {"pose", sizeof t->pose, NULL},
        {"keep", sizeof t->keep, t->keep}, {"state", sizeof t->state, t->state},
        {"history", sizeof t->history, t->history}, {"ledger", sizeof t->ledger, t->ledger},
        {"wall_material", sizeof t->wall_material, t->wall_material},
        {"table", sizeof table, table}, {"result", RESULT_ROOM * CAPACITY * sizeof(real), NULL}};
    for (int b = 0; b < 13; b++)
        fixture_bind(dev, k, &t->buffer[b], array[b].name, array[b].bytes, array[b].data);
    launch_bind_buffer(k, "motion", &t->buffer[0]);
    launch_set_int(k, "n_candidate", N_CANDIDATE);
    launch_set_int(k, "capacity", CAPACITY);
    launch_set_int_if(k, "n_material", N_MATERIAL);
    if (!launch_has(k, "table")) contact_table_set(k, t->row[0]);
    launch_set_real(k, "dt", STEP);
}

struct host_contact {
    struct contact_kinematics k;
    struct contact_result r;
    struct contact_history h;
    vec3 v_wall;
};

static struct host_contact law_of(const struct test *t, int c)
{
    const struct record *e = &t->element[t->of_element[c]];
    struct wall_primitive w = primitive_of(t, t->candidate[c]);
    int wall = t->wall_of[t->candidate[c]], row = 0;
    pvec3 x = p3(e->x[0], e->x[1], e->x[2]);
    vec3 v = v3(e->v[0], e->v[1], e->v[2]), spin = v3(0, 0, 0);
    real own = (real)e->radius;
    struct host_contact host;
#if WITH_SPIN
    spin = v3(e->w[0], e->w[1], e->w[2]);
    if (WITH_MATERIALS) row = N_MATERIAL * (int)e->material;
#endif
    if (WITH_TABLE) row += t->wall_material[wall];
    struct contact_parameters q;
    if (WITH_SIZES)
        q = contact_parameters_of(
            contact_scene_material(t->row[row]), contact_pair_wall(e->inverse_m, own), (real)STEP);
    else q = contact_scene_parameters(t->row[row]);
    struct wall_geometry g = WITH_MOVING ? wall_geometry_moving(w, x, v, t->pose[wall], (real)STEP)
                                         : wall_geometry(w, x, v, (real)STEP);
    host.h = contact_scene_history(t->state, t->history, CAPACITY, (size_t)c);
    if (WITH_TRIANGLE && !t->keep[c]) {
        g.distance = 2 * (preal)own; /* out of reach */
        host.h.state = 0;
    }
    host.v_wall = g.v;
    host.k = contact_kinematics_wall(
        g.n, g.n_half, own - (real)g.distance, own - (real)g.distance_half, v, g.v, spin, own);
    host.r = contact_law(host.k, q, (real)STEP, &host.h);
    return host;
}

/* A wall's work: mean of the force of the step before and of now, along the way of the wall. */
static void check_work(
    const struct test *t, const real *history, int c, struct host_contact host, double *ledger)
{
    vec3 before = contact_scene_plane(t->history, CAPACITY, (size_t)c, WALL_FORCE_AT);
    contact_scene_same("force that the wall remembers", c,
        contact_scene_plane(history, CAPACITY, (size_t)c, WALL_FORCE_AT), host.r.force);
    ledger[LEDGER_WORK] +=
        (double)((real)0.5 * (real)STEP * v3_dot(v3_add(before, host.r.force), host.v_wall));
}

static void check_candidate(struct test *t, int c, const struct reading *reading, const int *state,
    const real *history, const double *ledger, struct host_contact host)
{
    double own[LEDGER_WIDTH];
    const real *f = reading->force, *torque = reading->torque;
    /* zeros are added, so that -0 is 0 as in gather */
    vec3 zero = v3(0, 0, 0), expected = v3_fma(host.k.l_i, host.r.couple, host.r.moment);
    contact_scene_same("force", c, v3(f[0], f[1], f[2]), v3_add(zero, host.r.force));
    if (WITH_ROTATION)
        contact_scene_same(
            "torque", c, v3(torque[0], torque[1], torque[2]), v3_add(zero, expected));
    contact_scene_check_history(state, history, CAPACITY, (size_t)c, host.h);
    if (!WITH_ENERGY) return;
    for (int k = 0; k < LEDGER_WIDTH; k++) own[k] = t->ledger[k * CAPACITY + c];
    contact_scene_ledger(host.r, own);
    if (WITH_WALL_WORK) check_work(t, history, c, host, own);
    for (int k = 0; k < LEDGER_WIDTH; k++) {
        t->ledger[k * CAPACITY + c] = own[k];
        fixture_same("ledger", c, ledger[k * CAPACITY + c], own[k]);
    }
}

static void check_step(struct test *t)
{
    static struct reading reading[N_CANDIDATE];
    static real history[(HISTORY_WIDTH + 1) * CAPACITY];
    static double ledger[LEDGER_WIDTH * CAPACITY];
    static int state[CAPACITY];
    buffer_write(t->dev, &t->buffer[0], 0, sizeof t->element, t->element);
    buffer_write(t->dev, &t->buffer[5], 0, sizeof t->pose, t->pose);
    launch_run(t->launch, t->dev->compute, N_CANDIDATE, 0, NULL, NULL);
    reader_read(&t->reader, NULL, 0, &t->buffer[12], N_CANDIDATE, reading);
    buffer_read(t->dev, &t->buffer[7], 0, sizeof state, state);
    buffer_read(t->dev, &t->buffer[8], 0, sizeof history, history);
    buffer_read(t->dev, &t->buffer[9], 0, sizeof ledger, ledger);
    for (int c = 0; c < N_CANDIDATE; c++) {
        struct host_contact host = law_of(t, c);
        check_candidate(t, c, reading + c, state, history, ledger, host);
        t->n_touching += host.h.state != 0;
        t->n_apart += host.h.state == 0;
        t->n_ended += t->state[c] != 0 && host.h.state == 0;
        t->n_begun += t->state[c] == 0 && host.h.state != 0;
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
    for (int w = 0; w < N_WALL && WITH_MOVING; w++)
        for (int a = 0; a < 3; a++) t->pose[w][9 + a] += (preal)STEP * t->pose[w][12 + a];
}

static void check_law(bool one_lane)
{
    static const char *const sources[] = {"wall_force.cl", NULL};
    struct features features = fixture_features();
    struct test *t = fail_alloc(sizeof *t);
    t->dev = fixture_device();
    t->dev->one_lane = one_lane;
    struct program *program = fixture_program(t->dev, &features, FEATURES_WALL, sources);
    t->launch = launch_create(program, "wall_force");
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
    for (int k = 0; k < 13; k++) buffer_free(t->dev, &t->buffer[k]);
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
