/* Shares of cells that the surface of a body cuts, from what lattice_cover.c measures of each alone
 * to what holds between neighbours: one share for both ends of a link, masses.
 *
 * A sliver that hangs on nothing but slivers is left out. A link has the smaller of the two shares
 * of its face; one of less than `least` is none.
 *
 * Masses. The mass acts at the centre of a cell, what is covered has its middle beside it: the
 * neighbours on that side get so much of it that mass and first moments are those of the shape. The
 * second moments are then right to the order h^3.
 *
 * A sliver of the volume share f hangs on a link that may be whole, so with the mass f it
 * would oscillate as fast as f^-1/2. A cell of mass 1 carries six links; each has at least
 * `carried`/6 of the mass for every whole link that it carries, and gets what it lacks from its
 * neighbours, in proportion to what these have beyond that: nothing is lost, and little moves, by
 * one cell, of the order h^2 for the body. Every cell has the inertia of a whole one, of the order
 * h^3. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "lattice_parts.h"

enum { PASSES = 200 };
static const double least = 1e-3, carried = 0.7, flat = 0.1;

/* Cell over each face, linked or not, or -1; [n]. The caller frees. */
static int32_t (*neighbours(const struct lattice_cells *cells))[6]
{
    int32_t(*beside)[6] = fail_alloc((size_t)cells->n * sizeof *beside);
    int32_t *upper = fail_alloc((size_t)cells->n * sizeof *upper);
    for (int64_t i = 0; i < cells->n; i++)
        for (int f = 0; f < 6; f++) beside[i][f] = -1;
    for (int a = 0; a < 3; a++) {
        lattice_cells_upper(cells, a, upper);
        for (int64_t i = 0; i < cells->n; i++) {
            if (upper[i] < 0) continue;
            beside[i][2 * a + 1] = upper[i];
            beside[upper[i]][2 * a] = (int32_t)i;
        }
    }
    free(upper);
    return beside;
}

static double share_of_link(const struct lattice_cells *cells, int64_t i, int64_t j, int face)
{
    return fmin(
        lattice_cells_share(cells, i)->face[face], lattice_cells_share(cells, j)->face[face ^ 1]);
}

/* The cells that keep[] says move together. */
static void keep_cells(struct lattice_cells *cells, const bool *keep, struct lattice_cut *cut)
{
    int64_t n = 0;
    for (int64_t i = 0; i < cells->n; i++) {
        if (!keep[i]) {
            int b = cells->body[i];
            cells->n_of_body[b]--;
            cut[b].covered -= lattice_cells_share(cells, i)->volume;
            cut[b].n_sliver++;
            continue;
        }
        memcpy(cells->at[n], cells->at[i], sizeof *cells->at);
        cells->kind_of[n] = cells->kind_of[i];
        cells->body[n] = cells->body[i];
        cells->share_of[n++] = cells->share_of[i];
    }
    cells->n = n;
}

void lattice_shares_prune(struct lattice_cells *cells, struct lattice_cut *cut)
{
    if (cells->n_share <= 1) {
        free(cells->share);
        free(cells->share_of);
        cells->share = NULL;
        cells->share_of = NULL;
        cells->n_share = 0;
        return;
    }
    int32_t(*beside)[6] = neighbours(cells);
    bool *keep = fail_alloc((size_t)cells->n), changes = true;
    for (int64_t i = 0; i < cells->n; i++) keep[i] = lattice_cells_share(cells, i)->volume >= 0.5;
    while (changes) {
        changes = false;
        for (int64_t i = 0; i < cells->n; i++)
            for (int f = 0; f < 6 && !keep[i]; f++) {
                int32_t j = beside[i][f];
                keep[i] = j >= 0 && keep[j] && share_of_link(cells, i, j, f) >= least;
                changes |= keep[i];
            }
    }
    keep_cells(cells, keep, cut);
    free(keep);
    free(beside);
}

/* The row of cell i, its own. */
static struct lattice_share *own_share(struct lattice_cells *cells, int64_t i)
{
    if (!cells->share_of[i]) {
        int n = cells->n_share++;
        cells->share = fail_realloc(cells->share, (size_t)(n + 1) * sizeof *cells->share);
        cells->share[n] = cells->share[0];
        cells->share_of[i] = n;
    }
    return &cells->share[cells->share_of[i]];
}

/* One share and one middle for both ends of a link. */
static void settle_link(struct lattice_cells *cells, int64_t i, int64_t j, int face)
{
    double share = share_of_link(cells, i, j, face);
    if (!(share < 1)) return;
    struct lattice_share *own = own_share(cells, i), *other = own_share(cells, j);
    own = &cells->share[cells->share_of[i]]; /* the table may have moved */
    bool is_own = own->face[face] <= other->face[face ^ 1];
    memcpy(is_own ? other->offset[face ^ 1] : own->offset[face],
        is_own ? own->offset[face] : other->offset[face ^ 1], sizeof own->offset[face]);
    own->face[face] = other->face[face ^ 1] = share < least ? 0 : share;
    if (share >= least) return;
    cells->bits[i] &= (uint16_t)~CELL_LINK(face);
    cells->bits[j] &= (uint16_t)~CELL_LINK(face ^ 1);
}

/* Mass that the links of a cell ask for. */
static double needed(const struct lattice_cells *cells, int64_t i)
{
    const struct lattice_share *s = lattice_cells_share(cells, i);
    double sum = 0;
    for (int f = 0; f < 6; f++) sum += cells->bits[i] & CELL_LINK(f) ? s->face[f] : 0;
    return carried * sum / 6;
}

/* The cell of the same kind that is linked with cell i over the face, or -1. */
static int32_t mate_of(
    const struct lattice_cells *cells, const int32_t (*beside)[6], int64_t i, int face)
{
    int32_t j = beside[i][face];
    bool is = cells->bits[i] & CELL_LINK(face) && cells->kind_of[j] == cells->kind_of[i];
    return is ? j : -1;
}

/* Masses whose middles are those of what is covered. */
static void centre_masses(struct lattice_cells *cells, const int32_t (*beside)[6])
{
    int n = cells->n_share; /* cells that get a row here are whole */
    for (int64_t i = 0; i < cells->n; i++) {
        if (!cells->share_of[i] || cells->share_of[i] >= n) continue;
        struct lattice_share s = cells->share[cells->share_of[i]];
        double sum = fabs(s.centre[0]) + fabs(s.centre[1]) + fabs(s.centre[2]),
               part = s.volume / fmax(1, sum);
        for (int a = 0; a < 3; a++) {
            int32_t j = mate_of(cells, beside, i, 2 * a + (s.centre[a] > 0));
            if (j < 0) continue;
            own_share(cells, j)->mass += part * fabs(s.centre[a]);
            own_share(cells, i)->mass -= part * fabs(s.centre[a]);
        }
    }
}

/* Brings what cell i lacks; whether it lacked anything and got something. balanced: as much goes to
 * the cell behind the one that gives, so that the middle stays; else cells give that lack less, and
 * what they then lack comes from deeper ones. */
static bool bring_mass(
    struct lattice_cells *cells, int64_t i, const int32_t (*beside)[6], bool balanced)
{
    double lacks = needed(cells, i) - lattice_cells_share(cells, i)->mass, spare[6] = {0}, all = 0;
    int32_t mate[6], behind[6];
    if (!(lacks > 1e-12)) return false;
    for (int f = 0; f < 6; f++) {
        mate[f] = mate_of(cells, beside, i, f);
        behind[f] = mate[f] < 0 || !balanced ? -1 : mate_of(cells, beside, mate[f], f);
        if (mate[f] < 0) continue;
        double has = lattice_cells_share(cells, mate[f])->mass - needed(cells, mate[f]);
        spare[f] = fmax(0, !balanced ? (has + lacks) / 8 : behind[f] < 0 ? has : 0.5 * has);
        all += spare[f];
    }
    if (!(all > 1e-12)) return false;
    double part = fmin(1, lacks / all);
    for (int f = 0; f < 6; f++) {
        if (!(spare[f] > 0)) continue;
        own_share(cells, mate[f])->mass -= (behind[f] < 0 ? 1 : 2) * part * spare[f];
        if (behind[f] >= 0) own_share(cells, behind[f])->mass += part * spare[f];
    }
    own_share(cells, i)->mass += part * all;
    return true;
}

void lattice_shares_settle(struct lattice_cells *cells)
{
    if (!cells->share) return;
    int32_t(*beside)[6] = neighbours(cells);
    for (int64_t i = 0; i < cells->n; i++)
        for (int f = 0; f < 6; f++) {
            if (f % 2 && beside[i][f] >= 0) settle_link(cells, i, beside[i][f], f);
            /* what is left of a face beside a sliver that was left out is part of the surface */
            if (beside[i][f] < 0 && cells->share_of[i] &&
                cells->share[cells->share_of[i]].face[f] < flat)
                cells->share[cells->share_of[i]].face[f] = 0;
        }
    centre_masses(cells, (const int32_t(*)[6])beside);
    for (int balanced = 1; balanced >= 0; balanced--) {
        bool changes = true;
        for (int pass = 0; pass < PASSES && changes; pass++) {
            changes = false;
            for (int64_t i = 0; i < cells->n; i++)
                if (cells->share_of[i])
                    changes |= bring_mass(cells, i, (const int32_t(*)[6])beside, balanced);
        }
    }
    for (int64_t i = 0; i < cells->n; i++)
        if (cells->share_of[i])
            own_share(cells, i)->mass = fmax(own_share(cells, i)->mass, needed(cells, i));
    free(beside);
}
