/* Cells that a curved surface cuts: what they hold together is what the shape holds, links have one
 * share at both ends, pressure acts on the true area. */
#include "cells_fixture.h"

/* Mass in whole cells, its middle [m], and its moment of inertia about the axis z through that,
 * with that of each cell's own [cells m2]. */
struct whole {
    double mass, middle[3], inertia;
};

static struct whole whole_of(const struct lattice_cells *cells)
{
    struct whole w = {0};
    double x[3], h = cells->grid[0].h;
    for (int64_t i = 0; i < cells->n; i++) {
        double mass = lattice_cells_share(cells, i)->mass;
        lattice_cells_centre(cells, i, x);
        w.mass += mass;
        for (int a = 0; a < 3; a++) w.middle[a] += mass * x[a];
    }
    for (int a = 0; a < 3; a++) w.middle[a] /= w.mass;
    for (int64_t i = 0; i < cells->n; i++) {
        lattice_cells_centre(cells, i, x);
        for (int a = 0; a < 2; a++)
            w.inertia += lattice_cells_share(cells, i)->mass * pow(x[a] - w.middle[a], 2);
        w.inertia += h * h / 6;
    }
    return w;
}

static void near(const char *what, double value, double exact, double relative)
{
    print_message("%s: %.6g, exact %.6g\n", what, value, exact);
    assert_true(fabs(value - exact) < relative * fabs(exact));
}

/* A link has the same share and middle at both ends, and none is lost. */
static void check_links(const struct lattice_cells *cells)
{
    int32_t *upper = fail_alloc((size_t)cells->n * sizeof *upper);
    int64_t n_cut = 0;
    for (int a = 0; a < 3; a++) {
        lattice_cells_upper(cells, a, upper);
        for (int64_t i = 0; i < cells->n; i++) {
            const struct lattice_share *s = lattice_cells_share(cells, i);
            assert_true(s->volume > 0 && s->volume <= 1 && s->mass > 0);
            if (!(cells->bits[i] & LINK_BIT(a, 1))) continue;
            const struct lattice_share *t = lattice_cells_share(cells, upper[i]);
            n_cut += s->face[2 * a + 1] < 1;
            assert_memory_equal(&s->face[2 * a + 1], &t->face[2 * a], sizeof(double));
            for (int k = 0; k < 2 && s->face[2 * a + 1] < 1; k++)
                assert_memory_equal(&s->offset[2 * a + 1][k], &t->offset[2 * a][k], sizeof(double));
        }
    }
    assert_true(n_cut > 0);
    free(upper);
}

static void sphere(void **state)
{
    double r = 0.5, volume = 4 * M_PI / 3 * r * r * r;
    struct cut cut = cut_scene(
        *state, CURVED(BODY("ball", "a", "0.1", "sphere: {center: [1, 0.03, 0], radius: 0.5}")));
    struct whole w = whole_of(cut.cells);
    near("mass", w.mass * 1e-3, volume, 2e-4);
    near("middle", w.middle[0], 1, 1e-4);
    near("moment of inertia", w.inertia * 1e-3, 0.4 * volume * r * r, 0.02);
    check_links(cut.cells);
    cut_free(cut);
}

static void tilted_tube(void **state)
{
    double volume = M_PI * (0.6 * 0.6 - 0.37 * 0.37) * 5;
    struct cut cut = cut_scene(*state,
        CURVED(" - {name: tube, material: a, cell: 0.1, shape: {cylinder: {from: [0, 0, 0], "
               "to: [0, 3, 4], radius: 0.6}}, minus: [{cylinder: {from: [0, -3, -4], to: [0, 6, "
               "8], radius: 0.37}}]}\n"));
    struct whole w = whole_of(cut.cells);
    near("mass", w.mass * 1e-3, volume, 5e-4);
    near("middle", w.middle[1], 1.5, 1e-3);
    check_links(cut.cells);
    cut_free(cut);
}

/* A mesh of a box with these lengths, whose corner is at 0: turned by q, all of it above 0. */
static void write_box(struct fixture *f, const double size[3], double turn)
{
    static const int face[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5},
        {0, 5, 4}, {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    double c = cos(turn), s = sin(turn);
    char *path = fail_format("%s/box.stl", f->folder);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fprintf(file, "solid box\n");
    for (int k = 0; k < 12; k++) {
        fprintf(file, "facet normal 0 0 0\nouter loop\n");
        for (int v = 0; v < 3; v++) {
            double x = (face[k][v] & 1) * size[0], y = (face[k][v] >> 1 & 1) * size[1],
                   z = (face[k][v] >> 2) * size[2], u = c * x - s * y, w = s * x + c * y;
            fprintf(file, "vertex %.17g %.17g %.17g\n", u, c * w - s * z, s * w + c * z);
        }
        fprintf(file, "endloop\nendfacet\n");
    }
    fprintf(file, "endsolid box\n");
    fclose(file);
    free(path);
}

#define MESH CURVED(BODY("box", "a", "0.1", "stl: box.stl"))

/* A box as a mesh is the box, and turned it keeps its volume. */
static void mesh(void **state)
{
    const double size[3] = {1, 0.7, 0.5};
    write_box(*state, size, 0);
    struct cut cut = cut_scene(*state, MESH);
    assert_int_equal(cut.cells->n, 10 * 7 * 5);
    near("mass", whole_of(cut.cells).mass * 1e-3, 0.35, 1e-3);
    for (int64_t i = 0; i < cut.cells->n; i++)
        assert_true(fabs(lattice_cells_share(cut.cells, i)->volume - 1) < 1e-3);
    cut_free(cut);
    for (double turn = 0.2; turn < 0.9; turn += 0.3) {
        write_box(*state, size, turn);
        cut = cut_scene(*state, MESH);
        near("mass, turned", whole_of(cut.cells).mass * 1e-3, 0.35, 2e-3);
        check_links(cut.cells);
        cut_free(cut);
    }
}

/* What is thinner than the cells nowhere covers half of one: slivers that hang on slivers alone,
 * which are no body. */
static void sheet(void **state)
{
    const double thin[3] = {1, 0.7, 0.03};
    write_box(*state, thin, 0.5);
    cut_expect_one(*state, MESH,
        "scene.yaml:5:4: bodies[0]: 'box' has no cell: it covers less than half of each; take "
        "smaller ones");
}

/* What fills a hole leaves no cut; a hole in it does. Boxes have whole cells, aligned or not. */
static void filled(void **state)
{
    const char *plate = " - {name: plate, material: a, cell: 1, shape: {" BOX(0, 0, 0, 12, 12,
        2) "}, minus: [{cylinder: {from: [6, 6, -1], to: [6, 6, 3], radius: 4}}]}\n";
    char *alone = fail_format(CURVED("%s"), plate),
         *both = fail_format(CURVED("%s - {name: core, material: b, cell: 1, shape: {cylinder: "
                                    "{from: [6, 6, 0], to: [6, 6, 2], radius: 4}}}\n"),
             plate);
    struct cut cut = cut_scene(*state, alone);
    near("mass", whole_of(cut.cells).mass, 288 - 2 * M_PI * 4 * 4, 1e-3);
    cut_free(cut);
    cut = cut_scene(*state, both);
    assert_int_equal(cut.cells->n, 288);
    assert_null(cut.cells->share);
    cut_free(cut);
    free(alone);
    free(both);
    cut = cut_scene(*state, CURVED(BODY("block", "a", "1", BOX(0, 0, 0, 4.4, 3.3, 2.2))));
    assert_null(cut.cells->share);
    assert_int_equal(cut.cells->n, 4 * 3 * 2);
    cut_free(cut);
}

/* Pressure all over a ball: balanced, and pi r^2 across any axis. */
static void pressure(void **state)
{
    struct cut cut = cut_scene(*state,
        CURVED(" - {name: ball, material: a, cell: 0.1, shape: {sphere: {center: [0.02, 0, 0], "
               "radius: 0.53}}}\nboundaries:\n - {where: all, pressure: 2}\n"));
    double *rows = fail_alloc((size_t)cut.cells->loads->n_row * LOAD_WIDTH * sizeof *rows),
           force[3] = {0}, moment[3] = {0}, up = 0, x[3];
    lattice_loads_at(cut.cells->loads, cut.scene, 0, 0, 0, rows);
    for (int64_t i = 0; i < cut.cells->n; i++) {
        const double *row = rows + (int64_t)cut.cells->row[i] * LOAD_WIDTH;
        lattice_cells_centre(cut.cells, i, x);
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            force[a] += row[LOAD_BODY + a];
            moment[a] += x[b] * row[LOAD_BODY + c] - x[c] * row[LOAD_BODY + b] + row[LOAD_TURN + a];
        }
        up += fmax(0, row[LOAD_BODY + 2]);
    }
    for (int a = 0; a < 3; a++) {
        assert_true(fabs(force[a]) < 1e-12);
        assert_true(fabs(moment[a]) < 1e-12);
    }
    near("force across", up, 2 * M_PI * 0.53 * 0.53, 5e-3);
    free(rows);
    cut_free(cut);
}

int main(void)
{
    const struct CMUnitTest tests[] = {CUT_TEST(sphere), CUT_TEST(tilted_tube), CUT_TEST(mesh),
        CUT_TEST(sheet), CUT_TEST(filled), CUT_TEST(pressure)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
