/* The same law, compiled with different features: law_variant.c is built once for each, with its
 * own name. */
#ifndef DEMOCLES_LAW_VARIANT_H
#define DEMOCLES_LAW_VARIANT_H

#include "kernels/contact/law_contact.h"

struct variant_input {
    pvec3 D;
    struct kinematics_motion m;
    real r_i, r_j, dt;
    struct contact_parameters p;
    struct contact_history h;
};

struct variant_output {
    struct contact_result r;
    struct contact_history h;
    real l_i, l_j;
};

typedef struct variant_output variant_law(const struct variant_input *in);

variant_law variant_all;             /* every feature */
variant_law variant_linear;          /* linear, nothing else */
variant_law variant_linear_friction; /* linear, undamped friction */
variant_law variant_linear_damped;   /* linear, damped friction */
variant_law variant_linear_bond;     /* linear, damped friction, binding */
variant_law variant_linear_cdt;
variant_law variant_linear_epsd;
variant_law variant_linear_cut;    /* linear, no attraction */
variant_law variant_hertz;         /* Hertz, nothing else */
variant_law variant_hertz_damped;  /* Hertz, damped friction */
variant_law variant_hertz_choices; /* the same, with all that other codes do */

#endif
