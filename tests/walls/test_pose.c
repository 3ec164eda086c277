/* Motion of walls: the velocity of every point is its displacement over the step, batches are
 * single steps, walls come and go on step boundaries. */
#include "scratch.h"

#include "kernels/contact/law_wall.h"
#include "shape/walls.h"

static const double pi = 3.14159265358979323846;

static struct wall_frame frame_of(const struct wall_pose *pose)
{
    const double *r = pose->rotation, *t = pose->translation;
    struct wall_frame frame = {
        p3(r[0], r[1], r[2]), p3(r[3], r[4], r[5]), p3(r[6], r[7], r[8]), p3(t[0], t[1], t[2])};
    return frame;
}

static pvec3 point_of(const double *p)
{
    return p3(p[0], p[1], p[2]);
}

static double distance_of(pvec3 a, pvec3 b)
{
    pvec3 d = p3_sub(a, b);
    return sqrt(p3_dot(d, d));
}

/* A wall with every kind of motion at once. */
static struct wall moving_wall(uint64_t *state)
{
    struct wall wall = scratch_wall(SURFACE_RECTANGLE);
    double length = 0;
    wall.size[0] = 0.4;
    wall.size[1] = 0.2;
    for (int a = 0; a < 3; a++) {
        wall.velocity[a] = scratch_random(state, -1, 1);
        wall.amplitude[a] = scratch_random(state, -0.1, 0.1);
        wall.rotation_center[a] = scratch_random(state, -1, 1);
        wall.rotation_axis[a] = scratch_random(state, -1, 1);
        wall.point[a] = scratch_random(state, -1, 1);
        length += wall.rotation_axis[a] * wall.rotation_axis[a];
    }
    for (int a = 0; a < 3; a++) wall.rotation_axis[a] /= sqrt(length);
    wall.rotation_rate = scratch_random(state, -30, 30);
    wall.frequency = scratch_random(state, 1, 20);
    wall.phase = scratch_random(state, 0, 6);
    return wall;
}

/* V + W x (p_h - c) = (p^n - p^(n-1))/dt, for steps from tiny to a sixth of a turn; V, W of the
 * half step, p_h the mean of both places. */
static void test_velocity_is_displacement(void **unused)
{
    (void)unused;
    uint64_t state = 9;
    for (int k = 0; k < 200; k++) {
        struct wall wall = moving_wall(&state);
        struct scene scene = scratch_scene(&wall, 1);
        struct scene_errors errors = {0};
        struct walls *walls = walls_create(&scene, &errors);
        struct wall_pose pose[2];
        double dt = pow(10, -scratch_random(&state, 1.5, 6));
        walls_poses(walls, dt, (int64_t)scratch_random(&state, 0, 1000), 2, pose);
        for (int point = 0; point < 5; point++) {
            pvec3 q = p3(scratch_random(&state, -1, 1), scratch_random(&state, -1, 1),
                scratch_random(&state, -1, 1));
            pvec3 before = wall_to_world(frame_of(pose), q),
                  after = wall_to_world(frame_of(pose + 1), q);
            pvec3 middle = p3_scale(0.5, p3_add(before, after));
            pvec3 arm = p3_sub(middle, point_of(pose[1].centre));
            vec3 v = wall_velocity(v3_of_p3(point_of(pose[1].velocity)),
                v3_of_p3(point_of(pose[1].spin)), v3_of_p3(arm));
            /* positions of order 100 m at most, rounded */
            assert_true(distance_of(p3_scale(dt, p3_of_v3(v)), p3_sub(after, before)) < 1e-13);
        }
        walls_free(walls);
    }
}

/* A quarter of a turn about a centre that moves along, by hand; oscillation starts at A
 * sin(phase). */
static void test_places(void **unused)
{
    (void)unused;
    struct wall wall[2] = {scratch_wall(SURFACE_RECTANGLE), scratch_wall(SURFACE_PLANE)};
    wall[0].size[0] = wall[0].size[1] = 1;
    wall[0].rotation_center[0] = 1;
    wall[0].rotation_rate = pi / 2;
    wall[0].velocity[2] = 3;
    wall[1].amplitude[1] = 0.5;
    wall[1].frequency = 2;
    wall[1].phase = pi / 6;
    struct scene scene = scratch_scene(wall, 2);
    struct scene_errors errors = {0};
    struct walls *walls = walls_create(&scene, &errors);
    struct wall_pose pose[4];
    walls_poses(walls, 1, 0, 2, pose);
    assert_true(distance_of(wall_to_world(frame_of(pose), p3(2, 0, 0)), p3(2, 0, 0)) < 1e-15);
    assert_true(distance_of(wall_to_world(frame_of(pose + 2), p3(2, 0, 0)), p3(1, 1, 3)) < 1e-15);
    assert_true(fabs(pose[1].translation[1] - 0.25) < 1e-15);
    assert_int_equal(walls->n_moving, 2);
    walls_free(walls);
}

/* A batch gives the bits of single calls, also when it starts late. */
static void test_batch(void **unused)
{
    (void)unused;
    enum { FIRST = 12345, N = 17 };
    uint64_t state = 4;
    struct wall wall[3] = {moving_wall(&state), scratch_wall(SURFACE_PLANE), moving_wall(&state)};
    struct scene scene = scratch_scene(wall, 3);
    struct scene_errors errors = {0};
    struct walls *walls = walls_create(&scene, &errors);
    struct wall_pose batch[3 * N], one[3];
    walls_poses(walls, 1e-5, FIRST, N, batch);
    for (int s = 0; s < N; s++) {
        walls_poses(walls, 1e-5, FIRST + s, 1, one);
        for (int w = 0; w < 3; w++) {
            assert_memory_equal(batch[3 * s + w].rotation, one[w].rotation, sizeof one[w].rotation);
            assert_memory_equal(
                batch[3 * s + w].translation, one[w].translation, sizeof one[w].translation);
            assert_memory_equal(batch[3 * s + w].velocity, one[w].velocity, sizeof one[w].velocity);
        }
    }
    assert_true(walls->moves[0] && !walls->moves[1] && walls->moves[2]);
    const double identity[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    assert_memory_equal(batch[1].rotation, identity, sizeof identity);
    walls_free(walls);
}

/* remove_at 0.3 s at dt = 1e-5 s: active through step 29,999. 0.3/1e-5 is not 30,000 in floating
 * point. */
static void test_appear_and_remove(void **unused)
{
    (void)unused;
    struct wall wall = scratch_wall(SURFACE_PLANE);
    wall.appear_at = 0.1;
    wall.remove_at = 0.3;
    struct scene scene = scratch_scene(&wall, 1);
    struct scene_errors errors = {0};
    struct walls *walls = walls_create(&scene, &errors);
    /* 0.1/7e-5 = 1428.6, 0.3/7e-5 = 4285.7 */
    const int64_t step[4] = {9999, 10000, 29999, 30000}, after[4] = {1428, 1429, 4285, 4286};
    for (int k = 0; k < 4; k++) {
        struct wall_pose pose;
        walls_poses(walls, 1e-5, step[k], 1, &pose);
        assert_int_equal(pose.active, k == 1 || k == 2);
        walls_poses(walls, 7e-5, after[k], 1, &pose);
        assert_int_equal(pose.active, k == 1 || k == 2);
    }
    walls_free(walls);
}

/* No point of the wall moves further than walls_displacement says, and at a corner of its bounds it
 * is reached. */
static void test_displacement(void **unused)
{
    (void)unused;
    uint64_t state = 6;
    for (int k = 0; k < 100; k++) {
        struct wall wall = moving_wall(&state);
        struct scene scene = scratch_scene(&wall, 1);
        struct scene_errors errors = {0};
        struct walls *walls = walls_create(&scene, &errors);
        struct wall_pose a, b;
        double far = 0;
        walls_poses(walls, 1e-3, 10, 1, &a);
        walls_poses(walls, 1e-3, 60, 1, &b);
        double largest = walls_displacement(walls, 0, &a, &b, NULL, NULL);
        for (int corner = 0; corner < 8; corner++) {
            double q[3];
            for (int c = 0; c < 3; c++)
                q[c] = corner >> c & 1 ? walls->wall_high[c] : walls->wall_low[c];
            far = fmax(far, distance_of(wall_to_world(frame_of(&a), point_of(q)),
                                wall_to_world(frame_of(&b), point_of(q))));
        }
        assert_true(fabs(far - largest) < 1e-12);
        for (int corner = 0; corner < 4; corner++) {
            const double *row = walls->primitive;
            pvec3 q = p3_fma(corner & 1 ? row[9] : -row[9], point_of(row + 3), point_of(row));
            q = p3_fma(corner & 2 ? row[10] : -row[10], point_of(row + 6), q);
            assert_true(distance_of(wall_to_world(frame_of(&a), q),
                            wall_to_world(frame_of(&b), q)) <= largest + 1e-12);
        }
        walls_free(walls);
    }
}

/* A plane that slides in itself does not come nearer to anything; one that rises by 2 mm does by 2
 * mm; one that turns, by the angle times the distance. */
static void test_displacement_of_planes(void **unused)
{
    (void)unused;
    const double low[3] = {0, 0, 0}, high[3] = {2, 1, 1};
    for (int k = 0; k < 3; k++) {
        struct wall wall = scratch_wall(SURFACE_PLANE);
        wall.velocity[0] = k == 0;
        wall.velocity[2] = k == 1 ? 2 : 0;
        wall.rotation_axis[1] = 1;
        wall.rotation_axis[2] = 0;
        wall.rotation_rate = k == 2;
        struct scene scene = scratch_scene(&wall, 1);
        struct scene_errors errors = {0};
        struct walls *walls = walls_create(&scene, &errors);
        struct wall_pose a, b;
        walls_poses(walls, 1e-3, 0, 1, &a);
        walls_poses(walls, 1e-3, 1, 1, &b);
        double expected[3] = {0, 2e-3, 2 * sin(1e-3) - (cos(1e-3) - 1)},
               tolerance = k == 2 ? 1e-6 : 1e-15;
        assert_true(
            fabs(walls_displacement(walls, 0, &a, &b, low, high) - expected[k]) < tolerance);
        walls_free(walls);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_velocity_is_displacement),
        cmocka_unit_test(test_places), cmocka_unit_test(test_batch),
        cmocka_unit_test(test_appear_and_remove), cmocka_unit_test(test_displacement),
        cmocka_unit_test(test_displacement_of_planes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
