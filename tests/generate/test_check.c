/* The checks of the start: coincident elements, elements outside the domain, elements in walls. */
#include "../walls/scratch.h"

#include "particle/generate.h"
#include "shape/walls.h"

static struct elements_host *generate_from(
    const char *csv, struct domain domain, struct scene_errors *errors)
{
    char *path = scratch_file(csv, strlen(csv));
    struct element_group group = {.name = "grains", .from_file = true, .file = path, .line = 4};
    struct scene scene = {.path = "scene.yaml", .group = &group, .n_group = 1, .domain = domain};
    if (!(domain.start_overlap > 0)) scene.domain.start_overlap = HUGE_VAL;
    struct elements_host *e = generate_elements(&scene, errors);
    scratch_remove(path);
    return e;
}

/* The threshold is 1e-3 of the smaller radius; other overlaps are accepted up to a share. */
static void test_coincident(void **unused)
{
    (void)unused;
    struct domain open = {0};
    struct scene_errors errors = {0};
    struct elements_host *e = generate_from(
        "x,y,z,radius\n0,0,0,1\n1.01e-3,0,0,1\n0,5,0,0.1\n0,5.00011,0,10\n", open, &errors);
    assert_non_null(e);
    generate_free(e);
    assert_null(
        generate_from("x,y,z,radius\n0,0,0,1\n3,0,0,1\n0.99e-3,0,0,1\n0,5,0,0.1\n0,5.00009,0,10\n",
            open, &errors));
    assert_int_equal(errors.n, 2);
    scratch_expect(&errors, 0,
        "scene.yaml:4: element 0 of group 'grains' and element 2 of group 'grains' coincide at "
        "(0.00099, 0, 0)");
    scratch_expect(&errors, 1,
        "scene.yaml:4: element 3 of group 'grains' and element 4 of group 'grains' coincide at "
        "(0, 5.00009, 0)");
    scene_errors_free(&errors);
}

/* Pairs at random distances around the threshold, anywhere on the grid of cells: found exactly if
 * nearer. */
static void test_coincident_at_random(void **unused)
{
    (void)unused;
    uint64_t state = 31;
    for (int k = 0; k < 300; k++) {
        char csv[400];
        double x[3], y[3], d[3], length = 0, distance = scratch_random(&state, 0, 2e-3);
        for (int a = 0; a < 3; a++) {
            x[a] = scratch_random(&state, -0.02, 0.02);
            d[a] = scratch_random(&state, -1, 1);
            length += d[a] * d[a];
        }
        for (int a = 0; a < 3; a++) y[a] = x[a] + distance * d[a] / sqrt(length);
        snprintf(csv, sizeof csv,
            "x,y,z,radius\n%.17g,%.17g,%.17g,1\n9,9,9,1.5\n%.17g,%.17g,%.17g,1\n", x[0], x[1], x[2],
            y[0], y[1], y[2]);
        struct scene_errors errors = {0};
        struct domain open = {0};
        struct elements_host *e = generate_from(csv, open, &errors);
        assert_int_equal(e == NULL, distance < 1e-3);
        generate_free(e);
        scene_errors_free(&errors);
    }
}

/* Opposite corners of a fully periodic box are one point. */
static void test_coincident_across_faces(void **unused)
{
    (void)unused;
    struct domain domain = {.has_box = true, .periodic = {true, true, true}, .max = {10, 20, 30}};
    struct scene_errors errors = {0};
    assert_null(generate_from("x,y,z,radius\n10,0,30,1\n5,5,5,1\n0,20,0,1\n", domain, &errors));
    assert_int_equal(errors.n, 1);
    scratch_expect(&errors, 0,
        "scene.yaml:4: element 0 of group 'grains' and element 2 of group 'grains' coincide at "
        "(0, 20, 0)");
    scene_errors_free(&errors);
    domain.periodic[1] = false;
    struct elements_host *e =
        generate_from("x,y,z,radius\n10,0,30,1\n5,5,5,1\n0,20,0,1\n", domain, &errors);
    assert_non_null(e);
    generate_free(e);
}

/* Two images of a partner, or of the element itself, must not be within reach. */
static void test_short_period(void **unused)
{
    (void)unused;
    struct domain domain = {.has_box = true, .periodic = {true, false, true}, .max = {5.9, 3, 6}};
    struct scene_errors errors = {0};
    assert_null(generate_from("x,y,z,radius\n1,1,1,1.5\n4,1,4,0.5\n", domain, &errors));
    assert_int_equal(errors.n, 1);
    scratch_expect(&errors, 0,
        "scene.yaml: domain: periodic in x over 5.9 m, which has to be at least twice the largest "
        "diameter, 3 m");
    scene_errors_free(&errors);
    domain.max[0] = 6;
    struct elements_host *e =
        generate_from("x,y,z,radius\n1,1,1,1.5\n4,1,4,0.5\n", domain, &errors);
    assert_non_null(e);
    generate_free(e);
}

/* Twenty thousand times the same point: three are named, and it takes no time. */
static void test_all_in_one_place(void **unused)
{
    (void)unused;
    enum { N = 20000 };
    char *csv = malloc(N * 8 + 20);
    size_t size = (size_t)sprintf(csv, "x,y,z,radius\n");
    for (int k = 0; k < N; k++) size += (size_t)sprintf(csv + size, "0,0,0,1\n");
    struct domain open = {0};
    struct scene_errors errors = {0};
    assert_null(generate_from(csv, open, &errors));
    assert_int_equal(errors.n, 4);
    scratch_expect(&errors, 3, "scene.yaml:4: and 19996 more elements coincide with others");
    scene_errors_free(&errors);
    free(csv);
}

static void test_outside_the_domain(void **unused)
{
    (void)unused;
    struct domain domain = {.has_box = true, .max = {1, 1, 1}};
    struct scene_errors errors = {0};
    assert_null(generate_from(
        "x,y,z,radius\n0.5,0.5,0.5,0.1\n0.5,0.5,1.5,0.1\n-1,0,0,1\n-2,0,0,1\n-3,0,0,1\n", domain,
        &errors));
    assert_int_equal(errors.n, 4);
    scratch_expect(&errors, 0,
        "scene.yaml:4: element 1 of group 'grains' at (0.5, 0.5, 1.5) is outside the domain");
    scratch_expect(&errors, 3, "scene.yaml:4: and 1 more elements are outside the domain");
    scene_errors_free(&errors);
}

/* Elements of radius 1 at height z over a wall of each kind in the plane z = 0: allowed until half
 * the radius is in. */
static void check_heights(struct wall wall, const double *height, int n, int n_bad, double x)
{
    struct element_group group = {.name = "grains"};
    double position[30] = {0}, radius[10];
    int of_group[10] = {0};
    struct elements_host e = {.n = n, .x = position, .radius = radius, .group = of_group};
    struct scene scene = scratch_scene(&wall, 1);
    struct scene_errors errors = {0};
    scene.group = &group;
    scene.n_group = 1;
    for (int i = 0; i < n; i++) {
        radius[i] = 1;
        position[3 * i] = x;
        position[3 * i + 2] = height[i];
    }
    struct walls *walls = walls_create(&scene, &errors);
    generate_check_walls(&scene, walls, &e, &errors);
    assert_int_equal(errors.n, n_bad);
    if (n_bad == 1) {
        char text[200];
        snprintf(text, sizeof text,
            "scene.yaml:7: element %d of group 'grains' at (%g, 0, %g) is inside wall 'wall'",
            n - 1, x, height[n - 1]);
        scratch_expect(&errors, 0, text);
    }
    walls_free(walls);
    scene_errors_free(&errors);
}

static void test_in_walls(void **unused)
{
    (void)unused;
    struct wall wall = scratch_wall(SURFACE_PLANE);
    const double fine[4] = {3, 1, 0.8, 0.51}, deep[5] = {3, 1, 0.8, 0.51, 0.49},
                 behind[6] = {1, -0.6, -2, -100, -3, -4};
    check_heights(wall, fine, 4, 0, 0);
    check_heights(wall, deep, 5, 1, 0);
    check_heights(wall, behind, 6, 4, 0); /* five, of which three are named */
    wall = scratch_wall(SURFACE_RECTANGLE);
    wall.size[0] = wall.size[1] = 4;
    check_heights(wall, fine, 4, 0, 1);
    check_heights(wall, deep, 5, 1, 1);
    check_heights(wall, behind, 6, 0, 1);  /* two-sided: below is as good as above */
    wall = scratch_wall(SURFACE_CYLINDER); /* along y, its top at z = 0 */
    wall.from[1] = -5;
    wall.to[1] = 5;
    wall.from[2] = wall.to[2] = -20;
    wall.radius = 20;
    check_heights(wall, fine, 4, 0, 0);
    check_heights(wall, deep, 5, 1, 0);
    check_heights(wall, behind + 1, 2, 2, 0); /* a rod is solid */
    wall.inside = true;
    check_heights(wall, behind, 2, 0, 0);
}

/* A mesh that a phase of its oscillation puts elsewhere at t = 0, and walls that are not there
 * yet. */
static void test_in_a_moved_wall(void **unused)
{
    (void)unused;
    const double corner[18] = {-9, -9, 0, 9, -9, 0, 9, 9, 0, -9, -9, 0, 9, 9, 0, -9, 9, 0},
                 fine[2] = {3.6, 0}, deep[2] = {3.6, 3.4};
    struct wall wall = scratch_wall(SURFACE_STL);
    wall.stl = scratch_stl(corner, 2);
    wall.amplitude[2] = 3;
    wall.phase = 3.14159265358979 / 2;
    wall.frequency = 1;
    check_heights(wall, fine, 2, 0, 0);
    check_heights(wall, deep, 2, 1, 0);
    wall.appear_at = 0.1;
    check_heights(wall, deep, 2, 0, 0);
    scratch_remove(wall.stl);
}

/* All pairs of 300 elements with radii from 1 to 100, in a periodic box: as many, and the same
 * deepest one, as by brute force. */
static void test_overlaps(void **unused)
{
    (void)unused;
    enum { N = 300 };
    double x[3 * N], radius[N];
    struct elements_host e = {.n = N, .x = x, .radius = radius};
    for (int k = 0; k < 4; k++) {
        struct scene scene = {.domain = {.has_box = true, .periodic = {k & 1, k & 2, true}}};
        uint64_t state = 7 + (uint64_t)k;
        for (int a = 0; a < 3; a++) scene.domain.max[a] = 500 + 50 * a;
        for (int i = 0; i < N; i++) {
            radius[i] = pow(100, scratch_random(&state, 0, 1));
            for (int a = 0; a < 3; a++)
                x[3 * i + a] = scratch_random(&state, 0, scene.domain.max[a]);
        }
        struct generate_overlaps expected = {.element = {-1, -1}},
                                 found = generate_overlaps(&scene, &e);
        for (int i = 0; i < N; i++)
            for (int j = 0; j < i; j++) {
                double d2 = 0;
                for (int a = 0; a < 3; a++) {
                    double d = fabs(x[3 * i + a] - x[3 * j + a]);
                    if (scene.domain.periodic[a]) d = fmin(d, scene.domain.max[a] - d);
                    d2 += d * d;
                }
                double depth = radius[i] + radius[j] - sqrt(d2),
                       share = depth / fmin(radius[i], radius[j]);
                if (!(depth > 0)) continue;
                expected.n++;
                if (!(share > expected.share)) continue;
                expected.share = share;
                expected.depth = depth;
                expected.element[0] = j;
                expected.element[1] = i;
            }
        assert_true(expected.n > 100);
        assert_int_equal(found.n, expected.n);
        assert_true(
            found.element[0] == expected.element[0] && found.element[1] == expected.element[1]);
        assert_true(
            fabs(found.depth - expected.depth) < 1e-9 && fabs(found.share - expected.share) < 1e-9);
    }
}

static void test_overlaps_refused(void **unused)
{
    (void)unused;
    struct domain domain = {.start_overlap = 0.25};
    struct scene_errors errors = {0};
    const char *csv = "x,y,z,radius\n0,0,0,1\n1.76,0,0,1\n9,0,0,0.1\n9,1.06,0,1\n";
    assert_null(generate_from(csv, domain, &errors));
    assert_int_equal(errors.n, 1);
    scratch_expect(&errors, 0,
        "scene.yaml:4: element 2 of group 'grains' and element 3 of group 'grains' at (9, 1.06, 0) "
        "overlap by 0.04 m, 0.4 of the smaller radius, one of 2 pairs that overlap at the start; "
        "domain.start_overlap, the most that is accepted, is 0.25");
    scene_errors_free(&errors);
    domain.start_overlap = 0.41;
    struct elements_host *e = generate_from(csv, domain, &errors);
    assert_non_null(e);
    generate_free(e);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_coincident),
        cmocka_unit_test(test_coincident_at_random), cmocka_unit_test(test_coincident_across_faces),
        cmocka_unit_test(test_short_period), cmocka_unit_test(test_all_in_one_place),
        cmocka_unit_test(test_outside_the_domain), cmocka_unit_test(test_in_walls),
        cmocka_unit_test(test_in_a_moved_wall), cmocka_unit_test(test_overlaps),
        cmocka_unit_test(test_overlaps_refused)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
