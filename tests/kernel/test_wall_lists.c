/* Walls' candidates, kept triangles, the passing on of friction over a mesh, and histories through
 * a list build; each against the host. Two meshes, one of them in motion, a plane, a rectangle, a
 * cylinder, a box, and a wall that is not there yet. Compiled in double and in single, see
 * meson.build. */
#include "lists_fixture.h"

#include "../walls/wall_reference.h"
#include "kernels/contact/contact_memory.h"
#include "comm/fail.h"
#include "particle/owners_message.h"

enum { N = 700, GRID = 5, N_TRIANGLE = 2 * GRID * GRID, N_WALL = 7, STEP_NOW = 3 };
enum { N_PRIMITIVE = 2 * N_TRIANGLE + 10 };
static const double radius = 0.3, dt = 1e-3;
static struct lists lists;
static struct wall wall[N_WALL];
static struct scene scene;
static struct walls *walls;
static struct program *force;
static struct comm *comm;
static struct wall_contacts *contacts;
static uint64_t seed = 31;

static double uniform(double low, double high)
{
    return scratch_random(&seed, low, high);
}

/* A rough sheet over GRID x GRID cells: ridges and valleys everywhere. */
static char *sheet(void)
{
    static const int cut[2][6] = {{0, 1, 3, 0, 3, 2}, {0, 1, 2, 1, 3, 2}};
    double point[GRID + 1][GRID + 1][3], corner[9 * N_TRIANGLE], *at = corner;
    for (int i = 0; i <= GRID; i++)
        for (int j = 0; j <= GRID; j++) {
            point[i][j][0] = i + uniform(-0.3, 0.3);
            point[i][j][1] = j + uniform(-0.3, 0.3);
            point[i][j][2] = uniform(-0.2, 0.2);
        }
    for (int i = 0; i < GRID; i++)
        for (int j = 0; j < GRID; j++)
            for (int k = 0; k < 6; k++, at += 3) {
                int which = cut[(i + j) % 2][k];
                memcpy(at, point[i + (which & 1)][j + (which >> 1)], 3 * sizeof *at);
            }
    return scratch_stl(corner, N_TRIANGLE);
}

static void make_walls(void)
{
    static const enum surface_kind kind[N_WALL] = {SURFACE_STL, SURFACE_PLANE, SURFACE_STL,
        SURFACE_RECTANGLE, SURFACE_CYLINDER, SURFACE_BOX, SURFACE_RECTANGLE};
    struct scene_errors errors = {0};
    for (int w = 0; w < N_WALL; w++) {
        wall[w] = scratch_wall(kind[w]);
        if (kind[w] == SURFACE_STL) wall[w].stl = sheet();
        wall[w].size[0] = wall[w].size[1] = 2;
        wall[w].point[2] = -0.3;
        for (int a = 0; a < 3; a++) {
            wall[w].max[a] = a < 2 ? 5.2 : 1;
            wall[w].min[a] = -0.6;
        }
        wall[w].to[0] = 5;
        wall[w].radius = 0.5;
        wall[w].inside = true;
    }
    wall[2].velocity[2] = 100; /* with STEP_NOW and dt: above the first one */
    wall[2].rotation_rate = 3;
    wall[2].rotation_axis[2] = 0.8;
    wall[2].rotation_axis[1] = 0.6;
    wall[6].appear_at = 1;
    scene = scratch_scene(wall, N_WALL);
    walls = walls_create(&scene, &errors);
    assert_non_null(walls);
    assert_int_equal(walls->n_primitive, N_PRIMITIVE);
}

static struct wall_frame frame_of(int w)
{
    const double *r = wall_contacts_pose(contacts, STEP_NOW)[w].rotation,
                 *t = wall_contacts_pose(contacts, STEP_NOW)[w].translation;
    struct wall_frame f = {p3((preal)r[0], (preal)r[1], (preal)r[2]),
        p3((preal)r[3], (preal)r[4], (preal)r[5]), p3((preal)r[6], (preal)r[7], (preal)r[8]),
        p3((preal)t[0], (preal)t[1], (preal)t[2])};
    return f;
}

static struct wall_primitive primitive_of(int k)
{
    preal row[WALL_PRIMITIVE_WIDTH];
    for (int c = 0; c < WALL_PRIMITIVE_WIDTH; c++)
        row[c] = (preal)walls->primitive[WALL_PRIMITIVE_WIDTH * k + c];
    return WALL_PRIMITIVE(row, 0);
}

static pvec3 centre(const struct crowd *c, int e)
{
    return p3(c->element[e].x[0], c->element[e].x[1], c->element[e].x[2]);
}

static struct wall_closest closest_of(const struct crowd *c, int e, int k)
{
    return wall_closest_moved(primitive_of(k), frame_of(walls->wall_of[k]), centre(c, e));
}

/* Over the sheets, mostly nearer than a radius to some triangle. */
static struct crowd make(void)
{
    struct crowd c = crowd_create(N, N);
    for (int e = 0; e < N; e++) {
        for (int a = 0; a < 3; a++)
            c.element[e].x[a] = (preal)(a < 2 ? uniform(-0.3, 5.3) : uniform(-0.5, 0.8));
        c.element[e].radius = (preal)radius;
        c.reach[e] = (preal)uniform(radius, 1.3 * radius);
        c.gid[e] = 7919 * (int64_t)(e + 1) % 10007;
    }
    return c;
}

static void build(const struct crowd *c)
{
    static const double box[6] = {-1, -1, -1, 6, 6, 2};
    struct particles *p = lists.particles;
    p->n_owned = c->n_owned;
    p->n_ghost = 0;
    particles_reserve(p, &lists.features, c->n_all, 0);
    buffer_write(&p->field[FIELD_STATE].now, 0, (size_t)c->n_all * sizeof *c->element, c->element);
    buffer_write(&p->reach, 0, (size_t)c->n_all * sizeof *c->reach, c->reach);
    wall_contacts_set_step(contacts, STEP_NOW);
    wall_contacts_build(contacts, lists.scan, p, STEP_NOW, 2, box);
}

/* What the device has: candidates of element e are begin[e] <= k < begin[e + 1]. */
struct found {
    int *begin, *candidate, *element, *partner, *state;
    real *history, *keep;
};

static struct found read_found(void)
{
    struct wall_list *l = &contacts->now;
    size_t bytes = (size_t)(l->capacity * contacts->layout.history) * sizeof(real);
    struct found f = {lists_ints(&l->begin, N + 1), lists_ints(&l->candidate, l->n),
        lists_ints(&l->element, l->n), lists_ints(&contacts->partner, l->n),
        lists_ints(&l->state, l->capacity), fail_alloc(bytes),
        fail_alloc((size_t)l->n * sizeof(real))};
    buffer_read(&l->history, 0, bytes, f.history);
    buffer_read(&contacts->keep, 0, (size_t)l->n * sizeof(real), f.keep);
    return f;
}

static void free_found(struct found *f)
{
    void *all[] = {f->begin, f->candidate, f->element, f->partner, f->state, f->history, f->keep};
    for (int k = 0; k < 7; k++) free(all[k]);
}

static void candidates_within_reach(void **unused)
{
    (void)unused;
    struct crowd c = make();
    build(&c);
    struct found f = read_found();
    int at = 0;
    for (int e = 0; e < N; e++) {
        assert_int_equal(f.begin[e], at);
        for (int k = 0; k < walls->n_primitive; k++) {
            int w = walls->wall_of[k];
            double room = contacts->room_host[w];
            assert_true((room < 0) == (w == 6) && (room > 0) == (w == 2));
            preal far = c.reach[e] + (preal)room;
            if (walls->features[6 * k] >= 0) far += (FILLET_REACH - (preal)1) * c.element[e].radius;
            if (room < 0 ||
                !(wall_closest(primitive_of(k), wall_to_reference(frame_of(w), centre(&c, e)))
                        .distance < far))
                continue;
            assert_true(at < contacts->now.n && f.candidate[at] == k && f.element[at] == e);
            at++;
        }
    }
    assert_int_equal(contacts->now.n, at);
    assert_true(at > 5 * N);
    free_found(&f);
    crowd_free(&c);
}

/* What the rules of law_wall.h and law_fillet.h make of the candidates of one element. */
static int contacts_of(
    const struct crowd *c, const struct found *f, int e, struct reference_contact *out)
{
    const preal *at = c->element[e].x;
    double x[3] = {(double)at[0], (double)at[1], (double)at[2]};
    return reference_contacts(walls, wall_contacts_pose(contacts, STEP_NOW), x,
        (double)c->element[e].radius, f->candidate + f->begin[e], f->begin[e + 1] - f->begin[e],
        out);
}

/* The local minima, their shares and partners. */
static void one_contact_per_minimum(void **unused)
{
    (void)unused;
    struct crowd c = make();
    int n_kept = 0, n_dropped = 0, n_shared = 0, n_left = 0, n_valley = 0;
    build(&c);
    wall_contacts_select(contacts, lists.particles);
    struct found f = read_found();
    struct reference_contact minimum[N_PRIMITIVE];
    for (int e = 0; e < N; e++) {
        int n = contacts_of(&c, &f, e, minimum);
        for (int k = f.begin[e], m = 0; k < f.begin[e + 1]; k++) {
            bool wanted = m < n && minimum[m].primitive == f.candidate[k];
            real share = wanted ? (real)minimum[m].share : -1;
            int other = wanted ? minimum[m].partner : -1;
            fixture_same("share", k, f.keep[k], share);
            assert_int_equal(f.partner[k] < 0 ? -1 : f.candidate[f.partner[k]],
                other < 0 ? -1 : minimum[other].primitive);
            n_kept += wanted;
            n_dropped += !wanted;
            n_shared += share > 0 && share < 1;
            n_left += wanted && !(share > 0);
            n_valley += other >= 0;
            m += wanted;
        }
    }
    assert_true(n_kept > N && n_dropped > N && n_left > 20 && n_shared > 10 && n_valley > 10);
    free_found(&f);
    crowd_free(&c);
}

/* Numbers that tell which contact a history is of. */
static real history_of(int64_t gid, int primitive, int plane)
{
    return (real)(1 + (gid * 149 + primitive * 7 + plane) % 99991);
}

static void write_histories(const struct crowd *c, struct found *f)
{
    struct wall_list *l = &contacts->now;
    for (int64_t k = 0; k < l->n; k++) {
        f->state[k] = uniform(0, 1) < 0.5 ? CONTACT_TOUCHING : 0;
        for (int p = 0; p < contacts->layout.history; p++)
            f->history[p * l->capacity + k] =
                f->state[k] ? history_of(c->gid[f->element[k]], f->candidate[k], p) : 0;
    }
    buffer_write(&l->state, 0, (size_t)l->capacity * sizeof *f->state, f->state);
    buffer_write(&l->history, 0,
        (size_t)(l->capacity * contacts->layout.history) * sizeof *f->history, f->history);
}

/* Who gives its history to t, or -1, as law_wall.h says; state: as it is when its turn comes. */
static int giver_of(const struct crowd *c, const struct found *f, int e, int t, const int *state,
    const struct reference_contact *minimum, int n)
{
    struct wall_closest own = closest_of(c, e, f->candidate[t]), other;
    preal own_radius = c->element[e].radius, best = 0;
    int giver = -1;
    if (!reference_is_flat(walls, f->candidate[t]) || state[t] != 0 ||
        !reference_acts(minimum, n, f->candidate[t], own_radius))
        return -1;
    for (int s = f->begin[e]; s < f->begin[e + 1]; s++) {
        if (state[s] == 0 || !reference_is_flat(walls, f->candidate[s]) ||
            reference_acts(minimum, n, f->candidate[s], own_radius))
            continue;
        other = closest_of(c, e, f->candidate[s]);
        preal cosine = p3_dot(other.n, own.n);
        if (!wall_hands_over(other, own,
                walls->wall_of[f->candidate[s]] == walls->wall_of[f->candidate[t]], own_radius) ||
            !(cosine > best))
            continue;
        best = cosine;
        giver = s;
    }
    return giver;
}

static void friction_goes_over_the_mesh(void **unused)
{
    (void)unused;
    struct crowd c = make();
    int n_passed = 0, n_stayed = 0;
    build(&c);
    struct found before = read_found();
    write_histories(&c, &before);
    wall_contacts_select(contacts, lists.particles);
    struct found f = read_found();
    int *state = fail_alloc((size_t)contacts->now.capacity * sizeof *state),
        *from = fail_alloc((size_t)contacts->now.capacity * sizeof *from);
    memcpy(state, before.state, (size_t)contacts->now.capacity * sizeof *state);
    for (int k = 0; k < contacts->now.n; k++) from[k] = state[k] ? k : -1;
    struct reference_contact minimum[N_PRIMITIVE];
    for (int e = 0; e < N; e++) {
        int n = contacts_of(&c, &f, e, minimum);
        for (int t = f.begin[e]; t < f.begin[e + 1]; t++) {
            int giver = giver_of(&c, &f, e, t, state, minimum, n);
            if (giver < 0) continue;
            state[t] = state[giver];
            state[giver] = 0;
            from[t] = from[giver];
            from[giver] = -1;
            n_passed++;
        }
    }
    for (int k = 0; k < contacts->now.n; k++) {
        assert_int_equal(f.state[k], state[k]);
        n_stayed += from[k] == k;
        for (int p = 0; p < contacts->layout.history; p++) {
            real wanted =
                from[k] < 0 ? 0 : history_of(c.gid[f.element[k]], f.candidate[from[k]], p);
            fixture_same("history", k, f.history[p * contacts->now.capacity + k], wanted);
        }
    }
    assert_true(n_passed > 50 && n_stayed > N);
    free(state);
    free(from);
    free_found(&before);
    free_found(&f);
    crowd_free(&c);
}

/* Elements in another order, moved a little, a hundred of them as if they came from another rank
 * with their contacts. */
static void histories_follow_their_contacts(void **unused)
{
    (void)unused;
    enum { LEAVE = 100 };
    struct crowd c = make(), moved = crowd_create(N, N);
    struct owners_contacts leaving;
    struct buffer index, old_index;
    int from[N], leave[LEAVE], old[N], n_kept = 0;
    build(&c);
    struct found before = read_found();
    write_histories(&c, &before);
    for (int e = 0; e < N; e++) {
        from[e] = 11 * e % N; /* N = 700 has no factor of 11 */
        moved.element[e] = c.element[from[e]];
        moved.element[e].x[1] += (preal)uniform(-0.05, 0.05);
        moved.reach[e] = c.reach[from[e]];
        moved.gid[e] = c.gid[from[e]];
        old[e] = from[e] < LEAVE ? N + from[e] : from[e];
    }
    for (int k = 0; k < LEAVE; k++) leave[k] = k;
    fixture_buffer(lists.dev, &index, "index", sizeof leave, leave);
    fixture_buffer(lists.dev, &old_index, "old index", sizeof old, old);
    owners_pick_walls(&leaving, lists.scan, &index, LEAVE, contacts);
    owners_store_walls(contacts, &leaving, LEAVE);
    build(&moved);
    wall_contacts_carry(contacts, &old_index);
    struct found f = read_found();
    for (int e = 0; e < N; e++)
        for (int k = f.begin[e], q = before.begin[from[e]]; k < f.begin[e + 1]; k++) {
            while (q < before.begin[from[e] + 1] && before.candidate[q] < f.candidate[k]) q++;
            int state = q < before.begin[from[e] + 1] && before.candidate[q] == f.candidate[k]
                            ? before.state[q]
                            : 0;
            assert_int_equal(f.state[k], state);
            n_kept += state != 0;
            for (int p = 0; p < contacts->layout.history; p++) {
                real wanted = state ? history_of(moved.gid[e], f.candidate[k], p) : 0;
                fixture_same("history", k, f.history[p * contacts->now.capacity + k], wanted);
            }
        }
    assert_true(n_kept > N && n_kept < contacts->now.n - N);
    void *part[] = {leaving.begin, leaving.key, leaving.state, leaving.history};
    for (int k = 0; k < 4; k++) free(part[k]);
    buffer_free(&index);
    buffer_free(&old_index);
    free_found(&before);
    free_found(&f);
    crowd_free(&c);
    crowd_free(&moved);
}

int main(int argc, char **argv)
{
    static const char *const sources[] = {"wall_lists.cl", "wall_keep.cl", "layout.cl", NULL};
    const struct CMUnitTest tests[] = {cmocka_unit_test(candidates_within_reach),
        cmocka_unit_test(one_contact_per_minimum), cmocka_unit_test(friction_goes_over_the_mesh),
        cmocka_unit_test(histories_follow_their_contacts)};
    comm = comm_create(&argc, &argv);
    make_walls();
    lists_open(&lists);
    force = fixture_program(lists.dev, &lists.features, FEATURES_WALL, sources);
    contacts = wall_contacts_create(&(struct wall_setup){.comm = comm,
        .features = &lists.features,
        .scene = &scene,
        .walls = walls,
        .dt = dt,
        .program = force});
    assert_int_equal(contacts->layout.history, HISTORY_WIDTH);
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    wall_contacts_free(contacts);
    program_free(force);
    lists_close(&lists);
    walls_free(walls);
    scratch_remove(wall[0].stl);
    scratch_remove(wall[2].stl);
    comm_free(comm);
    return failed;
}
