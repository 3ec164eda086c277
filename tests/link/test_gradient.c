/* Forces and torques are the gradient of the energy: central differences of fourth order, a body of
 * several materials, with rotations. */
#include "body.h"

static struct body body;

static int with_hole(int x, int y, int z)
{
    return !(x == 1 && y == 1) && !(x == 2 && z == 0);
}

static void move(struct body *b, int i, int c, double by)
{
    pvec3 e = p3_scale((preal)by, p3_uncycle(p3(1, 0, 0), c % 3));
    if (c < 3) {
        b->u[i] = p3_add(b->u[i], e);
    } else {
        b->theta[i] = p3_add(b->theta[i], e);
        b->q[i] = quat_turn(b->q[i], e);
    }
}

static double energy_at(int i, int c, double by)
{
    struct body keep = body;
    move(&body, i, c, by);
    double energy = body_energy(&body);
    body = keep;
    return energy;
}

static void gradient(void **state)
{
    (void)state;
    const int size[3] = {3, 2, 2};
    const double step = 2e-3;
    double worst = 0, largest = 0;
    body_build(&body, size, with_hole, 0, 1);
    body.materials[0].poisson = WITH_VOLUME ? 0.3 : 0;
    body.materials[1] = (struct link_material){
        .density = 2, .young = 0.3, .poisson = WITH_SHEAR_APART ? -0.2 : body.materials[0].poisson};
    for (int i = 0; i < body.n; i++) body.material[i] = (uint8_t)(i % 2);
    body.walls[0] = 1;
    body_shake(&body, 0.05, 0.1);
    if (WITH_TURN) {
        body_turn(&body, quat_of(0.5, 0.1, -0.7, 0.5));
        body.walls[0] = 0; /* it did not turn */
    }
    body_forces(&body);
    for (int i = 0; i < body.n; i++)
        for (int c = 0; c < 6; c++) {
            double far = energy_at(i, c, 2 * step) - energy_at(i, c, -2 * step),
                   near = energy_at(i, c, step) - energy_at(i, c, -step);
            double expected = -(8 * near - far) / (12 * step);
            vec3 f = c < 3 ? body.force[i] : body.torque[i];
            double value = c % 3 == 0 ? f.x : c % 3 == 1 ? f.y : f.z;
            worst = fmax(worst, fabs(value - expected));
            largest = fmax(largest, fabs(value));
        }
    printf("worst difference over largest force: %.2g\n", worst / largest);
    assert_true(worst < 1e-10 * largest);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(gradient)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
