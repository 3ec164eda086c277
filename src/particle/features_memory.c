/* Device memory per element, from the widths that the kernels themselves use
 * (contact_memory.h). */
#include "features.h"

#include "kernels/contact/contact_memory.h"
#include "kernels/particle/particle_words.h"
#include "particles.h"

/* What the program of pairs is built with. */
#define HAS(flag) feature_table_option(features_table, features, FEATURES_PAIR, "WITH_" #flag)

/* Two generations of lists and of what contacts remember, one of results and losses. Rows list a
 * pair twice, with index and gid. */
double features_pair_bytes(const struct features *features)
{
    size_t real_bytes = particles_real(features), whole = sizeof(cl_int); /* [byte] */
    /* rows; pair_i, pair_j, incidence of both */
    size_t list = 2 * (whole + sizeof(cl_long)) + 4 * whole;
    if (HISTORY_OF(HAS)) list += whole + (size_t)HISTORY_WIDTH_OF(HAS) * real_bytes;
    return (double)(2 * list + (size_t)RESULT_WIDTH_OF(HAS) * real_bytes +
                    (HAS(ENERGY) ? LEDGER_WIDTH * sizeof(cl_double) : 0));
}

/* State now and spare, place and reach of the last lists, force and torque; indices of cells, lists
 * and owners. */
double features_element_bytes(const struct features *features)
{
    /* [byte] */
    size_t real_bytes = particles_real(features), preal_bytes = particles_preal(features);
    size_t carried =
        particles_record(features) + sizeof(cl_long) + (features->orientation ? 4 * real_bytes : 0);
    size_t own = 5 * preal_bytes + (features->spin ? 8 : 4) * real_bytes;
    /* pairs, twice; interior, boundary; cells and their members; owners and ghosts; neighbours as
     * found */
    size_t indices = (2 * 5 + 2 + 4 + 5 + ROW_FOUND) * sizeof(cl_int);
    return (double)(2 * carried + own + indices);
}
