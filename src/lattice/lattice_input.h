/* Turns a scene and its cells into the options of lattice_create. Knows no device. */
#ifndef DEMOCLES_LATTICE_INPUT_H
#define DEMOCLES_LATTICE_INPUT_H

#include "lattice_cells.h"
#include "lattice_features.h"

/* Options, and the tables that they point to. */
struct lattice_input {
    struct lattice_options options;
    struct link_material *material; /* [scene.n_material] */
    double *alpha;                  /* [scene.n_material] [1/s] */
    struct link_strength *strength; /* [cells.n_kind] */
    const struct scene *scene;
    struct lattice_loads *loads;
};

/* dt [s] of a step. `scene` and `cells` are borrowed. */
struct lattice_input *lattice_input_create(
    const struct scene *scene, const struct lattice_cells *cells, double dt);
void lattice_input_free(struct lattice_input *input); /* NULL is fine */

#endif
