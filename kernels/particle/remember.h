/* Whether a contact has anything to remember: state bits, or a plane of its history that is not
 * zero. A dashpot acts up to half a step before the touch and after it, and with energy accounted
 * for its force is kept, without a state bit. */
#ifndef DEMOCLES_REMEMBER_H
#define DEMOCLES_REMEMBER_H

#include "common/types.h"

#ifdef __OPENCL_VERSION__
/* history: planes [width][capacity]; p: the contact. */
LAW int contact_remembers(int state, __global const real *history, int width, int capacity, int p)
{
    int kept = state != 0;
    for (int c = 0; c < width && !kept; c++) kept = history[(size_t)c * capacity + p] != 0;
    return kept;
}
#endif

#endif
