#include "law_variant.h"

struct variant_output VARIANT(const struct variant_input *in) {
    struct contact_kinematics k = contact_kinematics_pair(in->D, in->m, in->r_i, in->r_j, in->dt);
    struct variant_output out;
    out.h = in->h;
    out.r = contact_law(k, in->p, in->dt, &out.h);
    out.l_i = k.l_i;
    out.l_j = k.l_j;
    return out;
}
