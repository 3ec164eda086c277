/* Two materials in series, and walls: uniaxial strain through layers is exact for any two (E, nu),
 * forces, Th and stress of every cell. */
#include "body.h"

static struct body body;

/* Rows along `axis`, sides held (periodic); n cells of each material. wall: a rigid wall carries
 * the lower end (1) or the upper end (2), the other is loaded; 0: both ends are loaded. */
static void layers(int axis, int wall)
{
    const int n = 4;
    int size[3] = {1, 1, 1};
    const double sigma = 0.02, h = 0.5;
    double M[2], lambda[2], boundary = n * h;
    size[axis] = 2 * n;
    body_build(&body, size, NULL, 7 & ~(1 << axis), h);
    for (int k = 0; k < 2; k++) {
        body.materials[k] = (struct link_material){
            1, exp(uniform(-2, 2)), WITH_VOLUME ? uniform(-0.5, 0.45) : 0, 0};
        lambda[k] = link_constants_lambda(LINK_ISOTROPIC, body.materials[k]);
        M[k] = lambda[k] + 2 * link_constants_shear(body.materials[k]);
    }
    for (int i = 0; i < body.n; i++) { /* u = 0 at the interface, or at the wall */
        double x = (body.at[i][axis] + 0.5) * h - boundary, fixed = wall == 1   ? boundary / M[0]
                                                                    : wall == 2 ? -boundary / M[1]
                                                                                : 0;
        int k = x > 0;
        body.material[i] = (uint8_t)k;
        body.u[i] = p3_uncycle(p3(sigma * (x / M[k] + fixed), 0, 0), axis);
        if (body.at[i][axis] == 0) {
            if (wall == 1) body.walls[i] |= LINK_BIT(axis, 0);
            else body.traction[i][2 * axis] = v3_uncycle(v3(-sigma, 0, 0), axis);
        }
        if (body.at[i][axis] == 2 * n - 1) {
            if (wall == 2) body.walls[i] |= LINK_BIT(axis, 1);
            else body.traction[i][2 * axis + 1] = v3_uncycle(v3(sigma, 0, 0), axis);
        }
    }
    body_forces(&body);
    for (int i = 0; i < body.n; i++) {
        int k = body.material[i];
        struct stress_rows r = body.rows[0][i];
        double lateral = axis == 0   ? r.y.y
                         : axis == 1 ? r.z.z
                                     : r.x.x,
               along = axis == 0   ? r.x.x
                       : axis == 1 ? r.y.y
                                   : r.z.z;
        assert_below(body_size(body.force[i]), 1e-14 * M[k] * h * h);
        assert_below(body_size(body.torque[i]), 1e-14);
        if (WITH_VOLUME) assert_near(body.strain[i], sigma / M[k], 1e-14);
        assert_near(along, sigma, 1e-13);
        assert_near(lateral, lambda[k] * sigma / M[k], 1e-13);
    }
}

static void two_layers(void **state)
{
    (void)state;
    for (int trial = 0; trial < 100; trial++)
        for (int axis = 0; axis < 3; axis++)
            for (int wall = 0; wall < 3; wall++) layers(axis, wall);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(two_layers)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
