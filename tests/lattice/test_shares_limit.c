/* The bound of w_max of bodies that a surface cuts, against the largest eigenvalue of M^-1 K. K
 * from the energy, written once more. With the gap of a link over an axis e at the offset d,
 *     g = u_j + theta_j x (d - h e/2) - u_i - theta_i x (d + h e/2), t = theta_j - theta_i,
 * U is the sum over links of c/2 (kn g_n^2 + ks |g_t|^2 + kt t_n^2 + kb |t_t|^2) and over cells of
 * lambda h^3 D Th^2/2, Th = sum over links of c g_n/(2 h)/D. */
#include "cells_fixture.h"

#include "lattice/lattice_frequency.h"

#define MOST 140 /* cells */
#define ALL (6 * MOST)

static double K[ALL][ALL], mass[ALL];

/* Adds k r r^T. */
static void add(double k, const double r[ALL], int n)
{
    for (int p = 0; p < n; p++)
        for (int q = 0; q < n && r[p] * r[p] > 0; q++) K[p][q] += k * r[p] * r[q];
}

/* The part of the gap along `along` by the DOF of one cell, whose face is at `arm` from its centre:
 * u + theta x arm. */
static void row_of(double r[ALL], int cell, double sign, int along, const double arm[3])
{
    int b = (along + 1) % 3, c = (along + 2) % 3;
    r[6 * cell + along] += sign;
    r[6 * cell + 3 + b] += sign * arm[c];
    r[6 * cell + 3 + c] -= sign * arm[b];
}

static void assemble(const struct scene *scene, const struct lattice_cells *cells)
{
    static double stretch[MOST][ALL];
    struct link_material m = lattice_frequency_material(&scene->material[0]);
    double h = cells->grid[0].h, G = link_constants_shear(m),
           lambda = link_constants_lambda(LINK_ISOTROPIC, m), missing[MOST];
    struct link_stiffness k = link_constants_between(LINK_ISOTROPIC, m, m, h);
    int n = 6 * (int)cells->n;
    int32_t *upper = fail_alloc((size_t)cells->n * sizeof *upper);
    memset(K, 0, sizeof K);
    memset(stretch, 0, sizeof stretch);
    for (int i = 0; i < cells->n; i++) missing[i] = 6 * lattice_cells_share(cells, i)->volume;
    for (int a = 0; a < 3; a++) {
        lattice_cells_upper(cells, a, upper);
        for (int i = 0; i < cells->n; i++) {
            const struct lattice_share *s = lattice_cells_share(cells, i);
            double c = s->face[2 * a + 1], arm_i[3] = {0}, arm_j[3];
            int j = upper[i];
            if (j < 0) continue;
            for (int e = 0; e < 2; e++) arm_i[(a + 1 + e) % 3] = s->offset[2 * a + 1][e] * h;
            memcpy(arm_j, arm_i, sizeof arm_j);
            arm_i[a] = 0.5 * h;
            arm_j[a] = -0.5 * h;
            for (int e = 0; e < 3; e++) {
                double gap[ALL] = {0}, turn[ALL] = {0};
                row_of(gap, j, 1, e, arm_j);
                row_of(gap, i, -1, e, arm_i);
                turn[6 * j + 3 + e] = 1;
                turn[6 * i + 3 + e] = -1;
                add(c * (e == a ? k.kn : k.ks), gap, n);
                add(c * (e == a ? k.kt : k.kb), turn, n);
                for (int p = 0; p < n && e == a; p++) {
                    stretch[i][p] += c * gap[p] / (2 * h);
                    stretch[j][p] += c * gap[p] / (2 * h);
                }
            }
            missing[i] -= c;
            missing[j] -= c;
        }
    }
    for (int i = 0; i < cells->n; i++) {
        const struct lattice_share *s = lattice_cells_share(cells, i);
        double size = s->volume + missing[i] * lambda / (4 * G);
        size = fmax(size, 0.25 * (1 + lambda / (4 * G)));
        add(lambda * h * h * h / size, stretch[i], n);
        for (int c = 0; c < 6; c++)
            mass[6 * i + c] =
                c < 3 ? s->mass * link_constants_mass(m, h) : link_constants_inertia(m, h);
    }
    free(upper);
}

/* By powers: from below, never above. */
static double largest(int n)
{
    static double x[ALL], y[ALL];
    double value = 0;
    for (int p = 0; p < n; p++) x[p] = cos(p * p * 0.7 + 1);
    for (int round = 0; round < 300; round++) {
        double xx = 0, xy = 0, size = 0;
        for (int p = 0; p < n; p++) {
            y[p] = 0;
            for (int q = 0; q < n; q++) y[p] += K[p][q] * x[q] / sqrt(mass[p] * mass[q]);
            xx += x[p] * x[p];
            xy += x[p] * y[p];
            size += y[p] * y[p];
        }
        value = xy / xx;
        for (int p = 0; p < n; p++) x[p] = y[p] / sqrt(size);
    }
    return value;
}

/* Bound over true w_max. */
static double slack(struct fixture *f, const char *name, const char *shape, double poisson)
{
    char *text = fail_format("method: lattice\ntime: {end: 1}\nmaterials: {a: {density: 2, young: "
                             "3, poisson: %g}}\nbodies:\n - {name: b, material: a, cell: 0.5, "
                             "shape: {%s}}\n",
        poisson, shape);
    struct cut cut = cut_scene(f, text);
    double bound = lattice_frequency_largest(cut.scene, cut.cells);
    assert_true(cut.cells->n <= MOST && cut.cells->share);
    assemble(cut.scene, cut.cells);
    double truth = sqrt(largest(6 * (int)cut.cells->n));
    struct link_material m = lattice_frequency_material(&cut.scene->material[0]);
    double whole = lattice_limit_uniform(LINK_ISOTROPIC, m, 0.5);
    print_message("%s, nu %g, %d cells: bound/true %.3f, true/whole cells' %.3f\n", name, poisson,
        (int)cut.cells->n, bound / truth, truth / whole);
    free(text);
    cut_free(cut);
    return bound / truth;
}

static void above(void **state)
{
    static const char *const shape[][2] = {
        {"ball", "sphere: {center: [0.1, 0, 0.2], radius: 1.27}"},
        {"small ball", "sphere: {center: [0, 0, 0], radius: 0.8}"},
        {"rod", "cylinder: {from: [0, 0, 0], to: [2, 0, 0], radius: 0.83}"},
        {"tilted rod", "cylinder: {from: [0, 0, 0], to: [1, 1.5, 0.7], radius: 0.61}"}};
    for (size_t k = 0; k < sizeof shape / sizeof *shape; k++)
        for (double poisson = -0.3; poisson < 0.46; poisson += 0.375) {
            double over = slack(*state, shape[k][0], shape[k][1], poisson);
            assert_true(over >= 1 && over < 1.25);
        }
}

/* A body of boxes on a grid of its own has the limit of whole cells, whatever is beside it. */
static void beside(void **state)
{
#define BLOCK BODY("block", "b", "0.1", BOX(5, 5, 5, 6, 6, 6))
    struct cut alone = cut_scene(*state, CURVED(BLOCK));
    double own = lattice_frequency_largest(alone.scene, alone.cells);
    cut_free(alone);
    struct cut both = cut_scene(
        *state, CURVED(BODY("ball", "a", "0.4", "sphere: {center: [0, 0, 0], radius: 1}") BLOCK));
    assert_non_null(both.cells->share);
    assert_true(lattice_frequency_largest(both.scene, both.cells) == own);
    cut_free(both);
}

int main(void)
{
    const struct CMUnitTest tests[] = {CUT_TEST(above), CUT_TEST(beside)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
