/* Contacts of one sphere with walls, as the rules of law_wall.h and law_fillet.h say: the reference
 * of the device's wall kernels. */
#ifndef WALL_REFERENCE_H
#define WALL_REFERENCE_H

#include "kernels/contact/law_fillet.h"
#include "kernels/contact/law_wall.h"
#include "shape/walls.h"

struct reference_contact {
    int primitive;
    struct wall_closest closest; /* in world coordinates */
    int partner;                 /* contact on the other side of its valley, -1: none */
    preal share;                 /* with which it acts */
    struct fillet_plane valley;  /* where it acts */
};

/* For the candidates (primitives, ascending) at the given poses [n_wall]: returns how many local
 * minima of the distance there are; they go to out [n_candidate]. The distance is not tested
 * against the radius. */
int reference_contacts(const struct walls *walls, const struct wall_pose *pose, const double x[3],
    double radius, const int *candidate, int n_candidate, struct reference_contact *out);

/* Whether a primitive is a plane, a rectangle or a triangle. */
bool reference_is_flat(const struct walls *walls, int primitive);

/* Whether that primitive is one of the n contacts and touches a sphere. */
bool reference_acts(const struct reference_contact *contact, int n, int primitive, preal radius);

#endif
