/* The rounded valley of law_fillet.h: a distance with a unit gradient that has no jump, the planes
 * themselves outside it, no trace of a face whose foot has left it; and on meshes of pipes, however
 * cut and tight, one contact whose overlap is continuous, while real corners keep two. How large a
 * ball touches a facet, against closed forms. */
#include "scratch.h"

#include "wall_reference.h"

static const double radius = 0.3;

static struct fillet_plane plane_at(
    const double n[3], const double on[3], const double x[3], double room)
{
    double distance = 0;
    for (int a = 0; a < 3; a++) distance += n[a] * (on[a] - x[a]);
    return fillet_plane(p3((preal)n[0], (preal)n[1], (preal)n[2]), (preal)distance, (preal)room);
}

/* Two planes through a line near the origin, normals 2 half apart, turned. */
struct valley {
    double n[2][3], on[3], room[2];
};

static struct valley make_valley(uint64_t *state, double half)
{
    struct valley v;
    double turn[9], left[3] = {sin(half), 0, cos(half)}, right[3] = {-sin(half), 0, cos(half)};
    scratch_rotation(state, turn);
    scratch_turn(turn, left, v.n[0]);
    scratch_turn(turn, right, v.n[1]);
    for (int a = 0; a < 3; a++) v.on[a] = scratch_random(state, -0.1, 0.1);
    /* some facets are too narrow for the ball, or leave less than a tenth of its radius */
    for (int k = 0; k < 2; k++) v.room[k] = radius * scratch_random(state, 0.95, 1.8);
    return v;
}

static struct fillet_plane met(const struct valley *v, int first, const double x[3])
{
    return fillet_of(plane_at(v->n[first], v->on, x, v->room[first]),
        plane_at(v->n[1 - first], v->on, x, v->room[1 - first]), radius);
}

/* Somewhere at the valley: across it by a part of what the rounding takes, above it. */
static void place(uint64_t *state, const struct valley *v, double half, double x[3])
{
    double across = scratch_random(state, -2, 2) * 0.1 * radius * half,
           over = scratch_random(state, 0.9, 1.02) * radius;
    for (int a = 0; a < 3; a++)
        x[a] = v->on[a] + across * (v->n[0][a] - v->n[1][a]) / (2 * sin(half)) -
               over * (v->n[0][a] + v->n[1][a]) / (2 * cos(half));
}

/* -grad distance = n, from both sides, by central differences; both orders of the planes agree. */
static void test_gradient(void **unused)
{
    (void)unused;
    uint64_t state = 41;
    int n_round = 0;
    for (int k = 0; k < 4000; k++) {
        double half = pow(10, -scratch_random(&state, 0.9, 3)), x[3], step = 1e-4 * half * radius;
        struct valley v = make_valley(&state, half);
        place(&state, &v, half, x);
        struct fillet_plane i = plane_at(v.n[0], v.on, x, v.room[0]),
                            j = plane_at(v.n[1], v.on, x, v.room[1]);
        int first = i.distance < j.distance ? 0 : 1;
        struct fillet_plane f = met(&v, first, x), g = met(&v, 1 - first, x);
        bool round = f.distance < fmin(i.distance, j.distance);
        assert_true(fabs((double)p3_dot(f.n, f.n) - 1) < 1e-12);
        n_round += round;
        if (!round) {
            assert_true(memcmp(&f, first == 0 ? &i : &j, sizeof f) == 0);
            continue;
        }
        assert_true(fabs(f.distance - g.distance) < 1e-14);
        for (int a = 0; a < 3; a++) {
            double up[3] = {x[0], x[1], x[2]}, down[3] = {x[0], x[1], x[2]};
            up[a] += step;
            down[a] -= step;
            double slope =
                       (met(&v, first, up).distance - met(&v, first, down).distance) / (2 * step),
                   n = a == 0   ? f.n.x
                       : a == 1 ? f.n.y
                                : f.n.z;
            assert_true(fabs(slope + n) < 1e-3 * half + 1e-10 / half);
        }
    }
    assert_true(n_round > 1000 && n_round < 3000);
}

/* A face whose foot has come to the edge of a nearer one, and planes that agree. */
static void test_no_trace(void **unused)
{
    (void)unused;
    for (double half = 0.3; half > 1e-4; half *= 0.7) {
        double c = cos(2 * half), depth = 0.8 * radius;
        struct fillet_plane near = fillet_plane(p3(0, 0, 1), depth, WALL_FAR),
                            left = fillet_plane(p3(sin(2 * half), 0, c), depth / c, WALL_FAR),
                            f = fillet_of(near, left, radius);
        assert_memory_equal(&f, &near, sizeof f);
        left = fillet_plane(near.n, depth * 1.001, WALL_FAR);
        f = fillet_of(near, left, radius);
        assert_memory_equal(&f, &near, sizeof f);
    }
}

enum { STRIPS = 48, PIECES = 3, PIPE_TRIANGLES = 2 * STRIPS * PIECES };

/* Pipe along z, corners at unit radius; strips cut at random heights, so that vertices lie within
 * edges of the neighbour when `torn`. */
static char *pipe_file(uint64_t *state, bool torn)
{
    static double corner[9 * PIPE_TRIANGLES];
    double *at = corner, cut[STRIPS][PIECES + 1];
    for (int s = 0; s < STRIPS; s++)
        for (int k = 0; k <= PIECES; k++)
            cut[s][k] = k % PIECES == 0 ? 4.0 * k / PIECES - 2
                                        : scratch_random(state, -0.5, 0.5) + 4.0 * k / PIECES - 2;
    for (int s = 0; s < STRIPS; s++)
        for (int k = 0; k < PIECES; k++) {
            double a = 2 * M_PI * s / STRIPS, b = 2 * M_PI * (s + 1) / STRIPS;
            const double *left = cut[torn ? s : 0], *right = torn ? left : cut[0];
            double quad[4][3] = {{cos(a), sin(a), left[k]}, {cos(b), sin(b), right[k]},
                {cos(b), sin(b), right[k + 1]}, {cos(a), sin(a), left[k + 1]}};
            static const int order[6] = {0, 1, 2, 0, 2, 3};
            for (int c = 0; c < 6; c++, at += 3) memcpy(at, quad[order[c]], sizeof quad[0]);
        }
    return scratch_stl(corner, PIPE_TRIANGLES);
}

/* Deepest overlap and number of contacts of a sphere at x. */
static int touch(const struct walls *walls, const struct wall_pose *pose, const double x[3],
    double own, double *overlap)
{
    static struct reference_contact contact[PIPE_TRIANGLES];
    static int all[PIPE_TRIANGLES];
    int n_touching = 0;
    for (int k = 0; k < walls->n_primitive; k++) all[k] = k;
    int n = reference_contacts(walls, pose, x, own, all, walls->n_primitive, contact);
    *overlap = 0;
    for (int k = 0; k < n; k++) {
        if (!(contact[k].share > 0) || !(contact[k].valley.distance < own)) continue;
        *overlap = own - contact[k].valley.distance;
        n_touching++;
    }
    return n_touching;
}

/* Round the pipe in small steps at a depth that overlaps several strips: always one contact, and
 * its overlap changes by no more than the way. So does that of a ball that nearly fills the pipe,
 * by no more than the strips lie off the circle. */
static void round_pipe(
    const struct walls *walls, const struct wall_pose *pose, double own, int n_step)
{
    double before = 0, rho = cos(M_PI / STRIPS) - own + 0.02;
    for (int k = 0; k < n_step; k++) {
        double angle = 2 * M_PI * k / 3000, overlap,
               x[3] = {rho * cos(angle), rho * sin(angle), 1.5 * sin(3 * angle)};
        assert_int_equal(touch(walls, pose, x, own, &overlap), 1);
        if (k > 0) assert_true(fabs(overlap - before) < rho * M_PI / STRIPS * 2 * M_PI / 3000);
        before = overlap;
    }
}

static void test_pipe_has_one_contact(void **unused)
{
    (void)unused;
    uint64_t state = 5;
    for (int torn = 0; torn < 2; torn++) {
        struct scene_errors errors = {0};
        struct wall wall = scratch_wall(SURFACE_STL);
        wall.stl = pipe_file(&state, torn);
        struct scene scene = scratch_scene(&wall, 1);
        struct walls *walls = walls_create(&scene, &errors);
        struct wall_pose pose;
        assert_non_null(walls);
        walls_poses(walls, 1e-3, 0, 1, &pose);
        round_pipe(walls, &pose, radius, 3000);
        round_pipe(walls, &pose, 0.95, 150); /* over two valleys */
        for (int k = 0; k < walls->n_primitive; k++) {
            const double *row = walls->primitive + WALL_PRIMITIVE_WIDTH * k;
            assert_true(fabs(row[9] / cos(M_PI / STRIPS) - 1) < 0.01 || row[9] >= WALL_FAR);
            assert_true(fabs(row[10] / cos(M_PI / STRIPS) - 1) < 0.01 || row[10] >= WALL_FAR);
            assert_true((row[9] < WALL_FAR) != (row[10] < WALL_FAR));
        }
        walls_free(walls);
        scratch_remove(wall.stl);
    }
}

/* A sheet of four strips along y, bent upwards twice and then down; cut by either diagonal. The
 * first three are one smooth surface from above; the last is much narrower than its neighbour. */
static void test_room_of_a_facet(void **unused)
{
    (void)unused;
    static const double turn[4] = {0, 0.1, 0.3, 0.2}, width[4] = {0.5, 1, 1.5, 0.2};
    double corner[9 * 8], x[5] = {0}, z[5] = {0}, *at = corner, t[3];
    for (int k = 0; k < 3; k++) t[k] = tan(0.5 * fabs(turn[k + 1] - turn[k]));
    double above = 3 / (2 * (t[0] + t[1]));
    const double room[2][4] = {
        {above, above, above, WALL_FAR}, {WALL_FAR, WALL_FAR, 1.5 / t[2], 0.2 / t[2]}};
    for (int k = 0; k < 4; k++) {
        x[k + 1] = x[k] + width[k] * cos(turn[k]);
        z[k + 1] = z[k] + width[k] * sin(turn[k]);
        double quad[4][3] = {
            {x[k], 0, z[k]}, {x[k + 1], 0, z[k + 1]}, {x[k + 1], 3, z[k + 1]}, {x[k], 3, z[k]}};
        static const int order[2][6] = {{0, 1, 2, 0, 2, 3}, {0, 1, 3, 3, 1, 2}};
        for (int c = 0; c < 6; c++, at += 3) memcpy(at, quad[order[k % 2][c]], sizeof quad[0]);
    }
    struct scene_errors errors = {0};
    struct wall wall = scratch_wall(SURFACE_STL);
    wall.stl = scratch_stl(corner, 8);
    struct scene scene = scratch_scene(&wall, 1);
    struct walls *walls = walls_create(&scene, &errors);
    assert_non_null(walls);
    for (int k = 0; k < 8; k++)
        for (int side = 0; side < 2; side++) {
            double found = walls->primitive[WALL_PRIMITIVE_WIDTH * k + 9 + side],
                   right = room[side][k / 2];
            assert_true(fabs(found / right - 1) < 0.01);
        }
    walls_free(walls);
    scratch_remove(wall.stl);
}

/* A floor of two files whose triangles meet in a T, and a third that lies in its plane over the
 * seam: one contact wherever a sphere touches them. A gate that stands out keeps its edge. */
static void test_flush_walls(void **unused)
{
    (void)unused;
    static const double left[18] = {-9, -5, 0, 0, -5, 0, 0, 5, 0, -9, -5, 0, 0, 5, 0, -9, 5, 0},
                        right[18] = {0, -5, 0, 9, -5, 0, 0, 1, 0, 9, -5, 0, 9, 5, 0, 0, 1, 0},
                        rest[9] = {0, 1, 0, 9, 5, 0, 0, 5, 0},
                        over[9] = {-2, 2, 0, 2, 2, 0, 0, 4, 0};
    const double *corner[4] = {left, right, rest, over};
    static const int n_triangle[4] = {2, 2, 1, 1};
    uint64_t state = 8;
    for (int raised = 0; raised < 2; raised++) {
        struct scene_errors errors = {0};
        struct wall wall[4];
        for (int w = 0; w < 4; w++) {
            wall[w] = scratch_wall(SURFACE_STL);
            wall[w].stl = scratch_stl(corner[w], n_triangle[w]);
        }
        wall[1].velocity[2] = 1; /* 1 mm in the step of the pose */
        struct scene scene = scratch_scene(wall, 4);
        struct walls *walls = walls_create(&scene, &errors);
        struct wall_pose pose[4];
        assert_non_null(walls);
        walls_poses(walls, 1e-3, raised, 1, pose);
        for (int k = 0; k < 400; k++) {
            double beside = pow(10, -scratch_random(&state, 0.6, 9)), overlap,
                   x[3] = {k % 2 ? beside : -beside, scratch_random(&state, -4, 4), 0.95 * radius};
            if (raised) x[0] = -0.04, x[1] = -fabs(x[1]);
            assert_int_equal(touch(walls, pose, x, radius, &overlap), 1 + raised);
        }
        walls_free(walls);
        for (int w = 0; w < 4; w++) scratch_remove(wall[w].stl);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_gradient),
        cmocka_unit_test(test_no_trace), cmocka_unit_test(test_pipe_has_one_contact),
        cmocka_unit_test(test_room_of_a_facet), cmocka_unit_test(test_flush_walls)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
