/* The table of primitives: order, kinds, bounds, the axes of a rectangle, which triangles share
 * what, messages about files. */
#include "scratch.h"

#include "kernels/contact/law_wall.h"
#include "shape/walls.h"

static void test_axes(void **unused)
{
    (void)unused;
    const double normal[6][3] = {
        {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -3, 0}, {0, 0, 1}, {0, 0, -1}};
    for (int k = 0; k < 6; k++) {
        double u[3], v[3];
        walls_axes(normal[k], u, v);
        for (int a = 0; a < 3; a++) {
            assert_true(u[a] == (a == (k < 2 ? 1 : 0)));
            assert_true(v[a] == (a == (k < 4 ? 2 : 1)));
        }
    }
    uint64_t state = 2;
    for (int k = 0; k < 200; k++) {
        double m[3] = {scratch_random(&state, -1, 1), scratch_random(&state, -1, 1),
            scratch_random(&state, -1, 1)},
               u[3], v[3];
        double mu = 0, mv = 0, uv = 0, uu = 0, vv = 0;
        walls_axes(m, u, v);
        for (int a = 0; a < 3; a++) {
            mu += m[a] * u[a];
            mv += m[a] * v[a];
            uv += u[a] * v[a];
            uu += u[a] * u[a];
            vv += v[a] * v[a];
        }
        assert_true(fabs(mu) < 1e-15 && fabs(mv) < 1e-15 && fabs(uv) < 1e-15 &&
                    fabs(uu - 1) < 1e-15 && fabs(vv - 1) < 1e-15);
    }
}

/* plane, box, mesh, rectangle, rod: 1, 6, 12, 1, 1 primitives in this order. */
static void test_order(void **unused)
{
    (void)unused;
    const double low[3] = {0, 0, 0}, high[3] = {1, 2, 3};
    double corner[108];
    scratch_box(low, high, corner);
    char *path = scratch_stl(corner, 12);
    struct wall wall[5] = {scratch_wall(SURFACE_PLANE), scratch_wall(SURFACE_BOX),
        scratch_wall(SURFACE_STL), scratch_wall(SURFACE_RECTANGLE), scratch_wall(SURFACE_CYLINDER)};
    for (int a = 0; a < 3; a++) wall[1].max[a] = 1;
    wall[2].stl = path;
    wall[2].scale = 0.1;
    wall[3].size[0] = 2;
    wall[3].size[1] = 4;
    wall[4].to[2] = 5;
    wall[4].radius = 0.5;
    struct scene scene = scratch_scene(wall, 5);
    struct scene_errors errors = {0};
    struct walls *walls = walls_create(&scene, &errors);
    const int first[6] = {0, 1, 7, 19, 20, 21}, of_kind[5] = {7, 1, 0, 1, 12};
    assert_memory_equal(walls->first, first, sizeof first);
    assert_memory_equal(walls->n_of_kind, of_kind, sizeof of_kind);
    for (int w = 0; w < 5; w++)
        for (int k = first[w]; k < first[w + 1]; k++) assert_int_equal(walls->wall_of[k], w);
    assert_true(walls->low[0] == -HUGE_VAL && walls->wall_high[3] == HUGE_VAL);
    for (int a = 0; a < 3; a++) {
        const double half[3] = {1, 2, 0}, round[3] = {0.5, 0.5, 5};
        assert_true(walls->wall_low[6 + a] == 0 && walls->wall_high[6 + a] == 0.1 * high[a]);
        assert_true(walls->wall_high[9 + a] == half[a] && walls->wall_low[9 + a] == -half[a]);
        assert_true(fabs(walls->wall_high[12 + a] - round[a]) < 1e-15);
    }
    walls_free(walls);
    scratch_remove(path);
}

/* Inside the box the distance to each of its planes is positive, one further out negative. */
static void test_box_faces_inwards(void **unused)
{
    (void)unused;
    struct wall wall = scratch_wall(SURFACE_BOX);
    for (int a = 0; a < 3; a++) wall.max[a] = 2 + a;
    struct scene scene = scratch_scene(&wall, 1);
    struct scene_errors errors = {0};
    struct walls *walls = walls_create(&scene, &errors);
    for (int k = 0; k < 6; k++) {
        double in[3] = {1, 1, 1}, out[3] = {1, 1, 1};
        in[k / 2] = k % 2 ? 2 + k / 2 - 0.25 : 0.25;
        out[k / 2] = k % 2 ? 2 + k / 2 + 0.25 : -0.25;
        struct wall_primitive plane = WALL_PRIMITIVE(walls->primitive, k);
        assert_true(wall_closest(plane, p3(in[0], in[1], in[2])).distance == 0.25);
        assert_true(wall_closest(plane, p3(out[0], out[1], out[2])).distance == -0.25);
    }
    walls_free(walls);
}

/* On a cube each edge is shared by two triangles; the lists agree with the numbers of each
 * triangle; a second mesh has numbers of its own. */
static void test_sharing(void **unused)
{
    (void)unused;
    const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    double corner[108];
    scratch_box(low, high, corner);
    char *path = scratch_stl(corner, 12);
    struct wall wall[3] = {
        scratch_wall(SURFACE_STL), scratch_wall(SURFACE_PLANE), scratch_wall(SURFACE_STL)};
    wall[0].stl = wall[2].stl = path;
    struct scene scene = scratch_scene(wall, 3);
    struct scene_errors errors = {0};
    struct walls *walls = walls_create(&scene, &errors);
    assert_int_equal(walls->n_feature, 2 * (18 + 8));
    assert_int_equal(walls->share_first[walls->n_feature], 2 * 12 * 6);
    for (int f = 0; f < walls->n_feature; f++) {
        int n = walls->share_first[f + 1] - walls->share_first[f];
        assert_true(f % 26 < 18 ? n == 2 : n >= 3);
        for (int s = walls->share_first[f]; s < walls->share_first[f + 1]; s++) {
            assert_true(wall_shares(WALL_FEATURES(walls->features, walls->share[s]), f));
            assert_true(s == walls->share_first[f] || walls->share[s] > walls->share[s - 1]);
            assert_int_equal(walls->wall_of[walls->share[s]], f < 26 ? 0 : 2);
        }
    }
    assert_false(wall_shares(WALL_FEATURES(walls->features, 12), 0)); /* the plane has none */
    walls_free(walls);
    scratch_remove(path);
}

/* Each unreadable file is named with the wall and its line; all are reported. */
static void test_messages(void **unused)
{
    (void)unused;
    struct wall wall[2] = {scratch_wall(SURFACE_STL), scratch_wall(SURFACE_STL)};
    wall[0].stl = "no.stl";
    wall[1].stl = "none.stl";
    wall[1].name = "other";
    wall[1].line = 12;
    struct scene scene = scratch_scene(wall, 2);
    struct scene_errors errors = {0};
    assert_null(walls_create(&scene, &errors));
    assert_int_equal(errors.n, 2);
    scratch_expect(&errors, 0, "scene.yaml:7: wall 'wall': no.stl: No such file or directory");
    scratch_expect(&errors, 1, "scene.yaml:12: wall 'other': none.stl: No such file or directory");
    scene_errors_free(&errors);
}

static struct wall rectangle(double x, double z, double normal_x, double half)
{
    struct wall wall = scratch_wall(SURFACE_RECTANGLE);
    double length = sqrt(1 + normal_x * normal_x);
    wall.point[0] = x;
    wall.point[2] = z;
    wall.normal[0] = normal_x / length;
    wall.normal[2] = 1 / length;
    wall.size[0] = wall.size[1] = 2 * half;
    return wall;
}

/* Two walls, of which the second may be a plane, in either order. */
static void check_flush(struct wall a, struct wall b, bool expected)
{
    for (int order = 0; order < 2; order++) {
        struct scene_errors errors = {0};
        struct wall wall[2] = {order ? b : a, order ? a : b};
        struct scene scene = scratch_scene(wall, 2);
        struct walls *walls = walls_create(&scene, &errors);
        assert_non_null(walls);
        assert_int_equal(walls_flush(walls), expected);
        walls_free(walls);
    }
}

static void flush(void **unused)
{
    (void)unused;
    struct wall floor = rectangle(0, 0, 0, 1), plane = scratch_wall(SURFACE_PLANE);
    check_flush(floor, rectangle(2, 0, 0, 1), true);      /* side by side */
    check_flush(floor, rectangle(1.5, 0, 0, 1), true);    /* over each other */
    check_flush(floor, rectangle(0, 1e-7, 0, 0.1), true); /* one within the other */
    check_flush(floor, rectangle(2.01, 0, 0, 1), false);  /* a gap */
    check_flush(floor, rectangle(2, 0.01, 0, 1), false);  /* a step */
    check_flush(floor, rectangle(0, 0, 0.01, 1), false);  /* it crosses */
    check_flush(floor, plane, true);
    check_flush(plane, plane, false);
    struct wall gate = rectangle(7, 0, 0, 1); /* it slides in, or may */
    gate.velocity[0] = -1;
    check_flush(floor, gate, true);
    gate = rectangle(7, 2, 0, 1);
    gate.velocity[0] = -1;
    check_flush(floor, gate, false);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(flush), cmocka_unit_test(test_axes),
        cmocka_unit_test(test_order), cmocka_unit_test(test_box_faces_inwards),
        cmocka_unit_test(test_sharing), cmocka_unit_test(test_messages)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
