/* What a body with curved surfaces covers of cells: of their volume, of their faces, and where.
 *
 * All is measured along lines, N by N through a cell and N over a face, with the shape's own answer
 * to whether a point is inside, so it holds for any shape. On a line the surface is looked for
 * between 1 + SAMPLES points, and found by halving to 2^-HALVINGS of an edge. Of a face the inner
 * side counts, INSIDE of an edge away: a surface that lies on it then belongs to one cell. What
 * bodies of one grid cover together counts, so that one that fills a hole of another leaves no gap.
 *
 * A function of the scene alone; every rank finds the same bits. */
#include <math.h>
#include <stdlib.h>

#include "comm/fail.h"
#include "lattice_parts.h"

enum { LINES = 8, SAMPLES = 4, HALVINGS = 12 };
#define INSIDE 1e-6
/* Smaller shares of a volume are left out, smaller gaps are none [1]. */
static const double sliver = 0.005, gap = 1e-4;

struct cover {
    const struct lattice_cut *cut; /* the first of n */
    int n, grid;
    double low[3], h; /* [m] corner of the body's cells, edge */
};

static bool holds(const struct cover *c, const double x[3])
{
    double inset = -LATTICE_SLACK * c->h;
    for (int b = 0; b < c->n; b++) {
        const struct lattice_cut *cut = &c->cut[b];
        if (cut->grid != c->grid || !region_holds(&cut->shape, x, inset)) continue;
        bool is_hole = false;
        for (int m = 0; m < cut->body->n_minus && !is_hole; m++)
            is_hole = region_holds(&cut->minus[m], x, inset);
        if (!is_hole) return true;
    }
    return false;
}

/* Where the surface is between two points of a line, at t = from and to [h], of which one is
 * inside. */
static double crossing(
    const struct cover *c, const double x[3], int axis, double from, double to, bool from_is_in)
{
    for (int k = 0; k < HALVINGS; k++) {
        double t = 0.5 * (from + to), y[3] = {x[0], x[1], x[2]};
        y[axis] += t * c->h;
        if (holds(c, y) == from_is_in) from = t;
        else to = t;
    }
    return 0.5 * (from + to);
}

/* Of the edge from x along the axis: what is covered, and its first moment about the middle [h]. */
static double covered(const struct cover *c, const double x[3], int axis, double *moment)
{
    bool before = false;
    double length = 0;
    *moment = 0;
    for (int k = 0; k <= SAMPLES; k++) {
        double t = (double)k / SAMPLES, y[3] = {x[0], x[1], x[2]}, low = t - 1.0 / SAMPLES,
               high = t;
        y[axis] += t * c->h;
        bool now = holds(c, y);
        if (k > 0 && now != before) *(now ? &low : &high) = crossing(c, x, axis, low, t, before);
        if (k > 0 && (now || before)) {
            length += high - low;
            *moment += (high - low) * (0.5 * (low + high) - 0.5);
        }
        before = now;
    }
    return length;
}

/* A face of the cell with its corner at x [m], by lines along `axis`. */
static void measure_face(
    const struct cover *c, const double x[3], int face, int axis, struct lattice_share *share)
{
    int a = face / 2, along_first = axis == (a + 1) % 3,
        beside = along_first ? (a + 2) % 3 : (a + 1) % 3;
    double area = 0, moment[2] = {0};
    for (int n = 0; n < LINES; n++) {
        double y[3] = {x[0], x[1], x[2]}, along, at = (n + 0.5) / LINES;
        y[a] += (face % 2 ? 1 - INSIDE : INSIDE) * c->h;
        y[beside] += at * c->h;
        double length = covered(c, y, axis, &along);
        area += length / LINES;
        moment[along_first] += (at - 0.5) * length / LINES;
        moment[!along_first] += along / LINES;
    }
    share->face[face] = area < gap ? 0 : area > 1 - gap ? 1 : area;
    for (int k = 0; k < 2; k++)
        share->offset[face][k] = area < gap || area > 1 - gap ? 0 : moment[k] / area;
}

/* By lines along `axis`. centre: of what is covered, from that of the cell [h]; returns the
 * share. */
static double measure_volume(const struct cover *c, const double x[3], int axis, double centre[3])
{
    int first = (axis + 1) % 3, second = (axis + 2) % 3;
    double volume = 0, moment[3] = {0};
    for (int n = 0; n < LINES * LINES; n++) {
        double at[2] = {(n % LINES + 0.5) / LINES, (n / LINES + 0.5) / LINES}, along,
               y[3] = {x[0], x[1], x[2]};
        y[first] += at[0] * c->h;
        y[second] += at[1] * c->h;
        double length = covered(c, y, axis, &along) / (LINES * LINES);
        volume += length;
        moment[first] += (at[0] - 0.5) * length;
        moment[second] += (at[1] - 0.5) * length;
        moment[axis] += along / (LINES * LINES);
    }
    for (int a = 0; a < 3; a++) centre[a] = volume > 0 ? moment[a] / volume : 0;
    return volume;
}

/* A point of the surface: from the middle of what is covered outwards along the surface's vector
 * area, which is what the faces lack to a closed surface. */
static void find_facet(const struct cover *c, const double x[3], struct lattice_share *share)
{
    double area[3], size = 0, low = 0, high = 2;
    for (int a = 0; a < 3; a++) {
        area[a] = share->face[2 * a] - share->face[2 * a + 1];
        size += area[a] * area[a];
    }
    size = sqrt(size);
    for (int k = 0; k < HALVINGS && size > gap; k++) {
        double t = 0.5 * (low + high), y[3];
        for (int a = 0; a < 3; a++)
            y[a] = x[a] + (0.5 + share->centre[a] + t * area[a] / size) * c->h;
        if (holds(c, y)) low = t;
        else high = t;
    }
    for (int a = 0; a < 3; a++)
        share->facet[a] = share->centre[a] + (size > gap ? low * area[a] / size : 0);
}

/* Points that are not all alike may have a surface between them: 1 where the corners and the centre
 * of a cell differ, 2 beside these, else 0. */
static uint8_t *find_cut(const struct lattice_cut *cut, const uint8_t *centre)
{
    size_t nx = (size_t)cut->size[0], ny = (size_t)cut->size[1], nz = (size_t)cut->size[2],
           step[3] = {1, nx, nx * ny};
    uint8_t *corner = lattice_cut_fill(cut, true), *is_cut = fail_alloc(nx * ny * nz);
    for (size_t k = 0, at = 0; k < nz; k++)
        for (size_t j = 0; j < ny; j++)
            for (size_t i = 0; i < nx; i++, at++) {
                int sum = 0;
                for (size_t n = 0; n < 8; n++)
                    sum += corner[((k + n / 4) * (ny + 1) + j + n / 2 % 2) * (nx + 1) + i + n % 2];
                is_cut[at] = sum != (centre[at] ? 8 : 0);
            }
    for (size_t k = 0, at = 0; k < nz; k++)
        for (size_t j = 0; j < ny; j++)
            for (size_t i = 0; i < nx; i++, at++) {
                size_t place[3] = {i, j, k}, size[3] = {nx, ny, nz};
                bool is_beside = false;
                for (int a = 0; a < 3; a++) {
                    is_beside |= place[a] > 0 && is_cut[at - step[a]] == 1;
                    is_beside |= place[a] + 1 < size[a] && is_cut[at + step[a]] == 1;
                }
                if (is_beside && !is_cut[at]) is_cut[at] = 2;
            }
    free(corner);
    return is_cut;
}

static bool is_whole(const struct lattice_share *s)
{
    bool is = s->volume > 1 - gap;
    for (int f = 0; f < 6; f++) is &= s->face[f] > 1 - gap;
    return is;
}

/* Of two axes the one that is more across the surface. */
static int across(const struct lattice_share *s, int a, int b)
{
    double of_a = fabs(s->face[2 * a] - s->face[2 * a + 1]),
           of_b = fabs(s->face[2 * b] - s->face[2 * b + 1]);
    return of_a > of_b ? a : b;
}

/* All six faces, by lines across the surface: these see a sliver however thin it is. A first look
 * along axes that are as good as any says where it faces. Returns the axis most across. */
static int measure_faces(const struct cover *c, const double x[3], struct lattice_share *share)
{
    for (int f = 0; f < 6; f++) measure_face(c, x, f, (f / 2 + 2) % 3, share);
    struct lattice_share first = *share;
    for (int f = 0; f < 6; f++) {
        int axis = across(&first, (f / 2 + 1) % 3, (f / 2 + 2) % 3);
        if (axis != (f / 2 + 2) % 3) measure_face(c, x, f, axis, share);
    }
    return across(share, across(share, 0, 1), 2);
}

/* own: the body alone, all: with the others of its grid. */
static void add_cut(struct lattice_cut *cut, const struct cover *own, const struct cover *all,
    const int at[3], bool has_centre, struct lattice_list *list)
{
    struct lattice_share share = {.mass = 1};
    double x[3];
    for (int a = 0; a < 3; a++) x[a] = own->low[a] + at[a] * own->h;
    share.volume = measure_volume(own, x, measure_faces(own, x, &share), share.centre);
    if (share.volume < sliver) return;
    cut->covered += share.volume;
    if (all->n > 1)
        share.volume = measure_volume(all, x, measure_faces(all, x, &share), share.centre);
    find_facet(all, x, &share);
    share.mass = share.volume;
    lattice_cut_add(cut, list, at, has_centre, is_whole(&share) ? NULL : &share);
}

void lattice_cover_append(struct lattice_cut *cuts, int n, int b, struct lattice_list *list)
{
    struct lattice_cut *cut = &cuts[b];
    struct cover own = {.cut = cut, .n = 1, .grid = cut->grid, .h = cut->body->cell}, all = own;
    int n_same = 0;
    for (int k = 0; k < n; k++) n_same += cuts[k].grid == cut->grid;
    for (int a = 0; a < 3; a++) own.low[a] = cut->shape.low[a];
    if (n_same > 1) {
        all.cut = cuts;
        all.n = n;
    }
    uint8_t *centre = lattice_cut_fill(cut, false), *is_cut = find_cut(cut, centre);
    size_t place = 0;
    for (int k = 0; k < cut->size[2]; k++)
        for (int j = 0; j < cut->size[1]; j++)
            for (int i = 0; i < cut->size[0]; i++, place++) {
                const int at[3] = {i, j, k};
                if (is_cut[place]) add_cut(cut, &own, &all, at, centre[place], list);
                else if (centre[place]) {
                    lattice_cut_add(cut, list, at, true, NULL);
                    cut->covered++;
                }
            }
    free(centre);
    free(is_cut);
}
