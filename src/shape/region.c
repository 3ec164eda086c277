#include "region.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "comm/fail.h"

static char *open_cylinder(struct region_shape *s)
{
    const struct region *r = s->region;
    for (int a = 0; a < 3; a++) s->axis[a] = r->to[a] - r->from[a];
    if (!vector_is_direction(s->axis)) return fail_format("the region's cylinder has no length");
    s->length = vector_normalise(s->axis);
    for (int a = 0; a < 3; a++) {
        double reach = r->radius * sqrt(fmax(0, 1 - s->axis[a] * s->axis[a]));
        s->low[a] = fmin(r->from[a], r->to[a]) - reach;
        s->high[a] = fmax(r->from[a], r->to[a]) + reach;
    }
    return NULL;
}

static char *open_stl(struct region_shape *s)
{
    const struct region *r = s->region;
    char *text = NULL;
    s->stl = stl_read(r->stl, r->scale, &text);
    if (!s->stl) return text;
    if (!stl_is_closed(s->stl))
        return fail_format(
            "%s: a region needs a closed surface with triangles that all face one way: %d of its "
            "%d edges do not match",
            r->stl, s->stl->n_open, s->stl->n_edge);
    s->solid = solid_create(s->stl);
    solid_bounds(s->solid, s->low, s->high);
    return NULL;
}

char *region_open(struct region_shape *s, const struct region *r)
{
    *s = (struct region_shape){.region = r};
    for (int a = 0; a < 3; a++) {
        s->low[a] = r->kind == REGION_BOX      ? r->min[a]
                    : r->kind == REGION_SPHERE ? r->center[a] - r->radius
                                               : -HUGE_VAL;
        s->high[a] = r->kind == REGION_BOX      ? r->max[a]
                     : r->kind == REGION_SPHERE ? r->center[a] + r->radius
                                                : HUGE_VAL;
    }
    return r->kind == REGION_CYLINDER ? open_cylinder(s)
           : r->kind == REGION_STL    ? open_stl(s)
                                      : NULL;
}

void region_close(struct region_shape *s)
{
    solid_free(s->solid);
    stl_free(s->stl);
    *s = (struct region_shape){0};
}

static double distance_squared(const double x[3], const double y[3])
{
    return (x[0] - y[0]) * (x[0] - y[0]) + (x[1] - y[1]) * (x[1] - y[1]) +
           (x[2] - y[2]) * (x[2] - y[2]);
}

bool region_holds(const struct region_shape *s, const double x[3], double inset)
{
    const struct region *r = s->region;
    double along = 0, square = 0;
    switch (r->kind) {
    case REGION_BOX:
        for (int a = 0; a < 3; a++)
            if (x[a] - inset < r->min[a] || x[a] + inset > r->max[a]) return false;
        return true;
    case REGION_SPHERE: return sqrt(distance_squared(x, r->center)) + inset <= r->radius;
    case REGION_STL:
        return solid_contains(s->solid, x) &&
               (inset <= 0 || solid_distance(s->solid, x, inset) >= inset);
    case REGION_CYLINDER:
        for (int a = 0; a < 3; a++) along += (x[a] - r->from[a]) * s->axis[a];
        for (int a = 0; a < 3; a++) {
            double across = x[a] - r->from[a] - along * s->axis[a];
            square += across * across;
        }
        return along >= inset && along <= s->length - inset && sqrt(square) + inset <= r->radius;
    case REGION_ALL: break;
    }
    return true;
}

void region_column(const struct region_shape *s, double x, double y, const double *z, int n,
    double inset, uint8_t *holds)
{
    if (s->region->kind == REGION_STL && inset <= 0) {
        solid_contains_column(s->solid, x, y, z, n, holds);
        return;
    }
    for (int k = 0; k < n; k++) holds[k] = region_holds(s, (double[3]){x, y, z[k]}, inset);
}
