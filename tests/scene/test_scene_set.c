/* --set: what it changes, creates and takes away, and its messages. */
#include "scene_fixture.h"

#include <math.h>

static struct scene *read_with(struct fixture *f, const char *const *set, int n)
{
    fixture_copy(f, "v_funnel.yaml");
    return fixture_read(f, set, n);
}

static void changes_values(void **state)
{
    const char *const set[] = {
        "time.end=1s",
        "contacts[0].normal.stiffness=2 kN/m",
        "walls[1].motion.remove_at=0.2s",
        "gravity[2]=-1.62",
        "output.fields=[id, owner]",
        "elements.mortar.fill.count=10",
        "time.step=auto",
    };
    struct scene *s = read_with(*state, set, 7);
    assert_true(s->time.end == 1 && s->time.step == 0 && s->contact[0].stiffness == 2000 &&
                s->wall[1].remove_at == 0.2);
    assert_true(s->gravity[2] == -1.62 && s->output.n_field == 2 && s->group[0].count == 10);
    scene_free(s);
}

static void finds_entries_by_name(void **state)
{
    const char *const set[] = {"walls.gate.motion.remove_at=never", "measure.energy.every=2 ms"};
    struct scene *s = read_with(*state, set, 2);
    assert_true(s->wall[1].remove_at == HUGE_VAL && s->measure[1].every == 2e-3 &&
                s->measure[0].every == 1e-3);
    scene_free(s);
}

/* Entries behind it move up, for the changes after. */
static void takes_entries_away(void **state)
{
    const char *const set[] = {"measure[0]=", "walls.gate=", "measure[0].every=5 ms"};
    struct scene *s = read_with(*state, set, 3);
    assert_int_equal(s->n_wall, 1);
    assert_string_equal(s->wall[0].name, "funnel");
    assert_string_equal(s->measure[0].name, "energy");
    assert_true(s->measure[0].every == 5e-3);
    scene_free(s);
}

static void creates_and_takes_away(void **state)
{
    const char *const set[] = {
        "walls.funnel.motion.oscillation={amplitude: [1 mm, 0, 0], frequency: 50}",
        "partition.threshold=0.5",
        "contacts[0].rolling.model=cdt",
        "contacts[0].rolling.friction=0.1",
        "contacts[0].binding=",
        "contacts[1].normal.damping_ratio=null",
        "contacts[1].normal.restitution=1",
    };
    struct scene *s = read_with(*state, set, 7);
    assert_true(s->wall[0].frequency == 50 && s->partition.threshold == 0.5 &&
                s->contact[0].rolling == ROLLING_CDT);
    assert_true(s->contact[0].binding_force == 0 && s->contact[1].damping_ratio == 0 &&
                s->contact[1].restitution == 1);
    scene_free(s);
}

static void the_last_one_counts(void **state)
{
    const char *const set[] = {"time.end=1", "time.end=2"};
    struct scene *s = read_with(*state, set, 2);
    assert_true(s->time.end == 2);
    scene_free(s);
}

static void messages_name_the_option(void **state)
{
    struct fixture *f = *state;
    fixture_copy(f, "v_funnel.yaml");
    const char *const set[] = {
        "time.end=1 mm",
        "tme.end=2",
        "walls.gat.motion.remove_at=1",
        "walls[7].name=x",
        "foo",
        "=1",
        "a..b=1",
        "contacts[0].normal.stifness=3",
        "measure[0].every=[1",
        "time.step.x=2",
        "domain.box[0]=1",
        "domain[0]=1",
        "gravity[3]=1",
        "partition.method=grpah",
    };
    const char *const message[] = {
        "--set time.end=1 mm: time.end: 'mm' is the unit of a length; expected a time, as in '1 s'",
        "--set tme.end=2: tme: unknown key; did you mean 'time'?",
        "--set walls.gat.motion.remove_at=1: walls.gat: no entry of that name; did you mean "
        "'gate'?",
        "--set walls[7].name=x: walls[7]: no such entry, there are [0] to [1]",
        "--set foo: expected KEY=VALUE",
        "--set =1: expected KEY=VALUE",
        "--set a..b=1: cannot read 'a..b' as a key like walls[1].motion.remove_at",
        "--set contacts[0].normal.stifness=3: contacts[0].normal.stifness: unknown key; did you "
        "mean 'stiffness'?",
        "--set measure[0].every=[1: measure[0].every: not valid YAML: did not find expected ',' "
        "or ']', while parsing a flow sequence (from line 1)",
        "--set time.step.x=2: time.step.x: its parent is a single value, not a mapping",
        "--set domain.box[0]=1: domain.box: the scene does not give this list; set it as a whole",
        "--set domain[0]=1: domain[0]: its parent is a mapping, not a list",
        "--set gravity[3]=1: gravity[3]: no such entry, there are [0] to [2]",
        "--set partition.method=grpah: partition.method: unknown word 'grpah'; did you mean "
        "'graph'?",
    };
    fixture_expect(f, set, 14, message, 14);
}

/* Those of the file come first. */
static void file_and_option(void **state)
{
    struct fixture *f = *state;
    fixture_scene(f,
        "method: particles\ntime: {end: 1}\nmaterials: {m: {density: 0}}\n"
        "elements: [{name: e, material: m, file: bed.csv}]\ncontacts: [{between: [m, m]}]\n");
    const char *const set[] = {"time.end=0"};
    const char *const message[] = {
        "scene.yaml:3:26: materials.m.density: 0 is out of range: must be > 0",
        "scene.yaml:4:41: elements[0].file: cannot read 'bed.csv': No such file or directory",
        "--set time.end=0: time.end: 0 is out of range: must be > 0",
    };
    fixture_expect(f, set, 1, message, 3);
}

#define TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        TEST(changes_values),
        TEST(finds_entries_by_name),
        TEST(takes_entries_away),
        TEST(creates_and_takes_away),
        TEST(the_last_one_counts),
        TEST(messages_name_the_option),
        TEST(file_and_option),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
