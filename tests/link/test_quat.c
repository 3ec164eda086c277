/* Rotations: columns against Rodrigues, several turns about a skew axis, and the order of the
 * updates that RK4 and RKN4 make. */
#include "kernels/common/quat.h"
#include "tests/limit/limit_test.h"

#define EPS (sizeof(preal) == 4 ? 6e-8 : 1.2e-16)

static const double axis[3] = {2.0 / 7, -3.0 / 7, 6.0 / 7}; /* a unit vector off all planes */

static struct quat exact(double angle)
{
    double s = sin(angle / 2);
    return quat_of(
        (preal)cos(angle / 2), (preal)(s * axis[0]), (preal)(s * axis[1]), (preal)(s * axis[2]));
}

static double size(pvec3 a)
{
    return sqrt((double)p3_dot(a, a));
}

static double apart(struct quat a, struct quat b) /* the same rotation has two signs */
{
    double dw = (double)(a.w - b.w), sw = (double)(a.w + b.w), dv = size(p3_sub(a.v, b.v)),
           sv = size(p3_add(a.v, b.v));
    return fmin(sqrt(dw * dw + dv * dv), sqrt(sw * sw + sv * sv));
}

static void columns(void **state)
{
    (void)state;
    for (double angle = 1e-9; angle < 3; angle *= 7) {
        struct quat q = exact(angle);
        for (int a = 0; a < 3; a++) {
            pvec3 d = quat_column(q, a), e = p3_uncycle(p3(1, 0, 0), a), turned = quat_rotate(q, e);
            const double found[3] = {(double)d.x, (double)d.y, (double)d.z};
            /* R = 1 cos + (1 - cos) n n^T + sin n x, with 1 - cos = 2 sin^2(angle/2) */
            for (int c = 0; c < 3; c++) {
                int next = (a + 1) % 3, other = 3 - a - c;
                double half = sin(angle / 2),
                       cross = c == a ? 0 : (c == next ? 1 : -1) * axis[other];
                double wanted =
                    2 * half * half * (axis[a] * axis[c] - (a == c)) + sin(angle) * cross;
                /* relative to the angle: no digit lost against 1 */
                assert_near(found[c], wanted, 8 * EPS * angle);
            }
            assert_near(size(p3_sub(turned, p3_add(e, d))), 0, 8 * EPS);
            assert_near(size(p3_sub(quat_unrotate(q, turned), e)), 0, 8 * EPS);
        }
    }
}

static void several_turns(void **state)
{
    const int steps = 4000;
    const double turns = 5.3, per_step = 2 * M_PI * turns / steps;
    struct quat q = quat_of(1, 0, 0, 0);
    pvec3 r =
        p3((preal)(per_step * axis[0]), (preal)(per_step * axis[1]), (preal)(per_step * axis[2]));
    double norm;
    (void)state;
    for (int k = 0; k < steps; k++) {
        q = quat_turn(q, r);
        norm = (double)q.w * (double)q.w + (double)p3_dot(q.v, q.v);
        assert_near(norm, 1, 6 * EPS);
    }
    printf("after %.1f turns in %d steps: off by %.2g\n", turns, steps,
        apart(q, exact(2 * M_PI * turns)));
    assert_below(apart(q, exact(2 * M_PI * turns)), 2 * steps * EPS);
    /* one large step: the series */
    q = quat_turn(quat_of(1, 0, 0, 0),
        p3((preal)(0.2 * axis[0]), (preal)(0.2 * axis[1]), (preal)(0.2 * axis[2])));
    assert_below(apart(q, exact(0.2)), 3 * EPS);
}

/* The other sign of the second term. */
static pvec3 wrong_rate(pvec3 r, pvec3 w)
{
    return p3_add(quat_rate(r, w), p3_cross(r, w));
}

struct top {
    struct quat q;
    pvec3 w;
};

/* A body with isotropic inertia whose three axes are drawn to fixed directions: its angular
 * acceleration depends on the attitude. */
static pvec3 pull(struct quat q)
{
    pvec3 a = p3_cross(quat_rotate(q, p3(1, 0, 0)), p3((preal)-0.5, 2, 1)),
          b = p3_cross(quat_rotate(q, p3(0, 1, 0)), p3(1, (preal)0.3, 2));
    return p3_add(a, b);
}

enum update { RK4, RK4_WRONG, RKN4, RKN4_END, RKN4_BARE };

static void step_rk4(struct top *t, double dt, enum update update)
{
    static const double ahead[4] = {0.5, 0.5, 1, 0}, weight[4] = {1, 2, 2, 1};
    pvec3 (*rate)(pvec3, pvec3) = update == RK4 ? quat_rate : wrong_rate;
    pvec3 r = p3(0, 0, 0), w = t->w, sum_r = r, sum_w = r;
    for (int stage = 0; stage < 4; stage++) {
        pvec3 dr = rate(r, w), dw = pull(quat_turn(t->q, r));
        sum_r = p3_fma((preal)weight[stage], dr, sum_r);
        sum_w = p3_fma((preal)weight[stage], dw, sum_w);
        r = p3_scale((preal)(ahead[stage] * dt), dr);
        w = p3_fma((preal)(ahead[stage] * dt), dw, t->w);
    }
    t->q = quat_turn(t->q, p3_scale((preal)(dt / 6), sum_r));
    t->w = p3_fma((preal)(dt / 6), sum_w, t->w);
}

/* RKN4_END has the commutator in the last formula alone, RKN4_BARE nowhere. */
static void step_rkn4(struct top *t, double dt, enum update update)
{
    const preal d = (preal)dt, in_stages = update == RKN4, at_end = update != RKN4_BARE;
    pvec3 w = t->w, none = p3(0, 0, 0);
    pvec3 k1 = pull(t->q);
    pvec3 to_2 = quat_rkn4(
              p3_fma(d * d / 8, k1, p3_scale(d / 2, w)), w, in_stages > 0 ? k1 : none, d / 2),
          k2 = pull(quat_turn(t->q, to_2));
    pvec3 to_3 = quat_rkn4(p3_fma(d * d / 2, k2, p3_scale(d, w)), w, in_stages > 0 ? k2 : none, d),
          k3 = pull(quat_turn(t->q, to_3));
    pvec3 end = quat_rkn4(
        p3_fma(d * d / 6, p3_fma(2, k2, k1), p3_scale(d, w)), w, at_end > 0 ? k2 : none, d);
    t->q = quat_turn(t->q, end);
    t->w = p3_fma(d / 6, p3_add(p3_fma(4, k2, k1), k3), w);
}

static struct top tumble(enum update update, int steps)
{
    struct top t = {{.w = 1}, {1, (preal)-0.7, (preal)0.5}};
    for (int k = 0; k < steps; k++)
        (update <= RK4_WRONG ? step_rk4 : step_rkn4)(&t, 2.0 / steps, update);
    return t;
}

/* dq/dt = w q/2 by RK4 on the quaternion, with many steps: another route to the same. */
static struct top reference(void)
{
    static const double ahead[4] = {0.5, 0.5, 1, 0}, weight[4] = {1, 2, 2, 1};
    const int steps = 10000;
    const double dt = 2.0 / steps;
    struct top t = tumble(RK4, 0);
    for (int k = 0; k < steps; k++) {
        struct top at = t, sum = {0};
        for (int stage = 0; stage < 4; stage++) {
            struct quat half = {.v = p3_scale((preal)0.5, at.w)}, d = quat_times(half, at.q);
            pvec3 dw = pull(at.q);
            preal on = (preal)(ahead[stage] * dt), weigh = (preal)weight[stage];
            sum.q.w += weigh * d.w;
            sum.q.v = p3_fma(weigh, d.v, sum.q.v);
            sum.w = p3_fma(weigh, dw, sum.w);
            at.q.w = t.q.w + on * d.w;
            at.q.v = p3_fma(on, d.v, t.q.v);
            at.w = p3_fma(on, dw, t.w);
        }
        t.q.w += (preal)(dt / 6) * sum.q.w;
        t.q.v = p3_fma((preal)(dt / 6), sum.q.v, t.q.v);
        t.w = p3_fma((preal)(dt / 6), sum.w, t.w);
    }
    return t;
}

static double order(enum update update, const char *name)
{
    double error[2];
    struct top truth = reference();
    for (int k = 0; k < 2; k++) {
        struct top t = tumble(update, 100 << k);
        error[k] = apart(t.q, truth.q) + size(p3_sub(t.w, truth.w));
    }
    double found = log(error[0] / error[1]) / log(2);
    printf("%s: error %.2g, order %.2f\n", name, error[1], found);
    return found;
}

static void orders(void **state)
{
    (void)state;
    if (sizeof(preal) == 4) skip();
    assert_between(order(RK4, "RK4"), 3.9, 4.2);
    assert_below(order(RK4_WRONG, "RK4, other sign"), 3);
    assert_between(order(RKN4, "RKN4"), 3.9, 4.2);
    assert_between(order(RKN4_END, "RKN4, commutator at the end alone"), 2.8, 3.2);
    assert_between(order(RKN4_BARE, "RKN4 without commutator"), 1.9, 2.2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(columns), cmocka_unit_test(several_turns), cmocka_unit_test(orders)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
