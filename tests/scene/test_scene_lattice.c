/* Scenes of method lattice: values, the resolved text, and what is wrong with the others. */
#include "scene_fixture.h"

#include <math.h>

#define ASSERT_VECTOR(v, x, y, z) assert_true((v)[0] == (x) && (v)[1] == (y) && (v)[2] == (z))

static void check_materials(const struct material *m)
{
    assert_true(m[0].mass_damping == 120 && m[0].link_damping == 1e-8 && m[0].has_strength &&
                m[0].tension == 400e6 && m[0].shear == 200e6);
    assert_true(m[0].criterion == CRITERION_STRESS && m[0].energy == 0);
    assert_int_equal(m[1].criterion, CRITERION_LARGEST); /* beside `energy` */
    assert_true(fabs(m[1].mass_damping - 4 * M_PI * 200 * 0.05) < 1e-12 && m[1].link_damping == 0);
    assert_true(m[1].poisson == -0.2 && m[1].tension == 0 && m[1].energy == 8 &&
                m[1].plane == PLANE_STRESS);
    assert_true(m[2].mass_damping == 0 && fabs(m[2].link_damping * (M_PI * 2e6) - 0.05) < 1e-16 &&
                m[2].plane == PLANE_STRAIN);
    assert_true(isinf(m[2].shear) && isinf(m[3].tension) && m[3].shear == 1e3 &&
                m[3].criterion == CRITERION_SUM);
}

static void check_bodies(const struct body *b)
{
    assert_true(b[0].material == 0 && b[0].cell == 5e-3 && b[0].shape.kind == REGION_BOX &&
                b[0].shape.max[2] == 0.1 && b[0].n_minus == 3);
    assert_true(b[0].n_crack == 0 && b[1].n_crack == 2 && b[1].crack[0].kind == REGION_BOX &&
                b[1].crack[0].max[2] == 0.5);
    assert_true(b[0].minus[0].kind == REGION_SPHERE && b[0].minus[0].center[1] == 0.5 &&
                b[0].minus[0].radius == 0.05);
    assert_true(b[0].minus[1].kind == REGION_STL && b[0].minus[1].scale == 1e-3 &&
                b[0].minus[2].kind == REGION_BOX);
    assert_true(b[1].shape.kind == REGION_CYLINDER && b[1].shape.radius == 0.01 &&
                b[1].n_minus == 0 && b[1].velocity[2] == -1);
    assert_true(b[2].shape.kind == REGION_SPHERE && b[2].shape.center[2] == 2);
    ASSERT_VECTOR(b[2].angular_velocity, 1, 2, 3);
    assert_true(b[3].shape.kind == REGION_STL && b[3].shape.stl && b[3].shape.scale == 0.01 &&
                b[3].minus[0].kind == REGION_CYLINDER);
    assert_true(b[0].line == 12 && b[0].column == 5 && b[3].line == 17);
}

static void check_boundaries(const struct boundary *b)
{
    assert_true(b[0].kind == BOUNDARY_FIX && b[0].where.kind == REGION_BOX && b[0].body == 1 &&
                b[0].history.kind == HISTORY_CONSTANT);
    for (int c = 0; c < 6; c++) assert_int_equal(b[0].fix[c], c == 0 || c == 5);
    assert_true(
        b[1].kind == BOUNDARY_FORCE && b[1].where.kind == REGION_CYLINDER && b[1].body == -1);
    ASSERT_VECTOR(b[1].value, 1000, 0, -2);
    assert_true(b[1].history.kind == HISTORY_RAMP && b[1].history.ramp == 2e-3);
    assert_true(
        b[2].kind == BOUNDARY_PRESSURE && b[2].pressure == 3e5 && b[2].where.kind == REGION_SPHERE);
    assert_true(b[2].history.kind == HISTORY_SINE && b[2].history.frequency == 50 &&
                fabs(b[2].history.phase - M_PI / 2) < 1e-15);
    assert_true(b[3].kind == BOUNDARY_ACCELERATION && b[3].where.kind == REGION_ALL &&
                b[3].history.kind == HISTORY_TABLE);
    assert_true(b[3].history.n_point == 3 && b[3].history.point[1][0] == 1e-3 &&
                b[3].history.point[2][1] == -0.5);
    assert_true(b[4].kind == BOUNDARY_VELOCITY && b[4].value[0] == 1 && isinf(b[4].value[1]) &&
                isinf(b[4].value[2]) && b[4].body == 2);
    assert_true(b[4].history.n_point == 2 && b[4].history.point[1][1] == 2);
    assert_true(b[5].kind == BOUNDARY_ANGULAR_VELOCITY && fabs(b[5].value[2] - M_PI / 3) < 1e-15 &&
                b[5].column == 5);
}

static void every_key(void **state)
{
    struct fixture *f = *state;
    fixture_copy(f, "lattice.yaml");
    struct scene *s = fixture_read(f, NULL, 0);
    assert_true(s->method == METHOD_LATTICE && s->time.scheme == SCHEME_LEAPFROG &&
                s->n_body == 4 && s->n_boundary == 6 && s->n_group == 0);
    check_materials(s->material);
    check_bodies(s->body);
    check_boundaries(s->boundary);
    assert_true(s->lattice.law == LAW_ISOTROPIC && s->lattice.rotation == ROTATION_SMALL &&
                s->lattice.stress == STRESS_EXTRAPOLATED);
    assert_true(s->lattice.relax && s->lattice.tolerance == 1e-4 && s->lattice.look_every == 50);
    assert_true(s->output.n_field == 2 && !strcmp(s->output.field[1], "broken"));
    assert_true(s->measure[0].kind == MEASURE_PROBE && s->measure[0].at[2] == 5e-3 &&
                s->measure[0].n_field == 1 && s->measure[1].n_field == 2);
    assert_true(s->measure[2].kind == MEASURE_STRESS_MAX && s->measure[3].kind == MEASURE_ENERGY &&
                s->measure[4].kind == MEASURE_BROKEN);
    scene_free(s);
}

/* The resolved text gives the same text, and the same values as far as cells depend on them. */
static void resolved_reads_back(void **state)
{
    static const char *const name[] = {"lattice.yaml", "plate.yaml"};
    struct fixture *f = *state;
    for (int k = 0; k < 2; k++) {
        fixture_copy(f, name[k]);
        struct scene *first = fixture_read(f, NULL, 0);
        fixture_write(f, "resolved.yaml", first->resolved, strlen(first->resolved));
        struct scene *second = fixture_read(f, NULL, 0);
        assert_string_equal(first->resolved, second->resolved);
        assert_int_equal(first->hash, second->hash);
        for (int b = 0; b < first->n_boundary; b++) {
            assert_memory_equal(first->boundary[b].value, second->boundary[b].value,
                sizeof first->boundary[b].value);
            assert_memory_equal(
                first->boundary[b].where.min, second->boundary[b].where.min, 6 * sizeof(double));
            assert_true(first->boundary[b].kind == second->boundary[b].kind &&
                        first->boundary[b].body == second->boundary[b].body);
            assert_int_equal(
                first->boundary[b].history.n_point, second->boundary[b].history.n_point);
        }
        for (int m = 0; m < first->n_material; m++) {
            assert_true(first->material[m].mass_damping == second->material[m].mass_damping);
            assert_true(first->material[m].link_damping == second->material[m].link_damping);
        }
        scene_free(first);
        scene_free(second);
    }
}

static void plate(void **state)
{
    struct fixture *f = *state;
    fixture_copy(f, "plate.yaml");
    struct scene *s = fixture_read(f, NULL, 0);
    assert_true(s->time.scheme == SCHEME_RK4 && s->material[0].mass_damping == 120 &&
                s->body[0].cell == 5e-3 && s->lattice.rotation == ROTATION_FINITE);
    assert_true(s->boundary[0].fix[0] && s->boundary[0].fix[5] &&
                s->boundary[1].value[2] == -1000 && s->boundary[1].history.ramp == 1e-3);
    assert_true(s->output.n_field == 5 && s->measure[2].kind == MEASURE_STRESS_MAX);
    scene_free(s);
}

#define SCENE(material, rest)                                                                      \
    "method: lattice\n"                                                                            \
    "time: {end: 1}\n"                                                                             \
    "materials: {m: {" material "}}\n"                                                             \
    "bodies: [{name: b, material: m, cell: 1, "                                                    \
    "shape: {box: {min: [0, 0, 0], max: [2, 2, 2]}}}]\n" rest
#define GOOD "density: 1, young: 1, poisson: 0.2"
#define BOUNDARY(rest) SCENE(GOOD, "boundaries: [{" rest "}]\n")

/* The name of the release before is taken, noted, and written as today's. */
static void renamed(void **state)
{
    struct fixture *f = *state;
    fixture_scene(f, SCENE("density: 1, young: 1, poisson: 0", "lattice: {law: seed}\n"));
    struct scene *s = fixture_read(f, NULL, 0);
    assert_true(s->lattice.law == LAW_REFERENCE && s->notes.n == 1);
    assert_non_null(strstr(
        s->notes.text[0], "scene.yaml: lattice.law: 'seed' is now called 'reference'; the old"));
    assert_non_null(strstr(s->resolved, "  law: reference\n"));
    scene_free(s);
}

static void materials(void **state)
{
    struct fixture *f = *state;
    fixture_expect_one(f, SCENE("density: 1, young: 1, poisson: 0.5", ""),
        "scene.yaml:3:48: materials.m.poisson: 0.5 is out of range: must be > -1 and < 0.5");
    fixture_expect_one(f, SCENE("density: -1, young: 1, poisson: 0", ""),
        "scene.yaml:3:26: materials.m.density: -1 is out of range: must be > 0");
    fixture_expect_one(f, SCENE("density: 1, poisson: 0", ""),
        "scene.yaml:3:16: materials.m: missing key 'young'");
    fixture_expect_one(f, SCENE(GOOD, "lattice: {law: reference}\n"),
        "scene.yaml:3:48: materials.m.poisson: poisson must be 0: the pair springs of this law, "
        "without a volumetric term, have no other");
    fixture_expect_one(f, SCENE(GOOD, "partition: {boundary: assigned}\n"),
        "scene.yaml:5:23: partition.boundary: 'assigned' is only valid with method: particles");
    fixture_expect_one(f, SCENE(GOOD ", damping: {ratio: 0.1}", ""),
        "scene.yaml:3:62: materials.m.damping: missing key 'at' (ratio)");
    fixture_expect_one(f, SCENE(GOOD ", damping: {at: 1}", ""),
        "scene.yaml:3:63: materials.m.damping.at: only valid with 'ratio'");
    fixture_expect_one(f, SCENE(GOOD ", damping: {ratio: 0.1, at: 1, mass: 1}", ""),
        "scene.yaml:3:70: materials.m.damping.ratio: cannot be combined with 'mass' and 'link'");
    fixture_expect_one(f, SCENE(GOOD ", damping: {link: 1 s}", "time.scheme: x\n"),
        "scene.yaml:5:1: time.scheme: unknown key");
    const char *const set[] = {"time.scheme=pefrl"},
                      *message =
                          "scene.yaml:3:62: materials.m.damping: this scheme does not support "
                          "stiffness-proportional (link) damping; leapfrog and rk4 do";
    fixture_scene(f, SCENE(GOOD ", damping: {link: 1 s}", ""));
    fixture_expect(f, set, 1, &message, 1);
    fixture_scene(f, SCENE(GOOD ", damping: {ratio: 1, at: 1, by: link}", ""));
    fixture_expect(f, set, 1, &message, 1);
    fixture_expect_one(f, SCENE(GOOD ", strength: {tension: 1, energy: 1}", ""),
        "scene.yaml:3:76: materials.m.strength: only one of 'tension', 'energy' can be given");
    fixture_expect_one(f, SCENE(GOOD ", strength: {energy: 1, criterion: sum}", ""),
        "scene.yaml:3:86: materials.m.strength.criterion: beside 'energy' it is largest or "
        "principal");
    fixture_expect_one(f,
        SCENE(GOOD ", strength: {tension: 1, shear: 1, criterion: principal}", ""),
        "scene.yaml:3:83: materials.m.strength.shear: not with criterion: principal, which breaks "
        "shear by its principal stress");
    fixture_expect_one(f, SCENE(GOOD ", strength: {tension: 1, path: drawn}", ""),
        "scene.yaml:3:82: materials.m.strength.path: with criterion: principal only");
    fixture_expect_one(f, SCENE(GOOD ", strength: {energy: 1 J}", ""),
        "scene.yaml:3:72: materials.m.strength.energy: 'J' is the unit of an energy; expected an "
        "energy per area, as in '1 J/m2'");
}

static void boundaries(void **state)
{
    struct fixture *f = *state;
    fixture_expect_one(f, BOUNDARY("where: {}, fix: [x]"),
        "scene.yaml:5:22: boundaries[0].where: needs a shape, a body, or the word all");
    fixture_expect_one(f, BOUNDARY("where: every, fix: [x]"),
        "scene.yaml:5:22: boundaries[0].where: expected a mapping, or 'all', found text");
    fixture_expect_one(f, BOUNDARY("where: {body: c}, fix: [x]"),
        "scene.yaml:5:29: boundaries[0].where.body: unknown body 'c'; expected one of: b");
    fixture_expect_one(f, BOUNDARY("where: {box: {min: [1, 0, 0], max: [0, 1, 1]}}, fix: [x]"),
        "scene.yaml:5:28: boundaries[0].where.box: min must not be above max in x");
    fixture_expect_one(f, BOUNDARY("where: all"),
        "scene.yaml:5:14: boundaries[0]: missing key: one of 'fix', 'force', 'pressure', "
        "'acceleration', 'velocity', 'angular_velocity'");
    fixture_expect_one(f, BOUNDARY("where: all, fix: [x, rq]"),
        "scene.yaml:5:36: boundaries[0].fix[1]: unknown direction 'rq'; did you mean 'rx'?");
    fixture_expect_one(f, BOUNDARY("where: all, fix: []"),
        "scene.yaml:5:32: boundaries[0].fix: an empty list fixes nothing");
    fixture_expect_one(f, BOUNDARY("where: all, fix: [x], history: {ramp: 1}"),
        "scene.yaml:5:46: boundaries[0].history: 'fix' takes no history: a support holds for the "
        "whole run");
    fixture_expect_one(f, BOUNDARY("where: all, velocity: [free, free, ~]"),
        "scene.yaml:5:14: boundaries[0]: all components are free");
    fixture_expect_one(f, BOUNDARY("where: all, force: [free, 0, 1]"),
        "scene.yaml:5:35: boundaries[0].force[0]: 'free' is not a number; expected a force, as in "
        "'1 N'");
}

static void tables(void **state)
{
    struct fixture *f = *state;
    fixture_write(f, "down.csv", "0,1\n-1,2\n", 9);
    fixture_expect_one(f, BOUNDARY("where: all, pressure: 1, history: {table: [[0, 1], [0, 2]]}"),
        "scene.yaml:5:66: boundaries[0].history.table[1]: times must increase");
    fixture_expect_one(f, BOUNDARY("where: all, pressure: 1, history: {table: [[0, 1], 2]}"),
        "scene.yaml:5:66: boundaries[0].history.table[1]: expected [time, factor]");
    fixture_expect_one(f, BOUNDARY("where: all, pressure: 1, history: {table: [[0 m, 1]]}"),
        "scene.yaml:5:59: boundaries[0].history.table[0]: 'm' is the unit of a length; expected a "
        "time, as in '1 s'");
    fixture_expect_one(f, BOUNDARY("where: all, pressure: 1, history: {table: []}"),
        "scene.yaml:5:57: boundaries[0].history.table: expected a list of pairs, or a file, found "
        "an empty list");
    fixture_expect_one(f, BOUNDARY("where: all, pressure: 1, history: {table: down.csv}"),
        "scene.yaml:5:57: boundaries[0].history.table: down.csv:2: times must increase");
    fixture_expect_one(f, BOUNDARY("where: all, pressure: 1, history: {table: none.csv}"),
        "scene.yaml:5:57: boundaries[0].history.table: cannot read 'none.csv': No such file or "
        "directory");
    fixture_expect_one(f, BOUNDARY("where: all, pressure: 1, history: {}"),
        "scene.yaml:5:49: boundaries[0].history: missing key: one of 'ramp', 'sine', 'table'");
}

/* A key of the one method in a scene of the other: named as such, and nothing else is said of
 * it. */
static void other_method(void **state)
{
    struct fixture *f = *state;
    fixture_expect_one(
        f, SCENE(GOOD, "walls: []\n"), "scene.yaml:5:1: walls: only valid with method: particles");
    fixture_expect_one(f, SCENE(GOOD, "domain: {periodic: [x]}\n"),
        "scene.yaml:5:1: domain: only valid with method: particles");
    fixture_expect_one(f, SCENE(GOOD, "measure: [{name: n, every: 1, count: {}}]\n"),
        "scene.yaml:5:31: measure[0].count: only valid with method: particles");
    fixture_expect_one(f,
        SCENE(GOOD, "measure: [{name: n, every: 1, probe: {element: 1, at: [0, 0, 0]}}]\n"),
        "scene.yaml:5:39: measure[0].probe.element: only valid with method: particles");
    fixture_expect_one(f, SCENE(GOOD, "output: {fields: [radius]}\n"),
        "scene.yaml:5:19: output.fields[0]: unknown field 'radius'; expected one of: "
        "id, displacement, rotation, velocity, angular_velocity, stress, von_mises, broken, "
        "body, material, owner");
    fixture_scene(f,
        "method: particles\ntime: {end: 1, scheme: rk4}\nmaterials: {m: {density: 1, damping: "
        "{mass: 1}}}\n"
        "elements: [{name: e, material: m, shape: {sphere: {diameter: 1}}, fill: {region: {box: "
        "{min: [0, 0, 0], max: [2, 2, 2]}}, count: 1}}]\n"
        "bodies: []\nboundaries: []\n");
    const char *const all[] = {
        "scene.yaml:2:24: time.scheme: method: particles supports leapfrog only",
        "scene.yaml:3:29: materials.m.damping: only valid with method: lattice",
        "scene.yaml:5:1: bodies: only valid with method: lattice",
        "scene.yaml:6:1: boundaries: only valid with method: lattice"};
    fixture_expect(f, NULL, 0, all, 4);
    fixture_expect_one(f, "method: lattice\ntime: {end: 1}\nmaterials: {m: {" GOOD "}}\n",
        "scene.yaml:1:1: missing key 'bodies'");
    fixture_expect_one(f,
        "method: latice\ntime: {end: 1}\nmaterials: {m: {" GOOD "}}\n"
        "bodies: [{name: b, material: m, cell: 1, shape: {box: {min: [0, 0, 0], max: [2, 2, "
        "2]}}}]\n",
        "scene.yaml:1:9: method: unknown word 'latice'; did you mean 'lattice'?");
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {TEST(every_key), TEST(resolved_reads_back), TEST(plate),
        TEST(materials), TEST(renamed), TEST(boundaries), TEST(tables), TEST(other_method)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
