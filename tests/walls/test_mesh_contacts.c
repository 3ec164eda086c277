/* A sphere over a triangle mesh has one contact per local minimum of the distance: no gap and no
 * double count, wherever it lies on a plane however cut and turned; one contact on a ridge, two in
 * a valley. The mesh goes through an STL file, as a user's does. Compiled in double and in
 * float. */
#include "scratch.h"

#include "wall_reference.h"

enum { N = 5, N_MESH = 20, N_PLACE = 60, N_TRIANGLE = 2 * N * N };
static const double radius = 0.3;

/* Heights z of a sheet over the unit grid, cut into N x N cells; inner grid points move at random,
 * diagonals fall either way. */
static void make_sheet(uint64_t *state, const double turn[9], const double shift[3], double fold,
    double point[N + 1][N + 1][3], double *corner)
{
    /* of the cell's corners 0: (0,0), 1: (1,0), 2: (0,1), 3: (1,1) */
    static const int cut[2][6] = {{0, 1, 3, 0, 3, 2}, {0, 1, 2, 1, 3, 2}};
    for (int i = 0; i <= N; i++)
        for (int j = 0; j <= N; j++) {
            /* where the sheet is folded, points move along the fold only */
            bool on_fold = 2 * i == N + 1;
            double x = i + (i % N && !on_fold ? scratch_random(state, -0.3, 0.3) : 0),
                   y = j + (j % N ? scratch_random(state, -0.3, 0.3) : 0);
            double flat[3] = {x, y, fold * fabs(x - 0.5 * (N + 1))};
            scratch_turn(turn, flat, point[i][j]);
            for (int a = 0; a < 3; a++) point[i][j][a] += shift[a];
        }
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            const int *which = cut[scratch_random(state, 0, 1) < 0.5];
            for (int k = 0; k < 6; k++) {
                memcpy(corner, point[i + (which[k] & 1)][j + (which[k] >> 1)], 3 * sizeof(double));
                corner += 3;
            }
        }
}

struct sheet {
    double turn[9], point[N + 1][N + 1][3], corner[9 * N_TRIANGLE];
    struct wall wall;
    struct scene scene;
    struct walls *walls;
    struct wall_pose pose;
};

static void open_sheet(struct sheet *sheet, uint64_t *state, double fold)
{
    struct scene_errors errors = {0};
    double shift[3] = {
        scratch_random(state, -5, 5), scratch_random(state, -5, 5), scratch_random(state, -5, 5)};
    scratch_rotation(state, sheet->turn);
    make_sheet(state, sheet->turn, shift, fold, sheet->point, sheet->corner);
    sheet->wall = scratch_wall(SURFACE_STL);
    sheet->wall.stl = scratch_stl(sheet->corner, N_TRIANGLE);
    sheet->scene = scratch_scene(&sheet->wall, 1);
    sheet->walls = walls_create(&sheet->scene, &errors);
    assert_int_equal(errors.n, 0);
    assert_int_equal(sheet->walls->n_primitive, N_TRIANGLE);
    walls_poses(sheet->walls, 1e-3, 0, 1, &sheet->pose);
}

static void close_sheet(struct sheet *sheet)
{
    walls_free(sheet->walls);
    scratch_remove(sheet->wall.stl);
}

/* Contacts of a sphere at x with candidates up to radius (1 + skin), normals into n. */
static int count_contacts(const struct sheet *sheet, const double x[3], double skin, pvec3 *n)
{
    int candidate[N_TRIANGLE], n_candidate = 0, n_contact = 0;
    struct reference_contact contact[N_TRIANGLE];
    for (int k = 0; k < N_TRIANGLE; k++) {
        reference_contacts(sheet->walls, &sheet->pose, x, radius, &k, 1, contact);
        if ((double)contact[0].closest.distance <= radius * (1 + skin))
            candidate[n_candidate++] = k;
    }
    int n_minimum =
        reference_contacts(sheet->walls, &sheet->pose, x, radius, candidate, n_candidate, contact);
    for (int k = 0; k < n_minimum; k++)
        if (contact[k].share > 0 && (double)contact[k].valley.distance < radius)
            n[n_contact++] = contact[k].valley.n;
    return n_contact;
}

/* p + h m, m the sheet's own direction d turned. */
static void lift(
    const struct sheet *sheet, const double p[3], double dx, double dz, double h, double x[3])
{
    double d[3] = {dx, 0, dz}, m[3];
    scratch_turn(sheet->turn, d, m);
    for (int a = 0; a < 3; a++) x[a] = p[a] + h * m[a] / sqrt(dx * dx + dz * dz);
}

static void check_one(const struct sheet *sheet, const double p[3], double h)
{
    double x[3], up[3] = {0, 0, 1};
    pvec3 n[N_TRIANGLE];
    lift(sheet, p, 0, 1, h, x);
    for (int extent = 0; extent < 3; extent++) { /* the list's reach must not matter */
        assert_int_equal(count_contacts(sheet, x, extent * 0.7 + 1e-3, n), 1);
        scratch_turn(sheet->turn, up, x);
        double away = (double)n[0].x * x[0] + (double)n[0].y * x[1] + (double)n[0].z * x[2];
        assert_true(fabs(fabs(away) - 1) < 1e-4 && (away < 0) == (h > 0));
        lift(sheet, p, 0, 1, h, x);
    }
}

/* Faces, exactly over edges and vertices, and beside edges by 1e-2 to 1e-12 edge lengths, where
 * rules 2 and 3 must meet; from both sides, from a fifth of the radius to almost touching. */
static void test_plane_however_cut(void **unused)
{
    (void)unused;
    uint64_t state = 2024;
    for (int mesh = 0; mesh < N_MESH; mesh++) {
        struct sheet sheet;
        open_sheet(&sheet, &state, 0);
        for (int k = 0; k < N_PLACE; k++) {
            const double *t = sheet.corner + 9 * (int)scratch_random(&state, 0, N_TRIANGLE);
            double u = scratch_random(&state, 0, 1), v = scratch_random(&state, 0, 1 - u),
                   h = scratch_random(&state, 0.2, 0.999) * radius;
            double face[3], edge[3], beside[3], off = pow(10, -scratch_random(&state, 2, 12));
            for (int a = 0; a < 3; a++) {
                face[a] = t[a] + u * (t[3 + a] - t[a]) + v * (t[6 + a] - t[a]);
                edge[a] = t[a] + u * (t[3 + a] - t[a]);
                beside[a] = edge[a] + off * (t[6 + a] - t[a]);
            }
            h = k % 2 ? h : -h;
            check_one(&sheet, face, h);
            check_one(&sheet, edge, h);
            check_one(&sheet, beside, h);
            check_one(&sheet, t + 3 * (k % 3), h);
        }
        close_sheet(&sheet);
    }
}

/* Folded along a line of edges, 45 degrees up on each side: from below, over the ridge, one
 * contact; from above, in the valley, one on each side. */
static void test_ridge_and_valley(void **unused)
{
    (void)unused;
    uint64_t state = 11;
    for (int mesh = 0; mesh < N_MESH; mesh++) {
        struct sheet sheet;
        double x[3];
        pvec3 n[N_TRIANGLE];
        open_sheet(&sheet, &state, 1);
        for (int k = 0; k < N_PLACE; k++) {
            int i = (N + 1) / 2, j = 1 + (int)scratch_random(&state, 0, N - 2);
            /* every third over a vertex of the fold */
            double at = k % 3 ? scratch_random(&state, 0, 1) : 0, p[3];
            for (int a = 0; a < 3; a++)
                p[a] =
                    sheet.point[i][j][a] + at * (sheet.point[i][j + 1][a] - sheet.point[i][j][a]);
            lift(&sheet, p, scratch_random(&state, -0.9, 0.9), -1, 0.9 * radius, x);
            assert_int_equal(count_contacts(&sheet, x, 0.5, n), 1);
            /* both faces at h/sqrt(2) < radius */
            lift(&sheet, p, 0, 1, scratch_random(&state, 0.3, 1.4) * radius, x);
            assert_int_equal(count_contacts(&sheet, x, 0.5, n), 2);
            /* the two faces are perpendicular */
            assert_true(fabs((double)p3_dot(n[0], n[1])) < 1e-4);
        }
        close_sheet(&sheet);
    }
}

/* Beside the rim of the sheet its outer edges and corners are met once. */
static void test_rim(void **unused)
{
    (void)unused;
    uint64_t state = 3;
    for (int mesh = 0; mesh < N_MESH; mesh++) {
        struct sheet sheet;
        pvec3 n[N_TRIANGLE];
        double x[3];
        open_sheet(&sheet, &state, 0);
        for (int j = 0; j <= N; j++) {
            lift(&sheet, sheet.point[N][j], 1, scratch_random(&state, -1, 1), 0.7 * radius, x);
            assert_int_equal(count_contacts(&sheet, x, 0.5, n), 1);
        }
        close_sheet(&sheet);
    }
}

static struct wall_closest seen(double nx, double nz, double distance)
{
    struct wall_closest c = {.n = p3((preal)nx, 0, (preal)nz), .distance = (preal)distance};
    c.D = p3_scale(c.distance, c.n);
    return c;
}

/* History goes to a contact with nearly the same normal, and to no other; from wall to wall only
 * where the points are close. */
static void test_hand_over(void **unused)
{
    (void)unused;
    struct wall_closest old = seen(0, 1, 0.3), near = seen(0.05, 0.99875, 0.3),
                        tilted = seen(0.5, 0.8660254, 0.3), far = seen(0.2, 0.98, 0.3);
    assert_true(wall_hands_over(old, near, 1, (preal)radius));
    assert_true(wall_hands_over(old, near, 0, (preal)radius));
    assert_true(wall_hands_over(old, far, 1, (preal)radius));
    assert_false(wall_hands_over(old, far, 0, (preal)radius));
    assert_false(wall_hands_over(old, tilted, 1, (preal)radius));
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_plane_however_cut),
        cmocka_unit_test(test_ridge_and_valley), cmocka_unit_test(test_rim),
        cmocka_unit_test(test_hand_over)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
