#include "contact_table.h"

#include <string.h>

#define WITH_LINEAR 1
#define WITH_HERTZ 1
#define WITH_NO_ATTRACTION 1
#define WITH_TANGENTIAL 1
#define WITH_TANGENTIAL_DAMPING 1
#define WITH_ROLLING_CDT 1
#define WITH_ROLLING_EPSD 1
#define WITH_BINDING 1
#define WITH_ENERGY 1
#include "kernels/contact/law_parameters.h"

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
    }
    p.mu = c->has_tangential ? c->friction : 0;
    p.f_b = c->binding_force;
    if (c->rolling != ROLLING_NONE)
        p = contact_material_rolling(p, c->rolling_friction,
            c->rolling == ROLLING_EPSD ? c->rolling_stiffness : 0, c->rolling_damping);
    if (!c->attraction) p.law |= CONTACT_NO_ATTRACTION;
    return p;
}

void contact_table_material(const struct scene *scene, int a, int b, double *row)
{
    const struct contact *c = find(scene, a, b);
    memset(row, 0, CONTACT_TABLE_MATERIAL * sizeof *row);
    if (!c) return;
    struct contact_material p = material_of(scene, c);
    const double value[CONTACT_TABLE_MATERIAL] = {
        p.k_n, p.k_t, p.gamma_n, p.gamma_t, p.mu, p.f_b, p.mu_r, p.k_r, p.c_r, p.law};
    memcpy(row, value, sizeof value);
}

void contact_table_parameters(const struct scene *scene, int a, int b, bool wall, double radius,
    double mass, double dt, double *row)
{
    const struct contact *c = find(scene, a, b);
    memset(row, 0, CONTACT_TABLE_PARAMETER * sizeof *row);
    if (!c) return;
    struct contact_pair s = wall ? contact_pair_wall(1 / mass, radius)
                                 : contact_pair_of(1 / mass, 1 / mass, radius, radius);
    struct contact_parameters p = contact_parameters_of(material_of(scene, c), s, dt);
    const double value[CONTACT_TABLE_PARAMETER] = {p.k_n, p.gamma_n, p.centring_n, p.damp_n, p.k_t,
        p.gamma_t, p.centring_t, p.damp_t, p.mu, p.f_b, p.roll_limit, p.roll_stop, p.k_r, p.c_r,
        p.law};
    memcpy(row, value, sizeof value);
}

void contact_table_set(struct launch *launch, const double *row)
{
    static const char *const name[] = {"k_n", "gamma_n", "centring_n", "damp_n", "k_t", "gamma_t",
        "centring_t", "damp_t", "mu", "f_b", "roll_limit", "roll_stop", "k_r", "c_r"};
    for (int i = 0; i < 14; i++) launch_set_real(launch, name[i], row[i]);
    launch_set_int(launch, "law", (int)row[14]);
}
