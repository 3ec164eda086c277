/* Constants of the lattice's links, cells and limits of strength, from materials and the edge h of
 * a cell. Knows no scene and no body; host only.
 *
 * LINK_ISOTROPIC: kn = ks = 2 G h, kt = G h^3/6, kb = E h^3/12, and lambda of each cell: isotropic
 *     with the E and nu that are asked for. With nu = 0 everywhere lambda is 0 and the volumetric
 *     pass can be left out.
 * LINK_REFERENCE: kn = ks = E h, kt = kb = E h^3, as an earlier solver of this kind has them:
 *     nu = 0 only, and EI is too large by 1 + 11/n^2 for n cells over the thickness. For comparison
 *     with that solver.
 *
 * Different materials: the face between them is the interface, so a link is two halves in series.
 * With M = lambda + 2 G
 *     r_i = 2 M_j/(M_i + M_j), r_j = 2 M_i/(M_i + M_j),  kn = h (G_i r_i^2 + G_j r_j^2)
 * and the others harmonic means,
 * which makes uniaxial strain through layers exact. A rigid wall is the limit of an infinitely
 * stiff j. */
#ifndef DEMOCLES_LINK_CONSTANTS_H
#define DEMOCLES_LINK_CONSTANTS_H

#include <stdbool.h>

enum link_set { LINK_ISOTROPIC, LINK_REFERENCE };

struct link_material {
    double density; /* [kg/m3] */
    double young;   /* E [Pa] */
    double poisson; /* nu [1] */
    double damping; /* Kelvin-Voigt time eta [s] */
};

struct link_stiffness {
    double kn, ks;   /* [N/m] */
    double kt, kb;   /* [N m] */
    double r_i, r_j; /* [1] */
    double eta;      /* [s]: mean of both, or that of the cell at a wall */
};

/* What a material bears; infinity: anything. */
struct link_strength {
    double tension, shear; /* sigma_c, tau_c [Pa] */
    int criterion;         /* BREAK_* of kernels/lattice/law_break.h */
    /* largest principal stress of a cell [Pa], 0: any, and how it rises with its direction [1],
     * kernels/lattice/law_principal.h */
    double principal, rise;
    bool drawn; /* which link then goes is drawn by lot, else the one that is pulled most */
};

/* One over what a link bears, for kernels/lattice/law_break.h; 0: anything. */
struct link_limits {
    double normal, shear; /* [1/N] */
    double bend, twist;   /* [1/(N m)] */
};

/* NULL, or what speaks against the material, as the end of a sentence. */
const char *link_constants_refusal(enum link_set set, struct link_material m);

/* G and lambda [Pa]; lambda is 0 in LINK_REFERENCE. */
double link_constants_shear(struct link_material m);
double link_constants_lambda(enum link_set set, struct link_material m);

/* i: the cell at lower coordinates; h [m]. Swapping the materials swaps r_i and r_j and changes
 * nothing else, to the last bit. */
struct link_stiffness link_constants_between(
    enum link_set set, struct link_material i, struct link_material j, double h);
/* Half a link from the cell i to a rigid wall at its upper face; at its lower face r_i and r_j
 * change places. */
struct link_stiffness link_constants_wall(enum link_set set, struct link_material i, double h);
/* Least size D of a cell that a surface cuts, kernels/lattice/law_volume.h [1]: a quarter of that
 * of a whole cell with one face missing. */
double link_constants_least_size(enum link_set set, struct link_material m);
/* Whether kn != ks, kt != kb: what the kernels have flags for (kernels/lattice/law_link.h). */
bool link_constants_shear_apart(struct link_stiffness k);
bool link_constants_twist_apart(struct link_stiffness k);

/* A cell's mass rho h^3 [kg], and its inertia m h^2/6 about any axis [kg m2]. */
double link_constants_mass(struct link_material m, double h);
double link_constants_inertia(struct link_material m, double h);

/* Of a link: the weaker of both, stress by stress, and the criterion of that with the weaker
 * tension (then shear, then of the smaller number). */
struct link_strength link_constants_weaker(struct link_strength i, struct link_strength j);
/* Stresses at the edge of the face: f_n/h^2 + 6 mom_b/h^3 against sigma_c, f_s/h^2 + 3 mom_t/h^3
 * (polar moment h^4/6) against tau_c. */
struct link_limits link_constants_limits(struct link_strength strength, double h);
/* sigma_c [Pa] for the energy of fracture G_c [J/m2]: a slow crack along the grid then spends G_c
 * per area at any h. The first intact link ahead of a K field carries 0.75 K/sqrt(h) (0.747 to
 * 0.759, nu from 0 to 0.45), so sigma_c = 0.75 sqrt(E' G_c/h) with E' = E in plane stress, E/(1 -
 * nu^2) in plane strain. */
double link_constants_tension(struct link_material m, double energy, double h, bool plane_strain);
/* The same for the largest principal stress of a cell. The worst cell at the tip of a K field bears
 * 0.62 K/sqrt(h) where the crack is along the grid, 0.64 where it is inclined in a plane, 0.63 to
 * 0.70 on {110} and {111} (docs/lattice.md): (0.625 + 0.1 q^2) sqrt(E' G_c/h) is within 4 % of all
 * of them. The strength for q = 0, and what it rises by. */
double link_constants_principal(struct link_material m, double energy, double h, bool plane_strain);
double link_constants_rise(void);

#endif
