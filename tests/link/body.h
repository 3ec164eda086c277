/* A small body of cells, evaluated with the laws as a kernel would: each cell looks at its six
 * faces and keeps its own share. The flags of the laws are those of the executable. Its constants
 * come from src/laws/link_constants.h. */
#ifndef DEMOCLES_LINK_BODY_H
#define DEMOCLES_LINK_BODY_H

#include "kernels/lattice/law_break.h"
#include "kernels/lattice/law_stress.h"
#include "kernels/lattice/law_volume.h"
#include "laws/lattice_limit.h"
#include "laws/link_constants.h"
#include "tests/limit/limit_test.h"

#define BODY_MOST 700
#define BODY_EPS (sizeof(real) == 4 ? 6e-8 : 1.2e-16)

struct body {
    enum link_set set;
    double h; /* [m] */
    int n;
    struct link_material materials[4];
    int at[BODY_MOST][3]; /* place on the grid */
    int neighbour[BODY_MOST][6];
    uint8_t walls[BODY_MOST], material[BODY_MOST];
    pvec3 u[BODY_MOST], theta[BODY_MOST];
    struct quat q[BODY_MOST];
    vec3 v[BODY_MOST], w[BODY_MOST];
    vec3 traction[BODY_MOST][6]; /* on faces without link [Pa] */
    /* results of body_forces */
    vec3 force[BODY_MOST], torque[BODY_MOST];
    real strain[BODY_MOST];                 /* Th */
    struct stress_rows rows[2][BODY_MOST];  /* average; extrapolated */
    int links[BODY_MOST], faces[BODY_MOST]; /* masks: with a link; with a link or a load */
};

/* The cells of a grid for which solid(x, y, z) holds (NULL: all), at rest, of material 0; periodic:
 * bits of axes. */
void body_build(
    struct body *b, const int size[3], int (*solid)(int x, int y, int z), int periodic, double h);
/* Random u, v [m, m/s] and rotations [rad, rad/s] of these sizes. */
void body_shake(struct body *b, double shift, double turn);
/* Turns the whole body by Q about the origin: u, q, v, w and tractions. */
void body_turn(struct body *b, struct quat Q);
/* Centre of cell i: reference, and now [m]. */
pvec3 body_place(const struct body *b, int i);
pvec3 body_now(const struct body *b, int i);
/* Tractions S n on all faces without link; S [Pa]. */
void body_load(struct body *b, const double S[3][3]);

/* The link over face `face` of cell i, in the direction that laws want; `upper`: i is its higher
 * cell. */
struct body_link {
    struct link_cell lower, upper;
    struct link_constants k;
    int axis, i, j; /* lower and higher cell; -1: a wall */
};
struct body_link body_link_of(const struct body *b, int i, int face);

void body_forces(struct body *b);
double body_energy(const struct body *b);      /* [J] */
double body_dissipation(const struct body *b); /* [W] */

/* Static solution by conjugate gradients: u and theta such that forces and torques, with the loads
 * f [n][6] and the tractions of `b`, are zero. free [n][6]: 1 or 0. Small rotations. Returns the
 * residual over the load. */
double body_solve(struct body *b, const double (*f)[6], const int (*free)[6], int rounds);

struct lattice_body body_lattice(const struct body *b);
double body_size(vec3 a); /* |a| */

#endif
