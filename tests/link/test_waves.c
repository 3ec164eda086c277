/* Frequencies of the lattice in closed form: chains, Bloch waves along [100], [110], [111], and the
 * largest one. A mode is put in, and the forces must be -m w^2 u, -J w^2 theta. nu = 0.3 where the
 * volumetric term is compiled in, else 0. */
#include "body.h"

static struct body body;
static const double nu = WITH_VOLUME ? 0.3 : 0;
static double m, J, kn, ks, kt, kb, lambda;

static void build(int nx, int ny, int nz, int periodic)
{
    const int size[3] = {nx, ny, nz};
    body_build(&body, size, NULL, periodic, 0.25);
    body.materials[0] = (struct link_material){3, 2, nu, 0};
    struct link_stiffness k =
        link_constants_between(LINK_ISOTROPIC, body.materials[0], body.materials[0], body.h);
    kn = k.kn, ks = k.ks, kt = k.kt, kb = k.kb;
    m = link_constants_mass(body.materials[0], body.h);
    J = link_constants_inertia(body.materials[0], body.h);
    lambda = link_constants_lambda(LINK_ISOTROPIC, body.materials[0]);
}

static double part(vec3 a, int c)
{
    return c == 0 ? a.x : c == 1 ? a.y : a.z;
}

/* Rows of cells along each axis, modes along it; nu = 0 in both (free sides, no lateral motion). */
static void chains(void **state)
{
    const int n = 11;
    (void)state;
    if (WITH_VOLUME) skip();
    for (int axis = 0; axis < 3; axis++)
        for (int k = 1; k < n; k++)
            for (int clamped = 0; clamped < 2; clamped++) {
                build(axis == 0 ? n : 1, axis == 1 ? n : 1, axis == 2 ? n : 1, 0);
                /* clamped: cell 0 is fixed, n - 1 are free */
                double phase = clamped ? (2 * k - 1) * M_PI / (2.0 * (2 * (n - 1) + 1))
                                       : k * M_PI / (2.0 * n),
                       w = 2 * sqrt(kn / m) * sin(phase);
                for (int i = 0; i < n; i++)
                    body.u[i] = p3_uncycle(
                        p3(clamped ? sin(2 * phase * i) : cos(2 * phase * (i + 0.5)), 0, 0), axis);
                body_forces(&body);
                for (int i = clamped; i < n; i++) /* cosines of 20 or so */
                    assert_near(part(body.force[i], axis),
                        -m * w * w * part(v3_of_p3(body.u[i]), axis), 1e-13 * kn);
            }
}

/* Longitudinal, q equal along k axes: m w^2 = 4 (kn + (k-1) ks) s^2 + 4 k lambda h s^2 (1 - s^2), s
 * = sin(q h/2). */
static void longitudinal(void **state)
{
    const int N = 6;
    (void)state;
    for (int k = 1; k <= 3; k++)
        for (int wave = 1; wave <= N / 2; wave++) {
            build(N, k > 1 ? N : 1, k > 2 ? N : 1, 7);
            double s = sin(M_PI * wave / N),
                   rigidity = 4 * (kn + (k - 1) * ks) * s * s +
                              4 * k * lambda * body.h * s * s * (1 - s * s);
            for (int i = 0; i < body.n; i++) {
                int sum = body.at[i][0] + (k > 1 ? body.at[i][1] : 0) + (k > 2 ? body.at[i][2] : 0);
                double u = cos(2 * M_PI * wave / N * sum);
                body.u[i] = p3(u, k > 1 ? u : 0, k > 2 ? u : 0);
            }
            body_forces(&body);
            for (int i = 0; i < body.n; i++)
                for (int c = 0; c < 3; c++) {
                    assert_near(part(body.force[i], c),
                        c < k ? -rigidity * part(v3_of_p3(body.u[i]), c) : 0, 2e-14 * kn);
                    assert_near(part(body.torque[i], c), 0, 2e-14 * kn);
                }
        }
}

/* Twist along [100]: J w^2 = 2 ks h^2 + 4 kt s^2. At (pi, 0, 0) the largest frequency of one
 * material, 28 G/(rho h^2). */
static void twist(void **state)
{
    const int N = 8;
    double h, largest = 0;
    (void)state;
    for (int wave = 0; wave <= N / 2; wave++) {
        build(N, 1, 1, 7);
        h = body.h;
        double s = sin(M_PI * wave / N), rigidity = 2 * ks * h * h + 4 * kt * s * s;
        for (int i = 0; i < N; i++) body.theta[i] = p3(cos(2 * M_PI * wave / N * i), 0, 0);
        body_forces(&body);
        for (int i = 0; i < N; i++) {
            assert_near(body.torque[i].x, -rigidity * body.theta[i].x, 1e-14 * kn);
            assert_near(body_size(body.force[i]), 0, 1e-14 * kn);
        }
        largest = sqrt(rigidity / J);
    }
    assert_near(largest / lattice_limit_uniform(LINK_ISOTROPIC, body.materials[0], h), 1, 1e-14);
    assert_near(largest * largest, 28 * link_constants_shear(body.materials[0]) / (3 * h * h),
        1e-12 * largest * largest);
}

/* Transverse along [100]: u_y = U cos, theta_z = T sin. The two frequencies solve L^2/6 - L (2 -
 * s^2/3 + 4 B s^2) + 4 s^2 (1 + 4 B s^2) = 0, L = m w^2/ks, B = kb/(ks h^2). */
static void transverse(void **state)
{
    const int N = 8;
    (void)state;
    for (int wave = 1; wave < N / 2; wave++) {
        double s = sin(M_PI * wave / N), q = 2 * M_PI * wave / N, k[2][2];
        for (int column = 0; column < 2; column++) {
            build(N, 1, 1, 7);
            for (int i = 0; i < N; i++) {
                if (column == 0) body.u[i] = p3(0, cos(q * i), 0);
                else body.theta[i] = p3(0, 0, sin(q * i));
            }
            body_forces(&body);
            k[0][column] = -(double)body.force[0].y; /* cos = 1 */
            k[1][column] = -(double)body.torque[1].z / sin(q);
            for (int i = 0; i < N; i++) { /* the form stays */
                assert_near(body.force[i].y, -k[0][column] * cos(q * i), 1e-13 * kn);
                assert_near(body.torque[i].z, -k[1][column] * sin(q * i), 1e-13 * kn);
            }
        }
        /* det(K - w^2 diag(m, J)) at the roots of the closed form */
        double B = kb / (ks * body.h * body.h), b = 2 - s * s / 3 + 4 * B * s * s,
               c = 4 * s * s * (1 + 4 * B * s * s);
        for (int sign = -1; sign <= 1; sign += 2) {
            double L = 3 * (b + sign * sqrt(b * b - 2.0 / 3 * c)), w2 = L * ks / m;
            double det = (k[0][0] - w2 * m) * (k[1][1] - w2 * J) - k[0][1] * k[1][0];
            assert_near(det / (ks * ks * body.h * body.h), 0, 1e-13 * (1 + L * L));
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(chains), cmocka_unit_test(longitudinal),
        cmocka_unit_test(twist), cmocka_unit_test(transverse)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
