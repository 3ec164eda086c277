#include "force_fixture.h"

#include <string.h>

#include "comm/fail.h"

enum { N_STEP = 5 };
static const struct force_test *under_test;
static uint64_t seed;

double force_any(void)
{
    return scratch_random(&seed, -1, 1);
}

double force_between(double low, double high)
{
    return scratch_random(&seed, low, high);
}

void force_rotation(double *r)
{
    scratch_rotation(&seed, r);
}

void force_element(const struct force_run *run, struct record *element, double radius)
{
    int material = WITH_MATERIALS && force_any() < 0;
    double own = WITH_SIZES ? radius * (2 + force_any()) / 2 : radius;
    double mass = run->contacts.material[material].density * 4.18879 * own * own * own;
    memset(element, 0, sizeof *element);
    element->radius = (preal)own;
    element->inverse_m = (real)(1 / mass);
    for (int a = 0; a < 3; a++) {
        element->v[a] = (real)force_any();
#if WITH_SPIN
        element->w[a] = (real)(100 * force_any());
#endif
#if WITH_KICK
        element->kick[a] = (float)(0.1 * force_any());
#endif
#if WITH_SPIN_KICK
        element->spun[a] = (float)(10 * force_any());
#endif
    }
#if WITH_SPIN
    element->material = (real)material;
#endif
}

struct kinematics_motion force_motion(const struct record *i, const struct record *j)
{
    static const struct record none;
    vec3 zero = v3(0, 0, 0);
    if (!j) j = &none;
    struct kinematics_motion m =
        kinematics_free(v3(i->v[0], i->v[1], i->v[2]), v3(j->v[0], j->v[1], j->v[2]), zero, zero);
#if WITH_SPIN
    m.w_i = v3(i->w[0], i->w[1], i->w[2]);
    m.w_j = v3(j->w[0], j->w[1], j->w[2]);
#endif
#if WITH_KICK
    m.kick = v3_sub(v3(i->kick[0], i->kick[1], i->kick[2]), v3(j->kick[0], j->kick[1], j->kick[2]));
#endif
#if WITH_SPIN_KICK
    m.spun_i = v3(i->spun[0], i->spun[1], i->spun[2]);
    m.spun_j = v3(j->spun[0], j->spun[1], j->spun[2]);
#endif
    return m;
}

void force_parameters(struct force_run *run, bool wall, double radius, double mass)
{
    for (int r = 0; r < FORCE_ROWS; r++) {
        int a = r / N_MATERIAL, b = r % N_MATERIAL;
        contact_scene_row(&run->contacts, a, b, wall, radius, mass, run->row[r]);
        for (int c = 0; c < TABLE_WIDTH; c++) run->table[r][c] = (real)run->row[r][c];
    }
    launch_set_int_if(run->launch, "n_material", N_MATERIAL);
    if (!launch_has(run->launch, "table")) contact_table_set(run->launch, run->row[0]);
    launch_set_real(run->launch, "dt", STEP);
}

void force_move(struct record *element, int n)
{
    for (int e = 0; e < n; e++)
        for (int a = 0; a < 3; a++) {
            element[e].x[a] += (preal)STEP * (preal)element[e].v[a];
            element[e].v[a] += (real)(0.1 * force_any());
        }
}

void force_history(int *state, real *history, size_t capacity, size_t at)
{
    state[at] = 0;
    if (!WITH_HISTORY || at % 3 == 1) return;
    state[at] = CONTACT_TOUCHING | (WITH_COHESION ? CONTACT_BONDED : 0);
    for (size_t c = 0; c < 3; c++) {
        if (WITH_TANGENTIAL) history[(XI_AT + c) * capacity + at] = (real)(1e-5 * force_any());
        if (WITH_ROLLING_EPSD) history[(THETA_AT + c) * capacity + at] = (real)(1e-3 * force_any());
    }
}

void force_check_ledger(const double *device, double *host, size_t capacity, size_t at,
    struct contact_result r, double work)
{
    double own[LEDGER_WIDTH];
    if (!WITH_ENERGY) return;
    for (size_t c = 0; c < LEDGER_WIDTH; c++) own[c] = host[c * capacity + at];
    contact_scene_ledger(r, own);
#if WITH_WALL_WORK
    own[LEDGER_WORK] += work;
#else
    (void)work;
#endif
    for (size_t c = 0; c < LEDGER_WIDTH; c++) {
        host[c * capacity + at] = own[c];
        fixture_same("ledger", at, device[c * capacity + at], own[c]);
    }
}

void force_count(struct force_run *run, int before, int after)
{
    run->n_touching += after != 0;
    run->n_apart += after == 0;
    run->n_ended += before != 0 && after == 0;
    run->n_begun += before == 0 && after != 0;
}

static void check_law(bool one_lane)
{
    const struct force_test *test = under_test;
    const char *const sources[] = {test->source, NULL};
    struct features features = fixture_features();
    struct force_run *run = fail_alloc(test->bytes);
    seed = test->seed;
    run->dev = fixture_device();
    run->dev->one_lane = one_lane;
    struct program *program = fixture_program(run->dev, &features, test->program, sources);
    run->launch = launch_create(program, test->kernel);
    launch_set_batch(run->launch, BATCH);
    reader_open(&run->reader, run->dev, &features);
    contact_scene_init(&run->contacts);
    test->set(run);
    for (int step = 0; step < N_STEP; step++) {
        test->check(run);
        test->move(run);
    }
    /* all kinds were there */
    assert_true(run->n_touching > 500 && run->n_apart > 300 && run->n_begun > 20);
    if (WITH_HISTORY) assert_true(run->n_ended > 20);
    reader_close(&run->reader);
    launch_free(run->launch);
    program_free(program);
    for (int b = 0; b < FORCE_BUFFERS; b++) buffer_free(&run->buffer[b]);
    device_free(run->dev);
    free(run);
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

int force_main(const struct force_test *test, int argc, char **argv)
{
    const struct CMUnitTest one[] = {cmocka_unit_test(batch_by_one_lane)},
                            many[] = {cmocka_unit_test(batch_by_many_lanes)};
    const char *lanes = argc > 1 ? argv[1] : "";
    under_test = test;
    int failed = strcmp(lanes, "many") ? cmocka_run_group_tests(one, NULL, NULL) : 0;
    return failed + (strcmp(lanes, "one") ? cmocka_run_group_tests(many, NULL, NULL) : 0);
}
