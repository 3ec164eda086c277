/* What the ledger of a contact counts in the two steps in which a contact is not one all the time:
 * the touch and the end. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "kernels/contact/law_contact.h"

#define R 5e-3
#define M 1.3e-3
#define K 1e4
#define MU 0.3

static struct contact_parameters parameters(real z, real f_b, real dt)
{
    struct contact_parameters p = {0};
    p.k_n = K;
    p.gamma_n = (real)2 * z * r_sqrt(K * M);
    p.centring_n = p.gamma_n * dt / (2 * M);
    p.damp_n = 1 / (1 + p.centring_n);
    p.turning_n = K * dt * dt / (2 * M);
    p.k_t = 0.8 * K;
    p.damp_t = 1;
    p.mu = MU;
    p.f_b = f_b;
    return p;
}

/* A ball on the plane z = 0 at height z, seen after a step with v and w. */
static struct contact_kinematics above(real z, vec3 v, vec3 w, real dt)
{
    vec3 n = v3(0, 0, -1);
    return contact_kinematics_wall(n, n, (real)R - z, (real)R - (z - (real)0.5 * dt * v.z),
        kinematics_free(v, v3(0, 0, 0), w, v3(0, 0, 0)), R);
}

/* A bond breaks while its friction spring is under load: both springs are lost, also where no Hertz
 * contact is compiled in. */
static void a_broken_bond_loses_its_friction_spring(void **state)
{
    const real dt = 1e-6, speed = 0.1, f_b = 1, xi = 2e-5;
    struct contact_history h = {.xi = {xi, 0, 0}, .state = CONTACT_BONDED};
    real gap = f_b / K + (real)0.2 * speed * dt; /* broke a fifth of a step ago */
    struct contact_result r = contact_law(
        above((real)R + gap, v3(0, 0, speed), v3(0, 0, 0), dt), parameters(0, f_b, dt), dt, &h);
    (void)state;
    assert_int_equal(h.state, 0);
    double springs = (double)(f_b * f_b / (2 * K) + (real)0.4 * K * xi * xi);
    /* but for what they did in that step */
    assert_true(fabs((double)r.loss_b - springs) < 2 * (double)(f_b * speed * dt));
    /* which is less than the friction spring held */
    assert_true((double)((real)0.4 * K * xi * xi) > 5 * (double)(f_b * speed * dt));
}

/* Fast and grazing: it slides from the touch to the end. Returns (energy after + losses - energy
 * before)/losses, worst over the phase. */
static double gap_of_grazing(int n)
{
    const double duration = 3.14159265358979 * sqrt(M / K), inertia = 0.4 * M * R * R;
    const real dt = duration / n;
    double worst = 0;
    for (int phase = 0; phase < 8; phase++) {
        struct contact_parameters p = parameters(0.2, 0, dt);
        struct contact_history h = {0};
        vec3 v = v3(40, 0, -0.5), w = v3(0, 0, 0), force = v3(0, 0, 0), torque = v3(0, 0, 0);
        double lost = 0, before = 0.5 * M * v3_dot(v, v), after;
        real z = (real)R * (real)1.001 - (real)(phase + 0.5) / 8 * v.z * dt;
        for (int s = 0; s < 2 * n; s++) {
            v = v3_fma((real)0.5 * dt / M, force, v);
            w = v3_fma((real)0.5 * dt / (real)inertia, torque, w);
            z += dt * v.z;
            struct contact_kinematics k = above(z, v, w, dt);
            struct contact_result r = contact_law(k, p, dt, &h);
            force = r.force;
            torque = v3_scale(k.l_i, r.couple);
            lost += (double)(r.loss_n + r.loss_s);
            v = v3_fma((real)0.5 * dt / M, force, v);
            w = v3_fma((real)0.5 * dt / (real)inertia, torque, w);
        }
        assert_true(h.state == 0 && v.z > 0);
        after = 0.5 * M * v3_dot(v, v) + 0.5 * inertia * v3_dot(w, w);
        worst = fmax(worst, fabs(after + lost - before) / lost);
    }
    return worst;
}

/* The friction that a dashpot brings with the first step is of finite size, and its kick lasts half
 * a step, whenever in that step the touch was. */
static void sliding_is_counted_from_the_kick(void **state)
{
    double coarse = gap_of_grazing(25), fine = gap_of_grazing(100);
    (void)state;
    assert_true(coarse < 1e-3);
    assert_true(fine < coarse / 8); /* second order: 16 */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_broken_bond_loses_its_friction_spring),
        cmocka_unit_test(sliding_is_counted_from_the_kick),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
