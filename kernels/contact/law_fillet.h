/* Contacts of a sphere with a smoothly bent mesh: which of several act, and the valley between two
 * of them.
 *
 * On a mesh a sphere has one contact for each local minimum of the distance (law_wall.h). In a
 * valley that is flat enough these overlap at once, though the surface that the mesh stands for is
 * met once, and each one ends with a jump when its foot leaves its triangle. So of contacts of one
 * wall whose normals are close that in the deepest valley acts, and the valley between it and its
 * neighbour is rounded: a ball of radius rho, a little larger than the sphere, rolls through it and
 * cannot reach further. With c = n_i.n_j and b = rho - distance that surface lies at the distance
 *
 *     rho - ((b_i^2 + b_j^2 - 2 c b_i b_j)/(1 - c^2))^(1/2)   where b_i > c b_j and b_j > c b_i,
 *     the smaller of both elsewhere;
 *
 * normal: (m_i n_i + m_j n_j)/|...|, m_i = (b_i - c b_j)/(1 - c^2). For two faces this is a
 * distance: its gradient is a unit vector and has no jump. So the force is that of a potential, the
 * energy of the law at the rounded distance, and an error of the step is of second order. A face
 * whose foot has come to an edge of a nearer face has distance = (nearer distance)/c, and
 * rho < (1 + c) distance says that it has no part any more: contacts come and go without a trace.
 * Normals that agree leave the valley as it is, to the last bit.
 *
 * How close: the contact that is less deep acts with the factor 1 - fillet_hides(c), from 0 at
 * FILLET_SMOOTH to 1 at FILLET_CORNER, a band because normals at edges and corners turn as the
 * sphere moves. rho falls to the radius at FILLET_OPEN, so corners keep their shape.
 *
 * The smallest distance in any valley is continuous: it is the potential's argument, also where the
 * nearest face has no part in it, as a facet that the ball cannot touch between its neighbours. */
#ifndef DEMOCLES_LAW_FILLET_H
#define DEMOCLES_LAW_FILLET_H

#include "common/vec.h"

/* Constants carry their type: a device without doubles rejects a cast one. */
#if POSITION_IS_FLOAT
#define FILLET_SMOOTH 0.9063078f /* cos 25 degrees */
#define FILLET_CORNER 0.8191520f /* cos 35 degrees */
#define FILLET_OPEN 0.1339746f   /* 1 - cos 30 degrees */
#define FILLET_ROOM 0.1f         /* rho/radius - 1 in the flattest valley */
#define FILLET_REACH 1.004f      /* no contact farther away than that, in radii, has a part */
#define FILLET_TINY 1e-9f        /* 1 - c of normals that agree to rounding */
#else
#define FILLET_SMOOTH 0.90630778703664996
#define FILLET_CORNER 0.81915204428899178
#define FILLET_OPEN 0.13397459621556135
#define FILLET_ROOM 0.1
#define FILLET_REACH 1.004
#define FILLET_TINY 1e-13
#endif

/* A plane seen from the centre: unit vector towards it, and how far [m]. */
struct fillet_plane {
    pvec3 n;
    preal distance;
    /* radius of the largest ball that touches the facets of this surface between their valleys,
     * WALL_FAR on a facet without one [m] */
    preal room;
};

LAW struct fillet_plane fillet_plane(pvec3 n, preal distance, preal room)
{
    struct fillet_plane p;
    p.n = n;
    p.distance = distance;
    p.room = room;
    return p;
}

/* rho - radius in the flattest valley between two facets: at most half of what they leave, since a
 * ball that cannot touch them makes valleys of faces that are no neighbours. */
LAW preal fillet_grown(preal radius, preal room_i, preal room_j)
{
    preal left = (preal)0.5 * (r_min(room_i, room_j) - radius);
    return r_min(radius * FILLET_ROOM, r_max(left, (preal)0));
}

/* Which of two contacts acts for the other: the deeper one in its valley, else, where both form the
 * same valley, the deeper face, else the lower number. */
LAW int fillet_is_first(
    preal valley, preal distance, int k, preal other_valley, preal other_distance, int other)
{
    if (valley < other_valley || other_valley < valley) return valley < other_valley;
    return distance < other_distance || (!(other_distance < distance) && k < other);
}

/* How much of a contact a deeper one takes, 0 to 1: the smooth step of the cosine. */
LAW preal fillet_hides(preal cosine)
{
    preal t = (cosine - FILLET_CORNER) / (FILLET_SMOOTH - FILLET_CORNER);
    t = r_clamp(t, (preal)0, (preal)1);
    return t * t * ((preal)3 - t - t);
}

/* The deeper contact i with its neighbour j. e = 1 - c is formed from the difference of the
 * normals, which keeps all digits. */
LAW struct fillet_plane fillet_of(struct fillet_plane i, struct fillet_plane j, preal radius)
{
    struct fillet_plane r;
    pvec3 apart = p3_sub(i.n, j.n);
    preal e = (preal)0.5 * p3_dot(apart, apart);
    preal rho =
        radius + fillet_grown(radius, i.room, j.room) * r_max((preal)1 - e / FILLET_OPEN, (preal)0);
    preal b_i = rho - i.distance, b_j = rho - j.distance, gap = b_i - b_j;
    int meet = e > FILLET_TINY && e < FILLET_OPEN && gap + e * b_j > 0 && e * b_i > gap;
    preal safe = meet ? e : (preal)1;
    preal sum = b_i + b_j, two = (preal)2 - safe;
    preal b = p_sqrt((preal)0.5 * (sum * sum / two + gap * gap / safe));
    preal scale = (preal)1 / (meet ? two * b : (preal)1);
    preal m_i = scale * (b_j + gap / safe), m_j = scale * (b_i - gap / safe);
    r.n.x = meet ? m_i * i.n.x + m_j * j.n.x : i.n.x;
    r.n.y = meet ? m_i * i.n.y + m_j * j.n.y : i.n.y;
    r.n.z = meet ? m_i * i.n.z + m_j * j.n.z : i.n.z;
    r.distance = meet ? rho - b : i.distance;
    r.room = i.room;
    return r;
}

#endif
