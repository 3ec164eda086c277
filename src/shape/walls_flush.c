/* Rectangles in the plane of others: two parts of a floor, a gate in it, a belt. */
#include "walls.h"

#include <math.h>
#include <stdlib.h>

#include "kernels/contact/law_wall.h"
#include "comm/fail.h"

#define TOLERANCE 1e-5 /* of angles, and of coordinates over their size */

/* A plane or a rectangle. */
struct flat {
    double point[3], normal[3], u[3], v[3]; /* u, v: axes of a rectangle */
    double half[2];                         /* its half edges [m]; infinite for a plane */
    bool moves;
};

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static struct flat flat_of(const struct walls *walls, int k)
{
    const double *row = walls->primitive + (size_t)WALL_PRIMITIVE_WIDTH * (size_t)k;
    struct flat f = {.half = {HUGE_VAL, HUGE_VAL}, .moves = walls->moves[walls->wall_of[k]]};
    bool is_plane = (int)row[11] == WALL_PLANE;
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        f.point[a] = row[a];
        f.u[a] = row[3 + a];
        f.v[a] = row[6 + a];
        f.normal[a] = is_plane ? row[3 + a] : row[3 + b] * row[6 + c] - row[3 + c] * row[6 + b];
    }
    if (!is_plane)
        for (int a = 0; a < 2; a++) f.half[a] = row[9 + a];
    return f;
}

/* Half the extent of a rectangle along an axis in its plane. */
static double extent(const struct flat *f, const double axis[3])
{
    return f->half[0] * fabs(dot(f->u, axis)) + f->half[1] * fabs(dot(f->v, axis));
}

/* Whether no side of the rectangle a keeps b away; b may be a plane. */
static bool reaches(const struct flat *a, const struct flat *b, double reach)
{
    const double *axis[2] = {a->u, a->v};
    for (int k = 0; k < 2; k++) {
        double away[3];
        if (isinf(a->half[k]) || isinf(b->half[0])) continue;
        for (int c = 0; c < 3; c++) away[c] = b->point[c] - a->point[c];
        if (fabs(dot(away, axis[k])) > a->half[k] + extent(b, axis[k]) + reach) return false;
    }
    return true;
}

static bool is_flush(const struct flat *a, const struct flat *b)
{
    double away[3], size = 0;
    if (isinf(a->half[0]) && isinf(b->half[0])) return false; /* two planes are one or none */
    if (fabs(fabs(dot(a->normal, b->normal)) - 1) > TOLERANCE * TOLERANCE) return false;
    for (int c = 0; c < 3; c++) {
        away[c] = b->point[c] - a->point[c];
        size = fmax(size, fmax(fabs(a->point[c]), fabs(b->point[c])));
    }
    for (int k = 0; k < 2; k++) {
        if (!isinf(a->half[k])) size = fmax(size, a->half[k]);
        if (!isinf(b->half[k])) size = fmax(size, b->half[k]);
    }
    double reach = TOLERANCE * size;
    if (fabs(dot(away, a->normal)) > reach) return false;
    return a->moves || b->moves || (reaches(a, b, reach) && reaches(b, a, reach));
}

bool walls_flush(const struct walls *walls)
{
    struct flat *flat = fail_alloc(((size_t)walls->n_primitive + 1) * sizeof *flat);
    bool found = false;
    int n = 0;
    for (int k = 0; k < walls->n_primitive; k++) {
        int kind = (int)walls->primitive[(size_t)WALL_PRIMITIVE_WIDTH * (size_t)k + 11];
        if (kind != WALL_PLANE && kind != WALL_RECTANGLE) continue;
        flat[n] = flat_of(walls, k);
        for (int l = 0; l < n && !found; l++) found = is_flush(&flat[l], &flat[n]);
        n++;
    }
    free(flat);
    return found;
}
