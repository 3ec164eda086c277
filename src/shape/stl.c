/* Corners of triangles (stl_file.h) become a welded mesh. */
#include "stl.h"

#include "base/whole.h"
#include "comm/fail.h"
#include "stl_file.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* Vertices in cells of a hash table: two corners within `near` of each other in each coordinate are
 * one. */
struct weld {
    double near;
    size_t mask;
    int *head, *next; /* by hash; by vertex */
};

static size_t weld_hash(const struct weld *weld, int64_t i, int64_t j, int64_t k)
{
    uint64_t h = (uint64_t)i * 0x9e3779b97f4a7c15u ^ (uint64_t)j * 0xbf58476d1ce4e5b9u ^
                 (uint64_t)k * 0x94d049bb133111ebu;
    return (size_t)(h ^ h >> 31) & weld->mask;
}

/* Cells are 4 near wide, so most corners have but one cell within reach. */
static int weld_vertex(struct weld *weld, struct stl *stl, const double x[3])
{
    int64_t from[3], to[3];
    for (int a = 0; a < 3; a++) {
        from[a] = whole_floor((x[a] - weld->near) / (4 * weld->near));
        to[a] = whole_floor((x[a] + weld->near) / (4 * weld->near));
    }
    for (int64_t i = from[0]; i <= to[0]; i++)
        for (int64_t j = from[1]; j <= to[1]; j++)
            for (int64_t k = from[2]; k <= to[2]; k++)
                for (int v = weld->head[weld_hash(weld, i, j, k)]; v >= 0; v = weld->next[v]) {
                    const double *y = stl->vertex + 3 * v;
                    if (fabs(x[0] - y[0]) <= weld->near && fabs(x[1] - y[1]) <= weld->near &&
                        fabs(x[2] - y[2]) <= weld->near)
                        return v;
                }
    int v = stl->n_vertex++;
    int64_t cell[3];
    for (int a = 0; a < 3; a++) {
        stl->vertex[3 * v + a] = x[a];
        cell[a] = whole_floor(x[a] / (4 * weld->near));
    }
    size_t h = weld_hash(weld, cell[0], cell[1], cell[2]);
    weld->next[v] = weld->head[h];
    weld->head[h] = v;
    return v;
}

/* No area: two corners in one, or a height below `near`. */
static bool is_flat(const struct stl *stl, const int v[3], double near)
{
    double longest = 0, ab[3], ac[3];
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) return true;
    for (int k = 0; k < 3; k++) {
        const double *p = stl->vertex + 3 * v[k], *q = stl->vertex + 3 * v[(k + 1) % 3];
        longest = fmax(longest, hypot(hypot(q[0] - p[0], q[1] - p[1]), q[2] - p[2]));
    }
    for (int a = 0; a < 3; a++) {
        ab[a] = stl->vertex[3 * v[1] + a] - stl->vertex[3 * v[0] + a];
        ac[a] = stl->vertex[3 * v[2] + a] - stl->vertex[3 * v[0] + a];
    }
    double twice_area = hypot(hypot(ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2]),
        ab[0] * ac[1] - ab[1] * ac[0]);
    return twice_area < near * longest;
}

static void weld_soup(struct stl *stl, const struct stl_soup *soup)
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL},
           extent = 0, far = 1e-30;
    for (size_t k = 0; k < 9 * soup->n; k++) {
        low[k % 3] = fmin(low[k % 3], soup->corner[k]);
        high[k % 3] = fmax(high[k % 3], soup->corner[k]);
        far = fmax(far, fabs(soup->corner[k]));
    }
    for (int a = 0; a < 3; a++) extent = fmax(extent, high[a] - low[a]);
    /* the latter keeps cell numbers within 64 bits */
    struct weld weld = {.near = fmax(1e-6 * extent, 1e-15 * far), .mask = 1};
    while (weld.mask < 3 * soup->n) weld.mask *= 2;
    weld.head = fail_alloc(weld.mask * sizeof *weld.head);
    weld.next = fail_alloc(3 * soup->n * sizeof *weld.next);
    for (size_t h = 0; h < weld.mask; h++) weld.head[h] = -1;
    weld.mask--;
    stl->vertex = fail_alloc(9 * soup->n * sizeof(double));
    stl->triangle = fail_alloc(3 * soup->n * sizeof(int));
    for (size_t t = 0; t < soup->n; t++) {
        int *v = stl->triangle + 3 * stl->n_triangle;
        for (int k = 0; k < 3; k++) v[k] = weld_vertex(&weld, stl, soup->corner + 9 * t + 3 * k);
        if (is_flat(stl, v, weld.near)) stl->n_dropped++;
        else stl->n_triangle++;
    }
    free(weld.head);
    free(weld.next);
}

/* Edge with its two vertices in ascending order; `way` is +1 where the triangle runs from the lower
 * to the higher. */
struct use {
    int low, high, at, way;
};

static int compare_uses(const void *a, const void *b)
{
    const struct use *p = a, *q = b;
    if (p->low != q->low) return p->low < q->low ? -1 : 1;
    if (p->high != q->high) return p->high < q->high ? -1 : 1;
    return (p->at > q->at) - (p->at < q->at);
}

/* Equal edges are neighbours after sorting. First edge[k] is the place of the edge's first use,
 * then (ascending, so that this one has its number already) that one's number. */
static void number_edges(struct stl *stl)
{
    int n = 3 * stl->n_triangle;
    struct use *use = fail_alloc((size_t)n * sizeof *use);
    stl->edge = fail_alloc((size_t)n * sizeof *stl->edge);
    for (int k = 0; k < n; k++) {
        int p = stl->triangle[k], q = stl->triangle[k - k % 3 + (k % 3 + 1) % 3];
        use[k] = (struct use){
            .low = p < q ? p : q, .high = p < q ? q : p, .at = k, .way = p < q ? 1 : -1};
    }
    qsort(use, (size_t)n, sizeof *use, compare_uses);
    for (int k = 0, end; k < n; k = end) {
        int sum = 0;
        for (end = k; end < n && use[end].low == use[k].low && use[end].high == use[k].high;
             end++) {
            sum += use[end].way;
            stl->edge[use[end].at] = use[k].at;
        }
        stl->n_open += sum != 0;
    }
    for (int k = 0; k < n; k++)
        stl->edge[k] = stl->edge[k] == k ? stl->n_edge++ : stl->edge[stl->edge[k]];
    free(use);
}

/* Fourth powers of lengths stand in the areas of triangles and must be numbers. */
static char *size_problem(const char *path, const struct stl_soup *soup, double scale)
{
    static const double largest = 1e75, smallest = 1e-75;
    double far = 0, low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL},
           high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, extent = 0;
    for (size_t k = 0; k < 9 * soup->n; k++) {
        far = fmax(far, fabs(soup->corner[k]));
        low[k % 3] = fmin(low[k % 3], soup->corner[k]);
        high[k % 3] = fmax(high[k % 3], soup->corner[k]);
    }
    for (int a = 0; a < 3; a++) extent = fmax(extent, high[a] - low[a]);
    if (far > largest || far * scale > largest)
        return fail_format("%s: corners at %g, and %g m with scale, are too far away: at most %g",
            path, far, far * scale, largest);
    if (extent > 0 && extent * scale < smallest)
        return fail_format(
            "%s: the surface is %g m wide with scale: at least %g", path, extent * scale, smallest);
    return NULL;
}

struct stl *stl_read(const char *path, double scale, char **error)
{
    struct stl_soup soup = {0};
    *error = stl_file_read(path, &soup);
    if (!*error && soup.n == 0) *error = fail_format("%s: no triangle", path);
    if (!*error && soup.n > INT32_MAX / 9)
        *error = fail_format("%s: %zu triangles are more than one surface can hold", path, soup.n);
    if (!*error) *error = size_problem(path, &soup, scale);
    if (*error) {
        free(soup.corner);
        return NULL;
    }
    struct stl *stl = fail_alloc(sizeof *stl);
    weld_soup(stl, &soup);
    free(soup.corner);
    for (int k = 0; k < 3 * stl->n_vertex; k++) stl->vertex[k] *= scale;
    if (stl->n_triangle == 0) {
        *error = fail_format("%s: all triangles have zero area (%d)", path, stl->n_dropped);
        stl_free(stl);
        return NULL;
    }
    number_edges(stl);
    return stl;
}

void stl_free(struct stl *stl)
{
    if (!stl) return;
    free(stl->vertex);
    free(stl->triangle);
    free(stl->edge);
    free(stl);
}

bool stl_is_closed(const struct stl *stl)
{
    return stl->n_open == 0;
}
