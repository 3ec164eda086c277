/* A body in a constant state of stress, held in balance by tractions on its exposed faces: every
 * cell writes just that stress, shear too, in both forms, before and after steps, in any attitude;
 * so does a body under pressure. Strain as in tests/link/test_patch.c. */
#include "tests/limit/limit_test.h"

#include <string.h>

#include "comm/fail.h"
#include "lattice_bodies.h"
#include "lattice/lattice_stress.h"
#include "kernels/common/quat.h"
#include "device_tests.h"

static const double edge = 0.005;

/* Row m: faces in the mask m are exposed. */
struct patch {
    double S[3][3];   /* in the body's axes [Pa] */
    double R[3][3];   /* columns: the body's axes in the world's */
    double T[3][3];   /* R S: tractions of its faces in the world's axes */
    bool is_pressure; /* S is -p 1, as a load that turns with the cell */
};

static void rows_at(void *context, double t, double from, double to, double *rows)
{
    const struct patch *p = context;
    (void)t;
    (void)from;
    (void)to;
    memset(rows, 0, 64 * LOAD_WIDTH * sizeof *rows);
    for (int m = 0; m < 64; m++)
        for (int f = 0; f < 6; f++) {
            double *row = rows + m * LOAD_WIDTH, sign = f & 1 ? 1 : -1, area = edge * edge;
            int a = f / 2;
            if (!(m >> f & 1)) continue;
            /* of forces: along normals at the start */
            row[LOAD_NORMAL + f] = p->is_pressure ? p->S[a][a] : p->T[a][a];
            /* along normals now, or no patch is exact */
            row[LOAD_TRACTION] += p->S[a][a];
            if (p->is_pressure) row[LOAD_BODY + a] += sign * area * p->S[a][a];
            for (int c = 0; c < 3 && !p->is_pressure; c++) {
                row[LOAD_FORCE + c] += sign * area * p->T[c][a];
                row[LOAD_LEVER + 3 * a + c] += 0.5 * edge * area * p->T[c][a];
            }
        }
}

/* Largest error over cells and components, over `size`. */
static double worst_of(struct lattice *l, const struct patch *p, bool extrapolate, double size)
{
    size_t n = (size_t)l->n_global;
    double(*stress)[9] = fail_alloc(n * sizeof *stress), *mises = fail_alloc(n * sizeof *mises),
    W[3][3], worst = 0, square = 0;
    struct lattice_stress *s = lattice_stress_create(l, extrapolate);
    lattice_stress_run(s, stress, mises);
    lattice_stress_free(s);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            int c = (a + 1) % 3;
            W[a][b] = 0;
            for (int d = 0; d < 3; d++) W[a][b] += p->T[a][d] * p->R[b][d]; /* R S R^T */
            if (b == c)
                square += 0.5 * pow(p->S[a][a] - p->S[c][c], 2) + 3 * p->S[a][c] * p->S[a][c];
        }
    for (size_t i = 0; i < n; i++) {
        worst = fmax(worst, fabs(mises[i] - sqrt(square)));
        for (int c = 0; c < 9; c++) worst = fmax(worst, fabs(stress[i][c] - W[c / 3][c % 3]));
    }
    free(stress);
    free(mises);
    return worst / size;
}

/* u and attitude of the strained, turned body; returns the largest component of u. */
static double place(const struct lattice_cells *cells, const struct patch *p,
    const struct link_material *m, const double q[4], struct lattice_motion *s)
{
    double G = link_constants_shear(*m), lambda = link_constants_lambda(LINK_ISOTROPIC, *m),
           trace = p->S[0][0] + p->S[1][1] + p->S[2][2], largest = 0;
    for (int64_t i = 0; i < cells->n; i++) {
        double x[3], y[3] = {0, 0, 0};
        for (int a = 0; a < 3; a++) x[a] = edge * cells->at[i][a];
        for (int a = 0; a < 3; a++)
            for (int b = 0; b < 3; b++)
                y[a] += (p->S[a][b] - (a == b ? lambda / (3 * lambda + 2 * G) * trace : 0)) /
                        (2 * G) * x[b];
        for (int a = 0; a < 3; a++) { /* (R - 1) x + R y */
            for (int b = 0; b < 3; b++)
                s->u[i][a] += (p->R[a][b] - (a == b)) * x[b] + p->R[a][b] * y[b];
            largest = fmax(largest, fabs(s->u[i][a]));
        }
        for (int a = 0; a < 4; a++) s->q[i][a] = q[a];
    }
    return largest;
}

static void patch(bodies_solid *solid, const int size[3], double nu, bool turn, struct patch p)
{
    const struct link_material steel = {7900, 2.1e11, nu, 0};
    struct lattice_cells *cells = bodies_create(1, size, edge, 1, solid);
    struct lattice_options o = {.dt = 1e-7,
        .turn = turn,
        .material = &steel,
        .n_material = 1,
        .n_row = 64,
        .rows_at = rows_at,
        .context = &p};
    struct quat q = quat_turn(
        quat_turn(quat_of(0.5, 0.5, -0.5, 0.5), p3(0.1, -0.05, 0.12)), p3(0.15, 0.02, -0.1));
    struct lattice_motion s = {.u = fail_alloc((size_t)cells->n * sizeof *s.u),
        .q = fail_alloc((size_t)cells->n * sizeof *s.q)};
    double largest = 0, start[2], end[2];
    if (!turn) q = quat_of(1, 0, 0, 0);
    for (int a = 0; a < 3; a++) {
        pvec3 column = quat_rotate(q, p3(a == 0, a == 1, a == 2));
        p.R[0][a] = column.x;
        p.R[1][a] = column.y;
        p.R[2][a] = column.z;
    }
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            largest = fmax(largest, fabs(p.S[a][b]));
            p.T[a][b] = p.R[a][0] * p.S[0][b] + p.R[a][1] * p.S[1][b] + p.R[a][2] * p.S[2][b];
        }
    for (int64_t i = 0; i < cells->n; i++) cells->row[i] = 63 & ~cells->bits[i];
    double shift = place(cells, &p, &steel, (const double[4]){q.w, q.v.x, q.v.y, q.v.z}, &s);
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    lattice_write(l, &s);
    for (int form = 0; form < 2; form++) start[form] = worst_of(l, &p, form, largest);
    lattice_begin_step(l);
    for (int step = 1; step <= 4; step++) lattice_advance(l, step == 4);
    for (int form = 0; form < 2; form++) end[form] = worst_of(l, &p, form, largest);
    printf(
        "%dx%dx%d, nu %.1f, %s%s: errors/S at the start %.2g (average) %.2g (extrapolated), after "
        "4 steps %.2g %.2g; u %.2g m\n",
        size[0], size[1], size[2], nu, turn ? "turned" : "small", p.is_pressure ? ", pressure" : "",
        start[0], start[1], end[0], end[1], shift);
    /* some 30 roundings of the largest u (turned: of the size of the body), as strains over h,
     * times E/(1 - 2 nu) */
    double ulp = 30 * 1.2e-16 * shift / edge * steel.young / (1 - 2 * nu) / largest;
    for (int form = 0; form < 2; form++) {
        assert_below(start[form], ulp);
        /* by any rotation tractions do not keep the balance beyond first order: they lack the
         * torque f_e g/2 that a link's gap has */
        assert_below(end[form], 2 * ulp + (turn ? largest / steel.young : 0));
    }
    lattice_free(l);
    free(s.u);
    free(s.q);
    bodies_free(cells);
}

static bool some; /* one shape, with a Poisson's ratio */

static void all_of(struct patch p)
{
    const int rough[3] = {7, 5, 4}, plate[3] = {6, 4, 1}, row[3] = {5, 1, 1};
    for (int turn = 0; turn < 2; turn++)
        for (int k = some; k < 2; k++) {
            patch(bodies_voxels, rough, k ? 0.3 : 0, turn, p);
            if (some) continue;
            patch(bodies_block, plate, k ? 0.3 : 0, turn, p);
            patch(bodies_block, row, k ? 0.3 : 0, turn, p);
        }
}

static void uniaxial(void **state)
{
    (void)state;
    all_of((struct patch){.S = {{1e8, 0, 0}, {0, 0, 0}, {0, 0, 0}}});
}
static void any_stress(void **state)
{
    (void)state;
    all_of((struct patch){.S = {{1e8, 3e7, -5e7}, {3e7, -4e7, 6e7}, {-5e7, 6e7, 2e7}}});
}
static void pressure(void **state)
{
    (void)state;
    all_of((struct patch){.S = {{-1e8, 0, 0}, {0, -1e8, 0}, {0, 0, -1e8}}, .is_pressure = true});
}

/* Argument: some or all. */
int main(int argc, char **argv)
{
    some = argc > 1 && strcmp(argv[1], "some") == 0;
    const struct CMUnitTest first[] = {cmocka_unit_test(any_stress), cmocka_unit_test(pressure)};
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(uniaxial), cmocka_unit_test(any_stress), cmocka_unit_test(pressure)};
    return some ? DEVICE_TESTS(first) : DEVICE_TESTS(tests);
}
