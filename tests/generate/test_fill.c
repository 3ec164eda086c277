/* Filled regions: every sphere whole within its region, no two overlapping, the number asked for,
 * from the lowest up, always the same. */
#include "../walls/scratch.h"

#include "particle/generate.h"

static struct element_group fill_group(enum region_kind kind)
{
    struct element_group group = {.name = "grains",
        .diameter = {0.1, 0.1},
        .jitter = 0.2,
        .seed = 1,
        .line = 9,
        .region = {.kind = kind, .scale = 1}};
    for (int a = 0; a < 3; a++) group.region.max[a] = 1.2;
    return group;
}

static struct scene fill_scene(struct element_group *group)
{
    struct scene scene = {
        .path = "scene.yaml", .group = group, .n_group = 1, .gravity = {0, 0, -9.81}};
    return scene;
}

static struct elements_host *fill(struct element_group *group)
{
    struct scene scene = fill_scene(group);
    struct scene_errors errors = {0};
    struct elements_host *e = generate_elements(&scene, &errors);
    assert_int_equal(errors.n, 0);
    return e;
}

/* Smallest gap between two surfaces [m], all pairs. */
static double smallest_gap(const struct elements_host *e)
{
    double gap = HUGE_VAL;
    for (int64_t i = 0; i < e->n; i++)
        for (int64_t j = 0; j < i; j++) {
            double d2 = 0;
            for (int a = 0; a < 3; a++)
                d2 += (e->x[3 * i + a] - e->x[3 * j + a]) * (e->x[3 * i + a] - e->x[3 * j + a]);
            gap = fmin(gap, sqrt(d2) - e->radius[i] - e->radius[j]);
        }
    return gap;
}

/* Edge 1.2 at pitch 0.12: 10 each way, and jitter 0.2 brings some pairs near to touching. */
static void test_box(void **unused)
{
    (void)unused;
    struct element_group group = fill_group(REGION_BOX);
    struct elements_host *e = fill(&group);
    assert_int_equal(e->n, 1000);
    for (int64_t k = 0; k < 3 * e->n; k++)
        assert_true(e->x[k] >= 0.05 - 1e-12 && e->x[k] <= 1.15 + 1e-12);
    double gap = smallest_gap(e);
    assert_true(gap > 0 && gap < 0.01);
    generate_free(e);
}

/* Sizes spread over their range, and displacements over theirs: mean and spread of uniform numbers
 * (spread of the mean: range/sqrt(12 n)). */
static void test_random_numbers(void **unused)
{
    (void)unused;
    struct element_group group = fill_group(REGION_BOX);
    group.diameter[0] = 0.02;
    struct elements_host *e = fill(&group);
    double low = 1, high = 0, mean = 0, square = 0;
    for (int64_t i = 0; i < e->n; i++) {
        low = fmin(low, e->radius[i]);
        high = fmax(high, e->radius[i]);
        mean += e->radius[i] / (double)e->n;
        for (int a = 0; a < 3; a++) { /* lattice points at 0.06 + 0.12 i */
            double shift = fmod(e->x[3 * i + a], 0.12) - 0.06;
            assert_true(fabs(shift) <= 0.01 + 1e-12);
            square += shift * shift / (3 * (double)e->n);
        }
    }
    assert_true(low >= 0.01 && low < 0.0102 && high <= 0.05 && high > 0.0498);
    assert_true(fabs(mean - 0.03) < 4 * 0.04 / sqrt(12 * (double)e->n));
    assert_true(fabs(square / (0.01 * 0.01 / 3) - 1) < 0.1);
    assert_true(smallest_gap(e) > 0);
    generate_free(e);
}

/* The first k of n are the k alone, bit for bit; another seed gives others; heights never fall by
 * more than the jitter. */
static void test_count_takes_the_lowest(void **unused)
{
    (void)unused;
    struct element_group group = fill_group(REGION_BOX);
    struct elements_host *all = fill(&group);
    group.count = 345;
    struct elements_host *some = fill(&group), *again = fill(&group);
    group.seed = 2;
    struct elements_host *other = fill(&group);
    assert_int_equal(some->n, 345);
    assert_memory_equal(some->x, all->x, 345 * 3 * sizeof(double));
    assert_memory_equal(some->x, again->x, 345 * 3 * sizeof(double));
    assert_memory_not_equal(some->x, other->x, 345 * 3 * sizeof(double));
    for (int64_t i = 1; i < all->n; i++)
        assert_true(all->x[3 * i + 2] > all->x[3 * i - 1] - 0.02 - 1e-12);
    generate_free(all);
    generate_free(some);
    generate_free(again);
    generate_free(other);
}

/* Whichever way gravity points, the chosen ones are the lowest lattice points. */
static void test_gravity(void **unused)
{
    (void)unused;
    const double gravity[6][3] = {
        {0, 0, 9.81}, {-1, 0, 0}, {0, 5, 0}, {1, 2, -3}, {0, 0, 0}, {0, -1e-200, 0}};
    for (int g = 0; g < 6; g++) {
        struct element_group group = fill_group(REGION_BOX);
        group.jitter = 0;
        struct scene scene = fill_scene(&group);
        struct scene_errors errors = {0};
        memcpy(scene.gravity, gravity[g], sizeof scene.gravity);
        struct elements_host *all = generate_elements(&scene, &errors);
        group.count = 500;
        struct elements_host *some = generate_elements(&scene, &errors);
        double up[3] = {-gravity[g][0], -gravity[g][1], g == 4 ? 1 : -gravity[g][2]},
               top = -HUGE_VAL;
        if (g == 5) up[1] = 1; /* the direction counts, not the length */
        int64_t n_below = 0;
        for (int64_t i = 0; i < some->n; i++)
            top = fmax(top,
                some->x[3 * i] * up[0] + some->x[3 * i + 1] * up[1] + some->x[3 * i + 2] * up[2]);
        for (int64_t i = 0; i < all->n; i++)
            n_below +=
                all->x[3 * i] * up[0] + all->x[3 * i + 1] * up[1] + all->x[3 * i + 2] * up[2] <
                top - 1e-9;
        assert_true(n_below < 500); /* those strictly below the highest chosen one are all chosen */
        generate_free(all);
        generate_free(some);
    }
}

static void test_cylinder(void **unused)
{
    (void)unused;
    struct element_group group = fill_group(REGION_CYLINDER);
    const double from[3] = {0.1, 0.2, 0.3}, to[3] = {0.5, 1.2, 1.1};
    memcpy(group.region.from, from, sizeof from);
    memcpy(group.region.to, to, sizeof to);
    group.region.radius = 0.4;
    struct elements_host *e = fill(&group);
    double length = 0, pitch = 0.12, volume;
    for (int a = 0; a < 3; a++) length += (to[a] - from[a]) * (to[a] - from[a]);
    length = sqrt(length);
    for (int64_t i = 0; i < e->n; i++) {
        double z = 0, square = 0;
        for (int a = 0; a < 3; a++) {
            z += (e->x[3 * i + a] - from[a]) * (to[a] - from[a]) / length;
            square += (e->x[3 * i + a] - from[a]) * (e->x[3 * i + a] - from[a]);
        }
        assert_true(
            z >= 0.05 - 1e-9 && z <= length - 0.05 + 1e-9 && sqrt(square - z * z) <= 0.35 + 1e-9);
    }
    volume = 3.14159265 * 0.35 * 0.35 * (length - 0.1); /* where centres may be */
    assert_true(fabs((double)e->n * pitch * pitch * pitch / volume - 1) < 0.1);
    assert_true(smallest_gap(e) > 0);
    generate_free(e);
}

/* A turned cube as STL holds what the check against its six planes allows, and about as many as by
 * volume. */
static void test_stl(void **unused)
{
    (void)unused;
    const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    double corner[108], turn[9];
    uint64_t state = 12;
    scratch_rotation(&state, turn);
    scratch_box(low, high, corner);
    for (int k = 0; k < 36; k++) scratch_turn(turn, corner + 3 * k, corner + 3 * k);
    struct element_group group = fill_group(REGION_STL);
    group.region.stl = scratch_stl(corner, 12);
    struct elements_host *e = fill(&group);
    for (int64_t i = 0; i < e->n; i++)
        for (int a = 0; a < 3; a++) {
            double q = turn[a] * e->x[3 * i] + turn[3 + a] * e->x[3 * i + 1] +
                       turn[6 + a] * e->x[3 * i + 2];
            assert_true(q >= 0.05 - 1e-9 && q <= 0.95 + 1e-9);
        }
    assert_true(fabs((double)e->n * 0.12 * 0.12 * 0.12 / (0.9 * 0.9 * 0.9) - 1) < 0.15);
    generate_free(e);
    scratch_remove(group.region.stl);
}

/* The case V-funnel: 10,600 spheres of 5 mm in the filling, none overlapping, none in the funnel's
 * wall or beyond its gate. */
static void test_v_funnel(void **unused)
{
    (void)unused;
    struct element_group group = fill_group(REGION_STL);
    group.diameter[0] = group.diameter[1] = 5e-3;
    group.jitter = 0.05;
    group.count = 10600;
    group.region.stl = CASES "/v_funnel/filling.stl";
    group.region.scale = 1e-3;
    struct elements_host *e = fill(&group);
    assert_int_equal(e->n, 10600);
    for (int64_t i = 0; i < e->n; i++) {
        const double *x = e->x + 3 * i;
        /* taper 1 : 2 above a neck of 60 mm */
        double half = x[2] < 0.06 ? 0.015 : fmin(0.135, 0.015 + 0.5 * (x[2] - 0.06));
        double slope = x[2] > 0.06 && x[2] < 0.3 ? sqrt(1.25) : 1;
        assert_true(
            x[2] > 2.5e-3 && fabs(x[1]) < 0.0125 && half - fabs(x[0]) > 2.5e-3 * slope - 1e-5);
    }
    generate_free(e);
}

/* A second group of other sizes in the same region, across its periodic faces too, finds its places
 * beside the first, the lowest that are left; it says so where they are not enough. */
static void test_two_groups(void **unused)
{
    (void)unused;
    struct element_group group[2] = {fill_group(REGION_BOX), fill_group(REGION_BOX)};
    group[0].count = 400;
    group[1].diameter[0] = 0.05;
    group[1].diameter[1] = 0.15;
    group[1].count = 50;
    group[1].seed = 2;
    struct scene scene = fill_scene(group);
    struct scene_errors errors = {0};
    scene.n_group = 2;
    scene.domain = (struct domain){.has_box = true, .periodic = {true, true}, .max = {1.2, 1.2, 9}};
    struct elements_host *e = generate_elements(&scene, &errors);
    assert_int_equal(errors.n, 0);
    assert_int_equal(e->n, 450);
    assert_int_equal(generate_overlaps(&scene, e).n, 0);
    assert_true(smallest_gap(e) > 0);
    double highest = 0;
    for (int64_t i = 0; i < 400; i++) highest = fmax(highest, e->x[3 * i + 2]);
    for (int64_t i = 400; i < 450; i++)
        assert_true(e->x[3 * i + 2] > highest - 0.3 && e->x[3 * i + 2] < highest + 0.5);
    generate_free(e);
    group[1].count = 400;
    assert_null(generate_elements(&scene, &errors));
    assert_int_equal(errors.n, 1);
    assert_non_null(strstr(errors.text[0], "400 elements were asked for, "));
    assert_non_null(strstr(errors.text[0], " fit into the region beside those of the groups"));
    scene_errors_free(&errors);
}

static void refuse(struct element_group *group, const char *text)
{
    struct scene scene = fill_scene(group);
    struct scene_errors errors = {0};
    assert_null(generate_elements(&scene, &errors));
    assert_int_equal(errors.n, 1);
    scratch_expect(&errors, 0, text);
    scene_errors_free(&errors);
}

static void test_refused(void **unused)
{
    (void)unused;
    const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    double corner[108];
    char text[300];
    struct element_group group = fill_group(REGION_BOX);
    group.count = 1001;
    refuse(&group,
        "scene.yaml:9: elements 'grains': 1001 elements were asked for, 1000 fit into the region");
    group.count = 0;
    group.region.max[1] = 0.08;
    refuse(&group, "scene.yaml:9: elements 'grains': no element of 0.1 m fits into the region");
    group = fill_group(REGION_STL);
    group.region.stl = "none.stl";
    refuse(&group, "scene.yaml:9: elements 'grains': none.stl: No such file or directory");
    scratch_box(low, high, corner);
    group.region.stl = scratch_stl(corner, 11);
    snprintf(text, sizeof text,
        "scene.yaml:9: elements 'grains': %s: a region needs a closed surface with triangles that "
        "all face one way: "
        "3 of its 18 edges do not match",
        group.region.stl);
    refuse(&group, text);
    scratch_remove(group.region.stl);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_box),
        cmocka_unit_test(test_random_numbers), cmocka_unit_test(test_count_takes_the_lowest),
        cmocka_unit_test(test_gravity), cmocka_unit_test(test_cylinder), cmocka_unit_test(test_stl),
        cmocka_unit_test(test_v_funnel), cmocka_unit_test(test_two_groups),
        cmocka_unit_test(test_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
