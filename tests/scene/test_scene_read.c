/* Good scenes: every value where it belongs, defaults, and the resolved text, which reads back to
 * the same scene. */
#include "scene_fixture.h"

#include <math.h>

#include "laws/restitution.h"

#define ASSERT_VECTOR(v, x, y, z) assert_true((v)[0] == (x) && (v)[1] == (y) && (v)[2] == (z))

static void v_funnel(void **state)
{
    struct fixture *f = *state;
    fixture_copy(f, "v_funnel.yaml");
    struct scene *s = fixture_read(f, NULL, 0);
    assert_string_equal(s->name, "v_funnel");
    assert_string_equal(s->title, "mortar V-funnel");
    assert_int_equal(s->method, METHOD_PARTICLES);
    assert_int_equal(s->precision, PRECISION_DOUBLE);
    assert_true(s->time.end == 3.3 && s->time.step == 1e-5 && s->time.safety == 0.8 &&
                !s->time.allow_unstable);
    ASSERT_VECTOR(s->gravity, 0, 0, -9.81);
    assert_int_equal(s->n_material, 2);
    assert_string_equal(s->material[1].name, "steel");
    assert_true(s->material[0].density == 2200 && s->material[0].young == 0);
    assert_int_equal(s->n_contact, 2);
    const struct contact *c = &s->contact[0];
    assert_true(c->between[0] == 0 && c->between[1] == 0 && c->normal_law == NORMAL_LINEAR &&
                c->stiffness == 1000);
    assert_true(c->damping_ratio == 0.02 && c->restitution < 0 && c->attraction);
    assert_true(c->has_tangential && c->stiffness_ratio == 0.8 && c->tangential_damping == 0 &&
                c->friction == 0.2);
    assert_true(
        c->rolling == ROLLING_NONE && c->binding_force == 5e-3 && s->contact[1].binding_force == 0);
    assert_int_equal(s->n_group, 1);
    const struct element_group *g = &s->group[0];
    assert_true(g->material == 0 && g->diameter[0] == 0.005 && g->diameter[1] == 0.005 &&
                !g->from_file && g->line == 25);
    assert_true(g->region.kind == REGION_STL && g->region.scale == 1e-3 && g->count == 10600 &&
                g->jitter == 0.05 && g->seed == 1);
    char *stl = fail_format("%s/filling.stl", f->folder);
    assert_string_equal(g->region.stl, stl);
    free(stl);
    assert_int_equal(s->n_wall, 2);
    assert_true(s->wall[0].kind == SURFACE_STL && s->wall[0].remove_at == HUGE_VAL &&
                s->wall[0].appear_at == 0);
    assert_true(s->wall[1].kind == SURFACE_RECTANGLE && s->wall[1].size[1] == 0.032 &&
                s->wall[1].remove_at == 0.3);
    assert_true(s->domain.remove_outside && !s->domain.has_box && !s->domain.periodic[2]);
    assert_true(s->partition.every == 1000 && s->partition.threshold == 0.1 &&
                s->partition.boundary == CUT_PAIRS_BOTH);
    assert_true(
        s->output.every == 0.02 && s->output.n_field == 4 && s->output.checkpoint_every == 0);
    assert_string_equal(s->output.field[3], "coordination");
    assert_int_equal(s->n_measure, 2);
    assert_true(s->measure[0].kind == MEASURE_COUNT && s->measure[0].every == 1e-3 &&
                s->measure[0].below[2] == 0);
    assert_true(s->measure[0].below[0] == HUGE_VAL && s->measure[0].above[2] == -HUGE_VAL &&
                s->measure[1].kind == MEASURE_ENERGY);
    scene_free(s);
}

static void everything_contacts(const struct scene *s)
{
    const struct contact *c = s->contact;
    assert_true(s->material[0].density == 2500 && s->material[0].young == 48e9 &&
                s->material[0].poisson == 0.2);
    assert_true(c[0].normal_law == NORMAL_HERTZ && c[0].restitution == 0.5 &&
                c[0].damping_ratio == restitution_damping(0.5, true));
    assert_true(c[0].has_tangential && c[0].stiffness_ratio < 0 && c[0].friction == 0.3 &&
                c[0].tangential_damping == 0.1 && c[0].damping_factor < 0);
    assert_true(c[0].damping_mass == DAMPING_MASS_CENTRE && c[0].slip == SLIP_SPRING &&
                c[0].lever == LEVER_CONTACT && c[0].cap == CAP_COMPRESSION && !c[0].rescale);
    assert_true(c[1].damping_factor == 0.5 && c[1].tangential_damping == 0 &&
                c[1].slip == SLIP_WHOLE && c[1].lever == LEVER_RADIUS &&
                c[1].cap == CAP_MAGNITUDE && c[1].rescale);
    assert_true(c[0].rolling == ROLLING_EPSD && c[0].rolling_friction == 0.05 &&
                c[0].rolling_damping == 0.3 && c[0].rolling_stiffness == 3);
    assert_true(c[0].binding_force == 2e-3);
    assert_true(c[1].between[0] == 1 && c[1].between[1] == 0 && !c[1].attraction &&
                c[1].damping_ratio == restitution_damping(0.5, false));
    assert_true(c[1].rolling == ROLLING_CDT && c[1].rolling_friction == 0.01 &&
                c[1].rolling_stiffness == 2.25);
    assert_true(!c[2].has_tangential && c[2].stiffness == 0 && c[2].damping_ratio == 0 &&
                c[2].rolling == ROLLING_NONE);
}

static void everything_walls(const struct scene *s)
{
    const struct wall *w = s->wall;
    assert_int_equal(w[0].kind, SURFACE_PLANE);
    ASSERT_VECTOR(w[0].point, 0, 0, -1e-3);
    ASSERT_VECTOR(w[0].normal, 0, 0, 1);
    ASSERT_VECTOR(w[1].normal, 0, 3.0 / 5, 4.0 / 5);
    ASSERT_VECTOR(w[1].velocity, 1, 0, 0);
    assert_true(w[1].appear_at == 1e-3 && w[1].remove_at == 0.3 && w[1].rotation_rate == 0);
    ASSERT_VECTOR(w[1].rotation_axis, 0, 0, 1);
    assert_int_equal(w[2].kind, SURFACE_BOX);
    ASSERT_VECTOR(w[2].max, 1, 1, 1);
    ASSERT_VECTOR(w[2].amplitude, 1e-3, 0, 0);
    assert_true(w[2].frequency == 50 && fabs(w[2].phase - acos(0.0)) < 1e-15);
    assert_true(
        w[3].kind == SURFACE_CYLINDER && !w[3].inside && w[3].radius == 0.1 && w[3].to[1] == 1);
    ASSERT_VECTOR(w[3].rotation_axis, 0, -1, 0);
    ASSERT_VECTOR(w[3].rotation_center, 0, 0, 1);
    assert_true(fabs(w[3].rotation_rate - 2 * acos(0.0)) < 1e-15);
    assert_true(w[4].kind == SURFACE_STL && w[4].scale == 1e-3 && w[4].line > w[3].line);
}

static void everything(void **state)
{
    struct fixture *f = *state;
    fixture_copy(f, "everything.yaml");
    struct scene *s = fixture_read(f, NULL, 0);
    assert_string_equal(s->title, "all: of \"it\" # ü");
    assert_true(s->time.end == 120 && s->time.step == 0 && s->time.safety == 0.5 &&
                s->time.allow_unstable && s->precision == PRECISION_MIXED);
    ASSERT_VECTOR(s->gravity, 0.01, 0, -9.81);
    everything_contacts(s);
    everything_walls(s);
    const struct element_group *g = s->group;
    assert_true(g[0].diameter[0] == 1e-3 && g[0].diameter[1] == 2e-3 &&
                g[0].region.kind == REGION_BOX && g[0].count == 1000 && g[0].seed == 7);
    ASSERT_VECTOR(g[0].angular_velocity, 1, 2, 3);
    assert_true(g[1].diameter[0] == 2e-3 && g[1].diameter[1] == 2e-3 &&
                g[1].region.kind == REGION_CYLINDER && g[1].count == 0);
    assert_true(g[2].diameter[0] == 2e-3 && g[2].diameter[1] == 6e-3 && g[2].region.scale == 0.01);
    assert_true(g[3].from_file && g[3].file && g[3].material == 0);
    assert_true(s->domain.periodic[0] && !s->domain.periodic[1] && s->domain.periodic[2] &&
                s->domain.has_box && s->domain.max[0] == 2);
    assert_true(s->partition.boundary == CUT_PAIRS_ASSIGNED);
    assert_true(s->partition.every == 500 && s->partition.threshold == 0.2 &&
                s->output.checkpoint_every == 1 && s->output.n_field == 3);
    const struct measure *m = s->measure;
    assert_true(m[0].below[2] == 0 && m[0].above[0] == -0.01 && m[2].kind == MEASURE_MOMENTUM &&
                m[2].every == 2e-3);
    assert_true(m[3].kind == MEASURE_WALL_FORCE && m[3].wall == 3 && m[4].kind == MEASURE_PROBE &&
                m[4].element == 42);
    scene_free(s);
}

/* The resolved text, written to another folder, gives the same text, hash and values. */
static void check_round_trip(struct fixture *f, const char *name)
{
    fixture_copy(f, name);
    struct scene *first = fixture_read(f, NULL, 0);
    char *folder = fail_format("%s/elsewhere", f->folder);
    assert_int_equal(mkdir(folder, 0700), 0);
    free(folder);
    fixture_write(f, "elsewhere/resolved.yaml", first->resolved, strlen(first->resolved));
    struct scene *second = fixture_read(f, NULL, 0);
    assert_string_equal(first->resolved, second->resolved);
    assert_int_equal(first->hash, second->hash);
    assert_memory_equal(&first->time, &second->time, sizeof first->time);
    assert_memory_equal(
        first->contact, second->contact, (size_t)first->n_contact * sizeof *first->contact);
    for (int k = 0; k < first->n_wall; k++) {
        assert_memory_equal(first->wall[k].point, second->wall[k].point,
            offsetof(struct wall, stl) - offsetof(struct wall, point));
        assert_memory_equal(&first->wall[k].scale, &second->wall[k].scale,
            offsetof(struct wall, line) - offsetof(struct wall, scale));
    }
    for (int k = 0; k < first->n_group; k++)
        assert_memory_equal(
            first->group[k].diameter, second->group[k].diameter, 2 * sizeof(double));
    scene_free(first);
    scene_free(second);
}

static void resolved_reads_back(void **state)
{
    check_round_trip(*state, "everything.yaml");
}

static void resolved_v_funnel_reads_back(void **state)
{
    check_round_trip(*state, "v_funnel.yaml");
}

static const char SMALL[] =
    "method: particles\n"
    "time: {end: 1}\n"
    "materials: {m: {density: 1e3}}\n"
    "elements: [{name: e, material: m, shape: {sphere: {diameter: 5 mm}}, fill: {region: {box: "
    "{min: [0, 0, 0], max: [1, 1, 1]}}, count: 1}}]\n";

/* The same scene in other words: order, units, comments, style. */
static const char SMALL_AGAIN[] =
    "# again\n"
    "elements:\n"
    "  - shape: {sphere: {diameter: 0.5 cm}}\n"
    "    fill: {count: 1, region: {box: {max: [1 m, 100 cm, 1e3 mm], min: [0, 0.0, 0e3]}}}\n"
    "    material: m\n"
    "    name: e\n"
    "materials: {m: {density: 1 g/cm3}}\n"
    "time:\n"
    "  end: 1000 ms\n"
    "method: particles\n";

static void smallest_scene_has_defaults(void **state)
{
    struct fixture *f = *state;
    fixture_scene(f, SMALL);
    struct scene *s = fixture_read(f, NULL, 0);
    assert_string_equal(s->title, "");
    assert_string_equal(s->name, f->folder + strlen("/tmp/"));
    assert_true(s->time.step == 0 && s->n_wall == 0 && s->n_contact == 0 && s->n_measure == 0 &&
                s->output.every == 0);
    assert_int_equal(s->output.n_field, 2);
    assert_string_equal(s->output.field[0], "velocity");
    assert_false(s->domain.remove_outside);
    scene_free(s);
}

static void wording_does_not_matter(void **state)
{
    struct fixture *f = *state;
    fixture_scene(f, SMALL);
    struct scene *first = fixture_read(f, NULL, 0);
    fixture_scene(f, SMALL_AGAIN);
    struct scene *second = fixture_read(f, NULL, 0);
    assert_string_equal(first->resolved, second->resolved);
    assert_int_equal(first->hash, second->hash);
    const char *set = "time.safety=0.7";
    struct scene *third = fixture_read(f, &set, 1);
    assert_int_not_equal(first->hash, third->hash);
    scene_free(first);
    scene_free(second);
    scene_free(third);
}

/* UTF-8 of a code point. */
static int put_character(char *to, unsigned c)
{
    if (c < 0x80) return to[0] = (char)c, 1;
    if (c < 0x800) return to[0] = (char)(0xc0 | c >> 6), to[1] = (char)(0x80 | (c & 0x3f)), 2;
    if (c < 0x10000) {
        to[0] = (char)(0xe0 | c >> 12);
        to[1] = (char)(0x80 | (c >> 6 & 0x3f));
        to[2] = (char)(0x80 | (c & 0x3f));
        return 3;
    }
    to[0] = (char)(0xf0 | c >> 18);
    to[1] = (char)(0x80 | (c >> 12 & 0x3f));
    to[2] = (char)(0x80 | (c >> 6 & 0x3f));
    to[3] = (char)(0x80 | (c & 0x3f));
    return 4;
}

/* The same title and hash from the scene with all defaults. */
static void reads_back(struct fixture *f, const char *title)
{
    struct scene *scene = fixture_read(f, NULL, 0);
    if (title) assert_string_equal(scene->title, title);
    struct scene_errors errors = {0};
    struct scene *again =
        scene_read_text(f->path, scene->resolved, strlen(scene->resolved), NULL, 0, &errors);
    for (int k = 0; k < errors.n; k++) print_error("%s\n", errors.text[k]);
    assert_non_null(again);
    assert_string_equal(again->title, scene->title);
    assert_string_equal(again->resolved, scene->resolved);
    assert_int_equal(again->hash, scene->hash);
    scene_free(again);
    scene_free(scene);
}

/* Code points in a title, by their escape and as they are where YAML takes them: each one of the
 * first two planes, and both ends of the others, which have nothing else of their own. */
static void characters(void **state)
{
    enum { BATCH = 2048 };
    struct fixture *f = *state;
    char *escaped = fail_alloc(12 * BATCH + 1000), *raw = fail_alloc(4 * BATCH + 1000),
         *title = fail_alloc(4 * BATCH + 2);
    for (unsigned first = 0; first < 0x110000; first += BATCH) {
        unsigned in_plane = first & 0xffff;
        if (first >= 0x20000 && in_plane != 0 && in_plane != 0x10000 - BATCH) continue;
        size_t e = (size_t)sprintf(escaped, "title: \"x"), r = (size_t)sprintf(raw, "title: 'x"),
               t = (size_t)sprintf(title, "x");
        for (unsigned c = first; c < first + BATCH; c++) {
            if (c == 0 || (c >= 0xd800 && c < 0xe000)) continue;
            e += (size_t)sprintf(escaped + e, "\\U%08x", c);
            t += (size_t)put_character(title + t, c);
            bool is_refused = c < 0x20 || c == 0x7f || (c >= 0x80 && c < 0xa0 && c != 0x85) ||
                              c == '\'' || c == 0xfffe || c == 0xffff;
            if (!is_refused) r += (size_t)put_character(raw + r, c);
        }
        title[t] = 0;
        sprintf(escaped + e, "\"\n%s", SMALL);
        sprintf(raw + r, "'\n%s", SMALL);
        fixture_scene(f, escaped);
        reads_back(f, title);
        fixture_scene(f, raw);
        reads_back(f, NULL);
    }
    free(escaped);
    free(raw);
    free(title);
}

/* A name is a key in the scene with all defaults. */
static void long_names(void **state)
{
    struct fixture *f = *state;
    char name[1200];
    for (int n = 900; n <= 1100; n += 100) {
        memset(name, 'q', sizeof name);
        name[n] = 0;
        char *text = fail_format("title: t\nmethod: particles\ntime: {end: 1, step: 1e-3}\n"
                                 "materials: {? %s : {density: 1}}\n"
                                 "elements: [{name: %s, material: %s, file: bed.csv}]\n"
                                 "contacts: [{between: [%s, %s], normal: {law: linear, "
                                 "stiffness: 1, damping_ratio: 0}}]\n",
            name, name, name, name, name);
        fixture_write(f, "bed.csv", "", 0);
        fixture_scene(f, text);
        free(text);
        if (n <= 1000) {
            reads_back(f, "t");
            continue;
        }
        struct scene_errors errors = {0};
        assert_null(scene_read(f->path, NULL, 0, &errors));
        assert_true(errors.n > 0);
        assert_non_null(strstr(errors.text[0], "a name is at most 1000 bytes long"));
        scene_errors_free(&errors);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(v_funnel, fixture_setup, fixture_teardown),
        cmocka_unit_test_setup_teardown(everything, fixture_setup, fixture_teardown),
        cmocka_unit_test_setup_teardown(resolved_reads_back, fixture_setup, fixture_teardown),
        cmocka_unit_test_setup_teardown(
            resolved_v_funnel_reads_back, fixture_setup, fixture_teardown),
        cmocka_unit_test_setup_teardown(
            smallest_scene_has_defaults, fixture_setup, fixture_teardown),
        cmocka_unit_test_setup_teardown(wording_does_not_matter, fixture_setup, fixture_teardown),
        cmocka_unit_test_setup_teardown(characters, fixture_setup, fixture_teardown),
        cmocka_unit_test_setup_teardown(long_names, fixture_setup, fixture_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
