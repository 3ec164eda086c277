/* How large a time step the contacts of one element allow: a bound that holds for any network of
 * spheres and walls.
 *
 * With V = dt v^{n+1/2} = x^{n+1} - x^n and dashpots gamma (p v^{n+1/2} + q (dt/2) a^n), p and q >=
 * 0 (law_normal.h: keep and gain), leapfrog is
 *     M (V' - V) = -dt^2 K x^{n+1} - dt sum gamma [p V + (q/2) (V - V_)],  V_, V' one step off,
 * the sum over contacts, each with its own p and q. Times (V' + V)/2 it is a balance of
 *     E = V (M - dt^2 K/4) V/2 + dt^2 xm K xm/2,  xm = (x^{n+1} + x^n)/2,
 * and of each dashpot's - gamma (dt/2) (a + b) [p b + (q/2) (b - c)] with a, b, c its velocities in
 * V', V, V_. With g = (q + p)/8 and
 *     Q(b, c) = -(p + q)/4 b^2 + g (b + c)^2
 * what is left of that, (a + b) [p b + (q/2) (b - c)]/2 - Q(a, b) + Q(b, c), is a sum of squares (a
 * form with a kernel (1, -1, 1) whose minor (p^2 + 2 p q)/64 is not negative). So E + dt sum gamma
 * Q never grows, and it is positive if
 *     4 M - dt^2 K - 2 dt C is,  C = sum of gamma (p + q) per contact,
 * for any network and any mixture. p = q = 1 is the plain prediction (x'' = -w^2 x - 2 z w x' is
 * then stable iff (w dt)^2 + 8 z w dt < 4: sharp, the root -1 appears there), p = 1, q = 0 the
 * lagged dashpot. Here p <= 1 and q = max(1 - c, 0)/(1 + c), so p + q <= max(2/(1 + c), 1), which
 * has c = gamma dt/(2 m*), tangential 3.5 gamma dt/(2 m*), in it; rolling has p = q = 1. gamma (p
 * + q) grows with gamma, and falls with the dt in c: the bound holds for dt if it gives at least dt
 * with dt put in there.
 *
 * A contact with relative displacement u, and rotations joined to it by the levers l, is bounded by
 * Cauchy and Schwarz with weights of its four ends (1, 2.5 s) m^(-1/2):
 *     |u|^2 <= (sum of weights) (sum of |part|^2/weight),
 * so that K and C are below block diagonal matrices, for element i with w = 1/m and p = w_i + (w_i
 * w_j)^(1/2) (wall: w_i) of each contact
 *     translation  T_i = sum p [k_n n n^T + (1 + 2.5 s) k_t (1 - n n^T)]
 *     rotation     R_i = sum {p (1 + 2.5 s)/s k_t (1 - n n^T) + q k_r (1 - n n^T)}
 * with q = 1/I_i + (I_i I_j)^(-1/2)
 * (the sums with gamma in place of k for C), and dt^2 a + 2 dt b <= 4 with a, b their largest
 * eigenvalues suffices. Any s > 0 is allowed, the same for all contacts; s = 1 is exact for two
 * equal spheres, limit_share is better in beds. The weights m^(-1/2) in place of 1/m keep the bound
 * near the truth where many small spheres lie on a large one.
 *
 * Not in it: CDT rolling (a moment of bounded size: it can chatter, not blow up), sliding (below
 * the spring that it replaces), tension of bonds, F/d against k_n: the share of a per cent that
 * `safety` covers.
 * Wants the features of pairs and walls together, all WITH_ flags defined. Knows no lists. */
#ifndef DEMOCLES_LAW_LIMIT_H
#define DEMOCLES_LAW_LIMIT_H

#include "law_normal.h"
#include "common/vec.h"

/* What rounding may take from the bound. */
#if REAL_IS_FLOAT
#define LIMIT_ROUNDING 0.999f
#define LIMIT_NONE 1e30f
#define LIMIT_NOISE 5e-7f /* of a determinant of order 1 */
#else
#define LIMIT_ROUNDING 0.999999999
#define LIMIT_NONE 1e30
#define LIMIT_NOISE 1e-15
#endif

#define LIMIT_STEPS 5

struct limit_matrix {
    real xx, yy, zz, xy, xz, yz;
};

/* Two ends of a contact: 1/m [1/kg], radii [m]; a wall is an end with 0 and 0. */
struct limit_ends {
    real w_i, w_j, r_i, r_j;
};

/* A contact as springs and dashpots. */
struct limit_contact {
    real k_n, k_t, k_r;         /* [N/m], [N/m], [N m] */
    real gamma_n, gamma_t, c_r; /* gamma (p + q) [N s/m], [N s/m], [N m s] */
    real stretch;               /* largest square of lever/radius, at least 1 */
};

/* T and R of stiffness [1/s2] and of damping [1/s]. */
struct limit_sums {
    struct limit_matrix t_k, t_g, r_k, r_g;
};

LAW struct limit_matrix limit_matrix_zero(void)
{
    struct limit_matrix a;
    a.xx = a.yy = a.zz = a.xy = a.xz = a.yz = 0;
    return a;
}

/* a + along n n^T + across (1 - n n^T) */
LAW struct limit_matrix limit_matrix_add(struct limit_matrix a, real along, real across, vec3 n)
{
    real d = along - across;
    a.xx += across + d * n.x * n.x;
    a.yy += across + d * n.y * n.y;
    a.zz += across + d * n.z * n.z;
    a.xy += d * n.x * n.y;
    a.xz += d * n.x * n.z;
    a.yz += d * n.y * n.z;
    return a;
}

LAW struct limit_matrix limit_matrix_square(struct limit_matrix a)
{
    struct limit_matrix b;
    b.xx = a.xx * a.xx + a.xy * a.xy + a.xz * a.xz;
    b.yy = a.xy * a.xy + a.yy * a.yy + a.yz * a.yz;
    b.zz = a.xz * a.xz + a.yz * a.yz + a.zz * a.zz;
    b.xy = a.xx * a.xy + a.xy * a.yy + a.xz * a.yz;
    b.xz = a.xx * a.xz + a.xy * a.yz + a.xz * a.zz;
    b.yz = a.xy * a.xz + a.yy * a.yz + a.yz * a.zz;
    return b;
}

/* Largest eigenvalue of a matrix that has none below zero, from above, without trigonometry: it is
 * at most ||A^4||_F^(1/4), 3^(1/8) too large at worst; Laguerre's method on det(x - A), whose roots
 * are all real, comes down from there and never passes the root. After LIMIT_STEPS the rest is
 * below 3e-4 (two equal roots), mostly nothing; in float up to 3 LIMIT_NOISE^(1/3) = 2.4e-2 where
 * three roots are nearly equal. */
LAW real limit_largest(struct limit_matrix a, int steps)
{
    real trace = a.xx + a.yy + a.zz;
    real scale = (real)1 / trace;
    struct limit_matrix b, c;
    real x, minors, det;

    if (!(trace > 0)) return 0;
    b.xx = scale * a.xx;
    b.yy = scale * a.yy;
    b.zz = scale * a.zz;
    b.xy = scale * a.xy;
    b.xz = scale * a.xz;
    b.yz = scale * a.yz;
    c = limit_matrix_square(limit_matrix_square(b));
    x = c.xx * c.xx + c.yy * c.yy + c.zz * c.zz +
        (real)2 * (c.xy * c.xy + c.xz * c.xz + c.yz * c.yz);
    x = r_sqrt(r_sqrt(r_sqrt(x)));
    minors = b.xx * b.yy - b.xy * b.xy + b.xx * b.zz - b.xz * b.xz + b.yy * b.zz - b.yz * b.yz;
    det = b.xx * (b.yy * b.zz - b.yz * b.yz) - b.xy * (b.xy * b.zz - b.yz * b.xz) +
          b.xz * (b.xy * b.yz - b.yy * b.xz);
    /* det(x - B) = x^3 - x^2 + minors x - det: the trace of B is 1 */
    for (int k = 0; k < steps; k++) {
        real p = r_max(((x - (real)1) * x + minors) * x - det - LIMIT_NOISE, (real)0);
        real p1 = ((real)3 * x - (real)2) * x + minors;
        real p2 = (real)6 * x - (real)2;
        real root = r_sqrt(r_max((real)4 * p1 * p1 - (real)6 * p * p2, (real)0));
        real slope = r_max(p1, (real)0) + root;
        real step = slope > 0 ? (real)3 * p / slope : (real)0;
        x -= step;
        if (step < (real)1e-4 * x) break;
    }
    return trace * x;
}

LAW real limit_r_star(struct limit_ends e)
{
    return e.r_j > 0 ? e.r_i * e.r_j / (e.r_i + e.r_j) : e.r_i;
}

/* gamma (p + q); centring: c. */
LAW real limit_dashpot(real gamma, real centring)
{
    return gamma * r_max((real)2 / ((real)1 + centring), (real)1);
}

/* delta [m], v_n: approach speed [m/s], of receding bodies without a bond 0 counts; dt [s] of the
 * dashpots' centring. */
LAW struct limit_contact limit_contact_of(
    struct contact_material c, struct limit_ends e, real delta, real v_n, real dt)
{
    struct limit_contact k;
    int hertz = material_is_hertz(c);
    real inverse_m = e.w_i + e.w_j;
    real m_star = (real)1 / inverse_m;
    real r_star = limit_r_star(e);
    real size = hertz ? r_sqrt(r_star) : (real)1;
    real root = hertz ? normal_deepest(c, r_star, m_star, delta, v_n) : (real)1;
    real damper = r_sqrt(size * m_star * root);
    real per_radius = e.r_j > 0 ? (real)0.5 / r_min(e.r_i, e.r_j) : (real)1 / e.r_i;
    /* bonds that are apart; spheres that have swallowed a smaller one */
    real lever = r_max(r_abs((real)1 - delta * per_radius), (real)1);
    real half_dt = (real)0.5 * dt * inverse_m;
    real gamma_n = damper * c.gamma_n, gamma_t = damper * c.gamma_t;

    k.stretch = lever * lever;
    k.k_n = (hertz ? (real)1.5 : (real)1) * size * c.k_n * root;
    k.gamma_n = limit_dashpot(gamma_n, gamma_n * half_dt);
    k.k_t = WITH_TANGENTIAL ? size * c.k_t * root : (real)0;
    k.gamma_t =
        WITH_TANGENTIAL_DAMPING ? limit_dashpot(gamma_t, (real)3.5 * gamma_t * half_dt) : (real)0;
    k.k_r = k.c_r = 0;
    if (WITH_ROLLING_EPSD) {
        real i_star =
            (real)1 / (e.w_i / (e.r_i * e.r_i) + (e.r_j > 0 ? e.w_j / (e.r_j * e.r_j) : (real)0));
        k.k_r = size * r_star * r_star * c.k_r * root;
        k.c_r = (real)2 * r_star * r_sqrt(size * i_star * root) * c.c_r;
    }
    return k;
}

LAW struct limit_sums limit_sums_zero(void)
{
    struct limit_sums s;
    s.t_k = s.t_g = s.r_k = s.r_g = limit_matrix_zero();
    return s;
}

/* Mobilities that element i feels in a contact: p [1/kg] and q [1/(kg m2)] above. */
LAW real limit_mobility(struct limit_ends e) { return e.w_i + r_sqrt(e.w_i * e.w_j); }
LAW real limit_spin_mobility(struct limit_ends e)
{
    real other = e.r_j > 0 ? r_sqrt(e.w_i * e.w_j) / (e.r_i * e.r_j) : (real)0;
    return (real)2.5 * (e.w_i / (e.r_i * e.r_i) + other);
}

/* Adds a contact of element i with unit normal n; share: s. */
LAW struct limit_sums limit_sums_add(
    struct limit_sums s, struct limit_contact c, struct limit_ends e, vec3 n, real share)
{
    real p = limit_mobility(e), q = WITH_ROLLING_EPSD ? limit_spin_mobility(e) : (real)0;
    real across = p * c.stretch * ((real)1 + (real)2.5 * share), turn = across / share;
    s.t_k = limit_matrix_add(s.t_k, p * c.k_n, across * c.k_t, n);
    s.t_g = limit_matrix_add(s.t_g, p * c.gamma_n, across * c.gamma_t, n);
    if (WITH_TANGENTIAL || WITH_ROLLING_EPSD) {
        s.r_k = limit_matrix_add(s.r_k, 0, turn * c.k_t + q * c.k_r, n);
        s.r_g = limit_matrix_add(s.r_g, 0, turn * c.gamma_t + q * c.c_r, n);
    }
    return s;
}

/* The share s that makes T and R equal in an isotropic bed of contacts with k_t/k_n = kappa
 * (tangent stiffnesses); 1 without friction. */
LAW real limit_share(real kappa)
{
    real b = kappa > 0 ? (real)0.5 / kappa - (real)1.5 : (real)-1.5;
    return (real)0.2 * (r_sqrt(b * b + (real)10) - b);
}

/* Largest dt with dt^2 a + 2 dt b <= 4; LIMIT_NONE without contacts. */
LAW real limit_step(real a, real b)
{
    real divisor = b + r_sqrt(b * b + (real)4 * a);
    return divisor > 0 ? (real)4 / divisor : LIMIT_NONE;
}

/* Steps of limit_largest as given. */
LAW real limit_of_sums_to(struct limit_sums s, int steps)
{
    real least = limit_step(limit_largest(s.t_k, steps), limit_largest(s.t_g, steps));
    if (WITH_TANGENTIAL || WITH_ROLLING_EPSD) {
        real r = limit_step(limit_largest(s.r_k, steps), limit_largest(s.r_g, steps));
        least = r_min(least, r);
    }
    return LIMIT_ROUNDING * least;
}

/* The bound of one element; a quick lower one if that is already above `enough`. Since eigenvalues
 * only come down, the minimum of several elements has the same bits whatever is known before. */
LAW real limit_of_sums(struct limit_sums s, real enough)
{
    real quick = limit_of_sums_to(s, 0);
    return quick > enough ? quick : limit_of_sums_to(s, LIMIT_STEPS);
}

#endif
