#include "lattice_cells.h"

#include <stdarg.h>
#include <stdio.h>

#include "lattice_parts.h"

void lattice_fault(const struct scene *scene, struct scene_errors *errors, int line, int column,
    const char *format, ...)
{
    char text[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    scene_errors_add(errors, "%s:%d:%d: %s", scene->path, line, column, text);
}

static uint64_t key_of(const int32_t at[3])
{
    return ((uint64_t)at[2] << LATTICE_BITS | (uint64_t)at[1]) << LATTICE_BITS | (uint64_t)at[0];
}

/* Both cells of a link are met in ascending order, so two marks that only move forwards find all of
 * them. */
void lattice_cells_upper(const struct lattice_cells *cells, int axis, int32_t *upper)
{
    uint64_t stride = (uint64_t)1 << (LATTICE_BITS * axis);
    int64_t j = 0;
    for (int64_t i = 0; i < cells->n; i++) {
        uint64_t want = key_of(cells->at[i]) + stride;
        int grid = cells->kind[cells->kind_of[i]].grid;
        upper[i] = -1;
        for (; j < cells->n; j++) {
            int at_grid = cells->kind[cells->kind_of[j]].grid;
            if (at_grid > grid || (at_grid == grid && key_of(cells->at[j]) >= want)) break;
        }
        if (j < cells->n && cells->kind[cells->kind_of[j]].grid == grid &&
            key_of(cells->at[j]) == want)
            upper[i] = (int32_t)j;
    }
}

const struct lattice_share *lattice_cells_share(const struct lattice_cells *cells, int64_t i)
{
    static const struct lattice_share whole = {.face = {1, 1, 1, 1, 1, 1}, .volume = 1, .mass = 1};
    return cells->share ? &cells->share[cells->share_of[i]] : &whole;
}

void lattice_cells_centre(const struct lattice_cells *cells, int64_t i, double x[3])
{
    const struct lattice_grid *grid = &cells->grid[cells->kind[cells->kind_of[i]].grid];
    for (int a = 0; a < 3; a++) x[a] = grid->origin[a] + (cells->at[i][a] + 0.5) * grid->h;
}
