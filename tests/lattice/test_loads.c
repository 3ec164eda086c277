/* What acts on cells: whom a boundary selects, sums of forces and moments, pressures, rows and
 * their sharing, histories, messages. */
#include "cells_fixture.h"

/* The rows at time t, velocities over [from, to]; owned by the caller. */
static double (*rows_at(const struct cut cut, double t, double from, double to))[LOAD_WIDTH]
{
    double(*rows)[LOAD_WIDTH] = fail_alloc((size_t)cut.cells->loads->n_row * sizeof *rows);
    lattice_loads_at(cut.cells->loads, cut.scene, t, from, to, rows[0]);
    return rows;
}

/* Total force, and total moment about the origin, of bodies at rest: force and B on centres, levers
 * as torques sum over a of e_a x L_a. */
static void total(const struct cut cut, double force[3], double moment[3])
{
    double(*rows)[LOAD_WIDTH] = rows_at(cut, 0, 0, 0);
    memset(force, 0, 3 * sizeof *force);
    memset(moment, 0, 3 * sizeof *moment);
    for (int64_t i = 0; i < cut.cells->n; i++) {
        const double *row = rows[cut.cells->row[i]], *lever = row + LOAD_LEVER;
        double x[3], f[3];
        lattice_cells_centre(cut.cells, i, x);
        for (int c = 0; c < 3; c++) f[c] = row[LOAD_FORCE + c] + row[LOAD_BODY + c];
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            force[a] += f[a];
            moment[a] += x[b] * f[c] - x[c] * f[b];
            /* e_b x L_b has -L_b[c]... : component a of sum over d of e_d x L_d */
            moment[a] += lever[3 * b + c] - lever[3 * c + b];
        }
    }
    free(rows);
}

static void expect_near(const double x[3], double a, double b, double c, double scale)
{
    const double y[3] = {a, b, c};
    for (int k = 0; k < 3; k++)
        if (!(fabs(x[k] - y[k]) < 1e-14 * scale))
            fail_msg("component %d: %.17g, expected %.17g", k, x[k], y[k]);
}

/* A bar of 10 x 3 x 2 cells of 0.1 m, the last face loaded: the force acts in the middle of that
 * face, at (1, 0.15, 0.1). */
#define BAR BODY("bar", "a", "0.1", BOX(0, 0, 0, 1, 0.3, 0.2))
#define END "{" BOX(0.99, -1, -1, 1.01, 1, 1) "}"

static void force_on_a_face(void **state)
{
    struct cut cut =
        cut_scene(*state, LATTICE(BAR "boundaries:\n - {where: " END ", force: [7, 11, 13]}\n"));
    double force[3], moment[3];
    total(cut, force, moment);
    expect_near(force, 7, 11, 13, 30);
    expect_near(moment, 0.15 * 13 - 0.1 * 11, 0.1 * 7 - 1 * 13, 1 * 11 - 0.15 * 7, 30);
    double(*rows)[LOAD_WIDTH] = rows_at(cut, 0, 0, 0);
    assert_int_equal(cut.cells->loads->n_row, 2);
    for (int64_t i = 0; i < cut.cells->n; i++)
        assert_int_equal(cut.cells->row[i], cut.cells->at[i][0] == 9);
    /* t.n = 7 N/(6 h^2) of each face, by the normals at the start */
    assert_true(fabs(rows[1][LOAD_TRACTION] - 7 / 0.06) < 1e-11 &&
                fabs(rows[1][LOAD_LEVER + 1] - 0.05 * 11 / 6) < 1e-15);
    for (int c = 0; c < LOAD_WIDTH; c++) assert_true(rows[0][c] == 0);
    free(rows);
    cut_free(cut);
}

/* Faces by their own centres: a region with the whole last layer also takes the faces around it, 6
 * + 3 + 3 + 2 + 2 in all. */
static void force_on_a_layer(void **state)
{
    struct cut cut = cut_scene(*state, LATTICE(BAR "boundaries:\n - {where: {" BOX(
                                           0.9, -1, -1, 2, 1, 1) "}, force: [0, 0, -16]}\n"));
    double force[3], moment[3];
    total(cut, force, moment);
    expect_near(force, 0, 0, -16, 20);
    /* middles: end face at 1, the ten others at 0.95 */
    expect_near(moment, 0.15 * -16, (6 * 1 + 10 * 0.95), 0, 30);
    double(*rows)[LOAD_WIDTH] = rows_at(cut, 0, 0, 0);
    for (int64_t i = 0; i < cut.cells->n; i++) {
        int n = 0;
        for (int f = 0; f < 6; f++) n += !(cut.cells->bits[i] & (1 << f));
        assert_true(rows[cut.cells->row[i]][LOAD_FORCE + 2] == (cut.cells->at[i][0] == 9 ? -n : 0));
    }
    free(rows);
    cut_free(cut);
}

/* Within a body there is no face: equal shares on the centres. */
static void force_on_centres(void **state)
{
    struct cut cut = cut_scene(*state,
        LATTICE(CUBE(
            5) "boundaries:\n - {where: {sphere: {center: [2.5, 2.5, 2.5], radius: 1}}, force: "
               "[3, 0, 14]}\n"));
    double force[3], moment[3];
    total(cut, force, moment);
    expect_near(force, 3, 0, 14, 20);
    expect_near(moment, 2.5 * 14, 2.5 * 3 - 2.5 * 14, -2.5 * 3, 200);
    double(*rows)[LOAD_WIDTH] = rows_at(cut, 0, 0, 0);
    int64_t n = 0;
    for (int64_t i = 0; i < cut.cells->n; i++) n += cut.cells->row[i] == 1;
    assert_true(n == 7 && cut.cells->loads->n_row == 2 && rows[1][LOAD_FORCE + 2] == 2 &&
                rows[1][LOAD_TRACTION] == 0);
    free(rows);
    cut_free(cut);
}

/* p A n on a face of 3 x 2 cells; nothing in all on a closed surface; the traction of each cell is
 * -p times its faces. */
static void pressures(void **state)
{
    struct cut cut =
        cut_scene(*state, LATTICE(BAR "boundaries:\n - {where: " END ", pressure: 5}\n"));
    double force[3], moment[3];
    total(cut, force, moment);
    expect_near(force, -5 * 0.06, 0, 0, 1);
    expect_near(moment, 0, 0.1 * -0.3, 0.15 * 0.3, 1);
    cut_free(cut);
    cut = cut_scene(*state,
        LATTICE(BODY("ball", "a", "0.1",
            "sphere: {center: [0, 0, 0], radius: 0.5}") "boundaries:\n - {where: all, pressure: "
                                                        "2}\n"));
    total(cut, force, moment);
    expect_near(force, 0, 0, 0, 1);
    expect_near(moment, 0, 0, 0, 1);
    double(*rows)[LOAD_WIDTH] = rows_at(cut, 0, 0, 0), up = 0;
    for (int64_t i = 0; i < cut.cells->n; i++) {
        const double *row = rows[cut.cells->row[i]];
        int n = 0;
        for (int f = 0; f < 6; f++) n += !(cut.cells->bits[i] & (1 << f));
        assert_true(row[LOAD_TRACTION] == -2 * n);
        up += fmax(0, -row[LOAD_BODY + 2]);
    }
    /* seen from above, the ball shows its columns of cells */
    int64_t columns = 0;
    for (int64_t i = 0; i < cut.cells->n; i++) columns += !(cut.cells->bits[i] & LINK_BIT(2, 1));
    assert_true(fabs(up - 2 * 0.01 * (double)columns) < 1e-13);
    free(rows);
    cut_free(cut);
}

/* Three forces on overlapping layers: cells with the same set of them share a row, and rows are
 * numbered as cells come. */
static void rows_are_shared(void **state)
{
    struct cut cut = cut_scene(
        *state, LATTICE(BAR "boundaries:\n"
                            " - {where: {" BOX(-1, -1, -1, 0.6, 1,
                                1) "}, acceleration: [1, 0, 0]}\n"
                                   " - {where: {" BOX(0.3, -1, -1, 2, 1,
                                       1) "}, acceleration: [0, 20, 0], history: {ramp: 4}}\n"
                                          " - {where: {body: bar}, acceleration: [0, 0, 3]}\n"));
    double(*rows)[LOAD_WIDTH] = rows_at(cut, 1, 0, 0);
    assert_int_equal(cut.cells->loads->n_row, 4);
    assert_int_equal(cut.cells->loads->begin[4], 2 + 3 + 2);
    for (int64_t i = 0; i < cut.cells->n; i++) {
        int x = cut.cells->at[i][0];
        assert_int_equal(cut.cells->row[i], x < 3 ? 1 : x < 6 ? 2 : 3);
        const double *a = rows[cut.cells->row[i]] + LOAD_ACCELERATION;
        assert_true(a[0] == (x < 6) && a[1] == (x >= 3 ? 5 : 0) && a[2] == 3);
    }
    free(rows);
    cut_free(cut);
}

/* Forces as they are at t, velocities as their mean over the drift; free components stay with the
 * forces. */
static void histories(void **state)
{
    struct cut cut =
        cut_scene(*state, LATTICE(BAR "boundaries:\n"
                                      " - {where: " END ", force: [6, 0, 0], history: {ramp: 2}}\n"
                                      " - {where: {" BOX(-1, -1, -1, 0.1, 1,
                                          1) "}, velocity: [free, 0, 8], history: {ramp: 2}}\n"
                                             " - {where: {" BOX(-1, -1, -1, 0.1, 1,
                                                 1) "}, angular_velocity: [1, free, free]}\n"));
    double(*rows)[LOAD_WIDTH] = rows_at(cut, 0.5, 1, 4);
    const double *first = rows[cut.cells->row[0]], *last = rows[cut.cells->row[cut.cells->n - 1]];
    assert_true(fabs(last[LOAD_FORCE] - 0.25) < 1e-15);
    /* a ramp: value over time */
    assert_true(fabs(last[LOAD_RATE] * 0.5 - last[LOAD_TRACTION]) < 1e-12 && last[LOAD_RATE] > 0);
    assert_true(
        first[LOAD_NOW + 2] == 8 * 0.25 && first[LOAD_NOW + 3] == 1 && first[LOAD_NOW] == 0);
    /* (integral of t/2 from 1 to 2) + 2 over 3 */
    assert_true(fabs(first[LOAD_VELOCITY + 2] - 8 * (0.75 + 2) / 3) < 1e-14 &&
                first[LOAD_VELOCITY + 3] == 1 && first[LOAD_VELOCITY] == 0);
    assert_int_equal(cut.cells->bits[0] & CELL_FIXED, CELL_FIX(1) | CELL_FIX(2) | CELL_FIX(3));
    free(rows);
    cut_free(cut);
}

/* One boundary over two grids: the lever is half of each one's own edge. */
static void two_grids(void **state)
{
    struct cut cut =
        cut_scene(*state, LATTICE(BODY("one", "a", "1", BOX(0, 0, 0, 1, 1, 1)) BODY("two", "a", "2",
                              BOX(5, 0, 0, 7, 2, 2)) "boundaries:\n - {where: {" BOX(-1, -1, -1, 9,
                              9, 0.01) "}, force: [2, 0, 0]}\n"));
    double(*rows)[LOAD_WIDTH] = rows_at(cut, 0, 0, 0);
    assert_true(cut.cells->n == 2 && cut.cells->loads->n_row == 3);
    for (int i = 0; i < 2; i++)
        assert_true(rows[i + 1][LOAD_FORCE] == 1 && rows[i + 1][LOAD_LEVER + 6] == -0.5 * (i + 1));
    free(rows);
    cut_free(cut);
}

/* Centres and faces on the region's surface to rounding are in it: 0.1 cells, and a region that
 * ends at their centres and faces. */
static void selection_on_surfaces(void **state)
{
    struct cut cut =
        cut_scene(*state, LATTICE(BAR "boundaries:\n"
                                      " - {where: {" BOX(0.35, 0, 0, 0.55, 0.3,
                                          0.2) "}, fix: [x]}\n"
                                               " - {where: {body: bar, " BOX(1, 0.05, 0.05, 1, 0.15,
                                                   0.15) "}, force: [0, 1, 0]}\n"));
    int64_t n_fix = 0, n_load = 0;
    for (int64_t i = 0; i < cut.cells->n; i++) {
        int x = cut.cells->at[i][0], y = cut.cells->at[i][1];
        assert_int_equal((cut.cells->bits[i] & CELL_FIX(0)) != 0, x >= 3 && x <= 5);
        assert_int_equal(cut.cells->row[i], x == 9 && y < 2);
        n_fix += (cut.cells->bits[i] & CELL_FIXED) != 0;
        n_load += cut.cells->row[i] > 0;
    }
    assert_true(n_fix == 18 && n_load == 4);
    cut_free(cut);
}

#define BAD(boundary)                                                                              \
    LATTICE(CUBE(4) "boundaries:\n - {where: {" BOX(                                               \
        -1, -1, -1, 0.6, 9, 9) "}, fix: [x, z]}\n" boundary)
#define FIRST "{" BOX(-0.1, -1, -1, 0.6, 9, 9) "}"

static void messages(void **state)
{
    struct fixture *f = *state;
    cut_expect_one(f, BAD(" - {where: {sphere: {center: [1, 1, 1], radius: 0.1}}, fix: [x]}\n"),
        "scene.yaml:8:4: boundaries[1].where: no cell has its centre in this region");
    cut_expect_one(f,
        BAD(" - {where: {sphere: {center: [9, 1, 1], radius: 0.1}}, force: [1, 0, 0]}\n"),
        "scene.yaml:8:4: boundaries[1].where: nothing is in this region");
    cut_expect_one(f, BAD(" - {where: {sphere: {center: [2, 2, 2], radius: 1}}, pressure: 1}\n"),
        "scene.yaml:8:4: boundaries[1].where: no free face has its centre in this region");
    cut_expect_one(f, BAD(" - {where: " FIRST ", force: [0, 1, -3]}\n"),
        "scene.yaml:8:4: boundaries[1].force: every cell that it acts on is fixed in z");
    cut_expect_one(f, BAD(" - {where: " FIRST ", acceleration: [1, 0, 0]}\n"),
        "scene.yaml:8:4: boundaries[1].acceleration: every cell that it acts on is fixed in x");
    cut_expect_one(f,
        BAD(" - {where: " FIRST ", velocity: [free, 1, free]}\n - {where: " FIRST
            ", pressure: 1}\n"),
        "scene.yaml:9:4: boundaries[2].pressure: every cell that it acts on is fixed");
    cut_expect_one(f, BAD(" - {where: {" BOX(0, 0, 0, 9, 9, 9) "}, velocity: [1, 1, free]}\n"),
        "scene.yaml:8:4: boundaries[1].where: an earlier boundary already prescribes the "
        "motion in x of some of these cells");
    const char *const two[] = {
        "scene.yaml:8:4: boundaries[1].where: no cell has its centre in this region",
        "scene.yaml:9:4: boundaries[2].force: every cell that it acts on is fixed in x"};
    cut_expect(f,
        BAD(" - {where: {" BOX(9, 9, 9, 10, 10, 10) "}, velocity: [1, 1, 1]}\n - {where: " FIRST
                                                    ", force: [1, 0, 0]}\n"),
        two, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {CUT_TEST(force_on_a_face), CUT_TEST(force_on_a_layer),
        CUT_TEST(force_on_centres), CUT_TEST(pressures), CUT_TEST(rows_are_shared),
        CUT_TEST(histories), CUT_TEST(two_grids), CUT_TEST(selection_on_surfaces),
        CUT_TEST(messages)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
