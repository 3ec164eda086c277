/* Device memory per element, from the widths that the kernels themselves use: their WITH_ switches
 * are read here at run time. */
#include "check_parts.h"

#include "particle/particles.h"

/* Widths of contact_memory.h, for the features of one program. The laws of that header are not
 * used. */
#define WITH_LINEAR 1
#define WITH_HERTZ 1
#define WITH_NO_ATTRACTION 1
#define WITH_TANGENTIAL 1
#define WITH_TANGENTIAL_DAMPING 1
#define WITH_ROLLING_CDT 1
#define WITH_ROLLING_EPSD 1
#define WITH_BINDING 1
#define WITH_ENERGY 1
#define WITH_SIZES 1
#define WITH_MOVING 0 /* of the program of pairs */
#include "kernels/contact/contact_memory.h"
#undef WITH_TANGENTIAL
#undef WITH_TANGENTIAL_DAMPING
#undef WITH_ROLLING_CDT
#undef WITH_ROLLING_EPSD
#undef WITH_BINDING
#undef WITH_ENERGY
#undef WITH_SIZES
#define WITH_TANGENTIAL (features->pair.tangential)
#define WITH_TANGENTIAL_DAMPING (features->pair.tangential_damping)
#define WITH_ROLLING_CDT (features->pair.rolling_cdt)
#define WITH_ROLLING_EPSD (features->pair.rolling_epsd)
#define WITH_BINDING (features->pair.binding)
#define WITH_ENERGY (features->energy)
#define WITH_SIZES (features->sizes)

enum { ROW_FOUND = 32 }; /* as in kernels/particle/rows.cl */

/* Two generations of lists and of what contacts remember, one of results and losses. Rows list a
 * pair twice, with index and gid. */
double check_pair_bytes(const struct features *features)
{
    size_t real_bytes = particles_real(features), whole = sizeof(cl_int); /* [byte] */
    /* rows; pair_i, pair_j, incidence of both */
    size_t list = 2 * (whole + sizeof(cl_long)) + 4 * whole;
    if (WITH_HISTORY) list += whole + (size_t)(HISTORY_WIDTH)*real_bytes;
    return (double)(2 * list + (size_t)(RESULT_WIDTH)*real_bytes +
                    (WITH_ENERGY ? LEDGER_WIDTH * sizeof(cl_double) : 0));
}

/* State now and spare, place and reach of the last lists, force and torque; indices of cells, lists
 * and owners. */
double check_element_bytes(const struct features *features)
{
    /* [byte] */
    size_t real_bytes = particles_real(features), preal_bytes = particles_preal(features);
    size_t carried = 4 * preal_bytes + (features->spin ? 8 : 4) * real_bytes + sizeof(cl_long) +
                     (features->orientation ? 4 * real_bytes : 0);
    size_t own = 5 * preal_bytes + (features->spin ? 8 : 4) * real_bytes;
    /* pairs, twice; interior, boundary; cells and their members; owners and ghosts; neighbours as
     * found */
    size_t indices = (2 * 5 + 2 + 4 + 5 + ROW_FOUND) * sizeof(cl_int);
    return (double)(2 * carried + own + indices);
}
