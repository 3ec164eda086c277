/* The largest ball that touches a facet between its valleys, for law_fillet.h.
 *
 * A ball of radius rho touches the facet no nearer to a valley than rho tan(angle/2), angle the one
 * by which the neighbour rises. So a point at the distances h_j from the lines of its valleys is
 * touched by balls up to min_j h_j/tan(angle_j/2), and the facet by balls up to the largest of that
 * over its points. A facet is all triangles in one plane that hang together, however it is cut.
 *
 * On a smooth surface this is its radius but for the scatter of the facets, and valleys that meet
 * must be rounded alike for the distance to have no jump. So facets that meet in valleys and agree
 * within a factor ALIKE all get the mean of their surface, sum(area)/sum(area/radius): exactly the
 * radius for a sphere or a pipe of flat strips, however irregular. */
#include "walls.h"

#include "bvh.h"
#include "comm/fail.h"
#include "kernels/contact/law_fillet.h"
#include "kernels/contact/law_wall.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FLAT 1e-4  /* sine of the angle below which two triangles are in one plane */
#define TOUCH 1e-6 /* edges this close, over the extent of the mesh, lie on each other */
#define ALIKE 3.0  /* ratio of rooms on one smooth surface */
#define THIRDS 14  /* cuts of a triangle in the search for the best point: to 0.4 % of its size */

/* Where a neighbour rises at an edge of a triangle. Side 0: that of the normal (b - a) x (c - a);
 * side 1: the other. */
struct valley {
    int edge, side, other, other_side; /* the neighbour */
    double tangent;                    /* of half the angle */
};

/* The line of a valley in the plane of its facet: the distance from it is in.p - offset. */
struct line {
    double in[3], offset, tangent;
};

struct mesh {
    struct walls *walls;
    int first, n; /* primitives */
    double touch; /* [m] */
    struct bvh *bvh;
    int *facet;        /* [n] a triangle that stands for all of the facet */
    int *valley_first; /* [n + 1] valleys of each triangle */
    struct valley *valley;
    struct line *line; /* [n_valley] room for those of one facet */
    int n_valley;
    int triangle, edge; /* whose neighbours are looked for */
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static const double *corner_of(const struct mesh *m, int triangle, int k)
{
    return m->walls->primitive + (size_t)WALL_PRIMITIVE_WIDTH * (size_t)(m->first + triangle) +
           3 * (k % 3);
}

/* An edge as seen from its triangle: unit vectors along it, into the triangle, and the normal. */
struct edge {
    const double *from, *to;
    double along[3], in[3], normal[3], length;
};

static void cross(const double a[3], const double b[3], double c[3])
{
    for (int k = 0; k < 3; k++)
        c[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double unit(double a[3])
{
    double length = sqrt(dot(a, a));
    for (int k = 0; k < 3; k++) a[k] /= length;
    return length;
}

static struct edge edge_of(const struct mesh *m, int triangle, int k)
{
    struct edge e = {.from = corner_of(m, triangle, k), .to = corner_of(m, triangle, k + 1)};
    const double *apex = corner_of(m, triangle, k + 2);
    double up[3];
    for (int a = 0; a < 3; a++) {
        e.along[a] = e.to[a] - e.from[a];
        up[a] = apex[a] - e.from[a];
    }
    e.length = unit(e.along);
    cross(e.along, up, e.normal);
    unit(e.normal);
    cross(e.normal, e.along, e.in);
    return e;
}

static int root_of(int *facet, int k)
{
    while (facet[k] != k) k = facet[k] = facet[facet[k]];
    return k;
}

/* Whether the edges lie on each other somewhere: seams whose vertices are not shared. */
static bool is_seam(const struct mesh *m, const struct edge *e, const struct edge *f)
{
    double place[2];
    for (int end = 0; end < 2; end++) {
        double away[3], square = 0;
        for (int a = 0; a < 3; a++) away[a] = (end ? f->to : f->from)[a] - e->from[a];
        place[end] = dot(away, e->along);
        for (int a = 0; a < 3; a++) {
            double off = away[a] - place[end] * e->along[a];
            square += off * off;
        }
        if (square > m->touch * m->touch) return false;
    }
    return fmax(place[0], place[1]) > m->touch && fmin(place[0], place[1]) < e->length - m->touch;
}

/* Two triangles at an edge: parts of one facet, or a valley between two. */
static void meet(struct mesh *m, int triangle, int k, int other, int l)
{
    struct edge e = edge_of(m, triangle, k), f = edge_of(m, other, l);
    double cosine = -dot(e.in, f.in), rise = dot(e.normal, f.in);
    if (!(cosine > 1 - FILLET_OPEN)) return;
    if (fabs(rise) < FLAT) {
        int a = root_of(m->facet, triangle), b = root_of(m->facet, other);
        m->facet[a > b ? a : b] = a > b ? b : a;
        return;
    }
    if ((m->n_valley & (m->n_valley - 1)) == 0) /* full at every power of two */
        m->valley = fail_realloc(
            m->valley, (size_t)(m->n_valley ? 2 * m->n_valley : 1) * sizeof *m->valley);
    struct valley *v = &m->valley[m->n_valley++];
    v->edge = k;
    v->side = rise < 0;
    v->other = other;
    v->other_side = dot(e.normal, f.normal) > 0 ? v->side : 1 - v->side;
    v->tangent = fabs(rise) / (1 + cosine);
}

static bool is_open(const struct mesh *m, int triangle, int k)
{
    int number = m->walls->features[6 * (m->first + triangle) + k];
    return m->walls->share_first[number + 1] - m->walls->share_first[number] < 2;
}

static void visit(int other, void *context)
{
    struct mesh *m = context;
    if (other == m->triangle) return;
    struct edge e = edge_of(m, m->triangle, m->edge);
    for (int l = 0; l < 3; l++) {
        if (!is_open(m, other, l)) continue;
        struct edge f = edge_of(m, other, l);
        if (is_seam(m, &e, &f)) meet(m, m->triangle, m->edge, other, l);
    }
}

/* The triangles at edge k: those that share it, else those whose edges lie on it. */
static void look_across(struct mesh *m, int triangle, int k)
{
    const struct walls *w = m->walls;
    int number = w->features[6 * (m->first + triangle) + k];
    if (!is_open(m, triangle, k)) {
        for (int s = w->share_first[number]; s < w->share_first[number + 1]; s++) {
            int other = w->share[s] - m->first;
            for (int l = 0; l < 3 && other != triangle; l++)
                if (w->features[6 * w->share[s] + l] == number) meet(m, triangle, k, other, l);
        }
        return;
    }
    const double *p = corner_of(m, triangle, k), *q = corner_of(m, triangle, k + 1);
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
        low[a] = fmin(p[a], q[a]) - m->touch;
        high[a] = fmax(p[a], q[a]) + m->touch;
    }
    if (!m->bvh) m->bvh = bvh_create(w->low + 3 * m->first, w->high + 3 * m->first, m->n);
    m->triangle = triangle;
    m->edge = k;
    bvh_visit(m->bvh, low, high, visit, m);
}

/* Radius of the largest ball that touches the facet at p. */
static double widest_at(const struct line *line, int n, const double p[3])
{
    double widest = HUGE_VAL;
    for (int k = 0; k < n; k++)
        widest = fmin(widest, (dot(line[k].in, p) - line[k].offset) / line[k].tangent);
    return widest;
}

/* The largest of it, a concave function, on the segment from a to b; with an apex, on the triangle:
 * on the segments to the apex. */
static double widest_on(
    const struct line *line, int n, const double a[3], const double b[3], const double *apex)
{
    double low = 0, high = 1, best = -HUGE_VAL;
    for (int k = 0; k < THIRDS; k++) {
        double found[2];
        for (int third = 0; third < 2; third++) {
            double at = low + (1 + third) * (high - low) / 3, p[3];
            for (int d = 0; d < 3; d++) p[d] = a[d] + at * (b[d] - a[d]);
            found[third] = apex ? widest_on(line, n, p, apex, NULL) : widest_at(line, n, p);
            best = fmax(best, found[third]);
        }
        if (found[0] < found[1]) low += (high - low) / 3;
        else high -= (high - low) / 3;
    }
    return best;
}

/* In the triangle, of those of one facet, whose corners and middles of edges do best. */
static double widest_of(const struct mesh *m, const int *triangle, int n_triangle, int n_line)
{
    double best = -HUGE_VAL;
    int where = triangle[0];
    for (int t = 0; t < n_triangle && n_triangle > 1; t++)
        for (int k = 0; k < 3; k++) {
            const double *a = corner_of(m, triangle[t], k), *b = corner_of(m, triangle[t], k + 1);
            double middle[3] = {0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1]), 0.5 * (a[2] + b[2])};
            double found = fmax(widest_at(m->line, n_line, a), widest_at(m->line, n_line, middle));
            if (!(found > best)) continue;
            best = found;
            where = triangle[t];
        }
    return widest_on(
        m->line, n_line, corner_of(m, where, 0), corner_of(m, where, 1), corner_of(m, where, 2));
}

static int lines_of(struct mesh *m, const int *triangle, int n_triangle, int side)
{
    int n = 0;
    for (int t = 0; t < n_triangle; t++)
        for (int k = m->valley_first[triangle[t]]; k < m->valley_first[triangle[t] + 1]; k++) {
            if (m->valley[k].side != side) continue;
            struct edge e = edge_of(m, triangle[t], m->valley[k].edge);
            struct line *line = &m->line[n++];
            memcpy(line->in, e.in, sizeof line->in);
            line->offset = dot(e.in, e.from);
            line->tangent = m->valley[k].tangent;
        }
    return n;
}

/* Triangles in the order of their facets. */
static int *by_facet(const struct mesh *m, int *first)
{
    int *order = fail_alloc((size_t)m->n * sizeof *order);
    for (int t = 0; t < m->n; t++) first[root_of(m->facet, t) + 2]++;
    for (int f = 0; f < m->n; f++) first[f + 2] += first[f + 1];
    for (int t = 0; t < m->n; t++) order[first[root_of(m->facet, t) + 1]++] = t;
    return order;
}

/* [2 n] by triangle and side. */
static double *rooms_of(struct mesh *m)
{
    double *room = fail_alloc(2 * (size_t)m->n * sizeof *room);
    int *first = fail_alloc(((size_t)m->n + 2) * sizeof *first), *order = by_facet(m, first);
    m->line = fail_alloc(((size_t)m->n_valley + 1) * sizeof *m->line);
    for (int f = 0; f < m->n; f++) {
        const int *triangle = order + first[f];
        int n_triangle = first[f + 1] - first[f];
        for (int side = 0; side < 2 && n_triangle > 0; side++) {
            int n = lines_of(m, triangle, n_triangle, side);
            double widest = n ? widest_of(m, triangle, n_triangle, n) : WALL_FAR;
            for (int t = 0; t < n_triangle; t++)
                room[2 * triangle[t] + side] = fmin(fmax(widest, 0), WALL_FAR);
        }
    }
    free(order);
    free(first);
    free(m->line);
    return room;
}

/* Numbers of surfaces [2 n]; facets are one already. */
static int *surfaces_of(struct mesh *m, const double *room)
{
    int *surface = fail_alloc(2 * (size_t)m->n * sizeof *surface);
    for (int k = 0; k < 2 * m->n; k++) surface[k] = 2 * root_of(m->facet, k / 2) + k % 2;
    for (int t = 0; t < m->n; t++)
        for (int k = m->valley_first[t]; k < m->valley_first[t + 1]; k++) {
            const struct valley *v = &m->valley[k];
            int a = 2 * t + v->side, b = 2 * v->other + v->other_side;
            if (room[a] > ALIKE * room[b] || room[b] > ALIKE * room[a]) continue;
            a = root_of(surface, a);
            b = root_of(surface, b);
            surface[a > b ? a : b] = a > b ? b : a;
        }
    for (int k = 0; k < 2 * m->n; k++) surface[k] = root_of(surface, k);
    return surface;
}

static double area_of(const struct mesh *m, int triangle)
{
    struct edge e = edge_of(m, triangle, 0);
    double up[3];
    for (int a = 0; a < 3; a++) up[a] = corner_of(m, triangle, 2)[a] - e.from[a];
    return 0.5 * e.length * dot(up, e.in);
}

/* The mean of each surface into the rows of its triangles. */
static void give_rooms(struct mesh *m, const double *room, const int *surface)
{
    double *area = fail_alloc(2 * (size_t)m->n * sizeof *area),
           *bent = fail_alloc(2 * (size_t)m->n * sizeof *bent);
    for (int k = 0; k < 2 * m->n; k++) {
        double own = area_of(m, k / 2);
        area[surface[k]] += own;
        bent[surface[k]] += own / fmax(room[k], DBL_MIN);
    }
    for (int k = 0; k < 2 * m->n; k++)
        m->walls->primitive[(size_t)WALL_PRIMITIVE_WIDTH * (size_t)(m->first + k / 2) + 9 +
                            (size_t)(k % 2)] =
            room[k] < WALL_FAR ? area[surface[k]] / bent[surface[k]] : WALL_FAR;
    free(area);
    free(bent);
}

void walls_room(struct walls *walls, int w)
{
    struct mesh m = {
        .walls = walls, .first = walls->first[w], .n = walls->first[w + 1] - walls->first[w]};
    if (walls->wall[w].kind != SURFACE_STL || m.n == 0) return;
    m.facet = fail_alloc((size_t)m.n * sizeof *m.facet);
    m.valley_first = fail_alloc(((size_t)m.n + 1) * sizeof *m.valley_first);
    for (int a = 0; a < 3; a++)
        m.touch = fmax(m.touch, TOUCH * (walls->wall_high[3 * w + a] - walls->wall_low[3 * w + a]));
    for (int t = 0; t < m.n; t++) m.facet[t] = t;
    for (int t = 0; t < m.n; t++) {
        for (int k = 0; k < 3; k++) look_across(&m, t, k);
        m.valley_first[t + 1] = m.n_valley;
    }
    double *room = rooms_of(&m);
    int *surface = surfaces_of(&m, room);
    give_rooms(&m, room, surface);
    free(room);
    free(surface);
    bvh_free(m.bvh);
    free(m.facet);
    free(m.valley_first);
    free(m.valley);
}
