/* What wall_keep.cl leaves for the kernels after it: where the candidates are met, and with whom
 * each forms a valley. */
#ifndef DEMOCLES_WALL_NEAR_H
#define DEMOCLES_WALL_NEAR_H

#include "contact/law_fillet.h"
#include "contact/law_wall.h"
#include "particle_words.h"

#ifdef __OPENCL_VERSION__
LAW struct fillet_plane wall_plane(__global const preal *near, int k)
{
    __global const preal *row = near + (size_t)NEAR_WIDTH * k;
    return fillet_plane(p3(row[0], row[1], row[2]), row[3], row[4]);
}

LAW preal wall_valley(__global const preal *near, int k)
{
    return near[(size_t)NEAR_WIDTH * k + NEAR_VALLEY];
}

/* While `feature` holds the features. */
LAW struct wall_closest wall_near(__global const preal *near, __global const int *feature, int k)
{
    struct fillet_plane p = wall_plane(near, k);
    struct wall_closest c;
    c.D = p3_scale(p.distance, p.n);
    c.n = p.n;
    c.distance = p.distance;
    c.feature = feature[k];
    return c;
}

/* The other side of the valley; out of reach where there is none. */
LAW struct fillet_plane wall_partner(__global const preal *near, int partner)
{
    if (partner < 0) return fillet_plane(p3(0, 0, 1), WALL_FAR, 0);
    return wall_plane(near, partner);
}

/* Whether a candidate touches and is not left to a deeper one. */
LAW int wall_acts(__global const preal *near, __global const int *partner,
    __global const real *keep, int k, preal radius)
{
    return keep[k] > 0 &&
           fillet_of(wall_plane(near, k), wall_partner(near, partner[k]), radius).distance < radius;
}
#endif

#endif
