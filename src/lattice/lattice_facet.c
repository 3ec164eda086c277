/* Over a closed surface n and r x n have no integral, so both follow for the part of a curved
 * surface in a cell from the covered parts of the cell's faces:
 *     A = - sum of s n,   integral of r x n = - sum of s c x n
 * with c the middles of these parts. Of the cell's length along an axis f - (s^- + s^+)/2 ends at
 * that part (kernels/lattice/law_volume.h), where the traction has the normal part t.n. */
#include "lattice_facet.h"

#include <math.h>

static const double smallest = 1e-3; /* [whole faces] */

double lattice_facet_area(const struct lattice_share *share, double area[3])
{
    double square = 0;
    for (int a = 0; a < 3; a++) {
        area[a] = share->face[2 * a] - share->face[2 * a + 1];
        square += area[a] * area[a];
    }
    return square > smallest * smallest ? sqrt(square) : 0;
}

/* Integral of r x n [whole faces times h]. */
static void moment_of(const struct lattice_share *share, double moment[3])
{
    moment[0] = moment[1] = moment[2] = 0;
    for (int f = 0; f < 6; f++) {
        int b = (f / 2 + 1) % 3, c = (f / 2 + 2) % 3; /* d x e_a = (0, d_c, -d_b) */
        double part = (f & 1 ? 1 : -1) * share->face[f];
        moment[b] -= part * share->offset[f][1];
        moment[c] += part * share->offset[f][0];
    }
}

void lattice_facet_load(const struct lattice_share *share, double h, const double *force,
    double all, double pressure, double *value)
{
    double area[3], moment[3], size = lattice_facet_area(share, area), normal = -pressure,
                               length = 0;
    if (!(size > 0)) return;
    moment_of(share, moment);
    if (force) normal = 0;
    for (int a = 0; a < 3; a++) {
        length += 2 * share->volume - share->face[2 * a] - share->face[2 * a + 1];
        if (!force) {
            value[LOAD_BODY + a] -= pressure * area[a] * h * h;
            value[LOAD_TURN + a] -= pressure * moment[a] * h * h * h;
            continue;
        }
        double own = force[a] * size / all;
        normal += force[a] / (all * h * h) * area[a] / size;
        value[LOAD_FORCE + a] += own;
        for (int c = 0; c < 3; c++) value[LOAD_LEVER + 3 * c + a] += share->facet[c] * h * own;
    }
    value[LOAD_TRACTION] += length * normal;
}
