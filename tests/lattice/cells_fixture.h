/* Scenes of method lattice from text, cut into cells. */
#ifndef DEMOCLES_TEST_CELLS_FIXTURE_H
#define DEMOCLES_TEST_CELLS_FIXTURE_H

#include "../scene/scene_fixture.h"

#include <math.h>

#include "lattice/lattice_cells.h"
#include "lattice/lattice_loads.h"
#include "kernels/lattice/lattice_words.h"

#define LATTICE_OF(surface, bodies)                                                                \
    "method: lattice\n"                                                                            \
    "time: {end: 1}\n"                                                                             \
    "materials: {a: {density: 1, young: 1, poisson: 0}, "                                          \
    "b: {density: 2, young: 3, poisson: 0.2}}\n"                                                   \
    "bodies:\n" bodies "lattice: {surface: " surface "}\n"
/* Whole cells alone, and cells that surfaces cut. */
#define LATTICE(bodies) LATTICE_OF("stepped", bodies)
#define CURVED(bodies) LATTICE_OF("cut", bodies)
#define BODY(name, material, cell, shape)                                                          \
    " - {name: " name ", material: " material ", cell: " cell ", shape: {" shape "}}\n"
#define BOX(x, y, z, X, Y, Z) "box: {min: [" #x ", " #y ", " #z "], max: [" #X ", " #Y ", " #Z "]}"
#define CUBE(n) BODY("cube", "a", "1", BOX(0, 0, 0, n, n, n))

struct cut {
    struct scene *scene;
    struct lattice_cells *cells;
};

/* The scene must be free of errors, and its cells too. */
static inline struct cut cut_scene(struct fixture *f, const char *text)
{
    struct scene_errors errors = {0};
    fixture_scene(f, text);
    struct cut cut = {.scene = fixture_read(f, NULL, 0)};
    cut.cells = lattice_cells_create(cut.scene, &errors);
    for (int k = 0; k < errors.n; k++) print_error("%s\n", errors.text[k]);
    assert_non_null(cut.cells);
    scene_errors_free(&errors);
    return cut;
}

static inline void cut_free(struct cut cut)
{
    lattice_cells_free(cut.cells);
    scene_free(cut.scene);
}

/* The scene reads well, and its cells give exactly these messages. */
static inline void cut_expect(
    struct fixture *f, const char *text, const char *const *message, int n)
{
    struct scene_errors errors = {0};
    fixture_scene(f, text);
    struct scene *scene = fixture_read(f, NULL, 0);
    assert_null(lattice_cells_create(scene, &errors));
    for (int k = 0; k < errors.n; k++) {
        char *text_k = errors.text[k];
        for (char *at = strstr(text_k, f->folder); at; at = strstr(text_k, f->folder))
            memmove(at, at + strlen(f->folder) + 1, strlen(at + strlen(f->folder)));
        if (k < n) assert_string_equal(text_k, message[k]);
        else print_error("one more: %s\n", text_k);
    }
    assert_int_equal(errors.n, n);
    scene_errors_free(&errors);
    scene_free(scene);
}

static inline void cut_expect_one(struct fixture *f, const char *text, const char *message)
{
    cut_expect(f, text, &message, 1);
}

static inline int64_t cut_links(const struct lattice_cells *cells)
{
    int64_t n = 0;
    for (int64_t i = 0; i < cells->n; i++)
        for (int a = 0; a < 3; a++) n += (cells->bits[i] & LINK_BIT(a, 1)) != 0;
    return n;
}

/* The cell at that place of its grid, or -1; by search, not by order. */
static inline int64_t cut_find(const struct lattice_cells *cells, int grid, int x, int y, int z)
{
    for (int64_t i = 0; i < cells->n; i++)
        if (cells->kind[cells->kind_of[i]].grid == grid && cells->at[i][0] == x &&
            cells->at[i][1] == y && cells->at[i][2] == z)
            return i;
    return -1;
}

/* Every cell: links where there is a neighbour on its grid and nowhere else, neighbours as found,
 * order by grid, z, y, x. */
static inline void cut_verify(const struct lattice_cells *cells)
{
    int32_t *upper = fail_alloc((size_t)cells->n * sizeof *upper);
    for (int a = 0; a < 3; a++) {
        lattice_cells_upper(cells, a, upper);
        for (int64_t i = 0; i < cells->n; i++) {
            int grid = cells->kind[cells->kind_of[i]].grid,
                next[3] = {cells->at[i][0], cells->at[i][1], cells->at[i][2]};
            next[a]++;
            int64_t beyond = cut_find(cells, grid, next[0], next[1], next[2]);
            assert_int_equal(upper[i], beyond);
            assert_int_equal((cells->bits[i] & LINK_BIT(a, 1)) != 0, beyond >= 0);
            next[a] -= 2;
            assert_int_equal((cells->bits[i] & LINK_BIT(a, 0)) != 0,
                cut_find(cells, grid, next[0], next[1], next[2]) >= 0);
        }
    }
    for (int64_t i = 1; i < cells->n; i++) {
        const int32_t *p = cells->at[i - 1], *q = cells->at[i];
        int g = cells->kind[cells->kind_of[i - 1]].grid, h = cells->kind[cells->kind_of[i]].grid;
        bool above =
            h > g ||
            (h == g &&
                (q[2] > p[2] || (q[2] == p[2] && (q[1] > p[1] || (q[1] == p[1] && q[0] > p[0])))));
        assert_true(above);
    }
    free(upper);
}

#define CUT_TEST(name) cmocka_unit_test_setup_teardown(name, fixture_setup, fixture_teardown)

#endif
