#include "lattice_frequency.h"

#include <math.h>
#include <stdlib.h>

#include "comm/fail.h"

enum { ROUNDS = 30 }; /* within a few per cent of where the bound goes */

struct link_material lattice_frequency_material(const struct material *m)
{
    return (struct link_material){m->density, m->young, m->poisson, m->link_damping};
}

static int kinds_on(const struct lattice_cells *cells, int grid, int *one)
{
    int n = 0;
    for (int k = 0; k < cells->n_kind; k++)
        if (cells->kind[k].grid == grid) {
            *one = k;
            n++;
        }
    return n;
}

static bool has_shares(const struct lattice_cells *cells, int64_t first, int64_t end)
{
    bool any = false;
    for (int64_t i = first; i < end && cells->share; i++) any |= cells->share_of[i] != 0;
    return any;
}

/* Cells first to end - 1, all those of a grid, of several materials or with shares. */
static double mixed_grid(const struct scene *scene, const struct lattice_cells *cells,
    int64_t first, int64_t end, const struct link_material *materials)
{
    size_t n = (size_t)(end - first);
    int(*neighbour)[6] = fail_alloc(n * sizeof *neighbour);
    int32_t *upper = fail_alloc((size_t)cells->n * sizeof *upper);
    for (size_t i = 0; i < n; i++)
        for (int f = 0; f < 6; f++) neighbour[i][f] = -1;
    for (int a = 0; a < 3; a++) {
        lattice_cells_upper(cells, a, upper);
        for (size_t i = 0; i < n; i++) {
            int64_t j = upper[first + (int64_t)i];
            if (j < 0) continue;
            neighbour[i][2 * a + 1] = (int)(j - first);
            neighbour[j - first][2 * a] = (int)i;
        }
    }
    struct lattice_body body = {.set = (enum link_set)scene->lattice.law,
        .h = cells->grid[cells->kind[cells->kind_of[first]].grid].h,
        .n = (int)n,
        .neighbour = (const int(*)[6])neighbour,
        .material = cells->kind_of + first,
        .materials = materials,
        .n_material = cells->n_kind,
        .share_of = cells->share_of ? cells->share_of + first : NULL,
        .share = has_shares(cells, first, end) ? cells->share : NULL};
    double largest = lattice_limit_body(&body, ROUNDS);
    free(neighbour);
    free(upper);
    return largest;
}

double lattice_frequency_largest(const struct scene *scene, const struct lattice_cells *cells)
{
    struct link_material *materials = fail_alloc((size_t)cells->n_kind * sizeof *materials);
    double largest = 0;
    int64_t first = 0, end;
    for (int k = 0; k < cells->n_kind; k++)
        materials[k] = lattice_frequency_material(&scene->material[cells->kind[k].material]);
    for (int g = 0; g < cells->n_grid; g++, first = end) {
        int kind = 0, n = kinds_on(cells, g, &kind);
        for (end = first; end < cells->n && cells->kind[cells->kind_of[end]].grid == g;) end++;
        double own = n == 1 && !has_shares(cells, first, end)
                         ? lattice_limit_uniform(
                               (enum link_set)scene->lattice.law, materials[kind], cells->grid[g].h)
                         : mixed_grid(scene, cells, first, end, materials);
        largest = fmax(largest, own);
    }
    free(materials);
    return largest;
}

double lattice_frequency_damping(
    const struct scene *scene, const struct lattice_cells *cells, double largest)
{
    double eta = 0;
    for (int k = 0; k < cells->n_kind; k++)
        eta = fmax(eta, scene->material[cells->kind[k].material].link_damping);
    return 0.5 * eta * largest;
}

double lattice_frequency_step(const struct scene *scene, const struct lattice_cells *cells)
{
    double largest = lattice_frequency_largest(scene, cells);
    return lattice_limit_factor((enum lattice_scheme)scene->time.scheme,
               lattice_frequency_damping(scene, cells, largest)) /
           largest;
}
