#include <math.h>
#include <string.h>

#include "impact.h"

static double mass_j(const struct impact *c)
{
    return c->ratio > 0 ? IMPACT_M * c->ratio * c->ratio * c->ratio : IMPACT_M;
}

static double radius_j(const struct impact *c)
{
    return c->ratio > 0 ? IMPACT_R * c->ratio : IMPACT_R;
}

static struct contact_material material(const struct impact *c)
{
    real z_n = (real)c->z_n, z_t = (real)c->z_t;
    struct contact_material m =
        c->hertz ? contact_material_hertz((real)IMPACT_E, (real)(0.2 * IMPACT_E), z_n, -1, z_t)
                 : contact_material_linear((real)IMPACT_K, z_n, (real)0.8, z_t);
    m.mu = (real)c->mu;
    m.f_b = (real)c->f_b;
    if (c->no_attraction) m.law |= CONTACT_NO_ATTRACTION;
    m.law |= c->choices;
    return c->mu_r > 0 ? contact_material_rolling(m, (real)c->mu_r, (real)c->k_r, (real)c->eta_r)
                       : m;
}

double impact_time(const struct impact *c)
{
    double m = IMPACT_M * mass_j(c) / (IMPACT_M + mass_j(c)),
           r = IMPACT_R * radius_j(c) / (IMPACT_R + radius_j(c));
    double depth = pow(5 * m * IMPACT_SPEED * IMPACT_SPEED / (16.0 / 3 * IMPACT_E * sqrt(r)), 0.4);
    return c->hertz ? 2.94328 * depth / IMPACT_SPEED : 3.14159265358979 * sqrt(m / IMPACT_K);
}

void impact_start(struct two_body *s, const struct impact *c, int n, double phase)
{
    double dt = impact_time(c) / n, gap = 0.3 * IMPACT_SPEED * impact_time(c),
           spin = IMPACT_SPEED * c->spin;
    vec3 normal = v3((real)0.6, (real)0.48, (real)0.64),
         tangent = v3((real)-0.8, (real)0.36, (real)0.48);
    vec3 v = v3_add(
        v3_scale((real)IMPACT_SPEED, normal), v3_scale((real)(c->slant * IMPACT_SPEED), tangent));
    pvec3 x_i = p3_scale((preal)(-phase * dt), p3_of_v3(v));
    pvec3 x_j = p3_scale((preal)(IMPACT_R + radius_j(c) + gap), p3_of_v3(normal));

    memset(s, 0, sizeof *s);
    s->dt = (real)dt;
    s->b[0] = two_body_sphere((real)IMPACT_M, (real)IMPACT_R, x_i, v,
        v3_scale((real)(spin / IMPACT_R), v3((real)0.3, (real)-0.5, (real)0.7)));
    s->b[1] = two_body_sphere((real)mass_j(c), (real)radius_j(c), x_j, v3(0, 0, 0),
        v3_scale((real)(spin / radius_j(c)), v3((real)-0.2, (real)0.4, (real)0.3)));
    two_body_set(s, material(c));
}

int impact_run(struct two_body *s, const struct impact *c, int n, double phase)
{
    int steps = (int)(n * (c->duration > 0 ? c->duration : 1.9));
    impact_start(s, c, n, phase);
    for (int k = 0; k < steps; k++) two_body_step(s);
    return steps;
}

void impact_velocities(const struct two_body *s, double out[12])
{
    for (int n = 0; n < 2; n++) {
        const struct body *b = &s->b[n];
        const double v[6] = {(double)b->v.x, (double)b->v.y, (double)b->v.z,
            (double)(b->w.x * b->r), (double)(b->w.y * b->r), (double)(b->w.z * b->r)};
        memcpy(out + 6 * n, v, sizeof v);
    }
}

double impact_difference(const double a[12], const double b[12])
{
    double worst = 0;
    for (int n = 0; n < 12; n++) worst = fabs(a[n] - b[n]) > worst ? fabs(a[n] - b[n]) : worst;
    return worst;
}
