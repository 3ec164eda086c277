/* Contacts of one sphere with walls, as the rules of law_wall.h say: the reference of the device's
 * wall kernels. */
#ifndef WALL_REFERENCE_H
#define WALL_REFERENCE_H

#include "kernels/contact/law_wall.h"
#include "shape/walls.h"

/* For the candidates (primitives, ascending) at the given poses [n_wall]: returns how many contacts
 * are left; their primitives go to kept and their geometry in world coordinates to closest, both
 * [n_candidate]. The distance is not tested against the radius. */
int reference_contacts(const struct walls *walls, const struct wall_pose *pose, const double x[3],
    double radius, const int *candidate, int n_candidate, int *kept, struct wall_closest *closest);

#endif
