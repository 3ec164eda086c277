#include "contact_table.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "kernels/contact/law_normal.h"

static const struct contact *find(const struct scene *scene, int a, int b)
{
    for (int i = 0; i < scene->n_contact; i++) {
        const int *m = scene->contact[i].between;
        if ((m[0] == a && m[1] == b) || (m[0] == b && m[1] == a)) return &scene->contact[i];
    }
    return NULL;
}

/* G = E/(2 (1 + nu)) */
static double shear(const struct material *m)
{
    return m->young / (2 * (1 + m->poisson));
}

/* The dashpot of friction and its choices; p has that of the default definition. */
static void set_tangential(struct contact_material *p, const struct contact *c)
{
    double centre = c->normal_law == NORMAL_HERTZ ? sqrt(3.5 * 5 / 6) : sqrt(3.5);
    if (!c->has_tangential) return;
    if (c->damping_mass == DAMPING_MASS_CENTRE) p->gamma_t *= centre;
    if (c->damping_factor >= 0) p->gamma_t = c->damping_factor * p->gamma_n;
    p->mu = c->friction;
    if (c->slip == SLIP_WHOLE) p->law |= CONTACT_WHOLE_SLIP;
    if (c->slip == SLIP_UNDAMPED) p->law |= CONTACT_UNDAMPED_SLIP;
    if (c->lever == LEVER_RADIUS) p->law |= CONTACT_RADIUS_LEVER;
    if (!c->rescale) p->law |= CONTACT_NO_RESCALE;
    if (c->cap == CAP_MAGNITUDE) p->law |= CONTACT_CAP_MAGNITUDE;
}

static struct contact_material material_of(const struct scene *scene, const struct contact *c)
{
    double z_t = c->has_tangential ? c->tangential_damping : 0;
    struct contact_material p;
    if (c->normal_law == NORMAL_LINEAR) {
        p = contact_material_linear(
            c->stiffness, c->damping_ratio, c->has_tangential ? c->stiffness_ratio : 0, z_t);
    } else {
        const struct material *a = &scene->material[c->between[0]],
                              *b = &scene->material[c->between[1]];
        double e = 1 / ((1 - a->poisson * a->poisson) / a->young +
                           (1 - b->poisson * b->poisson) / b->young);
        double g = 1 / ((2 - a->poisson) / shear(a) + (2 - b->poisson) / shear(b));
        p = contact_material_hertz(
            e, g, c->damping_ratio, c->has_tangential ? c->stiffness_ratio : 0, z_t);
        p.jkr = pow(2 * M_PI * c->adhesion_work / e, 2.0 / 3);
    }
    set_tangential(&p, c);
    p.f_b = c->binding_force;
    if (c->rolling != ROLLING_NONE)
        p = contact_material_rolling(p, c->rolling_friction,
            c->rolling == ROLLING_EPSD ? c->rolling_stiffness : 0, c->rolling_damping);
    if (!c->attraction) p.law |= CONTACT_NO_ATTRACTION;
    return p;
}

#define VALUE(type, name) p.name,

void contact_table_material(const struct scene *scene, int a, int b, double *row)
{
    const struct contact *c = find(scene, a, b);
    memset(row, 0, MATERIAL_WIDTH * sizeof *row);
    if (!c) return;
    struct contact_material p = material_of(scene, c);
    const double value[MATERIAL_WIDTH] = {CONTACT_MATERIAL(VALUE)};
    memcpy(row, value, sizeof value);
}

void contact_table_parameters(const struct scene *scene, int a, int b, bool wall, double radius,
    double mass, double dt, double *row)
{
    const struct contact *c = find(scene, a, b);
    memset(row, 0, PARAMETER_WIDTH * sizeof *row);
    if (!c) return;
    struct contact_pair s = wall ? contact_pair_wall(1 / mass, radius)
                                 : contact_pair_of(1 / mass, 1 / mass, radius, radius);
    struct contact_parameters p = contact_parameters_of(material_of(scene, c), s, dt);
    const double value[PARAMETER_WIDTH] = {CONTACT_PARAMETERS(VALUE)};
    memcpy(row, value, sizeof value);
}

/* By bisection: the law says whether it acts at a gap, and does so at every smaller one. */
double contact_table_reach(const double *row, double r_star)
{
    struct contact_material c = material_load(row);
    double near = 0, far = r_star;
    if (!normal_acts(c, r_star, -DBL_MIN)) return 0;
    while (normal_acts(c, r_star, -far)) far *= 2;
    for (int k = 0; k < 200; k++) {
        double middle = 0.5 * (near + far);
        if (normal_acts(c, r_star, -middle)) near = middle;
        else far = middle;
    }
    return far;
}

/* The largest pull on the way out, by golden section: it has one maximum. The mass of the pair has
 * no part in springs. */
double contact_table_pull(const double *row, double r_star)
{
    const double golden = 0.5 * (sqrt(5) - 1);
    struct contact_pair pair = {1, r_star, 1};
    struct contact_parameters p = contact_parameters_of(material_load(row), pair, 1);
    double from = contact_table_reach(row, r_star), to = 0;
    for (int k = 0; k < 100; k++) {
        double a = from + golden * (to - from), b = to + golden * (from - to);
        if (normal_spring_of(-a, p).force < normal_spring_of(-b, p).force) from = b;
        else to = a;
    }
    return fmax(0, -normal_spring_of(-from, p).force);
}

static void set_real(struct launch *launch, const char *name, double value)
{
    launch_set_real(launch, name, value);
}

static void set_int(struct launch *launch, const char *name, double value)
{
    launch_set_int(launch, name, (int)value);
}

#define SET(type, name) set_##type(launch, #name, row[PARAMETER_##name]);

void contact_table_set(struct launch *launch, const double *row)
{
    CONTACT_PARAMETERS(SET)
}
