/* Bodies cut into cells: which cells there are, against tests of their centres written here; links,
 * order, kinds, initial velocities, messages. */
#include "cells_fixture.h"

#include "../walls/scratch.h"

static void box(void **state)
{
    struct cut cut =
        cut_scene(*state, LATTICE(BODY("bar", "b", "0.1", BOX(1, -2, 0.3, 1.5, -1.6, 0.6))));
    const struct lattice_cells *c = cut.cells;
    double x[3];
    assert_int_equal(c->n, 5 * 4 * 3);
    assert_int_equal(cut_links(c), 4 * 4 * 3 + 5 * 3 * 3 + 5 * 4 * 2);
    assert_true(c->n_grid == 1 && c->n_kind == 1 && c->kind[0].material == 1 &&
                c->grid[0].h == 0.1 && c->n_of_body[0] == 60);
    assert_true(
        c->grid[0].origin[0] == 1 && c->grid[0].origin[1] == -2 && c->grid[0].origin[2] == 0.3);
    cut_verify(c);
    assert_int_equal(c->bits[0], LINK_BIT(0, 1) | LINK_BIT(1, 1) | LINK_BIT(2, 1));
    assert_int_equal(c->bits[59], LINK_BIT(0, 0) | LINK_BIT(1, 0) | LINK_BIT(2, 0));
    assert_int_equal(c->bits[cut_find(c, 0, 2, 1, 1)], CELL_LINKS);
    lattice_cells_centre(c, 59, x);
    assert_true(
        fabs(x[0] - 1.45) < 1e-15 && fabs(x[1] + 1.65) < 1e-15 && fabs(x[2] - 0.55) < 1e-15);
    for (int64_t i = 0; i < c->n; i++) assert_true(c->row[i] == 0 && c->body[i] == 0);
    assert_true(!c->v && !c->w && c->loads->n_row == 1);
    cut_free(cut);
}

/* Whether x is in the set that the test thinks of. */
typedef bool (*set)(const double x[3]);

/* The cells are those of the bounding box low to high whose centres are in the set; h divides the
 * box. */
static void check_set(const struct cut cut, const double low[3], const double high[3], set holds)
{
    double h = cut.cells->grid[0].h, x[3];
    int64_t n = 0;
    for (int k = 0; low[2] + (k + 0.5) * h < high[2]; k++)
        for (int j = 0; low[1] + (j + 0.5) * h < high[1]; j++)
            for (int i = 0; low[0] + (i + 0.5) * h < high[0]; i++) {
                x[0] = low[0] + (i + 0.5) * h;
                x[1] = low[1] + (j + 0.5) * h;
                x[2] = low[2] + (k + 0.5) * h;
                if (!holds(x)) continue;
                assert_true(n < cut.cells->n);
                double y[3];
                lattice_cells_centre(cut.cells, n++, y);
                for (int a = 0; a < 3; a++) assert_true(fabs(x[a] - y[a]) < 1e-12);
            }
    assert_int_equal(n, cut.cells->n);
}

static bool in_sphere(const double x[3])
{
    return (x[0] - 1) * (x[0] - 1) + x[1] * x[1] + x[2] * x[2] < 0.5 * 0.5;
}

static void sphere(void **state)
{
    struct cut cut = cut_scene(
        *state, LATTICE(BODY("ball", "a", "0.05", "sphere: {center: [1, 0, 0], radius: 0.5}")));
    check_set(cut, (double[]){0.5, -0.5, -0.5}, (double[]){1.5, 0.5, 0.5}, in_sphere);
    double volume = (double)cut.cells->n * 0.05 * 0.05 * 0.05, exact = 4.0 / 3 * M_PI * 0.125;
    assert_true(fabs(volume / exact - 1) < 0.01);
    cut_verify(cut.cells);
    cut_free(cut);
}

/* From (0, 0, 0) to (0, 3, 4), radius 1: u = (0, 0.6, 0.8). Bounds: x +-1, y -0.8 to 3.8, z -0.6 to
 * 4.6. */
static bool in_cylinder(const double x[3])
{
    double along = 0.6 * x[1] + 0.8 * x[2], across = 0.8 * x[1] - 0.6 * x[2];
    return along > 0 && along < 5 && x[0] * x[0] + across * across < 1;
}

static void cylinder(void **state)
{
    struct cut cut = cut_scene(*state,
        LATTICE(BODY("rod", "a", "0.2", "cylinder: {from: [0, 0, 0], to: [0, 3, 4], radius: 1}")));
    check_set(cut, (double[]){-1, -0.8, -0.6}, (double[]){1, 3.8, 4.6}, in_cylinder);
    double volume = (double)cut.cells->n * 0.008;
    assert_true(fabs(volume / (5 * M_PI) - 1) < 0.02);
    cut_verify(cut.cells);
    cut_free(cut);
}

static bool in_tetrahedron(const double x[3])
{
    return x[0] > 0 && x[1] > 0 && x[2] > 0 && x[0] + x[1] + x[2] < 1;
}

static bool in_tetrahedron_with_hole(const double x[3])
{
    return in_tetrahedron(x) &&
           !((x[0] - 0.25) * (x[0] - 0.25) + (x[1] - 0.25) * (x[1] - 0.25) < 0.01 && x[2] > -1 &&
               x[2] < 1);
}

/* Surfaces from files: a tetrahedron, and holes in it; a box as a surface is the box. */
static void surfaces(void **state)
{
    struct fixture *f = *state;
    const double p[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, low[3] = {0, 0, 0},
                 high[3] = {1, 1, 1};
    static const int face[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
    double corner[12 * 9];
    for (int k = 0; k < 4; k++)
        for (int n = 0; n < 3; n++) memcpy(corner + 9 * k + 3 * n, p[face[k][n]], sizeof p[0]);
    char *path = scratch_stl(corner, 4);
    static const char scene[] =
        LATTICE(" - {name: t, material: a, cell: 0.04, shape: {stl: %s}%s}\n"),
                      hole[] = ", minus: [{cylinder: {from: [0.25, 0.25, -1], to: [0.25, 0.25, 1], "
                               "radius: 0.1}}]";
    char *text = fail_format(scene, path, ""), *holed = fail_format(scene, path, hole);
    struct cut cut = cut_scene(f, text);
    check_set(cut, low, high, in_tetrahedron);
    cut_verify(cut.cells);
    cut_free(cut);
    cut = cut_scene(f, holed);
    check_set(cut, low, high, in_tetrahedron_with_hole);
    cut_verify(cut.cells);
    cut_free(cut);
    free(text);
    free(holed);
    scratch_remove(path);

    scratch_box((double[]){0, 0, 0}, (double[]){500, 400, 300}, corner);
    path = scratch_stl(corner, 12);
    text = fail_format(
        LATTICE(" - {name: s, material: a, cell: 0.1, shape: {stl: %s, scale: 1 mm}}\n"), path);
    struct cut surface = cut_scene(f, text),
               same = cut_scene(f, LATTICE(BODY("s", "a", "0.1", BOX(0, 0, 0, 0.5, 0.4, 0.3))));
    assert_int_equal(surface.cells->n, 60);
    assert_memory_equal(surface.cells->at, same.cells->at, 60 * sizeof *same.cells->at);
    cut_free(surface);
    cut_free(same);
    free(text);
    scratch_remove(path);
}

/* Centres on a surface to rounding are inside, also of a hole: the integer points of norm up to 2
 * are 33, six of them on the sphere. In 12.5 mm there are three centres of cells of 5 mm, the last
 * on the face. */
static void centres_on_surfaces(void **state)
{
    struct cut cut = cut_scene(
        *state, LATTICE(" - {name: c, material: a, cell: 0.1, shape: {" BOX(0, 0, 0, 0.9, 0.9,
                    0.9) "},\n"
                         "    minus: [{sphere: {center: [0.45, 0.45, 0.45], radius: 0.2}}]}\n"));
    assert_int_equal(cut.cells->n, 729 - 33);
    cut_free(cut);
    cut = cut_scene(*state, LATTICE(BODY("c", "a", "5 mm", BOX(0, 0, 0, 12.5 mm, 12.4 mm, 5 mm))));
    assert_int_equal(cut.cells->n, 3 * 2 * 1);
    cut_free(cut);
}

/* Bodies of unlike material that agree on a grid are joined; the second reaches lower, and the
 * later one has what both cover. */
static void two_bodies(void **state)
{
    struct cut cut =
        cut_scene(*state, LATTICE(BODY("one", "a", "0.1", BOX(0.3, 0, 0, 0.7, 0.2, 0.2))
                                  BODY("two", "b", "0.1", BOX(-0.2, 0, 0, 0.4, 0.2, 0.2))));
    const struct lattice_cells *c = cut.cells;
    assert_true(c->n_grid == 1 && c->n_kind == 2 && c->grid[0].origin[0] == -0.2);
    assert_true(c->n == 9 * 4 && c->n_of_body[0] == 3 * 4 && c->n_of_body[1] == 6 * 4);
    assert_int_equal(cut_links(c), 8 * 4 + 9 * 2 + 9 * 2);
    cut_verify(c);
    for (int64_t i = 0; i < c->n; i++) {
        assert_int_equal(c->body[i], c->at[i][0] < 6);
        assert_int_equal(c->kind[c->kind_of[i]].material, c->at[i][0] < 6);
    }
    cut_free(cut);
}

/* Half a cell off, or of another edge: grids of their own, and no link between them. */
static void two_grids(void **state)
{
    struct cut cut =
        cut_scene(*state, LATTICE(BODY("one", "a", "0.1", BOX(0, 0, 0, 0.2, 0.2, 0.2))
                                  BODY("two", "a", "0.1", BOX(0.25, 0, 0, 0.45, 0.2, 0.2))
                                      BODY("three", "a", "0.2", BOX(0, 0, 0.2, 0.2, 0.2, 0.4))
                                          BODY("four", "a", "0.1", BOX(0, 0.2, 0, 0.2, 0.4, 0.2))));
    const struct lattice_cells *c = cut.cells;
    assert_true(c->n_grid == 3 && c->n_kind == 3 && c->n == 8 + 8 + 1 + 8);
    assert_int_equal(cut_links(c), 12 + 12 + 12 + 4);
    cut_verify(c);
    assert_true(c->body[c->n - 1] == 2 && c->bits[c->n - 1] == 0);
    cut_free(cut);
}

/* v0 + w0 x (x - x0) about the middle; a fixed DOF stands, a prescribed one starts as
 * prescribed. */
static void initial_velocities(void **state)
{
    struct cut cut = cut_scene(*state,
        LATTICE(" - {name: c, material: a, cell: 1, shape: {" BOX(0, 0, 0, 4, 2,
            2) "},\n"
               "    velocity: [1, 2, 3], angular_velocity: [0, 0, 10]}\n"
               "boundaries:\n"
               " - {where: {" BOX(-1, -1, -1, 0.9, 3,
                   3) "}, fix: [x, rz]}\n"
                      " - {where: {" BOX(3.1, -1, -1, 9, 3,
                          3) "}, velocity: [free, 7, null], history: {table: [[0, 0.5], [1, "
                             "1]]}}\n"));
    const struct lattice_cells *c = cut.cells;
    assert_non_null(c->v);
    for (int64_t i = 0; i < c->n; i++) {
        double x[3];
        lattice_cells_centre(c, i, x);
        bool first = c->at[i][0] == 0, last = c->at[i][0] == 3;
        assert_true(fabs(c->v[i][0] - (first ? 0 : 1 - 10 * (x[1] - 1))) < 1e-13);
        assert_true(fabs(c->v[i][1] - (last ? 3.5 : 2 + 10 * (x[0] - 2))) < 1e-13);
        assert_true(c->v[i][2] == 3 && c->w[i][0] == 0 && c->w[i][1] == 0 &&
                    c->w[i][2] == (first ? 0 : 10));
        assert_int_equal(c->bits[i] & CELL_FIXED, first  ? CELL_FIX(0) | CELL_FIX(5)
                                                  : last ? CELL_FIX(1)
                                                         : 0);
    }
    cut_free(cut);
}

/* A flat crack takes the links that cross it, also those to another body; a thick one all that lie
 * in it. */
static void cracks(void **state)
{
    struct cut cut = cut_scene(*state,
        LATTICE(" - {name: c, material: a, cell: 0.1, shape: {" BOX(0, 0, 0, 0.4, 0.3,
            0.2) "},\n"
                 "    cracks: [{" BOX(0.2, 0, 0, 0.2, 0.2, 1) "}, {" BOX(
                     0.3, 0.3, 0, 0.4, 0.3, 0.1) "}]}\n" BODY("d", "a", "0.1",
                     BOX(0, 0.3, 0, 0.4, 0.4,
                         0.2)) " - {name: e, material: b, cell: 0.1, shape: {" BOX(0, 0, 0.2, 0.4,
                     0.4,
                     0.3) "},\n"
                          "    cracks: [{cylinder: {from: [0.2, 0.2, 0.2], to: [0.2, 0.2, 0.3], "
                          "radius: 0.08}}]}\n"));
    const struct lattice_cells *c = cut.cells;
    int64_t all = 3 * 4 * 3 + 4 * 3 * 3 + 4 * 4 * 2; /* 4 x 4 x 3 cells */
    assert_int_equal(c->n, 48);
    /* 2 x 2 of the plane x = 0.2, one of y = 0.3; in the cylinder 4 in its plane and 4 in its end
     * face */
    assert_int_equal(cut_links(c), all - 4 - 1 - 8);
    for (int64_t i = 0; i < c->n; i++) {
        const int32_t *at = c->at[i];
        bool flat = at[0] == 1 && at[1] < 2 && at[2] < 2,
             round = at[0] == 1 && (at[1] == 1 || at[1] == 2) && at[2] == 2;
        assert_int_equal((c->bits[i] & LINK_BIT(0, 1)) != 0, at[0] < 3 && !flat && !round);
        bool joint = at[0] == 3 && at[1] == 2 && at[2] == 0,
             in = (at[0] == 1 || at[0] == 2) && at[1] == 1 && at[2] == 2;
        assert_int_equal((c->bits[i] & LINK_BIT(1, 1)) != 0, at[1] < 3 && !joint && !in);
    }
    cut_free(cut);
}

static void messages(void **state)
{
    struct fixture *f = *state;
    cut_expect_one(f, LATTICE(BODY("sheet", "a", "0.1", BOX(0, 0, 0, 1, 1, 0.09))),
        "scene.yaml:5:4: bodies[0].cell: 0.1 m, and 'sheet' has only 0.09 m in z: thinner than a "
        "cell");
    cut_expect_one(f, LATTICE(BODY("huge", "a", "1 um", BOX(0, 0, 0, 1, 1, 1))),
        "scene.yaml:5:4: bodies[0].cell: 1e-06 m cuts the bounding box of 'huge' into too many "
        "cells");
    cut_expect_one(f,
        LATTICE(" - {name: void, material: a, cell: 1, shape: {" BOX(
            0, 0, 0, 2, 2, 2) "}, minus: [{" BOX(-1, -1, -1, 3, 3, 3) "}]}\n"),
        "scene.yaml:5:4: bodies[0]: 'void' has no cell: its shape contains no cell centre");
    cut_expect_one(f, LATTICE(CUBE(2) BODY("cover", "b", "1", BOX(0, 0, 0, 2, 2, 2))),
        "scene.yaml:5:4: bodies[0]: 'cube' has no cell: later bodies have taken them all");
    cut_expect_one(f,
        LATTICE(" - {name: c, material: a, cell: 1, shape: {" BOX(
            0, 0, 0, 2, 2, 2) "}, cracks: [{" BOX(0, 0, 0, 0, 2, 2) "}]}\n"),
        "scene.yaml:5:4: bodies[0].cracks[0]: no link is in it");
    fixture_write(f, "none.stl", "", 0);
    double corner[12 * 9];
    scratch_box((double[]){0, 0, 0}, (double[]){5, 4, 3}, corner);
    char *path = scratch_stl(corner, 11);
    char *text =
        fail_format(LATTICE(" - {name: open, material: a, cell: 1, shape: {stl: %s}}\n"
                            " - {name: o, material: a, cell: 1, shape: {stl: none.stl}}\n" BODY(
                                "sheet", "a", "0.1", BOX(0, 0, 0, 1, 1, 0.09))),
            path);
    char *open = fail_format(
        "scene.yaml:5:4: bodies[0].shape: %s: a region needs a closed surface with triangles that "
        "all face one way: "
        "3 of its 18 edges do not match",
        path);
    const char *const all[] = {open,
        "scene.yaml:6:4: bodies[1].shape: none.stl: neither ASCII nor binary STL: 0 bytes",
        "scene.yaml:7:4: bodies[2].cell: 0.1 m, and 'sheet' has only 0.09 m in z: thinner than a "
        "cell"};
    cut_expect(f, text, all, 3);
    free(open);
    free(text);
    scratch_remove(path);
}

int main(void)
{
    const struct CMUnitTest tests[] = {CUT_TEST(box), CUT_TEST(sphere), CUT_TEST(cylinder),
        CUT_TEST(surfaces), CUT_TEST(centres_on_surfaces), CUT_TEST(two_bodies),
        CUT_TEST(two_grids), CUT_TEST(cracks), CUT_TEST(initial_velocities), CUT_TEST(messages)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
