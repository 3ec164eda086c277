/* The strong patch test: any constant stress, a staircase body with holes, tractions on every
 * exposed face. Residual, Th and the stress of every cell are exact, by small rotations: eps = (S -
 * lambda/(3 lambda + 2 G) tr(S) 1)/(2 G), u = (eps + W) X with any spin W. */
#include "body.h"

static struct body body;

static int rough(int x, int y, int z)
{
    return (x * 7 + y * 5 + z * 3 + x * y * z) % 4 != 0;
}

/* Stress of a cell by both forms of its rows against S: the largest differences so far. */
static void compare_stress(int i, const double S[3][3], double *worst_stress, double *worst_skew)
{
    for (int form = 0; form < 2; form++) {
        struct stress s = stress_parts(body.rows[form][i], body.faces[i]);
        const double found[6] = {
            (double)s.xx, (double)s.yy, (double)s.zz, (double)s.yz, (double)s.zx, (double)s.xy};
        const double wanted[6] = {S[0][0], S[1][1], S[2][2], S[1][2], S[2][0], S[0][1]};
        for (int c = 0; c < 6; c++) *worst_stress = fmax(*worst_stress, fabs(found[c] - wanted[c]));
        *worst_skew = fmax(*worst_skew, body_size(s.skew));
    }
}

static void patch(double nu)
{
    const int size[3] = {5, 4, 4};
    const double h = 0.005, E = 210e9;
    double S[3][3], eps[3][3], W[3], trace = 0, largest = 0;
    double worst = 0, worst_strain = 0, worst_stress = 0, worst_skew = 0;
    int exposed = 0;
    body_build(&body, size, rough, 0, h);
    assert_true(body.n > 50);
    body.materials[0] = (struct link_material){7900, E, nu, 0};
    for (int a = 0; a < 3; a++)
        for (int b = 0; b <= a; b++) S[a][b] = S[b][a] = uniform(-1e8, 1e8);
    for (int a = 0; a < 3; a++) W[a] = uniform(-1e-3, 1e-3);
    double G = link_constants_shear(body.materials[0]),
           lambda = link_constants_lambda(LINK_ISOTROPIC, body.materials[0]);
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) {
            eps[a][b] =
                (S[a][b] -
                    (a == b ? lambda / (3 * lambda + 2 * G) * (S[0][0] + S[1][1] + S[2][2]) : 0)) /
                (2 * G);
            largest = fmax(largest, fabs(S[a][b]));
            if (a == b) trace += eps[a][a];
        }
    for (int i = 0; i < body.n; i++) {
        double x[3], u[3];
        for (int a = 0; a < 3; a++) x[a] = h * body.at[i][a];
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            u[a] = W[b] * x[c] - W[c] * x[b];
            for (int d = 0; d < 3; d++) u[a] += eps[a][d] * x[d];
        }
        body.u[i] = p3((preal)u[0], (preal)u[1], (preal)u[2]);
        body.theta[i] = p3((preal)W[0], (preal)W[1], (preal)W[2]);
    }
    body_load(&body, S);
    body_forces(&body);
    for (int i = 0; i < body.n; i++) {
        worst = fmax(worst, fmax(body_size(body.force[i]), body_size(body.torque[i]) / h));
        worst_strain = fmax(worst_strain, fabs(WITH_VOLUME ? (double)body.strain[i] - trace : 0));
        exposed += body.links[i] != 63;
        compare_stress(i, S, &worst_stress, &worst_skew);
    }
    assert_true(exposed > 20 && exposed < body.n + 1);
    printf("nu %5.2f: residual/(S h^2) %.2g, Th %.2g of %.2g, stress/S %.2g, skew/S %.2g\n", nu,
        worst / (largest * h * h), worst_strain, trace, worst_stress / largest,
        worst_skew / largest);
    /* strains of 1e-3 from u of 1e-5 m that are known to BODY_EPS (h 5 strain + spin): rounding of
     * some 10 ulp of E (strain + spin) h^2 */
    double ulp = 60 * BODY_EPS * (largest + E * 1e-3) / (nu < -0.8 || nu > 0.48 ? 0.01 : 1);
    assert_below(worst, ulp * h * h);
    assert_below(worst_stress, ulp);
    assert_below(worst_skew, ulp);
    assert_below(worst_strain, ulp / E);
}

static void strong(void **state)
{
    static const double nu[] = {-0.3, 0, 0.2, 0.3, 0.45, -0.9, 0.49};
    (void)state;
    for (int k = 0; k < 7; k++)
        if (WITH_VOLUME || nu[k] == 0) patch(nu[k]);
}

/* Uniaxial, in the words of a text book: lateral strain -nu sigma/E, Th = (1 - 2 nu) sigma/E. */
static void uniaxial(void **state)
{
    const int size[3] = {3, 3, 3};
    const double sigma = 0.01, nu = WITH_VOLUME ? 0.3 : 0,
                 S[3][3] = {{sigma, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    (void)state;
    body_build(&body, size, NULL, 0, 1);
    body.materials[0].poisson = nu;
    for (int i = 0; i < body.n; i++)
        body.u[i] = p3((preal)(sigma * body.at[i][0]), (preal)(-nu * sigma * body.at[i][1]),
            (preal)(-nu * sigma * body.at[i][2]));
    body_load(&body, S);
    body_forces(&body);
    for (int i = 0; i < body.n; i++) {
        struct stress s = stress_parts(body.rows[0][i], body.faces[i]);
        assert_below(body_size(body.force[i]), 20 * BODY_EPS * sigma);
        if (WITH_VOLUME) assert_near(body.strain[i], (1 - 2 * nu) * sigma, 20 * BODY_EPS * sigma);
        assert_near(s.xx, sigma, 20 * BODY_EPS * sigma);
        assert_near(s.yy, 0, 20 * BODY_EPS * sigma);
        assert_near(stress_von_mises(s), sigma, 20 * BODY_EPS * sigma);
    }
}

/* Principal stresses along the grid: the energy is that of the continuum, S:eps/2 per volume, with
 * the halves of the cells behind loaded faces. */
static void energy(void **state)
{
    const double S[3][3] = {{0.01, 0, 0}, {0, -0.02, 0}, {0, 0, 0.03}}, h = 0.5, nu = 0.3;
    const int size[3] = {5, 4, 4};
    double trace = S[0][0] + S[1][1] + S[2][2], density = 0, eps[3];
    (void)state;
    if (!WITH_VOLUME) skip();
    body_build(&body, size, rough, 0, h);
    body.materials[0].poisson = nu;
    for (int a = 0; a < 3; a++) {
        eps[a] = (1 + nu) * S[a][a] - nu * trace; /* E = 1 */
        density += 0.5 * S[a][a] * eps[a];
    }
    for (int i = 0; i < body.n; i++)
        body.u[i] = p3((preal)(eps[0] * h * body.at[i][0]), (preal)(eps[1] * h * body.at[i][1]),
            (preal)(eps[2] * h * body.at[i][2]));
    body_load(&body, S);
    assert_near(body_energy(&body) / (density * h * h * h * body.n), 1, 200 * BODY_EPS);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strong), cmocka_unit_test(uniaxial), cmocka_unit_test(energy)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
