/* How large the time step of the lattice may be: w_max, the largest frequency of the body, and
 * w_max dt of each scheme. Rigorous: never too large. Host only; knows no scene and no device.
 *
 * One material without wall links, any shape (free surfaces, holes, broken links and fixed DOF only
 * lower w_max):
 *     w_max^2 = 28 G/(rho h^2)                            up to lambda/G = 4.4305 (nu 0.408)
 *     w_max^2 = 3 (lambda + 2 G)^2/(lambda rho h^2)       above
 *     w_max^2 = 72 E/(rho h^2)                            with LINK_REFERENCE
 * from a scan of the Brillouin zone. Several materials, or walls: the largest of these is not safe
 * (one soft cell among stiff ones has up to 1.4 times its own). There, for any positive vector z,
 *     w_max^2 <= max over the DOF k of (B z)_k/z_k,  B = M^-1 |K|
 * (Collatz and Wielandt), |K| entry by entry: the 6 x 6 diagonal blocks assembled with signs first,
 * the volumetric part as |T|^T |D| |T|, Th = T u. Replacing z by B z never raises the bound. A link
 * that breaks later does not raise w_max.
 *
 * Bodies with cells that a surface cuts: the same bound, lattice_limit_cut.c. */
#ifndef DEMOCLES_LATTICE_LIMIT_H
#define DEMOCLES_LATTICE_LIMIT_H

#include "link_constants.h"

#include <stdint.h>

enum lattice_scheme { LATTICE_LEAPFROG, LATTICE_RK4, LATTICE_RKN4, LATTICE_PEFRL, LATTICE_VEFRL };

/* Largest w_max dt [1] of the scheme; zeta: damping ratio of the links at w_max, eta w_max/2 with
 * the largest eta of the body. 0: the scheme does not take damping of links (RKN4 has no stage for
 * it; PEFRL and VEFRL have steps back in time, which it blows up). Leapfrog: damping forces from
 * the velocity of the half step before. Mass-proportional damping as an exact factor has no
 * limit. */
double lattice_limit_factor(enum lattice_scheme scheme, double zeta);

/* w_max [rad/s] of one material. */
double lattice_limit_uniform(enum link_set set, struct link_material m, double h);

/* What the body covers of a cell that its surface cuts. Lengths in edges of the cell, from its
 * centre. */
struct lattice_share {
    /* share of each face, -x, +x, -y, +y, -z, +z: of its link, or covered without a link */
    double face[6];
    double offset[6][2]; /* middle of that part, along the two axes after the face's */
    double volume, mass; /* shares */
    double centre[3];    /* middle of what is covered */
    double facet[3];     /* a point of the surface */
};

/* Cells 0 to n - 1, and those that their neighbours name beyond (of other ranks, say). */
struct lattice_body {
    enum link_set set;
    double h; /* [m] */
    int n;
    /* [n][6]: cell over the face -x, +x, -y, +y, -z, +z, or -1 */
    const int (*neighbour)[6];
    /* [n]: bits of faces with a link, in this order; NULL: where there is a neighbour */
    const uint8_t *links;
    /* [n]: bits of faces without neighbour that a link joins to a rigid wall; NULL: none */
    const uint8_t *walls;
    const int32_t *share_of;               /* [n]: row of `share`, 0: whole; NULL: all are */
    const struct lattice_share *share;     /* row 0 is that of a whole cell */
    const uint8_t *material;               /* [all]: row of the table */
    const struct link_material *materials; /* [n_material] */
    int n_material;
};

/* w_max [rad/s]: lattice_limit_uniform if that is right for the body, else the bound after `rounds`
 * rounds (30 come within a few per cent of where it goes). All neighbours must be in 0 to n - 1. */
double lattice_limit_body(const struct lattice_body *body, int rounds);

/* The bound of a body with shares. */
double lattice_limit_cut(const struct lattice_body *body, int rounds);

/* One round in two parts, for a body on several ranks: the caller brings in z, and then s, of the
 * cells beyond n. z [all][6], in the order u_x u_y u_z theta_x theta_y theta_z; any positive
 * values, lattice_limit_start is a good start. */
void lattice_limit_start(const struct lattice_body *body, double (*z)[6]);
/* s [all] of cells 0 to n - 1: |D| |T| z. */
void lattice_limit_volume(const struct lattice_body *body, const double (*z)[6], double *s);
/* Bz = B z of cells 0 to n - 1; returns their largest (B z)_k/z_k [1/s2]. */
double lattice_limit_round(
    const struct lattice_body *body, const double (*z)[6], const double *s, double (*Bz)[6]);

#endif
