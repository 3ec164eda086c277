/* A lattice cell's share in the quantities that are conserved. Host and device alike; double sums
 * (sums.h), whatever `real` is.
 *
 * Elastic: half of each of its links, and its own volumetric energy with the halves beyond which
 * there is no link (law_volume.h); what dashpots add to the pressure is not in it. Gravity's
 * potential is 0 where cells begin.
 *
 * WITH_ENERGY also what its ledger has (lattice_work.h), with the two parts of the work that are
 * functions of the state. */
#ifndef DEMOCLES_LATTICE_ACCOUNT_H
#define DEMOCLES_LATTICE_ACCOUNT_H

#include "lattice_state.h"
#include "common/sums.h"

#if !defined(__OPENCL_VERSION__) || WITH_SUMS /* double exists */

/* What the link over a face has [J]; 0 where there is none. */
LAW real account_link(
    int face, int exists, struct link_cell me, struct link_cell other, struct link_constants k)
{
    int axis = face >> 1;
    struct link_state s =
        face & 1 ? link_state_of(axis, me, other, k) : link_state_of(axis, other, me, k);
    return exists ? link_energy(s, k) : (real)0;
}

/* The law of links is one of small strain: 1 where the gap is more than STRAIN_MOST of an edge, or
 * the faces are turned by more than 0.5 rad against each other. */
#define STRAIN_MOST 0.1
#define STRAIN_TURN (WITH_TURN ? 0.24740396 : 0.5) /* |v| = sin(angle/2) of the quaternion */

LAW real account_strained(
    int axis, int exists, struct link_cell me, struct link_cell upper, struct link_constants k)
{
    struct link_state s = link_state_of(axis, me, upper, k);
    real most = (real)STRAIN_MOST * k.h, turn = (real)STRAIN_TURN;
    int is = v3_dot(s.gap, s.gap) > most * most || v3_dot(s.turn, s.turn) > turn * turn;
    return exists && is ? (real)1 : (real)0;
}

/* stretch: sum over the links, without damping [m]. */
LAW real account_volume(real stretch, struct lattice_load l, int links, struct volume_constants c)
{
    real traction = WITH_LOADS ? l.traction : (real)0,
         squares = WITH_LOADS ? v3_dot(l.lower, l.lower) + v3_dot(l.upper, l.upper) : (real)0;
    return volume_energy(volume_strain(stretch, traction, links, c), traction, squares, links, c);
}

/* Work that the tractions on its free faces have done on the cell since they were zero, less what
 * the ledger has of it [J]. */
LAW real account_faces(real stretch, struct lattice_load l, int links, struct volume_constants c)
{
    real p = c.lambda * volume_strain(stretch, l.traction, links, c),
         squares = v3_dot(l.lower, l.lower) + v3_dot(l.upper, l.upper);
    return c.volume * c.per_4g * r_fma(-l.traction, p, (real)0.5 * squares);
}

/* Kinetic energy of held DOF [J]. */
SUMS double account_held(struct link_cell c, int word, double mass, double inertia)
{
    int held = word >> WORD_FIX;
    double v[3] = {(double)c.v.x, (double)c.v.y, (double)c.v.z},
           w[3] = {(double)c.w.x, (double)c.w.y, (double)c.w.z}, sum = 0.0;
    for (int a = 0; a < 3; a++) {
        sum += held >> a & 1 ? 0.5 * mass * v[a] * v[a] : 0.0;
        sum += held >> (a + 3) & 1 ? 0.5 * inertia * w[a] * w[a] : 0.0;
    }
    return sum;
}

/* Terms of a cell; links: sum of account_link [J], volume: account_volume [J], place: where its
 * centre was [m], 1/m [1/kg], 1/J [1/(kg m2)]. */
SUMS void account_cell(struct link_cell c, real links, real volume, const double *place,
    double per_mass, double per_inertia, const double *gravity, double *term)
{
    double u[3] = {(double)c.u.x, (double)c.u.y, (double)c.u.z},
           v[3] = {(double)c.v.x, (double)c.v.y, (double)c.v.z};
    double w[3] = {(double)c.w.x, (double)c.w.y, (double)c.w.z}, mass = 1.0 / per_mass,
           inertia = 1.0 / per_inertia;

    term[ACCOUNT_KINETIC] = 0.5 * mass * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    term[ACCOUNT_ROTATIONAL] = 0.5 * inertia * (w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    term[ACCOUNT_GRAVITY] = -mass * (gravity[0] * u[0] + gravity[1] * u[1] + gravity[2] * u[2]);
    term[ACCOUNT_ELASTIC] = 0.5 * (double)links + (double)volume;
    for (int a = 0; a < 3; a++) {
        int b = a < 2 ? a + 1 : 0, d = a > 0 ? a - 1 : 2;
        term[ACCOUNT_MOMENTUM + a] = mass * v[a];
        term[ACCOUNT_ANGULAR + a] =
            mass * ((place[b] + u[b]) * v[d] - (place[d] + u[d]) * v[b]) + inertia * w[a];
    }
}

#endif

#endif
