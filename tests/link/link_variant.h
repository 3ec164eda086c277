/* The law of one link, compiled once for each set of features: link_variant.c with its own name. */
#ifndef DEMOCLES_LINK_VARIANT_H
#define DEMOCLES_LINK_VARIANT_H

#include "kernels/lattice/law_link.h"

struct variant_input {
    int axis;
    struct link_cell lower, upper;
    struct link_constants k;
    real p_i, p_j;
};

struct variant_output {
    struct link_share lower, upper;
};

typedef struct variant_output variant_link(const struct variant_input *in);

variant_link small_all, small_bare, small_volume, small_damped;
variant_link turn_all, turn_bare, turn_volume, turn_shear, turn_twist, turn_damped;

#endif
