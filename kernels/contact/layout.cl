/* How wide contacts of this program are in memory, told to the host by the same text that the
 * kernels use. */
#include "contact_memory.h"

__kernel __attribute__((reqd_work_group_size(1, 1, 1))) void layout(__global int *out)
{
    if (get_global_id(0) > 0) return;
    out[0] = HISTORY_WIDTH;
    out[1] = RESULT_WIDTH;
    out[2] = WITH_HISTORY;
}
