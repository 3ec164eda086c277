/* What the lattice does in time, against closed forms, in double: modes of a chain, orders of all
 * schemes, free flight, loads, damping. */
#include "tests/limit/limit_test.h"

#include <string.h>

#include "comm/fail.h"
#include "lattice_bodies.h"
#include "device_tests.h"

static const enum lattice_scheme schemes[5] = {
    LATTICE_LEAPFROG, LATTICE_RK4, LATTICE_RKN4, LATTICE_PEFRL, LATTICE_VEFRL};

static bool some;
static int n_scheme; /* the first two, or all */

/* The state of a small body after n steps from m, in m. */
static void run(const struct lattice_cells *cells, const struct lattice_options *o, int n,
    struct lattice_motion *m)
{
    struct lattice *l = lattice_create(dev, comm, cells, o);
    lattice_write(l, m);
    lattice_begin_step(l);
    for (int step = 1; step <= n; step++) lattice_advance(l, step == n);
    lattice_read(l, m);
    lattice_free(l);
}

enum { N_CHAIN = 12, MODE = 3 };

/* Largest error of mode MODE of a free chain along an axis, over its amplitude, after n steps of dt
 * = z/w; frequency: of the reference [1 = w]. */
static double chain_error(
    enum lattice_scheme scheme, int axis, int n, double z, double frequency, bool turn)
{
    const struct link_material steel = {7900, 2.1e11, 0, 0};
    const double h = 0.008, amplitude = 1e-6;
    int size[3] = {1, 1, 1};
    size[axis] = N_CHAIN;
    struct lattice_cells *cells = bodies_create(1, size, h, 1, bodies_block);
    double kn = steel.young * h, m = steel.density * h * h * h,
           w = 2 * sqrt(kn / m) * sin(MODE * M_PI / (2 * N_CHAIN)), worst = 0;
    struct lattice_options o = {.scheme = scheme,
        .dt = z / w,
        .turn = turn,
        .material = &steel,
        .n_material = 1,
        .n_row = 1};
    struct lattice_motion s = bodies_motion(N_CHAIN);
    for (int i = 0; i < N_CHAIN; i++)
        s.u[i][axis] = amplitude * cos(M_PI * MODE * (i + 0.5) / N_CHAIN);
    run(cells, &o, n, &s);
    for (int i = 0; i < N_CHAIN; i++)
        for (int a = 0; a < 3; a++) {
            double exact = a == axis ? amplitude * cos(M_PI * MODE * (i + 0.5) / N_CHAIN) *
                                           cos(frequency * n * z)
                                     : 0;
            worst = fmax(worst, fabs(s.u[i][a] - exact) / amplitude);
        }
    bodies_motion_free(&s);
    bodies_free(cells);
    return worst;
}

/* Leapfrog has the mode with the frequency arcsin(z/2)/(z/2), exactly. */
static void chain_leapfrog(void **state)
{
    (void)state;
    for (int axis = 0; axis < 3; axis++)
        for (int turn = 0; turn < 2; turn++) {
            if (some && axis != 2 * turn) continue;
            assert_below(
                chain_error(LATTICE_LEAPFROG, axis, 200, 0.3, asin(0.15) / 0.15, turn), 1e-11);
        }
}

static void chain_orders(void **state)
{
    (void)state;
    for (int k = 0; k < n_scheme; k++) {
        int axis = some ? 0 : k % 3;
        double coarse = chain_error(schemes[k], axis, 20, 0.25, 1, false),
               fine = chain_error(schemes[k], axis, 40, 0.125, 1, false);
        double order = log2(coarse / fine), expected = schemes[k] == LATTICE_LEAPFROG ? 2 : 4;
        printf("chain, %s: errors %.3g and %.3g, order %.3f\n",
            lattice_schemes_table(schemes[k])->name, coarse, fine, order);
        assert_near(order, expected, 0.1);
    }
}

/* A spinning, vibrating block: error at t = 4 against PEFRL with a step 16 times smaller. */
static void block(enum lattice_scheme scheme, double dt, int n, struct lattice_motion *s)
{
    const struct link_material soft = {1, 1, 0.3, 0};
    const double w0[3] = {0.15, 0.05, 0.1};
    const int size[3] = {3, 2, 2};
    struct lattice_cells *cells = bodies_create(1, size, 1, 1, bodies_block);
    struct lattice_options o = {
        .scheme = scheme, .dt = dt, .turn = true, .material = &soft, .n_material = 1, .n_row = 1};
    *s = bodies_motion(cells->n);
    bodies_shake(cells, 0.025, 0.025);
    for (int64_t i = 0; i < cells->n; i++)
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            double r_b = cells->at[i][b] - 0.5 * (size[b] - 1),
                   r_c = cells->at[i][c] - 0.5 * (size[c] - 1);
            s->v[i][a] = cells->v[i][a] + w0[b] * r_c - w0[c] * r_b;
            s->w[i][a] = cells->w[i][a] + w0[a];
        }
    run(cells, &o, n, s);
    bodies_free(cells);
}

static double block_distance(const struct lattice_motion *a, const struct lattice_motion *b)
{
    double worst = 0;
    for (int i = 0; i < 12; i++)
        for (int c = 0; c < 4; c++) {
            worst = fmax(worst, fabs(a->q[i][c] - b->q[i][c]));
            if (c < 3)
                worst = fmax(
                    worst, fmax(fabs(a->u[i][c] - b->u[i][c]),
                               fmax(fabs(a->v[i][c] - b->v[i][c]), fabs(a->w[i][c] - b->w[i][c]))));
        }
    return worst;
}

static void block_orders(void **state)
{
    struct lattice_motion exact, coarse, fine;
    (void)state;
    block(LATTICE_PEFRL, 4.0 / 640, 640, &exact);
    for (int k = 0; k < n_scheme; k++) {
        block(schemes[k], 0.1, 40, &coarse);
        block(schemes[k], 0.05, 80, &fine);
        double a = block_distance(&coarse, &exact), b = block_distance(&fine, &exact),
               order = log2(a / b);
        printf("spinning block, %s: errors %.3g and %.3g, order %.3f\n",
            lattice_schemes_table(schemes[k])->name, a, b, order);
        assert_near(order, schemes[k] == LATTICE_LEAPFROG ? 2 : 4, 0.2);
        bodies_motion_free(&coarse);
        bodies_motion_free(&fine);
    }
    bodies_motion_free(&exact);
}

/* Row 1: a force, a torque by its lever, an acceleration, or a prescribed velocity. */
struct push {
    double force, lever, acceleration, v;
};

static void rows_at(void *context, double t, double from, double to, double *rows)
{
    const struct push *p = context;
    memset(rows, 0, 2 * LOAD_WIDTH * sizeof *rows);
    rows[LOAD_WIDTH + LOAD_FORCE] = p->force;
    rows[LOAD_WIDTH + LOAD_LEVER + 1] = p->lever; /* L_x along y: about z */
    rows[LOAD_WIDTH + LOAD_ACCELERATION + 1] = p->acceleration;
    /* v sin(t), mean over [from, to] */
    rows[LOAD_WIDTH + LOAD_VELOCITY + 2] =
        p->v * (to > from || to < from ? (cos(from) - cos(to)) / (to - from) : sin(from));
    rows[LOAD_WIDTH + LOAD_NOW + 2] = p->v * sin(t);
}

/* One free cell, t = 2 s: x = F t^2/(2 m), y = a t^2/2, w_z = T t/J with J = m h^2/6, for two
 * densities. */
static void free_cell(void **state)
{
    (void)state;
    for (int k = 0; k < 2 * n_scheme; k++) {
        const struct link_material m = {k < n_scheme ? 7900 : 1000, 1e6, 0, 0};
        const double h = 0.5, mass = m.density * h * h * h;
        const int size[3] = {1, 1, 1};
        struct push push = {.force = 30, .lever = 2, .acceleration = 0.7};
        struct lattice_cells *cells = bodies_create(1, size, h, 1, bodies_block);
        struct lattice_options o = {.scheme = schemes[k % n_scheme],
            .dt = 0.01,
            .material = &m,
            .n_material = 1,
            .n_row = 2,
            .rows_at = rows_at,
            .context = &push};
        struct lattice_motion s = bodies_motion(1);
        o.gravity[2] = -9.81;
        s.v[0][2] = 5;
        cells->row[0] = 1;
        run(cells, &o, 200, &s);
        assert_near(s.u[0][0], 30 / mass * 2, 1e-12);
        assert_near(s.u[0][1], 0.7 * 2, 1e-12);
        assert_near(s.u[0][2], 5 * 2 - 9.81 * 2, 1e-11);
        assert_near(s.w[0][2], 2 * 2 / (mass * h * h / 6), 1e-12);
        assert_near(s.theta[0][2], 2 * 2 / (mass * h * h / 6), 1e-12);
        bodies_motion_free(&s);
        bodies_free(cells);
    }
}

/* A prescribed DOF follows the integral of its velocity, 1 - cos t: exactly with splittings, at
 * fourth order with Runge-Kutta; others stay. */
static void prescribed(void **state)
{
    (void)state;
    for (int k = 0; k < n_scheme; k++) {
        const struct link_material m = {1000, 1e6, 0, 0};
        const int size[3] = {1, 1, 1};
        struct push push = {.force = 30, .v = 1};
        struct lattice_cells *cells = bodies_create(1, size, 0.5, 1, bodies_block);
        struct lattice_options o = {.scheme = schemes[k],
            .dt = 0.01,
            .material = &m,
            .n_material = 1,
            .n_row = 2,
            .rows_at = rows_at,
            .context = &push};
        struct lattice_motion s = bodies_motion(1);
        cells->row[0] = 1;
        cells->bits[0] |= CELL_FIX(0) | CELL_FIX(2);
        run(cells, &o, 200, &s);
        assert_near(s.u[0][0], 0, 0);
        assert_near(
            s.u[0][2], 1 - cos(2), lattice_schemes_table(schemes[k])->is_rk ? 1e-11 : 1e-13);
        /* ends with a drift: its mean */
        assert_near(s.v[0][2], sin(2), schemes[k] == LATTICE_PEFRL ? 1e-3 : 1e-12);
        bodies_motion_free(&s);
        bodies_free(cells);
    }
}

/* v = v0 exp(-alpha t), u = v0 (1 - exp(-alpha t))/alpha: kicks are exact in v. z = alpha dt: RK4
 * has 1 - z + z^2/2 - z^3/6 + z^4/24 in place of exp(-z); leapfrog's u is that of velocities at
 * half steps. */
static void mass_damping(void **state)
{
    (void)state;
    for (int k = 0; k < n_scheme; k++) {
        const struct link_material m = {1000, 1e6, 0, 0};
        const int size[3] = {1, 1, 1};
        const double alpha = 1.5;
        struct lattice_cells *cells = bodies_create(1, size, 0.5, 1, bodies_block);
        struct lattice_options o = {.scheme = schemes[k],
            .dt = 0.01,
            .material = &m,
            .n_material = 1,
            .n_row = 1,
            .alpha = &alpha};
        struct lattice_motion s = bodies_motion(1);
        if (schemes[k] == LATTICE_RKN4) { /* takes no damping */
            bodies_motion_free(&s);
            bodies_free(cells);
            continue;
        }
        s.v[0][1] = 2;
        s.w[0][0] = 3;
        run(cells, &o, 200, &s);
        double z = alpha * o.dt, exact = exp(-3),
               gone = schemes[k] == LATTICE_RK4
                          ? pow(1 - z * (1 - z * (0.5 - z * (1 / 6.0 - z / 24))), 200)
                          : exact;
        double middle = schemes[k] == LATTICE_LEAPFROG ? z * exp(-z / 2) / (1 - exp(-z)) : 1;
        assert_near(s.v[0][1], 2 * gone, 1e-14);
        assert_near(s.w[0][0], 3 * gone, 1e-14);
        assert_near(s.u[0][1], middle * 2 * (1 - exact) / alpha,
            schemes[k] == LATTICE_LEAPFROG ? 1e-13 : 1e-9);
        bodies_motion_free(&s);
        bodies_free(cells);
    }
}

/* A chain's mode with dashpots decays as exp(-zeta w t), zeta = eta w/2, with the frequency w
 * sqrt(1 - zeta^2). */
static void link_damping(void **state)
{
    const double h = 0.008, amplitude = 1e-6, zeta = 0.05, z = 0.02;
    struct link_material steel = {7900, 2.1e11, 0, 0};
    double w = 2 * sqrt(steel.young / steel.density) / h * sin(MODE * M_PI / (2 * N_CHAIN)),
           d = sqrt(1 - zeta * zeta);
    const int size[3] = {N_CHAIN, 1, 1}, n = 500;
    (void)state;
    steel.damping = 2 * zeta / w;
    struct lattice_cells *cells = bodies_create(1, size, h, 1, bodies_block);
    for (int k = 0; k < 2; k++) {
        double worst = 0;
        struct lattice_options o = {
            .scheme = schemes[k], .dt = z / w, .material = &steel, .n_material = 1, .n_row = 1};
        struct lattice_motion s = bodies_motion(N_CHAIN);
        for (int i = 0; i < N_CHAIN; i++)
            s.u[i][0] = amplitude * cos(M_PI * MODE * (i + 0.5) / N_CHAIN);
        run(cells, &o, n, &s);
        for (int i = 0; i < N_CHAIN; i++) {
            double exact = exp(-zeta * n * z) * (cos(d * n * z) + zeta / d * sin(d * n * z));
            worst = fmax(worst,
                fabs(s.u[i][0] / amplitude - exact * cos(M_PI * MODE * (i + 0.5) / N_CHAIN)));
        }
        printf("damped chain, %s: error %.3g\n", lattice_schemes_table(schemes[k])->name, worst);
        assert_below(worst, schemes[k] == LATTICE_RK4 ? 1e-8 : 2e-3);
        bodies_motion_free(&s);
    }
    bodies_free(cells);
}

/* Argument: some, for two schemes in place of five, in fewer layouts, without loads and damping,
 * with which tests/energy/test_budget.py closes a balance; or all. */
int main(int argc, char **argv)
{
    some = argc > 1 && strcmp(argv[1], "some") == 0;
    n_scheme = some ? 2 : 5;
    const struct CMUnitTest first[] = {cmocka_unit_test(chain_leapfrog),
        cmocka_unit_test(chain_orders), cmocka_unit_test(block_orders)};
    const struct CMUnitTest tests[] = {cmocka_unit_test(chain_leapfrog),
        cmocka_unit_test(chain_orders), cmocka_unit_test(block_orders), cmocka_unit_test(free_cell),
        cmocka_unit_test(prescribed), cmocka_unit_test(mass_damping),
        cmocka_unit_test(link_damping)};
    return some ? DEVICE_TESTS(first) : DEVICE_TESTS(tests);
}
