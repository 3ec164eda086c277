/* What a lattice scene needs of the kernels, and nothing more: each 0 or 1. Knows scene and cells; no device. */
#ifndef DEMOCLES_LATTICE_FEATURES_H
#define DEMOCLES_LATTICE_FEATURES_H

#include "lattice_cells.h"

struct lattice_features {
    bool real_is_float, position_is_float;
    bool turn;                     /* finite rotations */
    bool volume;                   /* the volumetric term: some Poisson's ratio is not 0 */
    bool shear_apart, twist_apart; /* links with kn != ks, kt != kb */
    bool link_damping, mass_damping;
    bool fix, loads, gravity;
    bool kinds; /* more than one */
    bool rk;    /* stages of a Runge-Kutta scheme */
    bool stress, breakage, relax;
};

struct lattice_features lattice_features_of(const struct scene *scene, const struct lattice_cells *cells);

/* Names and values, for run.json and `check`: i = 0, 1, ... until the name is NULL. */
const char *lattice_features_name(int i);
bool lattice_features_value(const struct lattice_features *features, int i);

#endif
