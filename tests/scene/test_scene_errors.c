/* Wrong scenes: the exact messages, all together, in the order of their places; one mistake gives
 * one message. */
#include "scene_fixture.h"

static void ten_mistakes(void **state)
{
    struct fixture *f = *state;
    fixture_copy(f, "ten_mistakes.yaml");
    const char *const message[] = {
        "ten_mistakes.yaml:4:8: time.end: 'mm' is the unit of a length; expected a time, as in '1 "
        "s'",
        "ten_mistakes.yaml:5:17: gravity[2]: 'fast' is not a number; expected an acceleration, as "
        "in '1 m/s2'",
        "ten_mistakes.yaml:7:21: materials.mortar.density: -2200 kg/m3 is out of range: must be > "
        "0",
        "ten_mistakes.yaml:11:31: contacts[0].normal.stifness: unknown key; did you mean "
        "'stiffness'?",
        "ten_mistakes.yaml:14:17: contacts[1].tangential: missing key 'friction'",
        "ten_mistakes.yaml:17:15: elements[0].material: unknown material 'motar'; did you mean "
        "'mortar'?",
        "ten_mistakes.yaml:19:60: elements[0].fill.count: 'many' is not a number; expected a "
        "plain number, without unit",
        "ten_mistakes.yaml:23:20: walls[0].surface.stl: cannot read 'funel.stl': No such file or "
        "directory",
        "ten_mistakes.yaml:24:32: walls[0].motion.remove_at: duplicate key, given first in line 24",
        "ten_mistakes.yaml:26:53: measure[0].count.below.z: unknown unit 'sec'; expected a "
        "length, as in '1 m', or 'none'",
    };
    fixture_expect(f, NULL, 0, message, 10);
}

/* A scene with one line of its own at the end, and materials m and w. */
#define SCENE(rest)                                                                                \
    "method: particles\n"                                                                          \
    "time: {end: 1}\n"                                                                             \
    "materials: {m: {density: 1e3}, w: {density: 2e3}}\n" rest
#define ELEMENTS(fill)                                                                             \
    "elements: [{name: e, material: m, shape: {sphere: {diameter: 5 mm}}, " fill "}]\n"
#define ONE ELEMENTS("fill: {region: {box: {min: [0, 0, 0], max: [1, 1, 1]}}, count: 1}")
#define MANY ELEMENTS("fill: {region: {box: {min: [0, 0, 0], max: [1, 1, 1]}}}")
#define ELASTIC "normal: {law: linear, stiffness: 1e3, damping_ratio: 0}"

static void types(void **state)
{
    struct fixture *f = *state;
    fixture_expect_one(f, SCENE(ONE "gravity: -9.81\n"),
        "scene.yaml:5:10: gravity: expected a list of 3 numbers, found text");
    fixture_expect_one(f, SCENE(ONE "gravity: [0, 0]\n"),
        "scene.yaml:5:10: gravity: expected a list of 3 numbers, found 2");
    fixture_expect_one(f, SCENE(ONE "precision: [double]\n"),
        "scene.yaml:5:12: precision: expected a word, found a list");
    fixture_expect_one(f, SCENE(ONE "precision: doubel\n"),
        "scene.yaml:5:12: precision: unknown word 'doubel'; did you mean 'double'?");
    fixture_expect_one(f, SCENE(ONE "precision: half\n"),
        "scene.yaml:5:12: precision: unknown word 'half'; expected one of: double, mixed, single");
    fixture_expect_one(
        f, SCENE(ONE "output:\n"), "scene.yaml:5:8: output: expected a mapping, found nothing");
    fixture_expect_one(f, SCENE(ONE "output: {every: }\n"),
        "scene.yaml:5:17: output.every: expected a number, found nothing");
    fixture_expect_one(f, SCENE(ONE "output: {fields: [mas]}\n"),
        "scene.yaml:5:19: output.fields[0]: unknown field 'mas'; did you mean 'mass'?");
    fixture_expect_one(f, SCENE(ONE "output: {fields: [id, id]}\n"),
        "scene.yaml:5:23: output.fields[1]: 'id' is listed twice");
    fixture_expect_one(f, SCENE(ONE "partition: {every: 1.5}\n"),
        "scene.yaml:5:20: partition.every: expected a whole number, found 1.5");
    fixture_expect_one(f, SCENE(ONE "domain: {remove_outside: yes}\n"),
        "scene.yaml:5:26: domain.remove_outside: expected true or false, found 'yes'");
    fixture_expect_one(f, SCENE(ONE "walls: {name: w}\n"),
        "scene.yaml:5:8: walls: expected a list of mappings, found a mapping");
    fixture_expect_one(
        f, SCENE(ONE "walls: [w]\n"), "scene.yaml:5:9: walls[0]: expected a mapping, found text");
    fixture_expect_one(f, SCENE("elements: []\n"),
        "scene.yaml:4:11: elements: expected a list of mappings, found an empty one");
    fixture_expect_one(
        f, SCENE(ONE "bodies: []\n"), "scene.yaml:5:1: bodies: only valid with method: lattice");
    fixture_expect_one(f, SCENE(ONE "bodys: []\n"), "scene.yaml:5:1: bodys: unknown key");
    fixture_expect_one(f, SCENE(ONE "output: {colour: red}\n"),
        "scene.yaml:5:10: output.colour: unknown key; expected one of: every, fields, "
        "checkpoint_every");
}

static void what_is_not_here_yet(void **state)
{
    struct fixture *f = *state;
    fixture_expect_one(f, SCENE(ONE "partition: {method: grpah}\n"),
        "scene.yaml:5:21: partition.method: unknown word 'grpah'; did you mean 'graph'?");
    if (!HAVE_METIS)
        fixture_expect_one(f, SCENE(ONE "partition: {method: graph}\n"),
            "scene.yaml:5:21: partition.method: graph needs METIS, without which this program was "
            "built; take geometric or interactions");
    fixture_expect_one(f, SCENE(ONE "partition: {boundary: one}\n"),
        "scene.yaml:5:23: partition.boundary: unknown word 'one'; expected one of: both, assigned");
}

/* shape goes with fill, not with file; and one of the two is needed. */
static void elements_from_nowhere(void **state)
{
    struct fixture *f = *state;
    fixture_scene(f, SCENE(ELEMENTS("velocity: [0, 0, 0]")));
    const char *const message[] = {
        "scene.yaml:4:12: elements[0]: missing key: one of 'fill', 'file'",
        "scene.yaml:4:35: elements[0].shape: only valid with 'fill'",
    };
    fixture_expect(f, NULL, 0, message, 2);
}

static void contacts(void **state)
{
    struct fixture *f = *state;
    fixture_expect_one(
        f, SCENE(MANY), "scene.yaml:1:1: contacts: no entry between 'm' and 'm', which can meet");
    fixture_expect_one(f,
        SCENE(ONE
            "walls: [{name: w, material: w, surface: {box: {min: [0, 0, 0], max: [1, 1, 1]}}}]\n"),
        "scene.yaml:1:1: contacts: no entry between 'm' and 'w', which can meet");
    fixture_expect_one(f, SCENE(MANY "contacts: [{between: [w, w], " ELASTIC "}]\n"),
        "scene.yaml:5:11: contacts: no entry between 'm' and 'm', which can meet");
    fixture_expect_one(f,
        SCENE(MANY "contacts: [{between: [m, m], " ELASTIC "}, {between: [m, m]}]\n"),
        "scene.yaml:5:98: contacts[1].between: contacts[0] is between these materials already");
    fixture_expect_one(f,
        SCENE(ONE "contacts: [{between: [m, w], " ELASTIC "}, {between: [w, m]}]\n"),
        "scene.yaml:5:98: contacts[1].between: contacts[0] is between these materials already");
    fixture_expect_one(f, SCENE(MANY "contacts: [{between: [m, mm], " ELASTIC "}]\n"),
        "scene.yaml:5:26: contacts[0].between[1]: unknown material 'mm'; did you mean 'm'?");
    fixture_expect_one(f, SCENE(MANY "contacts: [{between: [m, m], binding: {force: 1}}]\n"),
        "scene.yaml:5:39: contacts[0].binding: requires 'normal'");
    fixture_expect_one(f,
        SCENE(MANY "contacts: [{between: [m, m], normal: {law: linear, stiffness: 1}}]\n"),
        "scene.yaml:5:38: contacts[0].normal: missing key: one of 'damping_ratio', 'restitution'");
    fixture_expect_one(f,
        SCENE(
            MANY "contacts: [{between: [m, m], normal: {law: linear, stiffness: 1, restitution: 1, "
                 "damping_ratio: 0}}]\n"),
        "scene.yaml:5:66: contacts[0].normal: only one of 'damping_ratio', 'restitution' can be "
        "given");
    fixture_expect_one(f,
        SCENE(MANY "contacts: [{between: [m, m], normal: {law: linear, damping_ratio: 0}}]\n"),
        "scene.yaml:5:38: contacts[0].normal: missing key 'stiffness' (law: linear)");
    fixture_expect_one(f,
        SCENE(MANY
            "contacts: [{between: [m, m], normal: {law: linear, stiffness: 1, restitution: 0}}]\n"),
        "scene.yaml:5:79: contacts[0].normal.restitution: 0 is out of range: must be > 0 and <= 1");
    fixture_expect_one(f,
        SCENE(MANY "contacts: [{between: [m, m], " ELASTIC ", tangential: {friction: 1}}]\n"),
        "scene.yaml:5:99: contacts[0].tangential: missing key 'stiffness_ratio' (law: linear)");
    fixture_expect_one(f,
        SCENE(MANY "contacts: [{between: [m, m], " ELASTIC
                   ", rolling: {model: cdt, friction: 1, damping_ratio: 1}}]\n"),
        "scene.yaml:5:122: contacts[0].rolling.damping_ratio: only valid with 'model: epsd'");
}

#define SLIDES(keys) ", tangential: {friction: 1, stiffness_ratio: 1, " keys "}}]\n"
static void choices_of_friction(void **state)
{
    struct fixture *f = *state;
    fixture_expect_one(f,
        SCENE(MANY "contacts: [{between: [m, m], " ELASTIC SLIDES("rescale: false")),
        "scene.yaml:5:142: contacts[0].tangential.rescale: false is only valid with 'normal.law: "
        "hertz'");
    fixture_expect_one(f,
        SCENE(MANY
            "contacts: [{between: [m, m], " ELASTIC SLIDES("damping_ratio: 0, damping_factor: 1")),
        "scene.yaml:5:151: contacts[0].tangential: only one of 'damping_ratio', 'damping_factor' "
        "can be given");
    fixture_expect_one(f,
        SCENE(MANY "contacts: [{between: [m, m], " ELASTIC SLIDES("damping_mass: centre")),
        "scene.yaml:5:133: contacts[0].tangential.damping_mass: only valid with 'damping_ratio'");
    fixture_expect_one(f, SCENE(MANY "contacts: [{between: [m, m], " ELASTIC SLIDES("slip: all")),
        "scene.yaml:5:139: contacts[0].tangential.slip: unknown word 'all'; expected one of: "
        "spring, whole, undamped");
}

static void hertz_needs_moduli(void **state)
{
    struct fixture *f = *state;
    fixture_scene(
        f, SCENE(MANY
               "contacts: [{between: [m, w], normal: {law: hertz, stiffness: 1, restitution: 1}}, "
               "{between: [m, m], " ELASTIC "}]\n"));
    const char *const message[] = {
        "scene.yaml:5:44: contacts[0].normal.law: hertz needs 'young' of material 'm'",
        "scene.yaml:5:44: contacts[0].normal.law: hertz needs 'poisson' of material 'm'",
        "scene.yaml:5:44: contacts[0].normal.law: hertz needs 'young' of material 'w'",
        "scene.yaml:5:44: contacts[0].normal.law: hertz needs 'poisson' of material 'w'",
        "scene.yaml:5:51: contacts[0].normal.stiffness: only valid with 'law: linear'",
    };
    fixture_expect(f, NULL, 0, message, 5);
}

#define WALL(rest) "walls: [{name: w, material: w, " rest "}]\n" CONTACT
#define CONTACT "contacts: [{between: [m, w], " ELASTIC "}]\n"

static void directions(void **state)
{
    struct fixture *f = *state;
#define SHORT "too short for a direction: numbers below 2.2e-308 lose their digits"
    fixture_expect_one(f,
        SCENE(ONE WALL("surface: {plane: {point: [0, 0, 0], normal: [0, 0, 1e-310]}}")),
        "scene.yaml:5:76: walls[0].surface.plane.normal: " SHORT);
    fixture_expect_one(f,
        SCENE(ONE WALL("surface: {rectangle: {center: [0, 0, 0], normal: [1e-320, 0, 0], size: [1, "
                       "1]}}")),
        "scene.yaml:5:81: walls[0].surface.rectangle.normal: " SHORT);
    fixture_expect_one(f,
        SCENE(ONE WALL("surface: {plane: {point: [0, 0, 0], normal: [0, 0, 1]}}, motion: "
                       "{rotation: {center: [0, 0, 0], axis: [0, 1e-309, 0], rate: 1}}")),
        "scene.yaml:5:134: walls[0].motion.rotation.axis: " SHORT);
#define NO_LENGTH "from and to are less than 1e-12 radii from each other, which is no length"
    fixture_expect_one(f,
        SCENE(ONE WALL("surface: {cylinder: {from: [0, 0, 0], to: [0, 0, 1e-200], radius: 1}}")),
        "scene.yaml:5:52: walls[0].surface.cylinder: " NO_LENGTH);
    fixture_expect_one(f,
        SCENE(ONE WALL("surface: {cylinder: {from: [0, 0, 0], to: [0, 1e-14, 0], radius: 0.1}}")),
        "scene.yaml:5:52: walls[0].surface.cylinder: " NO_LENGTH);
    fixture_expect_one(f,
        SCENE(
            ONE WALL("surface: {cylinder: {from: [-1e308, 0, 0], to: [1e308, 0, 0], radius: 1}}")),
        "scene.yaml:5:52: walls[0].surface.cylinder: from and to are too far from each other");
}

static void walls_and_regions(void **state)
{
    struct fixture *f = *state;
    fixture_expect_one(f,
        SCENE(ONE WALL("surface: {plane: {point: [0, 0, 0], normal: [0, 0, 0]}}")),
        "scene.yaml:5:76: walls[0].surface.plane.normal: a direction must not be zero");
    fixture_expect_one(f, SCENE(ONE WALL("surface: {box: {min: [0, 0, 0], max: [1, 0, 1]}}")),
        "scene.yaml:5:47: walls[0].surface.box: min must be below max in y");
    fixture_expect_one(f,
        SCENE(ONE WALL("surface: {cylinder: {from: [0, 0, 0], to: [0, 0, 0], radius: 1}}")),
        "scene.yaml:5:52: walls[0].surface.cylinder: from and to are the same point");
    fixture_expect_one(f, SCENE(ONE WALL("surface: {}")),
        "scene.yaml:5:41: walls[0].surface: missing key: one of 'plane', 'rectangle', 'box', "
        "'cylinder', 'stl'");
    fixture_expect_one(f,
        SCENE(ONE WALL("surface: {box: {min: [0, 0, 0], max: [1, 1, 1]}, scale: 1 mm}")),
        "scene.yaml:5:81: walls[0].surface.scale: only valid with 'stl'");
    fixture_expect_one(f,
        SCENE(ONE WALL(
            "surface: {box: {min: [0, 0, 0], max: [1, 1, 1]}}, motion: {appear_at: 2, remove_at: "
            "1}")),
        "scene.yaml:5:116: walls[0].motion.remove_at: must be after appear_at");
    fixture_expect_one(f,
        SCENE(ONE WALL(
            "surface: {box: {min: [0, 0, 0], max: [1, 1, 1]}}, motion: {rotation: {center: [0, 0, "
            "0], axis: [0, 0, 1], rate: 1 Hz}}")),
        "scene.yaml:5:144: walls[0].motion.rotation.rate: 'Hz' is the unit of a frequency; "
        "expected an angular velocity, as in '1 rad/s'");
    fixture_expect_one(f,
        SCENE(ELEMENTS("fill: {region: {box: {min: [0, 0, 0], max: [1, 1, -1]}}, count: 1}")),
        "scene.yaml:4:91: elements[0].fill.region.box: min must be below max in z");
    fixture_expect_one(f, SCENE(ELEMENTS("fill: {region: {box: {min: [0, 0, 0]}}, count: 1}")),
        "scene.yaml:4:91: elements[0].fill.region.box: missing key 'max'");
    fixture_expect_one(f,
        SCENE(ELEMENTS(
            "fill: {region: {box: {min: [0, 0, 0], max: [1, 1, 1]}}, count: 1, packing: full}")),
        "scene.yaml:4:136: elements[0].fill: only one of 'count', 'packing' can be given");
    fixture_expect_one(f, SCENE("elements: [{name: e, material: m, file: nix.csv}]\n"),
        "scene.yaml:4:41: elements[0].file: cannot read 'nix.csv': No such file or directory");
}

static void names_and_domain(void **state)
{
    struct fixture *f = *state;
    fixture_expect_one(f, SCENE(ONE "domain: {periodic: [x]}\n"),
        "scene.yaml:5:20: domain.periodic: requires 'box', the extent of the periodic domain");
    fixture_expect_one(f, SCENE(ONE "measure: [{name: a, every: 1, wall_force: gate}]\n"),
        "scene.yaml:5:43: measure[0].wall_force: unknown wall 'gate'");
    fixture_expect_one(f, SCENE(ONE "measure: [{name: a/b, every: 1, energy: all}]\n"),
        "scene.yaml:5:18: measure[0].name: a name may hold letters, digits, '_' and '-' only");
    fixture_expect_one(f, SCENE(ONE "measure: [{name: \"a\\x85\", every: 1, energy: all}]\n"),
        "scene.yaml:5:18: measure[0].name: a name may hold letters, digits, '_' and '-' only");
    fixture_expect_one(f,
        SCENE(
            ONE "measure: [{name: a, every: 1, energy: all}, {name: a, every: 1, energy: all}]\n"),
        "scene.yaml:5:52: measure[1].name: 'a' is the name of measure[0] already");
    fixture_expect_one(f, SCENE(ONE "measure: [{name: a, every: 0, energy: all}]\n"),
        "scene.yaml:5:28: measure[0].every: 0 is out of range: must be > 0");
    fixture_expect_one(f, SCENE(ONE "measure: [{name: a, every: 1}]\n"),
        "scene.yaml:5:11: measure[0]: missing key: one of 'count', 'energy', 'momentum', "
        "'wall_force', 'wall_torque', 'probe'");
}

static void too_many_steps(void **state)
{
    struct fixture *f = *state;
    fixture_expect_one(f,
        "method: particles\ntime: {end: 1e10, step: 1e-6}\nmaterials: {m: {density: 1}}\n" ONE,
        "scene.yaml:2:25: time.step: 1e+16 steps until time.end are too many, at most 1e+15");
    fixture_expect_one(f,
        "method: particles\ntime: {end: 1, step: 1e-320}\nmaterials: {m: {density: 1}}\n" ONE,
        "scene.yaml:2:22: time.step: inf steps until time.end are too many, at most 1e+15");
}

static void no_scene_at_all(void **state)
{
    struct fixture *f = *state;
    fixture_expect_one(f, "", "scene.yaml:1:1: the file is empty");
    fixture_expect_one(f, "# only a comment\n", "scene.yaml:1:1: the file is empty");
    fixture_expect_one(f, "\xef\xbb\xbfhello\n", "scene.yaml:1:1: expected a mapping, found text");
    fixture_expect_one(f, "hello\n", "scene.yaml:1:1: expected a mapping, found text");
    fixture_expect_one(f, "a: 1\nb: \xff\n", "scene.yaml:2:4: not UTF-8 text (byte 0xff)");
    fixture_expect_one(f, "a: \x07\n", "scene.yaml:1:4: control character 0x07");
    fixture_expect_one(f, "a: 1\n b: 2\n",
        "scene.yaml:2:3: not valid YAML: mapping values are not allowed in this context");
    fixture_expect_one(f, "a: [1, 2\n",
        "scene.yaml:2:1: not valid YAML: did not find expected ',' or ']', while parsing a flow "
        "sequence (from line 1)");
    fixture_expect_one(
        f, "a: 1\n---\nb: 1\n", "scene.yaml:2:1: a second document; a scene is one document");
    fixture_expect_one(
        f, "a: &a [*a]\n", "scene.yaml:1:4: nested too deeply (an alias that contains itself?)");
    fixture_expect_one(
        f, "? [1]\n: 2\n", "scene.yaml:1:3: a key must be a word, not a list or mapping");
    remove(f->path);
    const char *gone = "scene.yaml: cannot be read: No such file or directory";
    fixture_expect(f, NULL, 0, &gone, 1);
    mkdir(f->path, 0700);
    const char *folder = "scene.yaml: cannot be read: Is a directory";
    fixture_expect(f, NULL, 0, &folder, 1);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(ten_mistakes),
        TEST(choices_of_friction),
        TEST(types),
        TEST(what_is_not_here_yet),
        TEST(elements_from_nowhere),
        TEST(contacts),
        TEST(hertz_needs_moduli),
        TEST(directions),
        TEST(walls_and_regions),
        TEST(names_and_domain),
        TEST(too_many_steps),
        TEST(no_scene_at_all),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
