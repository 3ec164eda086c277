/* Whether a link breaks, decided once per step from the state at its start. The link is always seen
 * from its lower cell, so both ends, and all ranks that hold it, decide alike. Compression never
 * breaks.
 *
 * Each load is divided by its limit; a limit that does not exist has the reciprocal 0:
 *     n = f_n/F_n, s = |f_s|/F_s, b = |mom_b|/M_b, t = |mom_t|/M_t
 * BREAK_SUM      max(n, 0) + s + b + t >= 1: forces and moments, as in LAMMPS bpm/rotational
 * BREAK_LARGEST  max(n, s, b, t) >= 1
 * BREAK_STRESS   n + b >= 1 or s + t >= 1, with F_n = h^2 sigma_c, M_b = h^3 sigma_c/6,
 *                F_s = h^2 tau_c, M_t = h^3 tau_c/3: the stress at the face's edge, as in parallel
 *                bonds; the twist by the polar moment h^4/6 that kt has. Compression relieves the
 *                edge.
 * The mode is the largest share. With f the force f_n is its part along n. */
#ifndef DEMOCLES_LAW_BREAK_H
#define DEMOCLES_LAW_BREAK_H

#include "law_link.h"

#define BREAK_SUM 0
#define BREAK_LARGEST 1
#define BREAK_STRESS 2

#define BREAK_INTACT 0
#define BREAK_TENSION 1
#define BREAK_SHEAR 2
#define BREAK_BENDING 3
#define BREAK_TWIST 4

/* One over the limits; 0: none. */
struct break_limits {
    real normal, shear; /* [1/N] */
    real bend, twist;   /* [1/(N m)] */
    int criterion;      /* BREAK_SUM, BREAK_LARGEST or BREAK_STRESS */
};

/* Size of what a link carries; normal > 0 is tension. */
struct break_load {
    real normal, shear; /* [N] */
    real bend, twist;   /* [N m] */
};

struct break_result {
    real measure; /* >= 1: broken */
    int mode;     /* BREAK_INTACT or why */
};

/* Constants with eta = 0 in link_force_of give elastic loads, others those with the dashpots. */
LAW struct break_load break_load_of(struct link_state s, struct link_force f)
{
    struct break_load l;
    real scale = WITH_TURN ? (real)1 / r_sqrt(v3_dot(s.n, s.n)) : (real)1;
    vec3 n = v3_scale(scale, s.n), shear, bend;

    l.normal = v3_dot(f.force, n);
    l.twist = v3_dot(f.moment, n);
    shear = v3_fma(-l.normal, n, f.force);
    bend = v3_fma(-l.twist, n, f.moment);
    l.shear = r_sqrt(v3_dot(shear, shear));
    l.bend = r_sqrt(v3_dot(bend, bend));
    l.twist = r_abs(l.twist);
    return l;
}

LAW struct break_result break_of(struct break_load l, struct break_limits k)
{
    struct break_result r;
    real n = k.normal * l.normal, s = k.shear * l.shear, b = k.bend * l.bend, t = k.twist * l.twist;
    real pull = r_max(n, (real)0), first = r_max(pull, s), second = r_max(b, t);
    real sum = pull + s + (b + t), largest = r_max(first, second), stress = r_max(n + b, s + t);
    int mode = first >= second ? (pull >= s ? BREAK_TENSION : BREAK_SHEAR)
                               : (b >= t ? BREAK_BENDING : BREAK_TWIST);

    r.measure = k.criterion == BREAK_STRESS ? stress : k.criterion == BREAK_LARGEST ? largest : sum;
    r.mode = r.measure >= (real)1 ? mode : BREAK_INTACT;
    return r;
}

#endif
