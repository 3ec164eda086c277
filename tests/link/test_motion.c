/* What rigid motion and a superposed rotation do, and the two momenta. */
#include "body.h"

static struct body body, other;
static const struct quat Q = {.w = 0.1, .v = {0.7, -0.5, 0.5}}; /* 169 degrees */

static int with_hole(int x, int y, int z)
{
    return !(x == 1 && y == 1) && !(x == 2 && z == 0);
}

/* Materials that need every flag that is on. */
static void build(double shift, double turn)
{
    const int size[3] = {4, 3, 2};
    body_build(&body, size, with_hole, 0, 0.5);
    body.materials[0] = (struct link_material){1, 2, WITH_VOLUME ? 0.3 : 0, 0.1};
    body.materials[1] =
        (struct link_material){2, 0.7, WITH_SHEAR_APART ? -0.2 : body.materials[0].poisson, 0.2};
    for (int i = 0; i < body.n; i++) body.material[i] = (uint8_t)(i % 3 == 0);
    body_shake(&body, shift, turn);
}

static double worst_force(const struct body *b)
{
    double worst = 0;
    for (int i = 0; i < b->n; i++)
        worst = fmax(worst, fmax(body_size(b->force[i]), body_size(b->torque[i])));
    return worst;
}

static void rigid(void **state)
{
    (void)state;
    build(0, 0);
    if (WITH_TURN) {
        body_turn(&body, Q);
    } else { /* linear: theta = W everywhere, u = W x X */
        pvec3 W = p3((preal)0.1, (preal)-0.2, (preal)0.3);
        for (int i = 0; i < body.n; i++) {
            body.theta[i] = W;
            body.u[i] = p3_cross(W, body_place(&body, i));
        }
    }
    for (int i = 0; i < body.n; i++)
        body.u[i] = p3_add(body.u[i], p3((preal)0.5, (preal)2, (preal)-1));
    body_forces(&body);
    printf("largest force of a rigid motion over E h^2: %.2g\n", worst_force(&body) / (2 * 0.25));
    /* gaps of 1e-16 (size of u) times E h; 12 or so of them */
    assert_below(worst_force(&body), 400 * BODY_EPS * 2 * 0.25);
    for (int i = 0; i < body.n; i++)
        for (int form = 0; form < 2; form++)
            assert_below(body_size(body.rows[form][i].x), 800 * BODY_EPS * 2);
}

static vec3 turned(vec3 a)
{
    return v3_of_p3(quat_rotate(Q, p3_of_v3(a)));
}

static double apart(vec3 a, vec3 b)
{
    return body_size(v3_sub(a, b));
}

static struct stress_rows world_stress(const struct body *b, int i)
{
    struct stress s = stress_parts(stress_in_cell(b->rows[0][i], b->q[i]), b->faces[i]);
    return stress_in_world(stress_symmetric(s), b->q[i]);
}

static void superposed(void **state)
{
    const double S[3][3] = {{0.1, 0.05, 0}, {0.05, -0.2, 0.1}, {0, 0.1, 0.1}};
    double scale, before, after;
    (void)state;
    if (!WITH_TURN) skip();
    build(0.05, 0.1);
    body_load(&body, S);
    body_forces(&body);
    other = body;
    body_turn(&other, Q);
    body_forces(&other);
    scale = 200 * BODY_EPS * 2 * 0.25;
    for (int i = 0; i < body.n; i++) {
        /* Q a Q^T: rows, then columns */
        struct stress_rows a = world_stress(&body, i), b = world_stress(&other, i), c;
        vec3 x = turned(a.x), y = turned(a.y), z = turned(a.z);
        c.x = turned(v3(x.x, y.x, z.x));
        c.y = turned(v3(x.y, y.y, z.y));
        c.z = turned(v3(x.z, y.z, z.z));
        assert_below(apart(turned(body.force[i]), other.force[i]), scale);
        assert_below(apart(turned(body.torque[i]), other.torque[i]), scale);
        assert_near(other.strain[i], body.strain[i], scale);
        assert_below(apart(v3(c.x.x, c.y.x, c.z.x), b.x), 8 * scale);
        assert_below(apart(v3(c.x.y, c.y.y, c.z.y), b.y), 8 * scale);
        assert_below(apart(v3(c.x.z, c.y.z, c.z.z), b.z), 8 * scale);
        assert_true(body_size(a.x) > 1e-3);
    }
    before = body_energy(&body);
    after = body_energy(&other);
    assert_near(after, before, 100 * BODY_EPS * before);
    assert_true(before > 1e-3);
}

static void momenta(void **state)
{
    double P[3] = {0, 0, 0}, L[3] = {0, 0, 0};
    (void)state;
    build(0.05, 0.1);
    if (WITH_TURN) body_turn(&body, Q);
    body_forces(&body);
    for (int i = 0; i < body.n; i++) {
        vec3 f = body.force[i], x = v3_of_p3(WITH_TURN ? body_now(&body, i) : body_place(&body, i));
        vec3 l = v3_add(body.torque[i], v3_cross(x, f));
        P[0] += (double)f.x;
        P[1] += (double)f.y;
        P[2] += (double)f.z;
        L[0] += (double)l.x;
        L[1] += (double)l.y;
        L[2] += (double)l.z;
    }
    printf("sum of forces %.2g, of moments %.2g, largest force %.2g\n",
        fabs(P[0]) + fabs(P[1]) + fabs(P[2]), fabs(L[0]) + fabs(L[1]) + fabs(L[2]),
        worst_force(&body));
    for (int c = 0; c < 3; c++) {
        assert_below(fabs(P[c]), 20 * BODY_EPS * worst_force(&body));
        assert_below(fabs(L[c]), 60 * BODY_EPS * worst_force(&body));
    }
}

/* Dashpots never give power, nothing to a strained body that moves rigidly, and what they take is
 * what they say. */
static void damping(void **state)
{
    double power = 0, taken, scale = 0;
    (void)state;
    if (!WITH_LINK_DAMPING) skip();
    for (int trial = 0; trial < 20; trial++) {
        power = 0;
        build(0.05, 0.1);
        if (WITH_TURN) body_turn(&body, Q);
        other = body;
        other.materials[0].damping = other.materials[1].damping = 0;
        body_forces(&body);
        body_forces(&other);
        for (int i = 0; i < body.n; i++)
            power += (double)(v3_dot(v3_sub(body.force[i], other.force[i]), body.v[i]) +
                              v3_dot(v3_sub(body.torque[i], other.torque[i]), body.w[i]));
        taken = body_dissipation(&body);
        assert_true(taken > 0);
        assert_near(power, -taken, 400 * BODY_EPS * taken);
    }
    build(0.05, 0.1);
    for (int i = 0; i < body.n; i++) {
        body.w[i] = v3((real)0.3, (real)-0.2, (real)0.5);
        body.v[i] = v3_add(v3(1, 2, 3),
            v3_cross(body.w[i], v3_of_p3(WITH_TURN ? body_now(&body, i) : body_place(&body, i))));
    }
    other = body;
    other.materials[0].damping = other.materials[1].damping = 0;
    body_forces(&body);
    body_forces(&other);
    for (int i = 0; i < body.n; i++) scale = fmax(scale, body_size(other.force[i]));
    for (int i = 0; i < body.n; i++) {
        assert_below(apart(body.force[i], other.force[i]), 100 * BODY_EPS * scale);
        assert_below(apart(body.torque[i], other.torque[i]), 100 * BODY_EPS * scale);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(rigid), cmocka_unit_test(superposed),
        cmocka_unit_test(momenta), cmocka_unit_test(damping)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
