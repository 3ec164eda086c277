/* Inside is decided by a ray upwards (+z): each triangle above the point, seen from above, adds the
 * winding number of its outline around the ray, and the sum over a closed surface is the winding
 * number of the surface. An edge's side of the ray is computed from its two vertices in one fixed
 * order, so two triangles at an edge, or several at a vertex, always agree whose it is: no ray
 * slips through, none is counted twice, and nothing is jittered. */
#include "solid.h"

#include "bvh.h"
#include "comm/fail.h"
#include "kernels/contact/law_wall.h"

#include <stdlib.h>

struct solid {
    const struct stl *stl;
    struct bvh *bvh;
};

struct solid *solid_create(const struct stl *stl)
{
    struct solid *solid = fail_alloc(sizeof *solid);
    size_t n = (size_t)stl->n_triangle;
    double *low = fail_alloc(3 * n * sizeof *low), *high = fail_alloc(3 * n * sizeof *high);
    for (size_t t = 0; t < n; t++)
        for (int a = 0; a < 3; a++) {
            double p = stl->vertex[3 * stl->triangle[3 * t] + a],
                   q = stl->vertex[3 * stl->triangle[3 * t + 1] + a],
                   s = stl->vertex[3 * stl->triangle[3 * t + 2] + a];
            low[3 * t + (size_t)a] = fmin(fmin(p, q), s);
            high[3 * t + (size_t)a] = fmax(fmax(p, q), s);
        }
    solid->stl = stl;
    solid->bvh = bvh_create(low, high, stl->n_triangle);
    free(low);
    free(high);
    return solid;
}

void solid_free(struct solid *solid)
{
    if (!solid) return;
    bvh_free(solid->bvh);
    free(solid);
}

void solid_bounds(const struct solid *solid, double low[3], double high[3])
{
    for (int a = 0; a < 3; a++) {
        low[a] = solid->bvh->low[a];
        high[a] = solid->bvh->high[a];
    }
}

struct query {
    const struct stl *stl;
    const double *x;
    double nearest; /* distance so far [m] */
    int winding;    /* sum so far */
};

static const double *corner_of(const struct stl *stl, int t, int k)
{
    return stl->vertex + 3 * stl->triangle[3 * t + k];
}

static pvec3 point_of(const double *p)
{
    return p3(p[0], p[1], p[2]);
}

static void visit_distance(int t, void *context)
{
    struct query *query = context;
    struct wall_primitive triangle =
        wall_primitive(point_of(corner_of(query->stl, t, 0)), point_of(corner_of(query->stl, t, 1)),
            point_of(corner_of(query->stl, t, 2)), 0, 0, WALL_TRIANGLE);
    query->nearest =
        fmin(query->nearest, wall_closest_triangle(triangle, point_of(query->x)).distance);
}

double solid_distance(const struct solid *solid, const double x[3], double limit)
{
    struct query query = {.stl = solid->stl, .x = x, .nearest = limit};
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
        low[a] = x[a] - limit;
        high[a] = x[a] + limit;
    }
    bvh_visit(solid->bvh, low, high, visit_distance, &query);
    return query.nearest;
}

/* Twice the signed area of (p, q, x) in the plane; > 0: x is left of p -> q. */
static double side(const double *p, const double *q, const double *x)
{
    return (q[0] - p[0]) * (x[1] - p[1]) - (q[1] - p[1]) * (x[0] - p[0]);
}

/* What the edge p -> q adds to the winding number around x in the plane: +1 (-1) if it crosses,
 * upwards (downwards), the half line from x to the right. Half open in y, so a vertex belongs to
 * one of its edges. Always computed from the lower end to the upper, which is the same for both
 * triangles at the edge. */
static int crossing(const double *p, const double *q, const double *x)
{
    int p_above = p[1] > x[1], q_above = q[1] > x[1];
    if (p_above == q_above) return 0;
    if (q_above) return side(p, q, x) > 0 ? 1 : 0;
    return side(q, p, x) > 0 ? -1 : 0;
}

/* What triangle t adds to the winding number of the points below *height on the line through x and
 * y of x; 0: it does not cross the line. */
static int cross(const struct stl *stl, int t, const double *x, double *height)
{
    const double *p = corner_of(stl, t, 0), *q = corner_of(stl, t, 1), *s = corner_of(stl, t, 2);
    int winding = crossing(p, q, x) + crossing(q, s, x) + crossing(s, p, x);
    if (winding == 0) return 0;
    double area = side(p, q, s), low = fmin(fmin(p[2], q[2]), s[2]),
           high = fmax(fmax(p[2], q[2]), s[2]);
    if (area > 0 || area < 0)
        *height = (side(q, s, x) * p[2] + side(s, p, x) * q[2] + side(p, q, x) * s[2]) / area;
    else *height = low;
    *height = r_clamp(*height, low, high);
    return winding;
}

static void visit_ray(int t, void *context)
{
    struct query *query = context;
    double height;
    int winding = cross(query->stl, t, query->x, &height);
    if (winding != 0 && height > query->x[2]) query->winding += winding;
}

bool solid_contains(const struct solid *solid, const double x[3])
{
    struct query query = {.stl = solid->stl, .x = x};
    double high[3] = {x[0], x[1], HUGE_VAL};
    bvh_visit(solid->bvh, x, high, visit_ray, &query);
    return query.winding != 0;
}

struct column {
    const struct stl *stl;
    const double *x, *z; /* [2], [n] */
    int n;
    int *winding; /* [n]: of a crossing, at the highest point below it */
};

static void visit_column(int t, void *context)
{
    struct column *column = context;
    double height;
    int winding = cross(column->stl, t, column->x, &height), low = 0, high = column->n;
    if (winding == 0) return;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (height > column->z[middle]) low = middle + 1;
        else high = middle;
    }
    if (low > 0) column->winding[low - 1] += winding;
}

void solid_contains_column(
    const struct solid *solid, double x, double y, const double *z, int n, uint8_t *holds)
{
    double low[3] = {x, y, n > 0 ? z[0] : 0}, high[3] = {x, y, HUGE_VAL};
    struct column column = {solid->stl, low, z, n, fail_alloc((size_t)n * sizeof(int))};
    bvh_visit(solid->bvh, low, high, visit_column, &column);
    for (int k = n - 1, sum = 0; k >= 0; k--) {
        sum += column.winding[k];
        holds[k] = sum != 0;
    }
    free(column.winding);
}
