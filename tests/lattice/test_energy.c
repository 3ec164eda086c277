/* Energies and momenta of a lattice against closed forms, and how well they are kept. */
#include "tests/limit/limit_test.h"

#include <string.h>

#include "comm/fail.h"
#include "lattice_bodies.h"
#include "lattice/lattice_energy.h"
#include "device_tests.h"

static struct lattice_energy energy_of(struct lattice *l, const struct lattice_cells *cells)
{
    struct lattice_energy e;
    struct lattice_account *a = lattice_energy_create(l, cells);
    lattice_energy_now(a, &e);
    lattice_energy_free(a);
    return e;
}

/* A free cell of the second grid, shifted, moving and spinning: m v^2/2, J w^2/2, -m g.u, m v, x x
 * m v + J w. */
static void one_cell(void **state)
{
    const struct link_material m = {7900, 1e6, 0, 0};
    const int size[3] = {1, 1, 1};
    const double h = 0.5, mass = m.density * h * h * h, J = mass * h * h / 6;
    struct lattice_cells *cells = bodies_create(1, size, h, 1, bodies_block);
    struct lattice_options o = {.dt = 0.01,
        .turn = true,
        .gravity = {1, -2, -9.81},
        .material = &m,
        .n_material = 1,
        .n_row = 1};
    double u[1][3] = {{0.1, 0.2, -0.3}}, v[1][3] = {{1, -2, 3}}, w[1][3] = {{4, 5, -6}};
    (void)state;
    cells->grid[0].origin[1] = 7;
    cells->at[0][0] = 3;
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    lattice_write(l, &(struct lattice_motion){.u = u, .v = v, .w = w});
    struct lattice_energy e = energy_of(l, cells);
    const double x[3] = {3.5 * h + 0.1, 7 + 0.5 * h + 0.2, 0.5 * h - 0.3};
    assert_near(e.kinetic, 0.5 * mass * 14, 1e-11);
    assert_near(e.rotational, 0.5 * J * 77, 1e-11);
    assert_near(e.gravity, -mass * (0.1 - 0.4 + 9.81 * 0.3), 1e-11);
    assert_near(e.elastic, 0, 0);
    assert_near(e.n_strained, 0, 0);
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        assert_near(e.momentum[a], mass * v[0][a], 1e-11);
        assert_near(e.angular[a], mass * (x[b] * v[0][c] - x[c] * v[0][b]) + J * w[0][a], 1e-10);
    }
    lattice_free(l);
    bodies_free(cells);
}

/* A block stretched along x, nothing moved sideways: every link along x has kn (e h)^2/2, once, and
 * Th of the cells at the ends is half. */
static void strained(void **state)
{
    const struct link_material m = {1000, 2e7, 0.3, 0};
    const int size[3] = {6, 3, 2};
    const double h = 0.1, e0 = 1e-3, G = link_constants_shear(m),
                 lambda = link_constants_lambda(LINK_ISOTROPIC, m);
    struct lattice_cells *cells = bodies_create(1, size, h, 1, bodies_block);
    (void)state;
    for (int turn = 0; turn < 2; turn++) {
        struct lattice_options o = {
            .dt = 1e-4, .turn = turn, .material = &m, .n_material = 1, .n_row = 1};
        double(*u)[3] = fail_alloc((size_t)cells->n * sizeof *u), expected = 0;
        for (int64_t i = 0; i < cells->n; i++) {
            int ends = (cells->at[i][0] == 0) + (cells->at[i][0] == size[0] - 1),
                missing = 6 - __builtin_popcount(cells->bits[i] & 63);
            double c = missing * lambda / (4 * G), strain = e0 * (2 - ends) / 2 / (1 + c);
            u[i][0] = e0 * h * cells->at[i][0];
            expected += 0.5 * lambda * h * h * h * strain * strain * (1 + c);
            if (cells->at[i][0] > 0) expected += 0.5 * 2 * G * h * e0 * h * e0 * h; /* kn = 2 G h */
        }
        struct lattice *l = lattice_create(dev, comm, cells, &o);
        lattice_write(l, &(struct lattice_motion){.u = u});
        assert_near(energy_of(l, cells).elastic / expected, 1, 1e-12);
        lattice_free(l);
        free(u);
    }
    bodies_free(cells);
}

/* Links of two cells along x, the upper one shifted by u or turned about x. */
static double strained_by(bool turn, const double shift[3], double angle)
{
    const struct link_material m = {1000, 2e7, 0.3, 0};
    const int size[3] = {2, 1, 1};
    struct lattice_cells *cells = bodies_create(1, size, 0.1, 1, bodies_block);
    struct lattice_options o = {
        .dt = 1e-4, .turn = turn, .material = &m, .n_material = 1, .n_row = 1};
    double u[2][3] = {{0}, {shift[0], shift[1], shift[2]}},
           q[2][4] = {{1, 0, 0, 0}, {cos(angle / 2), sin(angle / 2), 0, 0}},
           theta[2][3] = {{0}, {angle, 0, 0}};
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    struct lattice_motion motion = {.u = u};
    if (turn) motion.q = q;
    else motion.theta = theta;
    lattice_write(l, &motion);
    double n = energy_of(l, cells).n_strained;
    lattice_free(l);
    bodies_free(cells);
    return n;
}

/* 10 % of an edge in any direction, 0.5 rad. */
static void out_of_range(void **state)
{
    (void)state;
    for (int turn = 0; turn < 2; turn++) {
        assert_near(strained_by(turn, (const double[]){0, 0, 0}, 0.499), 0, 0);
        assert_near(strained_by(turn, (const double[]){0, 0, 0}, -0.501), 1, 0);
        assert_near(strained_by(turn, (const double[]){-0.00999, 0, 0}, 0), 0, 0);
        assert_near(strained_by(turn, (const double[]){0.01001, 0, 0}, 0), 1, 0);
        assert_near(strained_by(turn, (const double[]){0, 0.0071, 0.0071}, 0), 1, 0);
        assert_near(strained_by(turn, (const double[]){0, 0.007, 0.007}, 0), 0, 0);
    }
}

/* Largest change of the total over 4 s of a block that spins and vibrates, E = rho = h = 1, over
 * its start; momenta stay. */
static double change(enum lattice_scheme scheme, double dt, double *drift)
{
    const struct link_material soft = {1, 1, 0.3, 0};
    const double w0[3] = {0.15, 0.05, 0.1};
    const int size[3] = {3, 2, 2};
    struct lattice_cells *cells = bodies_create(1, size, 1, 1, bodies_block);
    struct lattice_options o = {
        .scheme = scheme, .dt = dt, .turn = true, .material = &soft, .n_material = 1, .n_row = 1};
    double worst = 0;
    bodies_shake(cells, 0.025, 0.025);
    for (int64_t i = 0; i < cells->n; i++)
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            cells->v[i][a] += w0[b] * (cells->at[i][c] - 0.5 * (size[c] - 1)) -
                              w0[c] * (cells->at[i][b] - 0.5 * (size[b] - 1));
            cells->w[i][a] += w0[a];
        }
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    struct lattice_account *account = lattice_energy_create(l, cells);
    struct lattice_energy start, now;
    lattice_energy_now(account, &start);
    *drift = 0;
    lattice_begin_step(l);
    for (int step = 1; step <= (int)lround(4 / dt); step++) {
        bool observe = step % (int)lround(0.2 / dt) == 0;
        lattice_advance(l, observe);
        if (!observe) continue;
        lattice_energy_now(account, &now);
        lattice_begin_step(l);
        double total = now.kinetic + now.rotational + now.elastic,
               first = start.kinetic + start.rotational + start.elastic;
        worst = fmax(worst, fabs(total / first - 1));
        for (int a = 0; a < 3; a++)
            *drift = fmax(*drift, fmax(fabs(now.momentum[a] - start.momentum[a]),
                                      fabs(now.angular[a] - start.angular[a])));
    }
    lattice_energy_free(account);
    lattice_free(l);
    bodies_free(cells);
    return worst;
}

static void kept(void **state)
{
    const enum lattice_scheme scheme[2] = {LATTICE_LEAPFROG, LATTICE_PEFRL};
    (void)state;
    for (int k = 0; k < 2; k++) {
        double drift[2], coarse = change(scheme[k], 0.1, &drift[0]),
                         fine = change(scheme[k], 0.05, &drift[1]), order = log2(coarse / fine);
        printf("spinning block, %s: energy %.3g and %.3g, order %.2f; momenta %.2g\n",
            lattice_schemes_table(scheme[k])->name, coarse, fine, order, fmax(drift[0], drift[1]));
        assert_near(order, k == 0 ? 2 : 4, 0.3);
        assert_below(fmax(drift[0], drift[1]), 1e-13);
    }
}

enum { N_BAR = 6 };
static const double pull = 1e4; /* [Pa] */

static void bar_rows(void *context, double t, double from, double to, double *rows)
{
    const double h = *(const double *)context;
    (void)t;
    (void)from;
    (void)to;
    memset(rows, 0, 3 * LOAD_WIDTH * sizeof *rows);
    for (int f = 0; f < 2; f++) {
        double *row = rows + (1 + f) * LOAD_WIDTH;
        row[LOAD_FORCE] = (f ? 1 : -1) * pull * h * h;
        row[LOAD_LEVER] = 0.5 * h * pull * h * h;
        row[LOAD_TRACTION] = row[LOAD_NORMAL + f] = pull;
    }
}

/* What the tractions have done on a bar: force times the way of the faces, (h/2) eps beyond the
 * centres, eps = (t - lambda Th)/(2 G) [J]. */
static double work_on_bar(const struct lattice *l, const struct link_material *m, double h)
{
    double u[N_BAR][3], G = link_constants_shear(*m),
                        lambda = link_constants_lambda(LINK_ISOTROPIC, *m), way = 0;
    lattice_read(l, &(struct lattice_motion){.u = u});
    for (int end = 0; end < 2; end++) {
        double stretch = end ? u[N_BAR - 1][0] - u[N_BAR - 2][0] : u[1][0] - u[0][0];
        double strain = (stretch / (2 * h) + pull / (4 * G)) / (1 + 5 * lambda / (4 * G));
        way += (end ? u[N_BAR - 1][0] : -u[0][0]) + 0.5 * h * (pull - lambda * strain) / (2 * G);
    }
    return pull * h * h * way;
}

/* A free bar that is pulled at both ends from time 0 on: largest change of energy less work, over
 * the largest work. */
static double unbalanced(double dt)
{
    const struct link_material m = {1000, 2e7, 0.3, 0};
    const int size[3] = {N_BAR, 1, 1};
    double h = 0.1, worst = 0, most = 0;
    struct lattice_cells *cells = bodies_create(1, size, h, 1, bodies_block);
    struct lattice_options o = {
        .dt = dt, .material = &m, .n_material = 1, .n_row = 3, .rows_at = bar_rows, .context = &h};
    struct lattice_energy now;
    cells->row[0] = 1;
    cells->row[N_BAR - 1] = 2;
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    struct lattice_account *account = lattice_energy_create(l, cells);
    lattice_energy_now(account, &now);
    double start = now.elastic - work_on_bar(l, &m, h), first = work_on_bar(l, &m, h);
    lattice_begin_step(l);
    for (int step = 1; step <= (int)lround(8e-3 / dt); step++) {
        bool observe = step % (int)lround(4e-4 / dt) == 0;
        lattice_advance(l, observe);
        if (!observe) continue;
        lattice_energy_now(account, &now);
        double work = work_on_bar(l, &m, h);
        lattice_begin_step(l);
        most = fmax(most, work - first);
        worst = fmax(worst, fabs(now.kinetic + now.rotational + now.elastic - work - start));
    }
    lattice_energy_free(account);
    lattice_free(l);
    bodies_free(cells);
    return worst / most;
}

static void loaded(void **state)
{
    (void)state;
    double coarse = unbalanced(1e-4), fine = unbalanced(5e-5), order = log2(coarse / fine);
    printf("pulled bar: energy less work %.3g and %.3g of the work, order %.2f\n", coarse, fine,
        order);
    assert_near(order, 2, 0.2);
    assert_below(fine, 1e-2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(one_cell), cmocka_unit_test(strained),
        cmocka_unit_test(out_of_range), cmocka_unit_test(kept), cmocka_unit_test(loaded)};
    return DEVICE_TESTS(tests);
}
