/* The inside of a closed surface: is a sphere wholly within it? */
#ifndef DEMOCLES_SOLID_H
#define DEMOCLES_SOLID_H

#include "stl.h"

#include <stdint.h>

struct solid;

/* The mesh must be closed (stl_is_closed) and outlive the solid. Surfaces may turn either way and
 * may be several that overlap: inside is where the winding number is not 0. */
struct solid *solid_create(const struct stl *stl);
void solid_free(struct solid *solid);

/* Distance from x to the surface [m], or `limit` if nothing is nearer than that. */
double solid_distance(const struct solid *solid, const double x[3], double limit);
/* Whether the point x is inside. Exact but for points that lie on the surface to rounding: edges
 * and vertices over x are counted once. */
bool solid_contains(const struct solid *solid, const double x[3]);
/* The same for the points (x, y, z[k]), whose n heights ascend, with one walk through the surface:
 * holds[k] is 1 or 0. */
void solid_contains_column(
    const struct solid *solid, double x, double y, const double *z, int n, uint8_t *holds);
/* The mesh's bounds [m]. */
void solid_bounds(const struct solid *solid, double low[3], double high[3]);

#endif
