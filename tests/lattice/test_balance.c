/* The balance of energy closes with the order of the scheme: a bar that all kinds of loads pull and
 * that damping slows. */
#include "tests/limit/limit_test.h"

#include <string.h>

#include "comm/fail.h"
#include "lattice_bodies.h"
#include "lattice/lattice_energy.h"
#include "device_tests.h"

enum { N_X = 6, ROW_END = 1, ROW_SIDE, ROW_BASE, ROW_PULL, N_ROW };
static const double h = 0.1, omega = 150, force = 300 /* [N] per cell at the end */,
                    pressure = 2e4 /* [Pa] */;

/* sin(omega t), its change, and its mean. */
static double wave(double t)
{
    return sin(omega * t);
}
static double wave_mean(double from, double to)
{
    return from < to || to < from ? (cos(omega * from) - cos(omega * to)) / (omega * (to - from))
                                  : wave(from);
}

/* At the end a force that keeps its direction, as a traction on the upper face, and one that acts
 * on the centres; on the side a pressure that turns with the cells, and an acceleration; the base
 * is led to and fro in y, and about x. */
static void rows_at(void *context, double t, double from, double to, double *rows)
{
    double *end = rows + ROW_END * LOAD_WIDTH, *side = rows + ROW_SIDE * LOAD_WIDTH,
           *base = rows + ROW_BASE * LOAD_WIDTH, at = wave(t);
    double traction[3] = {force, 0.3 * force, -0.5 * force}, change = omega * cos(omega * t);
    (void)context;
    memset(rows, 0, N_ROW * LOAD_WIDTH * sizeof *rows);
    for (int a = 0; a < 3; a++) {
        end[LOAD_FORCE + a] = at * traction[a] + (a == 2 ? 50 : 0);
        end[LOAD_LEVER + a] = 0.5 * h * at * traction[a];
    }
    end[LOAD_TRACTION] = end[LOAD_NORMAL + 1] = at * traction[0] / (h * h);
    end[LOAD_RATE] = change * traction[0] / (h * h);
    side[LOAD_BODY + 1] = -at * pressure * h * h;
    side[LOAD_TRACTION] = side[LOAD_NORMAL + 3] = -at * pressure;
    side[LOAD_RATE] = -change * pressure;
    side[LOAD_ACCELERATION] = 20 * at;
    rows[ROW_PULL * LOAD_WIDTH + LOAD_FORCE + 2] = 50;
    base[LOAD_VELOCITY + 1] = 0.3 * wave_mean(from, to);
    base[LOAD_VELOCITY + 3] = 2 * wave_mean(from, to);
    base[LOAD_NOW + 1] = 0.3 * at;
    base[LOAD_NOW + 3] = 2 * at;
}

/* Base: x = 0, held but in y and about x, where it is led. End: x = N_X - 1. Side: y = 1 of the
 * third layer. */
static bool bar(int grid, const int at[3], struct bodies_cell *cell)
{
    (void)grid;
    cell->kind = at[0] >= N_X / 2;
    if (at[0] == 0) cell->row = ROW_BASE;
    if (at[0] == 0) cell->fixed = 63;
    if (at[0] == N_X - 1) cell->row = ROW_END;
    if (at[0] == 2 && at[1] == 1) cell->row = ROW_SIDE;
    return true;
}

struct sums {
    double worst, work, links, mass;
};

/* Largest |balance| over 0.04 s, and the terms at the end [J]. */
static struct sums run(struct lattice_options o, double eta, double alpha_1, double dt)
{
    const struct link_material material[2] = {{1000, 1e7, 0.3, eta}, {1500, 7e6, 0.2, 0}};
    const double alpha[2] = {alpha_1, 2 * alpha_1};
    const int size[3] = {N_X, 2, 2};
    struct lattice_cells *cells = bodies_create(1, size, h, 2, bar);
    struct sums s = {0, 0, 0, 0};
    o.dt = dt;
    o.energy = true;
    o.material = material;
    o.n_material = 2;
    o.alpha = alpha;
    o.n_row = N_ROW;
    o.rows_at = rows_at;
    o.gravity[1] = -9.81;
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    struct lattice_account *account = lattice_energy_create(l, cells);
    struct lattice_energy start, now;
    lattice_energy_now(account, &start);
    lattice_begin_step(l);
    int n = (int)lround(0.04 / dt), every = (int)lround(0.004 / dt);
    for (int step = 1; step <= n; step++) {
        lattice_advance(l, step % every == 0);
        if (step % every != 0) continue;
        lattice_energy_now(account, &now);
        s.worst = fmax(s.worst, fabs(lattice_energy_balance(&start, &now)));
        if (step < n) lattice_begin_step(l);
    }
    s.work = now.work;
    s.links = now.link_damping;
    s.mass = now.mass_damping;
    lattice_energy_free(account);
    lattice_free(l);
    bodies_free(cells);
    return s;
}

/* From dt to dt/4. Runge-Kutta schemes lose energy at fifth order too, and the two cancel at some
 * step: from dt to dt/16 there, and not below 4. */
static void closes(const char *what, struct lattice_options o, double eta, double alpha, double dt,
    double expected)
{
    bool is_rk = lattice_schemes_table(o.scheme)->is_rk;
    int halvings = is_rk ? 4 : 2;
    struct sums coarse = run(o, eta, alpha, dt), fine = run(o, eta, alpha, ldexp(dt, -halvings));
    double order = log2(coarse.worst / fine.worst) / halvings;
    printf("%s: work %.5g J, links %.4g J, mass %.4g J; off by %.3g and %.3g J, order %.2f\n", what,
        fine.work, fine.links, fine.mass, coarse.worst, fine.worst, order);
    assert_near(order, is_rk ? expected + 0.4 : expected, is_rk ? 0.6 : 0.1);
    assert_below(coarse.worst, 1e-3 * fabs(fine.work));
    assert_true((fine.links > 0) == (eta > 0) && (fine.mass > 0) == (alpha > 0));
}

/* What 0.1 s of a small body without weight take, a line of n cells along x; u [n][3] is where they
 * are then. */
static struct lattice_energy pass(const struct link_material *m, double alpha, int n, int row,
    int fixed, double v, enum lattice_scheme scheme, double (*u)[3])
{
    const int size[3] = {n, 1, 1};
    struct lattice_cells *cells = bodies_create(1, size, h, 1, bodies_block);
    struct lattice_options o = {.scheme = scheme,
        .dt = 1e-4,
        .energy = true,
        .material = m,
        .alpha = &alpha,
        .n_material = 1,
        .n_row = N_ROW,
        .rows_at = rows_at};
    struct lattice_energy e;
    bodies_shake(cells, 0, 0);
    for (int i = 0; i < n; i++) {
        cells->row[i] = row;
        cells->bits[i] |= (uint16_t)(fixed << 6);
        cells->v[i][0] = i == 0 ? v : -v;
    }
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    struct lattice_account *account = lattice_energy_create(l, cells);
    lattice_begin_step(l);
    for (int step = 1; step <= 1000; step++) lattice_advance(l, step == 1000);
    lattice_energy_now(account, &e);
    lattice_read(l, &(struct lattice_motion){.u = u});
    lattice_energy_free(account);
    lattice_free(l);
    bodies_free(cells);
    return e;
}

/* A force of 50 N along z on the centre of a free cell with mass damping: v = (F/(m alpha)) (1 -
 * e^(-alpha t)), work F z, what is not kinetic is lost. Kicks know the damping, so only what drifts
 * do to z and the trapezia of the work are of second order. */
static void pulled_cell(void **state)
{
    const struct link_material m = {1000, 1e6, 0, 0};
    const double alpha = 30, mass = m.density * h * h * h, t = 0.1, F = 50,
                 v = F / (mass * alpha) * -expm1(-alpha * t);
    const double z = F / (mass * alpha) * (t + expm1(-alpha * t) / alpha);
    double u[1][3];
    (void)state;
    struct lattice_energy e = pass(&m, alpha, 1, ROW_PULL, 0, 0, LATTICE_LEAPFROG, u);
    assert_near(e.kinetic, 0.5 * mass * v * v, 1e-6 * F * z);
    assert_near(e.work, F * z, 1e-6 * F * z);
    assert_near(e.mass_damping, F * z - 0.5 * mass * v * v, 1e-6 * F * z);
}

/* A led cell: all that its drive gives is its kinetic energy; damping of masses does not act on
 * it. */
static void led_cell(void **state)
{
    const struct link_material m = {1000, 1e6, 0, 0};
    const double mass = m.density * h * h * h, v = 0.3 * wave(0.1), w = 2 * wave(0.1);
    double u[1][3];
    (void)state;
    struct lattice_energy e = pass(&m, 30, 1, ROW_BASE, 63, 0, LATTICE_LEAPFROG, u);
    assert_near(e.work, 0.5 * mass * v * v + 0.5 * (mass * h * h / 6) * w * w, 1e-14);
    assert_near(e.kinetic + e.rotational, e.work, 1e-14);
    assert_near(e.mass_damping, 0, 0);
}

/* Two cells that start towards each other with v each, and a dashpot: r'' = -w^2 (r + eta r'), w^2
 * = 2 kn/m, so r = (2 v/w_d) e^(-d t) sin(w_d t), d = w^2 eta/2, w_d^2 = w^2 - d^2, and the links
 * have lost m v^2 - m r'^2/4 - kn r^2/2. */
static void dashpot(void **state)
{
    const struct link_material m = {1000, 1e5, 0, 2e-3};
    const double mass = m.density * h * h * h, kn = m.young * h, w2 = 2 * kn / mass,
                 d = 0.5 * w2 * m.damping, wd = sqrt(w2 - d * d), v = 0.1;
    const double t = 0.1, r = 2 * v / wd * exp(-d * t) * sin(wd * t),
                 rate = 2 * v * exp(-d * t) * (cos(wd * t) - d / wd * sin(wd * t));
    double u[2][3], lost = mass * v * v - 0.25 * mass * rate * rate - 0.5 * kn * r * r;
    (void)state;
    struct lattice_energy e = pass(&m, 0, 2, 0, 0, v, LATTICE_RK4, u);
    assert_near(u[0][0] - u[1][0], r, 1e-7 * v / wd);
    assert_near(e.link_damping, lost, 1e-8 * mass * v * v);
    assert_near(e.work, 0, 0);
}

static void leapfrog(void **state)
{
    (void)state;
    closes("leapfrog, damped", (struct lattice_options){.scheme = LATTICE_LEAPFROG, .turn = true},
        1e-4, 20, 2e-4, 2);
}
static void small_rotations(void **state)
{
    (void)state;
    closes("leapfrog, small rotations", (struct lattice_options){.scheme = LATTICE_LEAPFROG}, 1e-4,
        20, 2e-4, 2);
}
static void undamped(void **state)
{
    (void)state;
    closes("leapfrog", (struct lattice_options){.scheme = LATTICE_LEAPFROG, .turn = true}, 0, 0,
        2e-4, 2);
}
static void rk4(void **state)
{
    (void)state;
    closes("rk4, damped", (struct lattice_options){.scheme = LATTICE_RK4, .turn = true}, 1e-4, 20,
        4e-4, 4);
}
static void rkn4(void **state)
{
    (void)state;
    closes("rkn4", (struct lattice_options){.scheme = LATTICE_RKN4, .turn = true}, 0, 0, 4e-4, 4);
}
static void pefrl(void **state)
{
    (void)state;
    closes("pefrl, damped", (struct lattice_options){.scheme = LATTICE_PEFRL, .turn = true}, 0, 20,
        4e-4, 4);
}
static void vefrl(void **state)
{
    (void)state;
    closes("vefrl, damped", (struct lattice_options){.scheme = LATTICE_VEFRL, .turn = true}, 0, 20,
        4e-4, 4);
}

/* Argument: none, or schemes for those that are not the default and what they share. */
int main(int argc, char **argv)
{
    const struct CMUnitTest some[] = {cmocka_unit_test(pulled_cell), cmocka_unit_test(led_cell),
        cmocka_unit_test(dashpot), cmocka_unit_test(leapfrog)};
    const struct CMUnitTest more[] = {cmocka_unit_test(small_rotations), cmocka_unit_test(undamped),
        cmocka_unit_test(rk4), cmocka_unit_test(rkn4), cmocka_unit_test(pefrl),
        cmocka_unit_test(vefrl)};
    return argc > 1 && strcmp(argv[1], "schemes") == 0 ? DEVICE_TESTS(more) : DEVICE_TESTS(some);
}
