/* Regions of a scene as sets of points: bounds, and what is inside. */
#ifndef DEMOCLES_REGION_H
#define DEMOCLES_REGION_H

#include "scene/scene.h"
#include "solid.h"

#include <stdint.h>

/* A region that has been opened; region_close frees what it holds. */
struct region_shape {
    const struct region *region;
    double low[3], high[3]; /* bounds [m]; infinite of REGION_ALL */
    double axis[3], length; /* of a cylinder: unit vector, [m] */
    struct stl *stl;        /* of REGION_STL */
    struct solid *solid;
};

/* NULL, or why the region cannot be used (its file, its surface), owned by the caller. The region
 * must outlive the shape. */
char *region_open(struct region_shape *shape, const struct region *region);
void region_close(struct region_shape *shape);

/* Whether x is inside, and at least `inset` [m] away from the surface. A negative inset takes in
 * points so far outside (not with STL surfaces). */
bool region_holds(const struct region_shape *shape, const double x[3], double inset);

/* A column of points x, y, z[k]: holds[k] as region_holds gives it, for n heights that ascend. One
 * walk through an STL surface for all. */
void region_column(const struct region_shape *shape, double x, double y, const double *z, int n,
    double inset, uint8_t *holds);

#endif
