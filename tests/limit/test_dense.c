/* The limit of the densest packing, from the scene alone: known packings, sizes, numbers, impacts;
 * and the advice beside it. */
#include "limit_test.h"

#include <string.h>

#include "comm/fail.h"
#include "particle/contact_table.h"
#include "particle/limit.h"

static struct material mortar = {.name = "mortar", .density = 2200, .young = 1e7, .poisson = 0.2};
static struct contact linear = {.normal_law = NORMAL_LINEAR,
    .stiffness = 1e3,
    .attraction = true,
    .has_tangential = true,
    .stiffness_ratio = 0.8,
    .friction = 0.2};
static struct contact hertz = {.normal_law = NORMAL_HERTZ, .attraction = true};

static struct scene scene_of(struct contact *contact)
{
    struct scene s = {.material = &mortar,
        .n_material = 1,
        .contact = contact,
        .n_contact = 1,
        .time = {.end = 1}};
    return s;
}

/* n elements in a row, of radii r[0], r[1], r[0], ... */
static struct elements_host row_of(int64_t n, double r0, double r1)
{
    struct elements_host e = {.n = n};
    e.x = fail_alloc((size_t)n * 3 * sizeof(double));
    e.v = fail_alloc((size_t)n * 3 * sizeof(double));
    e.w = fail_alloc((size_t)n * 3 * sizeof(double));
    e.radius = fail_alloc((size_t)n * sizeof(double));
    e.material = fail_alloc((size_t)n * sizeof(int));
    e.group = fail_alloc((size_t)n * sizeof(int));
    for (int64_t i = 0; i < n; i++) {
        e.radius[i] = i % 2 ? r1 : r0;
        e.x[3 * i] = (double)i * 2 * fmax(r0, r1);
    }
    return e;
}

static void elements_free(struct elements_host *e)
{
    free(e->x);
    free(e->v);
    free(e->w);
    free(e->radius);
    free(e->material);
    free(e->group);
}

static double dense(const struct scene *s, int64_t n, double r0, double r1, double speed)
{
    struct elements_host e = row_of(n, r0, r1);
    double dt = limit_dense(s, &e, speed);
    elements_free(&e);
    return dt;
}

static double mass(double r)
{
    return mortar.density * 4 / 3 * M_PI * r * r * r;
}

/* Cases A and B: true limits 1.34e-4 and 6.23e-5 s (FCC); the bound with the best share is 0.822 of
 * that, damping takes a little. */
static void equal_spheres(void **state)
{
    (void)state;
    struct scene s = scene_of(&linear);
    assert_near(dense(&s, 100, 2.5e-3, 2.5e-3, 1), 0.822 * 1.342e-4, 2e-7);
    linear.damping_ratio = 0.02;
    assert_between(dense(&s, 100, 2.5e-3, 2.5e-3, 1), 1.04e-4, 0.822 * 1.34e-4);
    assert_between(dense(&s, 100, 1.5e-3, 1.5e-3, 1), 4.85e-5, 0.822 * 6.23e-5);
    linear.damping_ratio = 0;
}

/* As few as there are: none, a pair (exact), three, and from 13 on a full shell. */
static void numbers(void **state)
{
    (void)state;
    struct contact smooth = linear;
    smooth.has_tangential = false;
    struct scene s = scene_of(&smooth);
    double w = sqrt(1e3 / mass(2.5e-3));
    assert_true(isinf(dense(&s, 1, 2.5e-3, 2.5e-3, 1)));
    assert_near(dense(&s, 2, 2.5e-3, 2.5e-3, 1) * w, 2 / sqrt(2), 1e-6);
    /* above the true 2/3^(1/2) of a chain of three is nothing */
    assert_near(dense(&s, 3, 2.5e-3, 2.5e-3, 1) * w, 2 / sqrt(4), 1e-6);
    assert_near(dense(&s, 13, 2.5e-3, 2.5e-3, 1) * w, 2 / sqrt(8), 1e-6);
    assert_near(dense(&s, 1000, 2.5e-3, 2.5e-3, 1) * w, 2 / sqrt(8), 1e-6);
}

/* Small spheres set the limit, and the more of them fit round a large one the lower it is, but not
 * without end. */
static void mixed_sizes(void **state)
{
    (void)state;
    struct scene s = scene_of(&linear);
    double alone = dense(&s, 1000, 1e-3, 1e-3, 1), before = alone;
    for (double large = 1.5; large < 20; large *= 2) {
        double mixed = dense(&s, 1000, 1e-3, large * 1e-3, 1);
        assert_true(mixed <= before * (1 + 1e-9));
        before = mixed;
    }
    assert_between(before, 0.5 * alone, alone);
    double few = dense(&s, 3, 1e-3, 10e-3, 1); /* one large one and two small ones */
    assert_true(few > 1.2 * before);
}

/* A wall far stiffer than the elements counts. */
static void stiff_wall(void **state)
{
    (void)state;
    struct material both[2] = {mortar, {.name = "steel", .density = 7800}};
    struct contact contact[2] = {linear, linear};
    contact[1].between[1] = 1;
    contact[1].stiffness = 1e6;
    contact[1].has_tangential = false;
    struct wall wall = {.material = 1};
    struct scene s = {.material = both,
        .n_material = 2,
        .contact = contact,
        .n_contact = 2,
        .wall = &wall,
        .n_wall = 1};
    double w = sqrt(1e6 / mass(2.5e-3));
    assert_between(dense(&s, 1000, 2.5e-3, 2.5e-3, 1) * w, 1.9, 2);
    assert_near(dense(&s, 1, 2.5e-3, 2.5e-3, 1) * w, 2, 1e-6);
}

/* Two Hertz spheres that meet at v: K delta^(1/2) 3/2 at the deepest; K = (4/3) E* (r/2)^(1/2), E*
 * = E/(2 (1 - nu^2)). */
static void hertz_impact(void **state)
{
    (void)state;
    struct scene s = scene_of(&hertz);
    double r = 5e-3, v = 0.5, m = mass(r), K = 4.0 / 3 * 1e7 / (2 * (1 - 0.04)) * sqrt(r / 2);
    double column = pow(0.5 * mortar.density * v * v * 4 * r * r / K, 2.0 / 3),
           deepest = pow(pow(column, 2.5) + 1.25 * m / 2 * v * v / K, 0.4);
    double expected = 2 / sqrt(2 * 1.5 * K * sqrt(deepest) / m);
    assert_near(dense(&s, 2, r, r, v) / expected, 1, 1e-4);
    /* v^(-1/5) and a little more */
    assert_between(dense(&s, 2, r, r, 32 * v) / expected, 0.4, 0.55);
    assert_true(isfinite(dense(&s, 2, r, r, 0)));
}

/* Falls of the domain's height, but no longer than the run; walls come on top. */
static void speeds(void **state)
{
    (void)state;
    struct scene s = scene_of(&linear);
    struct wall wall = {.velocity = {0, 3, 4}, .amplitude = {0.01, 0, 0}, .frequency = 10};
    struct elements_host e = row_of(2, 1e-3, 1e-3);
    e.v[3] = 2;
    s.gravity[2] = -9.81;
    s.domain = (struct domain){.has_box = true, .min = {0, 0, 0}, .max = {1, 1, 0.6}};
    assert_near(limit_speed(&s, NULL, &e), sqrt(4 + 2 * 9.81 * 0.6), 1e-9);
    s.wall = &wall;
    s.n_wall = 1;
    assert_near(limit_speed(&s, NULL, &e), sqrt(4 + 2 * 9.81 * 0.6) + 5 + 2 * M_PI * 0.1, 1e-9);
    s.n_wall = 0;
    s.time.end = 0.01;
    assert_near(limit_speed(&s, NULL, &e), 2 + 0.0981, 1e-9);
    elements_free(&e);
}

static int warnings(const struct scene *s, double dt, double speed, const char *word)
{
    struct elements_host e = row_of(100, 2.5e-3, 2.5e-3);
    struct scene_errors out = {NULL, 0};
    limit_warnings(s, NULL, &e, speed, dt, &out);
    int n = out.n;
    if (word) assert_non_null(strstr(out.text[0], word));
    scene_errors_free(&out);
    elements_free(&e);
    return n;
}

/* Case A: contact pi (m/2k)^(1/2) = 8.43e-4 s; bonds of 5 um that hold up to F_b/(k m/2)^(1/2) =
 * 1.86 cm/s are crossed in 2.7e-4 s. */
static void advice(void **state)
{
    (void)state;
    struct contact bonded = linear;
    bonded.binding_force = 5e-3;
    struct scene s = scene_of(&linear), b = scene_of(&bonded);
    assert_int_equal(warnings(&s, 4.1e-5, 3, NULL), 0);
    assert_int_equal(
        warnings(&s, 4.3e-5, 3, "the shortest contact lasts 0.000843 s, 19.6 time steps"), 1);
    assert_int_equal(warnings(&s, 4.1e-5, 7, "of the smallest radius in one time step"), 1);
    assert_int_equal(warnings(&b, 2.6e-5, 3, NULL), 0);
    assert_int_equal(
        warnings(&b, 2.8e-5, 3, "bonds act up to a gap of 5e-06 m (pull-off force over stiffness)"),
        1);
    assert_int_equal(warnings(&b, 2.8e-5, 1e-3, NULL), 0); /* nothing is that fast */
}

/* What lists and `check` ask of the law: F_b/k and F_b of a bond; 0 of a plain contact. */
static void reach_and_pull(void **state)
{
    (void)state;
    struct contact bonded = linear;
    bonded.binding_force = 5e-3;
    struct scene plain = scene_of(&linear), bond = scene_of(&bonded);
    double row[MATERIAL_WIDTH];
    contact_table_material(&plain, 0, 0, row);
    assert_true(contact_table_reach(row, 1e-3) <= 0 && contact_table_pull(row, 1e-3) <= 0);
    contact_table_material(&bond, 0, 0, row);
    assert_near(contact_table_reach(row, 1e-3) / (5e-3 / linear.stiffness), 1, 1e-12);
    assert_near(contact_table_pull(row, 1e-3) / 5e-3, 1, 1e-12);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(equal_spheres), cmocka_unit_test(numbers),
        cmocka_unit_test(mixed_sizes), cmocka_unit_test(stiff_wall), cmocka_unit_test(hertz_impact),
        cmocka_unit_test(speeds), cmocka_unit_test(advice), cmocka_unit_test(reach_and_pull)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
