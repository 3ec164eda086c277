/* The features that a lattice needs of its kernels, and the tables of constants that these read.
 * Knows no device. */
#ifndef DEMOCLES_LATTICE_FEATURES_H
#define DEMOCLES_LATTICE_FEATURES_H

#include <stdbool.h>

#include "device/feature_table.h"
#include "lattice_layout.h"
#include "laws/lattice_schemes.h"

/* Rows of loads at time t [s], double [n_row][LOAD_WIDTH]; velocities as means over [from, to] [s],
 * or their values if from == to. */
typedef void lattice_rows_at(void *context, double t, double from, double to, double *rows);

struct lattice_options {
    double dt; /* [s] */
    enum lattice_scheme scheme;
    bool turn;   /* any rotation, else small ones */
    bool energy; /* keep the account of work and losses; for devices with double precision */
    bool real_is_float, position_is_float;
    double gravity[3]; /* [m/s2] */
    enum link_set set;
    /* [n_material], with damping of links; borrowed for the lattice's life */
    const struct link_material *material;
    /* [n_material] mass-proportional damping [1/s]; NULL: none */
    const double *alpha;
    int n_material;
    const struct link_strength *strength; /* [n_kind of the cells]; NULL: nothing breaks */
    int n_row;                            /* rows of loads; up to 1: no loads */
    lattice_rows_at *rows_at;
    void *context;
    struct lattice_lay run; /* length 0: what suits the body */
    struct scene_partition partition;
    /* [n_rank] of the work that each rank is to have (partition.h); NULL: equal ones */
    const int64_t *share;
};

struct lattice_features {
    bool real_is_float, position_is_float;
    bool turn;                     /* any rotation */
    bool volume;                   /* some Poisson's ratio is not 0 */
    bool shear_apart, twist_apart; /* links with kn != ks, kt != kb */
    bool link_damping, mass_damping;
    bool fix, loads, gravity;
    bool kinds;       /* more than one */
    bool rk, nystrom; /* stages of a Runge-Kutta scheme; of Nystrom's */
    bool energy;      /* work and losses are accounted for */
    bool breakage;
    bool shares;    /* cells that a curved surface cuts */
    bool principal; /* by the stress of cells: kernels/lattice/link_principal.cl */
};

struct lattice_features lattice_features_of(
    const struct lattice_cells *cells, const struct lattice_options *o);
extern const struct feature_row lattice_features_table[];
/* Build options; the caller frees. */
char *lattice_features_options(
    const struct lattice_features *f, const struct lattice_layout *layout);
/* Tables of kernels/lattice/lattice_state.h; the caller frees: links [n_kind][n_kind][LINK_WIDTH],
 * cells [n_kind][CELL_WIDTH]. */
double *lattice_features_links(const struct lattice_cells *cells, const struct lattice_options *o);
/* Limits [n_kind][n_kind][BREAK_WIDTH]; options have strengths. */
double *lattice_features_limits(const struct lattice_cells *cells, const struct lattice_options *o);
/* One over the largest principal stress that cells bear [n_kind] [1/Pa], 0: any; then its rise
 * [n_kind], as kernels/lattice/law_principal.h. */
double *lattice_features_principal(
    const struct lattice_cells *cells, const struct lattice_options *o);
/* Where in [0, 1) the lot of cell i falls (kernels/lattice/law_principal.h), below 0 where none is
 * drawn. */
double lattice_features_lot(
    const struct lattice_cells *cells, const struct lattice_options *o, int64_t i);
/* Shares [n_share][SHARE_WIDTH]. */
double *lattice_features_shares(const struct lattice_cells *cells, const struct lattice_options *o);
double *lattice_features_cells(const struct lattice_cells *cells, const struct lattice_options *o);
/* Kicks [n + 2][n_kind][KICK_WIDTH] of a splitting: its evaluations; the first that ends a step
 * only; the first that begins one only. */
double *lattice_features_kicks(const struct lattice_cells *cells, const struct lattice_options *o);

#endif
