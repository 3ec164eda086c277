/* Where a wall is at a step, as the kernels see it: a row of POSE_WIDTH preal per wall, from
 * walls_poses of src/shape/walls.h. */
#ifndef DEMOCLES_WALL_POSE_H
#define DEMOCLES_WALL_POSE_H

#include "contact/law_wall.h"
#include "particle_words.h"

#ifdef __OPENCL_VERSION__
LAW struct wall_frame pose_frame(__global const preal *p)
{
    struct wall_frame f;
    f.row_x = p3(p[0], p[1], p[2]);
    f.row_y = p3(p[3], p[4], p[5]);
    f.row_z = p3(p[6], p[7], p[8]);
    f.t = p3(p[9], p[10], p[11]);
    return f;
}
#endif

#endif
