#include "link_variant.h"

/* As kernels call it: a constant axis. */
static struct variant_output along(int axis, const struct variant_input *in)
{
    struct link_state s = link_state_of(axis, in->lower, in->upper, in->k);
    struct link_force f = link_force_of(s, in->k, in->p_i, in->p_j);
    struct variant_output out = {link_on_lower(axis, s, f), link_on_upper(axis, s, f)};
    return out;
}

struct variant_output VARIANT(const struct variant_input *in) {
    if (in->axis == 0) return along(0, in);
    if (in->axis == 1) return along(1, in);
    return along(2, in);
}
