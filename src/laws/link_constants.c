#include "link_constants.h"

#include <math.h>
#include <stddef.h>

const char *link_constants_refusal(enum link_set set, struct link_material m)
{
    if (!(m.density > 0) || !isfinite(m.density)) return "density must be above 0";
    if (!(m.young > 0) || !isfinite(m.young)) return "young must be above 0";
    if (!(m.poisson > -1 && m.poisson < 0.5))
        return "poisson must lie between -1 and 0.5, both excluded: no other elastic solid is "
               "stable";
    if (!(m.damping >= 0) || !isfinite(m.damping))
        return "the damping of links must not be negative";
    if (set == LINK_REFERENCE && (m.poisson < 0 || m.poisson > 0))
        return "poisson must be 0: the pair springs of this law, without a volumetric term, have "
               "no other";
    return NULL;
}

double link_constants_shear(struct link_material m)
{
    return m.young / (2 * (1 + m.poisson));
}

double link_constants_lambda(enum link_set set, struct link_material m)
{
    return set == LINK_REFERENCE ? 0
                                 : m.young * m.poisson / ((1 + m.poisson) * (1 - 2 * m.poisson));
}

/* Of one material alone. */
static struct link_stiffness own(enum link_set set, struct link_material m, double h)
{
    double g = link_constants_shear(m), area = h * h * h;
    struct link_stiffness k = {.kn = 2 * g * h, .r_i = 1, .r_j = 1, .eta = m.damping};
    k.ks = k.kn;
    k.kt = set == LINK_REFERENCE ? m.young * area : g * area / 6;
    k.kb = set == LINK_REFERENCE ? m.young * area : m.young * area / 12;
    if (m.poisson == 0) k.kt = k.kb; /* to the last bit, see link_constants_twist_apart */
    return k;
}

static double series(double a, double b)
{
    return a == b ? a : 2 * a * b / (a + b);
}

struct link_stiffness link_constants_between(
    enum link_set set, struct link_material i, struct link_material j, double h)
{
    struct link_stiffness a = own(set, i, h), b = own(set, j, h), k;
    double m_i = link_constants_lambda(set, i) + a.kn / h,
           m_j = link_constants_lambda(set, j) + b.kn / h;
    k.r_i = 2 * m_j / (m_i + m_j);
    k.r_j = 2 * m_i / (m_i + m_j);
    k.ks = series(a.ks, b.ks);
    /* with one nu r is as G, and kn is ks */
    k.kn = i.poisson == j.poisson ? k.ks : 0.5 * (a.kn * k.r_i * k.r_i + b.kn * k.r_j * k.r_j);
    k.kt = series(a.kt, b.kt);
    k.kb = series(a.kb, b.kb);
    k.eta = 0.5 * (i.damping + j.damping);
    return k;
}

struct link_stiffness link_constants_wall(enum link_set set, struct link_material i, double h)
{
    struct link_stiffness k = own(set, i, h);
    k.kn *= 2;
    k.ks *= 2;
    k.kt *= 2;
    k.kb *= 2;
    k.r_i = 2;
    k.r_j = 0;
    return k;
}

double link_constants_least_size(enum link_set set, struct link_material m)
{
    return 0.25 * (1 + link_constants_lambda(set, m) / (4 * link_constants_shear(m)));
}

bool link_constants_shear_apart(struct link_stiffness k)
{
    return k.kn < k.ks || k.kn > k.ks;
}

bool link_constants_twist_apart(struct link_stiffness k)
{
    return k.kt < k.kb || k.kt > k.kb;
}

double link_constants_mass(struct link_material m, double h)
{
    return m.density * h * h * h;
}

double link_constants_inertia(struct link_material m, double h)
{
    return link_constants_mass(m, h) * h * h / 6;
}

struct link_strength link_constants_weaker(struct link_strength i, struct link_strength j)
{
    bool is_i = i.tension < j.tension ||
                (i.tension <= j.tension &&
                    (i.shear < j.shear || (i.shear <= j.shear && i.criterion < j.criterion)));
    return (struct link_strength){fmin(i.tension, j.tension), fmin(i.shear, j.shear),
        is_i ? i.criterion : j.criterion, 0, 0, false};
}

struct link_limits link_constants_limits(struct link_strength strength, double h)
{
    double area = h * h;
    return (struct link_limits){1 / (area * strength.tension), 1 / (area * strength.shear),
        6 / (area * h * strength.tension), 3 / (area * h * strength.shear)};
}

/* What the worst cell at a crack's tip bears, over K/sqrt(h): along the grid, and how it rises. */
#define TIP_ALONG 0.625
#define TIP_RISE 0.1

/* K/sqrt(h) [Pa] of a crack that spends `energy`. */
static double stress_at_tip(struct link_material m, double energy, double h, bool plane_strain)
{
    double stiffness = plane_strain ? m.young / (1 - m.poisson * m.poisson) : m.young;
    return sqrt(stiffness * energy / h);
}

double link_constants_tension(struct link_material m, double energy, double h, bool plane_strain)
{
    return 0.75 * stress_at_tip(m, energy, h, plane_strain);
}

double link_constants_principal(struct link_material m, double energy, double h, bool plane_strain)
{
    return TIP_ALONG * stress_at_tip(m, energy, h, plane_strain);
}

double link_constants_rise(void)
{
    return TIP_RISE / TIP_ALONG;
}
