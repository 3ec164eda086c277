/* Bending by small rotations: exact for nu = 0, second order otherwise, and what the reference's
 * constants make of it. */
#include "body.h"

static struct body body;

static double offset(int index, int n)
{
    return body.h * (index - 0.5 * (n - 1));
}

/* Pure bending of a bar of n x n cells about z: u = (-kappa x y, kappa x^2/2, 0), theta_z = kappa
 * x. Every cell between the ends must be at rest, and the ends carry f_i = E h^2 kappa y_i and kb
 * kappa h. Returns the moment over E I kappa. */
static double pure_bending(int axis, int n, enum link_set set)
{
    const int length = 6;
    const double kappa = 0.01, E = 2, h = 0.5;
    int size[3];
    double moment = 0, I = pow(n * h, 4) / 12;
    for (int a = 0; a < 3; a++) size[a] = a == axis ? length : n;
    body_build(&body, size, NULL, 0, h);
    body.set = set;
    body.materials[0].young = E;
    int b = (axis + 1) % 3;
    double kb = link_constants_between(set, body.materials[0], body.materials[0], h).kb;
    for (int i = 0; i < body.n; i++) {
        double x = h * body.at[i][axis], y = offset(body.at[i][b], n);
        body.u[i] = p3_uncycle(p3(-kappa * x * y, 0.5 * kappa * x * x, 0), axis);
        body.theta[i] = p3_uncycle(p3(0, 0, kappa * x), axis);
    }
    body_forces(&body);
    for (int i = 0; i < body.n; i++) {
        vec3 f = v3_cycle(body.force[i], axis), t = v3_cycle(body.torque[i], axis);
        double y = offset(body.at[i][b], n), end = body.at[i][axis] == 0            ? 1
                                                   : body.at[i][axis] == length - 1 ? -1
                                                                                    : 0;
        assert_near(f.x, -end * E * h * h * kappa * y, 1e-14);
        assert_near(f.y, 0, 1e-14);
        assert_near(t.z, end * kb * kappa * h, 1e-14);
        if (end > 0) moment += (double)t.z - y * (double)f.x;
    }
    return moment / (E * I * kappa);
}

static void pure(void **state)
{
    (void)state;
    for (int axis = 0; axis < 3; axis++)
        for (int n = 1; n <= 4; n++) {
            assert_near(pure_bending(axis, n, LINK_ISOTROPIC), 1, 1e-12);
            assert_near(pure_bending(axis, n, LINK_REFERENCE), 1 + 11.0 / (n * n), 1e-11);
        }
}

/* A row of N free cells beyond a fixed one, load P on the centre of the last: P L^3/(3 E I) (1 -
 * 1/(4 N^2)) + P L/(ks h). */
static void cantilever(void **state)
{
    static double f[BODY_MOST][6];
    static int free_dof[BODY_MOST][6];
    const double E = 2, h = 0.5, P = 0.01;
    (void)state;
    for (int N = 1; N <= 12; N++) {
        const int size[3] = {N + 1, 1, 1};
        body_build(&body, size, NULL, 0, h);
        body.materials[0].young = E;
        for (int i = 0; i <= N; i++)
            for (int c = 0; c < 6; c++) {
                f[i][c] = i == N && c == 1 ? P : 0;
                free_dof[i][c] = i > 0;
            }
        double residual = body_solve(&body, f, free_dof, 1000), L = N * h, I = pow(h, 4) / 12,
               ks = E * h;
        double expected = P * L * L * L / (3 * E * I) * (1 - 1 / (4.0 * N * N)) + P * L / (ks * h);
        assert_below(residual, 1e-13);
        assert_near(body.u[N].y / expected, 1, 1e-11);
        assert_near(body.u[N].x, 0, 1e-14);
    }
}

/* EI/EI_true of a long bar with nu != 0, from the curvature in its middle; the values are of an
 * independent solution of the same lattice. */
static void poisson(void **state)
{
    static double f[BODY_MOST][6];
    static int free_dof[BODY_MOST][6];
    static const double nu[] = {0.3, 0.45, -0.3},
                        expected[3][3] = {{1.0000, 1.0392, 1.0226}, {1.0000, 1.0907, 1.0495},
                            {1.0000, 1.0476, 1.0313}};
    (void)state;
    if (!WITH_VOLUME) skip();
    for (int k = 0; k < 3; k++)
        for (int n = 1; n <= 3; n++) {
            const int length = 16 * n, size[3] = {length, n, n};
            const double kappa = 0.01;
            double turn[2] = {0, 0}, I = pow(n, 4) / 12, moment = 0;
            body_build(&body, size, NULL, 0, 1);
            body.materials[0].poisson = nu[k];
            for (int i = 0; i < body.n; i++) {
                int end = body.at[i][0] == 0 ? 1 : body.at[i][0] == length - 1 ? -1 : 0;
                double y = offset(body.at[i][1], n), kb = 1.0 / 12;
                for (int c = 0; c < 6; c++) {
                    /* the forces come from the tractions, which know Th */
                    f[i][c] = c == 5 ? -end * kb * kappa : 0;
                    free_dof[i][c] = 1;
                }
                if (end) body.traction[i][end < 0] = v3(end * kappa * y, 0, 0);
                if (end > 0) moment += kb * kappa + kappa * y * y;
            }
            double residual = body_solve(&body, f, free_dof, 3000);
            for (int i = 0; i < body.n; i++)
                for (int side = 0; side < 2; side++)
                    if (body.at[i][0] == length / 2 - 1 + side)
                        turn[side] += body.theta[i].z / (n * n);
            double ratio = moment / (I * (turn[1] - turn[0]));
            printf("nu %.2f, n %d: EI/EI_true %.5f, table %.4f, residual %.1g\n", nu[k], n,
                fabs(ratio), expected[k][n - 1], residual);
            assert_below(residual, 1e-12);
            assert_near(fabs(ratio), expected[k][n - 1], 0.6e-4);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(pure), cmocka_unit_test(cantilever), cmocka_unit_test(poisson)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
