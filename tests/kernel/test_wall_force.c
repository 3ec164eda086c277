/* wall_force against contact_law on the host, bit for bit, over several steps: every kind of
 * primitive that the flags have, at rest or in motion, touching, parting, bonded, far away.
 * Compiled once for each set of features and each precision, see meson.build. */
#include "force_fixture.h"
#include "kernels/contact/law_wall.h"

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
    RESULT_ROOM = 16
};
static const double radius = 2e-3;

struct test {
    struct force_run f;
    struct record element[N_ELEMENT];
    preal primitive[N_PRIMITIVE][WALL_PRIMITIVE_WIDTH], pose[N_WALL][POSE_WIDTH];
    int wall_of[N_PRIMITIVE], wall_material[N_WALL], candidate[N_CANDIDATE],
        of_element[N_CANDIDATE], partner[N_CANDIDATE], state[CAPACITY];
    real keep[N_CANDIDATE];
    preal near[N_CANDIDATE][NEAR_WIDTH];
    real history[(HISTORY_WIDTH + 1) * CAPACITY];
    double ledger[LEDGER_WIDTH * CAPACITY]; /* of the host */
};

/* Two perpendicular unit vectors into b and c. */
static void set_axes(preal *b, preal *c)
{
    double r[9];
    force_rotation(r);
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
    for (int a = 0; a < 3; a++) row[a] = (preal)(0.05 * force_any());
    set_axes(row + 3, row + 6);
    for (int a = 3; a < 9 && kind == WALL_TRIANGLE; a++) row[a] = (preal)(0.05 * force_any());
    row[9] = (preal)(0.01 + 0.005 * force_any());
    row[10] = (preal)(0.02 + 0.01 * force_any());
    row[11] = (preal)kind;
    t->wall_of[k] = k % N_WALL;
}

static void set_poses(struct test *t)
{
    for (int w = 0; w < N_WALL; w++) {
        double turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        if (WITH_MOVING) force_rotation(turn);
        for (int c = 0; c < 9; c++) t->pose[w][c] = (preal)turn[c];
        for (int c = 9; c < POSE_WIDTH; c++) t->pose[w][c] = WITH_MOVING ? (preal)force_any() : 0;
        for (int a = 9; a < 12; a++) t->pose[w][a] *= (preal)0.1;
        for (int a = 15; a < 18; a++) t->pose[w][a] *= (preal)100;
        for (int a = 25; a < 28; a++) t->pose[w][a] *= (preal)100;
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
    int k = (int)force_between(0, N_PRIMITIVE);
    double gap = e % 10 == 9 ? 0.3 * radius * force_any() : 2e-5 * force_any();
    struct wall_frame frame = pose_frame(t->pose[t->wall_of[k]]);
    preal q[3];
    force_element(&t->f, r, radius);
    for (int a = 0; a < 3; a++) q[a] = t->primitive[k][a] + (preal)(0.02 * force_any());
    pvec3 near = p3(q[0], q[1], q[2]);
    struct wall_closest c = wall_closest(primitive_of(t, k), near);
    pvec3 x = wall_to_world(frame, p3_fma(c.distance - (r->radius + (preal)gap), c.n, near));
    r->x[0] = x.x;
    r->x[1] = x.y;
    r->x[2] = x.z;
    for (int a = 0; a < 3; a++) r->v[a] += (real)t->pose[t->wall_of[k]][12 + a];
    t->candidate[e] = k;
    t->of_element[e] = e;
}

/* Every second one forms a valley with a plane that is tilted a little and about as near. */
static void set_partner(struct test *t, int k)
{
    const struct record *e = &t->element[t->of_element[k]];
    struct wall_frame frame = pose_frame(t->pose[t->wall_of[t->candidate[k]]]);
    struct wall_closest c =
        wall_closest_moved(primitive_of(t, t->candidate[k]), frame, p3(e->x[0], e->x[1], e->x[2]));
    double n[3], square = 0;
    for (int a = 0; a < 3; a++) {
        n[a] = (double)(a == 0 ? c.n.x : a == 1 ? c.n.y : c.n.z) + 0.1 * force_any();
        square += n[a] * n[a];
    }
    t->partner[k] = k % 2 ? k : -1;
    for (int a = 0; a < 3; a++) t->near[k][a] = (preal)(n[a] / sqrt(square));
    t->near[k][3] = c.distance + (preal)(1e-6 * force_any());
    /* no ball that fits, a tight hollow, or a wide one */
    t->near[k][4] = (preal)(radius * (0.9 + 0.1 * (double)(k / 2 % 4)));
}

static void set_candidate(struct test *t, int k)
{
    if (k >= N_ELEMENT) { /* further ones, mostly far away */
        t->of_element[k] = (int)force_between(0, N_ELEMENT);
        t->candidate[k] = (int)force_between(0, N_PRIMITIVE);
    }
    t->keep[k] = force_any() > -0.8 ? (real)force_between(0.1, 2) : (real)(k % 2 - 1);
    if (t->keep[k] > 1) t->keep[k] = 1;
    set_partner(t, k);
    force_history(t->state, t->history, CAPACITY, (size_t)k);
    for (int c = 0; c < 3 && WITH_WALL_WORK && t->state[k]; c++)
        t->history[(WALL_FORCE_AT + c) * CAPACITY + k] = (real)(0.1 * force_any());
}

static void set_arguments(struct test *t)
{
    struct force_run *f = &t->f;
    const struct {
        const char *name;
        size_t bytes;
        const void *data;
    } array[FORCE_BUFFERS] = {{"position", sizeof t->element, NULL},
        {"candidate", sizeof t->candidate, t->candidate},
        {"candidate_element", sizeof t->of_element, t->of_element},
        {"primitive", sizeof t->primitive, t->primitive},
        {"wall_of", sizeof t->wall_of, t->wall_of}, {"pose", sizeof t->pose, NULL},
        {"keep", sizeof t->keep, t->keep}, {"state", sizeof t->state, t->state},
        {"history", sizeof t->history, t->history}, {"ledger", sizeof t->ledger, t->ledger},
        {"wall_material", sizeof t->wall_material, t->wall_material},
        {"table", sizeof f->table, f->table},
        {"result", RESULT_ROOM * CAPACITY * sizeof(real), NULL},
        {"partner", sizeof t->partner, t->partner}, {"near", sizeof t->near, t->near}};
    for (int b = 0; b < FORCE_BUFFERS; b++)
        fixture_bind(
            f->dev, f->launch, &f->buffer[b], array[b].name, array[b].bytes, array[b].data);
    launch_bind_buffer(f->launch, "motion", &f->buffer[0]);
    launch_set_int(f->launch, "n_candidate", N_CANDIDATE);
    launch_set_int(f->launch, "capacity", CAPACITY);
}

static void set(struct force_run *f)
{
    struct test *t = (struct test *)f;
    set_poses(t);
    for (int k = 0; k < N_PRIMITIVE; k++) set_primitive(t, k);
    for (int e = 0; e < N_ELEMENT; e++) set_element(t, e);
    for (int k = 0; k < N_CANDIDATE; k++) set_candidate(t, k);
    force_parameters(f, true, radius, 1 / (double)t->element[0].inverse_m);
    set_arguments(t);
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
    struct kinematics_motion m = force_motion(e, NULL);
    vec3 v = m.v;
    real own = (real)e->radius;
    struct host_contact host;
#if WITH_SPIN
    if (WITH_MATERIALS) row = N_MATERIAL * (int)e->material;
#endif
    if (WITH_TABLE) row += t->wall_material[wall];
    struct contact_parameters q;
    if (WITH_SIZES)
        q = contact_parameters_of(
            material_load(t->f.row[row]), contact_pair_wall(e->inverse_m, own), (real)STEP);
    else q = parameters_load(t->f.row[row]);
    struct wall_geometry g = WITH_MOVING ? wall_geometry_moving(w, x, v, t->pose[wall], (real)STEP)
                                         : wall_geometry(w, x, v, (real)STEP);
    host.h = contact_scene_history(t->state, t->history, CAPACITY, (size_t)c);
    if (WITH_TRIANGLE && t->partner[c] >= 0) {
        const preal *near = t->near[t->partner[c]];
        g = wall_geometry_valley(
            g, fillet_plane(p3(near[0], near[1], near[2]), near[3], near[4]), v, own, (real)STEP);
    }
    bool counts = !WITH_TRIANGLE || t->keep[c] > 0;
    if (!counts) {
        g.distance = 2 * (preal)own; /* out of reach */
        host.h.state = 0;
    }
    host.v_wall = g.v;
    m.v = v3_sub(m.v, g.v);
    m.kick = v3_sub(m.kick, g.kick);
    m.radius_lever = parameters_radius_lever(q);
    host.k = contact_kinematics_wall(
        g.n, g.n_half, own - (real)g.distance, own - (real)g.distance_half, m, own);
    host.r = contact_law(host.k, q, (real)STEP, &host.h);
    if (WITH_TRIANGLE && counts) host.r = contact_result_share(host.r, t->keep[c]);
    return host;
}

/* A wall's work: mean of the force of the step before and of now, along the way of the wall. */
static double work_of(const struct test *t, const real *history, int c, struct host_contact host)
{
    if (!WITH_WALL_WORK) return 0;
    vec3 before = contact_scene_plane(t->history, CAPACITY, (size_t)c, WALL_FORCE_AT);
    contact_scene_same("force that the wall remembers", c,
        contact_scene_plane(history, CAPACITY, (size_t)c, WALL_FORCE_AT), host.r.force);
    return (double)((real)0.5 * (real)STEP * v3_dot(v3_add(before, host.r.force), host.v_wall));
}

static void check_candidate(struct test *t, int c, const struct reading *reading, const int *state,
    const real *history, const double *ledger, struct host_contact host)
{
    const real *f = reading->force, *torque = reading->torque;
    /* zeros are added, so that -0 is 0 as in gather */
    vec3 zero = v3(0, 0, 0), expected = v3_fma(host.k.l_i, host.r.couple, host.r.moment);
    contact_scene_same("force", c, v3(f[0], f[1], f[2]), v3_add(zero, host.r.force));
    if (WITH_ROTATION)
        contact_scene_same(
            "torque", c, v3(torque[0], torque[1], torque[2]), v3_add(zero, expected));
    contact_scene_check_history(state, history, CAPACITY, (size_t)c, host.h);
    force_check_ledger(
        ledger, t->ledger, CAPACITY, (size_t)c, host.r, work_of(t, history, c, host));
}

static void check(struct force_run *f)
{
    static struct reading reading[N_CANDIDATE];
    static real history[(HISTORY_WIDTH + 1) * CAPACITY];
    static double ledger[LEDGER_WIDTH * CAPACITY];
    static int state[CAPACITY];
    struct test *t = (struct test *)f;
    buffer_write(&f->buffer[0], 0, sizeof t->element, t->element);
    buffer_write(&f->buffer[5], 0, sizeof t->pose, t->pose);
    launch_run(f->launch, N_CANDIDATE);
    reader_read(&f->reader, NULL, 0, &f->buffer[12], N_CANDIDATE, reading);
    buffer_read(&f->buffer[7], 0, sizeof state, state);
    buffer_read(&f->buffer[8], 0, sizeof history, history);
    buffer_read(&f->buffer[9], 0, sizeof ledger, ledger);
    for (int c = 0; c < N_CANDIDATE; c++) {
        struct host_contact host = law_of(t, c);
        check_candidate(t, c, reading + c, state, history, ledger, host);
        force_count(f, t->state[c], host.h.state);
    }
    memcpy(t->state, state, sizeof state);
    memcpy(t->history, history, sizeof history);
}

static void move(struct force_run *f)
{
    struct test *t = (struct test *)f;
    force_move(t->element, N_ELEMENT);
    for (int w = 0; w < N_WALL && WITH_MOVING; w++)
        for (int a = 0; a < 3; a++) t->pose[w][9 + a] += (preal)STEP * t->pose[w][12 + a];
}

int main(int argc, char **argv)
{
    static const struct force_test test = {
        "wall_force.cl", "wall_force", FEATURES_WALL, sizeof(struct test), 4, set, check, move};
    return force_main(&test, argc, argv);
}
