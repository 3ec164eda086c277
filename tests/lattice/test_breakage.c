/* Breakage on the device, in double: one link at its very limit, in each mode; and a body whose
 * links have broken goes on, to the bit, as the body that never had them. */
#include "tests/limit/limit_test.h"

#include <string.h>

#include "comm/fail.h"
#include "lattice_bodies.h"
#include "kernels/lattice/lattice_words.h"
#include "lattice/lattice_break.h"
#include "lattice/lattice_energy.h"
#include "tests/mpi_check.h"
#include "device_tests.h"

static const enum lattice_scheme schemes[5] = {
    LATTICE_LEAPFROG, LATTICE_RK4, LATTICE_RKN4, LATTICE_PEFRL, LATTICE_VEFRL};
enum { TENSION, SHEAR, BENDING, TWIST };

/* Axis first: displacement of the upper of two cells [m], and its rotation, half that of the link:
 * the lower cell has the opposite. The vector of a quaternion, or a small rotation [1]. */
struct strain {
    double shift[3], turn[3];
};

/* Mode in which the link of two cells along `axis` breaks in one step from the strain, or -1. E =
 * 1024 Pa, nu = 0, h = 1/2 m. */
static int mode_of(
    int axis, struct strain s, struct link_strength strength, enum lattice_scheme scheme, bool turn)
{
    const struct link_material m = {1000, 1024, 0, 0};
    int size[3] = {1, 1, 1}, mode = -1;
    int64_t count[LATTICE_BREAK_MODES], all = 0;
    size[axis] = 2;
    struct lattice_cells *cells = bodies_create(1, size, 0.5, 1, bodies_block);
    struct lattice_options o = {.scheme = scheme,
        .dt = 1e-9,
        .turn = turn,
        .material = &m,
        .n_material = 1,
        .n_row = 1,
        .strength = &strength};
    struct lattice_motion x = bodies_motion(2);
    double square = 0;
    for (int a = 0; a < 3; a++) {
        int b = (axis + a) % 3;
        x.u[1][b] = s.shift[a];
        x.theta[1][b] = x.q[1][1 + b] = s.turn[a];
        x.theta[0][b] = x.q[0][1 + b] = -s.turn[a];
        square += s.turn[a] * s.turn[a];
    }
    x.q[0][0] = x.q[1][0] = sqrt(1 - square);
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    lattice_write(l, &x);
    lattice_begin_step(l);
    lattice_advance(l, true);
    lattice_break_count(l->breakage, count);
    for (int k = 0; k < LATTICE_BREAK_MODES; k++) {
        if (count[k]) mode = k;
        all += count[k];
    }
    assert_true(all <= 1);
    lattice_free(l);
    bodies_free(cells);
    bodies_motion_free(&x);
    return mode;
}

/* Forces: f = E h x for a shift x, over h^2. In powers of two this is exact, and so is the limit.
 * Moments: (E h^3/12) chi, chi = 2 x for small rotations x and -x, sin(4 arcsin x) for quaternions
 * with the vectors x and -x; the edge has 6 mom/h^3 in bending, 3 mom/h^3 in twist. */
static void limits(enum lattice_scheme scheme, bool turn, int first, int end)
{
    const double x = 1.0 / 1024, none = HUGE_VAL, stress = 1024 * x / 0.5,
                 chi = turn ? sin(4 * asin(x)) : 2 * x, edge = 1024 * chi / 2;
    const double more = nextafter(stress, 1e9), below = 1 - 1e-14, above = 1 + 1e-14;
    const struct strain pull = {{x, 0, 0}, {0, 0, 0}}, push = {{-100 * x, 0, 0}, {0, 0, 0}},
                        slide = {{0, 0, -x}, {0, 0, 0}};
    const struct strain bend = {{0, 0, 0}, {0, x, 0}}, twist = {{0, 0, 0}, {-x, 0, 0}};
    for (int axis = first; axis < end; axis++) {
        int c = turn ? axis : 2 - axis; /* the criterion; all of them are the same here */
        assert_int_equal(
            mode_of(axis, pull, (struct link_strength){stress, none, c, 0, 0, 0}, scheme, turn),
            TENSION);
        assert_int_equal(
            mode_of(axis, pull, (struct link_strength){more, none, c, 0, 0, 0}, scheme, turn), -1);
        assert_int_equal(
            mode_of(axis, push, (struct link_strength){stress, none, c, 0, 0, 0}, scheme, turn),
            -1);
        assert_int_equal(
            mode_of(axis, slide, (struct link_strength){none, stress, c, 0, 0, 0}, scheme, turn),
            SHEAR);
        assert_int_equal(
            mode_of(axis, slide, (struct link_strength){none, more, c, 0, 0, 0}, scheme, turn), -1);
        assert_int_equal(
            mode_of(axis, twist, (struct link_strength){none, below * edge / 2, c, 0, 0, 0}, scheme,
                turn),
            TWIST);
        assert_int_equal(
            mode_of(axis, twist, (struct link_strength){none, above * edge / 2, c, 0, 0, 0}, scheme,
                turn),
            -1);
        /* faces that turn by any angle also open a little */
        if (turn && c != CRITERION_LARGEST) continue;
        assert_int_equal(mode_of(axis, bend, (struct link_strength){below * edge, none, c, 0, 0, 0},
                             scheme, turn),
            BENDING);
        assert_int_equal(mode_of(axis, bend, (struct link_strength){above * edge, none, c, 0, 0, 0},
                             scheme, turn),
            -1);
    }
}

static void one_link(void **state)
{
    (void)state;
    limits(LATTICE_LEAPFROG, false, 0, 1);
    limits(LATTICE_RK4, true, 2, 3);
}
static void one_link_other_axes(void **state)
{
    (void)state;
    limits(LATTICE_LEAPFROG, false, 1, 3);
    limits(LATTICE_RK4, true, 0, 2);
}

static void schemes_agree(void **state)
{
    const struct strain pull = {{1.0 / 1024, 0, 0}, {0, 0, 0}};
    (void)state;
    for (int k = 0; k < 5; k++) {
        assert_int_equal(
            mode_of(0, pull, (struct link_strength){2, HUGE_VAL, CRITERION_SUM, 0, 0, 0},
                schemes[k], true),
            TENSION);
        assert_int_equal(
            mode_of(0, pull,
                (struct link_strength){nextafter(2, 3), HUGE_VAL, CRITERION_SUM, 0, 0, 0},
                schemes[k], true),
            -1);
    }
}

/* n steps from x, into x; links: those left at the end, if not NULL. */
static uint64_t run(const struct lattice_cells *cells, const struct lattice_options *o, int n,
    struct lattice_motion *x, int32_t *links)
{
    struct lattice *l = lattice_create(dev, comm, cells, o);
    uint64_t digest;
    lattice_write(l, x);
    lattice_begin_step(l);
    for (int step = 1; step <= n; step++) lattice_advance(l, step == n);
    lattice_read(l, x);
    assert_int_equal(lattice_digest(l, &digest), 0);
    if (links) lattice_break_read(l->breakage, links, NULL);
    lattice_free(l);
    return digest;
}

static void shake(struct lattice_motion *x, int64_t n)
{
    for (int64_t i = 0; i < n; i++)
        for (int a = 0; a < 3; a++) {
            x->u[i][a] =
                1e-3 *
                ((double)(mpi_check_random((uint64_t)(3 * i + a)) >> 11) / 4503599627370496.0 - 1);
            x->v[i][a] = -100 * x->u[i][a];
        }
}

/* All links of the second material break at once, those of the first never. What is left is a body
 * with more free faces (kernels/lattice/law_volume.h). */
static void never_there(int begin, int end)
{
    const int size[3] = {17, 9, 4};
    const struct link_material material[2] = {{1000, 2e7, 0.3, 0}, {700, 1e7, 0.1, 0}};
    const struct link_strength strength[2] = {
        {HUGE_VAL, HUGE_VAL, CRITERION_SUM, 0, 0, 0}, {1e-30, 1e-30, CRITERION_SUM, 0, 0, 0}};
    for (int k = begin; k < end; k++) {
        struct lattice_cells *cells = bodies_create(1, size, 0.1, 2, bodies_mixed);
        struct lattice_options o = {.scheme = schemes[k],
            .dt = 1e-4,
            .turn = true,
            .material = material,
            .n_material = 2,
            .n_row = 1};
        struct lattice_motion x = bodies_motion(cells->n), all = bodies_motion(cells->n);
        int32_t *links = fail_alloc((size_t)cells->n * sizeof *links);
        int64_t gone = 0, left = 0;
        for (int64_t i = 0; i < cells->n; i++) cells->row[i] = 0;
        shake(&x, cells->n);
        shake(&all, cells->n);
        o.strength = strength;
        uint64_t broken = run(cells, &o, 9, &all, NULL);
        run(cells, &o, 1, &x, links);
        for (int64_t i = 0; i < cells->n; i++) {
            left += __builtin_popcount((unsigned)links[i]);
            gone += __builtin_popcount((unsigned)(cells->bits[i] & CELL_LINKS)) -
                    __builtin_popcount((unsigned)links[i]);
            if (cells->kind_of[i] == 1) assert_int_equal(links[i], 0);
            cells->bits[i] = (uint16_t)((cells->bits[i] & CELL_FIXED) | links[i]);
        }
        assert_true(left > 100 && gone > 100);
        o.strength = NULL;
        assert_true(run(cells, &o, 8, &x, NULL) == broken);
        free(links);
        bodies_motion_free(&x);
        bodies_motion_free(&all);
        bodies_free(cells);
    }
}

static void as_if_never_there(void **state)
{
    (void)state;
    never_there(0, 1);
}
static void as_if_never_there_more(void **state)
{
    (void)state;
    never_there(1, 5);
}

/* A run that goes on from links and fates at any step has the bits of one that never stopped: also
 * where a link is due, which goes with the step after. */
static void due_is_kept(void **state)
{
    const int size[3] = {17, 9, 4};
    const struct link_material material = {1000, 2e7, 0.3, 0};
    const struct link_strength strength = {HUGE_VAL, HUGE_VAL, CRITERION_SUM, 1e5, 0, true};
    struct lattice_cells *cells = bodies_create(1, size, 0.1, 1, bodies_block);
    struct lattice_options o = {
        .dt = 1e-4, .material = &material, .n_material = 1, .n_row = 1, .strength = &strength};
    size_t n = (size_t)cells->n;
    struct lattice_motion x = bodies_motion(cells->n);
    int32_t *links = fail_alloc(n * sizeof *links), *fate = fail_alloc(n * sizeof *fate);
    int64_t count[LATTICE_BREAK_MODES];
    int n_due = 0;
    (void)state;
    for (int64_t i = 0; i < cells->n; i++)
        x.v[i][0] = 8 * sin(cells->at[i][0]), x.v[i][1] = 4 * cos(cells->at[i][1]);
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    lattice_write(l, &x);
    lattice_begin_step(l);
    for (int step = 1; step <= 12; step++) {
        uint64_t whole, resumed;
        struct lattice *other = lattice_create(dev, comm, cells, &o);
        lattice_advance(l, true);
        lattice_read(l, &x);
        lattice_break_read(l->breakage, links, fate);
        for (int64_t i = 0; i < cells->n; i++) n_due += fate[i] >> FATE_DUE_AT != 0;
        lattice_write(other, &x);
        lattice_break_write(other->breakage, links, fate);
        lattice_begin_step(l);
        lattice_begin_step(other);
        lattice_advance(l, true);
        lattice_advance(other, true);
        assert_int_equal(lattice_digest(l, &whole), 0);
        assert_int_equal(lattice_digest(other, &resumed), 0);
        assert_true(whole == resumed);
        lattice_begin_step(l);
        lattice_free(other);
    }
    lattice_break_count(l->breakage, count);
    assert_true(n_due > 20 && count[0] > 20 && !count[1] && !count[2] && !count[3]);
    lattice_free(l);
    free(links);
    free(fate);
    bodies_free(cells);
    bodies_motion_free(&x);
}

/* Balance of energy over the time 2 ms, over what is released: a block in two halves, pulled apart
 * and moving, whose joint breaks at once. */
static double unbalanced(enum lattice_scheme scheme, double dt, double *released)
{
    const int size[3] = {10, 8, 3};
    const struct link_material material[2] = {{1000, 2e7, 0.3, 0}, {700, 1e7, 0.1, 0}};
    const struct link_strength strength[2] = {
        {HUGE_VAL, HUGE_VAL, CRITERION_SUM, 0, 0, 0}, {1e-30, 1e-30, CRITERION_SUM, 0, 0, 0}};
    struct lattice_cells *cells = bodies_create(1, size, 0.1, 2, bodies_block);
    struct lattice_options o = {.scheme = scheme,
        .dt = dt,
        .turn = true,
        .energy = true,
        .material = material,
        .n_material = 2,
        .n_row = 1,
        .strength = strength};
    struct lattice_motion x = bodies_motion(cells->n);
    struct lattice_energy start, now;
    for (int64_t i = 0; i < cells->n; i++) {
        cells->kind_of[i] = cells->at[i][0] == 5 && cells->at[i][1] < 5;
        for (int a = 0; a < 3; a++) x.v[i][a] = x.u[i][0] = 0;
        x.u[i][0] = 1e-3 * cells->at[i][0] + 2e-4 * sin(cells->at[i][1]);
        x.u[i][1] = 3e-4 * cos(cells->at[i][0] + cells->at[i][2]);
        x.v[i][0] = 0.5 * cells->at[i][0];
    }
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    lattice_write(l, &x);
    struct lattice_account *account = lattice_energy_create(l, cells);
    lattice_energy_now(account, &start);
    int n = (int)lround(2e-3 / dt);
    lattice_begin_step(l);
    for (int step = 1; step <= n; step++) lattice_advance(l, step == n);
    lattice_energy_now(account, &now);
    *released = now.released;
    lattice_energy_free(account);
    lattice_free(l);
    bodies_free(cells);
    bodies_motion_free(&x);
    return lattice_energy_balance(&start, &now) / now.released;
}

static void released(void **state)
{
    (void)state;
    for (int k = 0; k < 5; k++) {
        double coarse_released, fine_released,
            coarse = unbalanced(schemes[k], 1e-4, &coarse_released);
        double fine = unbalanced(schemes[k], 5e-5, &fine_released);
        printf("%s: %g J released, balance off by %.3g and %.3g of it\n",
            lattice_schemes_table(schemes[k])->name, fine_released, coarse, fine);
        assert_true(fine_released > 0);
        assert_true(fabs(fine) < 0.3 * fabs(coarse) && fabs(fine) < 0.02);
    }
}

/* Argument: none, or schemes for what takes longer. */
int main(int argc, char **argv)
{
    const struct CMUnitTest some[] = {
        cmocka_unit_test(one_link), cmocka_unit_test(as_if_never_there)};
    const struct CMUnitTest more[] = {cmocka_unit_test(one_link_other_axes),
        cmocka_unit_test(due_is_kept), cmocka_unit_test(schemes_agree), cmocka_unit_test(released),
        cmocka_unit_test(as_if_never_there_more)};
    return argc > 1 && strcmp(argv[1], "schemes") == 0 ? DEVICE_TESTS(more) : DEVICE_TESTS(some);
}
