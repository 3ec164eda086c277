/* What a contact needs to know of its two materials and sizes.
 *
 * Two steps, so that equal spheres pay nothing: contact_material holds what the two materials say,
 * whatever the sizes; contact_parameters is that for one effective mass and radius, constant during
 * the run. Scenes of one size compute the latter once on the host, others in the kernel (one square
 * root or two and two divisions).
 *
 * One set of members serves both normal laws. With s = 1 (linear) or s = delta^(1/2) (Hertz), and
 * s^(1/2) = 1 or delta^(1/4):
 *     spring k_n s delta, normal dashpot gamma_n s^(1/2),
 *     tangential spring k_t s, tangential dashpot gamma_t s^(1/2), rolling spring k_r s.
 * Knows no scene and no element. All WITH_ flags must be defined, 0 or 1. */
#ifndef DEMOCLES_LAW_PARAMETERS_H
#define DEMOCLES_LAW_PARAMETERS_H

#include "common/types.h"

#define FLAG(feature) WITH_##feature

/* Bits of contact_material.law and contact_parameters.law. */
#define CONTACT_HERTZ 1         /* Hertz-Mindlin, else linear */
#define CONTACT_NO_ATTRACTION 2 /* the dashpot may not pull: F_n = max(F_n, 0) */
/* Friction as other codes have it; docs/conventions.md says which. */
#define CONTACT_WHOLE_SLIP 4     /* slip takes spring and dashpot together */
#define CONTACT_RADIUS_LEVER 8   /* lever arms are the radii, whatever the overlap */
#define CONTACT_NO_RESCALE 16    /* F_t = k_t(delta) xi, so that a cycle of loading gives energy */
#define CONTACT_CAP_MAGNITUDE 32 /* friction is limited by mu |F_n| */
#define CONTACT_UNDAMPED_SLIP 64 /* the spring slips by itself, its dashpot rests meanwhile */
/* Any slip rule but the default; the feature WHOLE_SLIP has them all. */
#define CONTACT_OTHER_SLIP (CONTACT_WHOLE_SLIP | CONTACT_UNDAMPED_SLIP)

/* Two materials, any sizes. S = 1 (linear) or R*^(1/2) (Hertz). One row (type, name) each; from it
 * follow the struct, the tables that the host makes and the kernels read. */
#define CONTACT_MATERIAL(X)                                                                        \
    X(real, k_n)     /* k_n/S: linear [N/m], Hertz (4/3) E* [Pa] */                                \
    X(real, k_t)     /* k_t/S: linear [N/m], Hertz 8 G* [Pa] */                                    \
    X(real, gamma_n) /* gamma_n/(S m*)^(1/2): 2 z_n k_n^(1/2), Hertz 5^(1/2) z_n k_n^(1/2) */      \
    X(real, gamma_t) /* gamma_t/(S m*)^(1/2): 2 z_t (2 k_t/7)^(1/2) */                             \
    X(real, mu)      /* friction [1]; 0: none */                                                   \
    X(real, f_b)     /* binding force [N]; 0: none */                                              \
    X(real, jkr)     /* JKR: (2 pi w/E*)^(2/3) [m^(2/3)], w the work of adhesion; 0: none */       \
    X(real, mu_r)    /* rolling friction [1]; 0: none */                                           \
    X(real, k_r)     /* EPSD: k_r/(S R*^2); 0: CDT */                                              \
    X(real, c_r)     /* EPSD: C_r/(S R*^2 I*)^(1/2) */                                             \
    X(int, law)      /* CONTACT_ bits */

/* Effective sizes of a pair. */
struct contact_pair {
    real m_star; /* m_i m_j/(m_i + m_j) [kg]; wall: m_i */
    real r_star; /* r_i r_j/(r_i + r_j) [m]; wall: r_i */
    real i_star; /* 1/(1/(m_i r_i^2) + 1/(m_j r_j^2)) [kg m2]; wall: m_i r_i^2 */
};

/* Two materials, two sizes, one time step, in rows as above; also the arguments of the force
 * kernels where all contacts have the same. Units: linear / Hertz. */
#define CONTACT_PARAMETERS(X)                                                                      \
    X(real, k_n)        /* [N/m] / [N/m^1.5] */                                                    \
    X(real, gamma_n)    /* [N s/m] / [N s/m^1.25] */                                               \
    X(real, centring_n) /* gamma_n dt/(2 m*) [1] / [m^-0.25] */                                    \
    X(real, damp_n)     /* linear: 1/(1 + centring_n) */                                           \
    X(real, turning_n)  /* tangent stiffness/s times dt^2/(2 m*) [1] / [m^-0.5] */                 \
    X(real, k_t)        /* [N/m] / [N/m^1.5] */                                                    \
    X(real, gamma_t)    /* [N s/m] / [N s/m^1.25] */                                               \
    X(real, centring_t) /* 3.5 gamma_t dt/(2 m*) [1] / [m^-0.25] */                                \
    X(real, damp_t)     /* linear: 1/(1 + centring_t) */                                           \
    X(real, turning_t)  /* 3.5 k_t dt^2/(2 m*) [1] / [m^-0.5] */                                   \
    X(real, mu)         /* [1] */                                                                  \
    X(real, f_b)        /* [N] */                                                                  \
    X(real, jkr)        /* JKR: L = (2 pi w R*^(1/2)/E*)^(2/3) [m]; 0: none */                     \
    X(real, roll_limit) /* mu_r R* [m] */                                                          \
    X(real, roll_stop)  /* CDT: 1/(2 dt (1/I_i + 1/I_j)) [N m s], halves w_r in dt */              \
    X(real, k_r)        /* EPSD: [N m] / [N m^0.5]; 0: CDT */                                      \
    X(real, c_r)        /* EPSD: [N m s] / [N m^0.75 s] */                                         \
    X(int, law)         /* CONTACT_ bits */

#define CONTACT_MEMBER(type, name) type name;
struct contact_material {
    CONTACT_MATERIAL(CONTACT_MEMBER)
};
struct contact_parameters {
    CONTACT_PARAMETERS(CONTACT_MEMBER)
};

/* Columns of the tables' rows: MATERIAL_k_n, PARAMETER_k_n, ... */
#define MATERIAL_COLUMN(type, name) MATERIAL_##name,
#define PARAMETER_COLUMN(type, name) PARAMETER_##name,
enum { CONTACT_MATERIAL(MATERIAL_COLUMN) MATERIAL_WIDTH };
enum { CONTACT_PARAMETERS(PARAMETER_COLUMN) PARAMETER_WIDTH };

#ifdef __OPENCL_VERSION__
#define CONTACT_ROW __global const real
#else
#define CONTACT_ROW const double
#endif
#define MATERIAL_FROM_ROW(type, name) (type) row[MATERIAL_##name],
#define PARAMETER_FROM_ROW(type, name) (type) row[PARAMETER_##name],

LAW struct contact_material material_load(CONTACT_ROW *row)
{
    struct contact_material c = {CONTACT_MATERIAL(MATERIAL_FROM_ROW)};
    return c;
}

LAW struct contact_parameters parameters_load(CONTACT_ROW *row)
{
    struct contact_parameters p = {CONTACT_PARAMETERS(PARAMETER_FROM_ROW)};
    return p;
}

LAW int parameters_choose(struct contact_parameters p, int bit) { return (p.law & bit) != 0; }

LAW int parameters_radius_lever(struct contact_parameters p)
{
    return WITH_RADIUS_LEVER && parameters_choose(p, CONTACT_RADIUS_LEVER);
}

LAW int material_is_hertz(struct contact_material c)
{
    return WITH_HERTZ && (!WITH_LINEAR || (c.law & CONTACT_HERTZ) != 0);
}

/* k_n [N/m], damping ratios z [1], k_t/k_n [1]. Friction, binding and rolling are off. */
LAW struct contact_material contact_material_linear(
    real k_n, real z_n, real stiffness_ratio, real z_t)
{
    struct contact_material c = {0};
    c.k_n = k_n;
    c.k_t = stiffness_ratio * k_n;
    c.gamma_n = (real)2 * z_n * r_sqrt(c.k_n);
    c.gamma_t = (real)2 * z_t * r_sqrt(c.k_t * (real)2 / (real)7);
    return c;
}

/* 1/E* = (1 - nu_i^2)/E_i + (1 - nu_j^2)/E_j, 1/G* = (2 - nu_i)/G_i + (2 - nu_j)/G_j [Pa] (rigid
 * partner: its term is 0).
 * stiffness_ratio: k_t over the tangent k_n = 2 E* (R* delta)^(1/2), at all overlaps; negative:
 * Mindlin's 4 G_star/E_star. */
LAW struct contact_material contact_material_hertz(
    real e_star, real g_star, real z_n, real stiffness_ratio, real z_t)
{
    struct contact_material c = contact_material_linear((real)4 / (real)3 * e_star, z_n, 0, 0);
    c.k_t = stiffness_ratio < 0 ? (real)8 * g_star : (real)2 * stiffness_ratio * e_star;
    c.gamma_n = r_sqrt((real)5 * c.k_n) * z_n;
    c.gamma_t = (real)2 * z_t * r_sqrt(c.k_t * (real)2 / (real)7);
    c.law = CONTACT_HERTZ;
    return c;
}

/* CDT: only mu_r [1]. EPSD: k_r = ratio k_n (mu_r R*)^2 with the tangent k_n (ratio 2.25 by Ai et
 * al. 2011; 0 chooses CDT), and C_r = 2 eta (k_r I_r)^(1/2), 1/I_r = 1/(1.4 m_i r_i^2) + 1/(1.4 m_j
 * r_j^2). */
LAW struct contact_material contact_material_rolling(
    struct contact_material c, real mu_r, real ratio, real eta)
{
    real tangent = c.law & CONTACT_HERTZ ? (real)1.5 * c.k_n : c.k_n;
    c.mu_r = mu_r;
    c.k_r = ratio * tangent * mu_r * mu_r;
    c.c_r = (real)2 * eta * r_sqrt((real)1.4 * c.k_r);
    return c;
}

/* Two spheres: inverse masses [1/kg], radii [m]. */
LAW struct contact_pair contact_pair_of(real inverse_m_i, real inverse_m_j, real r_i, real r_j)
{
    struct contact_pair s;
    s.m_star = (real)1 / (inverse_m_i + inverse_m_j);
    s.r_star = r_i * r_j / (r_i + r_j);
    s.i_star = 0;
    if (WITH_ROLLING_CDT || WITH_ROLLING_EPSD)
        s.i_star = (real)1 / (inverse_m_i / (r_i * r_i) + inverse_m_j / (r_j * r_j));
    return s;
}

/* A sphere and a wall. */
LAW struct contact_pair contact_pair_wall(real inverse_m, real r)
{
    struct contact_pair s;
    s.m_star = (real)1 / inverse_m;
    s.r_star = r;
    s.i_star = s.m_star * r * r;
    return s;
}

/* x^(1/3) from + * / sqrt, so with the same bits everywhere: 1/3 = 1/4 + 1/16 + 1/64 + ..., then
 * Newton; for x from 1e-12 to 1 to rounding. */
LAW real r_cube_root(real x)
{
    real q = r_sqrt(r_sqrt(x)), q4 = r_sqrt(r_sqrt(q));
    real y = q * q4 * r_sqrt(r_sqrt(q4));
    y = ((real)2 * y + x / (y * y)) * ((real)1 / (real)3);
    y = ((real)2 * y + x / (y * y)) * ((real)1 / (real)3);
    y = ((real)2 * y + x / (y * y)) * ((real)1 / (real)3);
    return ((real)2 * y + x / (y * y)) * ((real)1 / (real)3);
}

/* dt [s]. Members that no compiled feature uses may hold anything finite. */
LAW struct contact_parameters contact_parameters_of(
    struct contact_material c, struct contact_pair s, real dt)
{
    struct contact_parameters p;
    real size = material_is_hertz(c) ? r_sqrt(s.r_star) : (real)1;
    real root = r_sqrt(size * s.m_star);
    real half_dt = (real)0.5 * dt * size / (root * root); /* dt/(2 m*) */
    real both;

    p.k_n = size * c.k_n;
    p.k_t = size * c.k_t;
    p.gamma_n = root * c.gamma_n;
    p.gamma_t = root * c.gamma_t;
    p.centring_n = p.gamma_n * half_dt;
    p.centring_t = (real)3.5 * p.gamma_t * half_dt;
    both = (real)1 / (((real)1 + p.centring_n) * ((real)1 + p.centring_t));
    p.damp_n = both * ((real)1 + p.centring_t);
    p.damp_t = both * ((real)1 + p.centring_n);
    p.turning_n = (material_is_hertz(c) ? (real)1.5 : (real)1) * p.k_n * half_dt * dt;
    p.turning_t = (real)3.5 * p.k_t * half_dt * dt;
    p.mu = c.mu;
    p.f_b = c.f_b;
    p.jkr = WITH_JKR ? c.jkr * r_cube_root(s.r_star) : (real)0;
    p.roll_limit = c.mu_r * s.r_star;
    p.roll_stop = (real)0.2 * s.i_star / dt;
    p.k_r = size * s.r_star * s.r_star * c.k_r;
    p.c_r = s.r_star * r_sqrt(size * s.i_star) * c.c_r;
    p.law = c.law;
    return p;
}

#endif
