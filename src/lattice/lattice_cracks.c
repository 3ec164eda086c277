/* Initial cracks: links of a body that are missing from the start. */
#include <stdlib.h>

#include "comm/fail.h"
#include "lattice_parts.h"

/* Cuts the links along `axis` whose middle the shape holds and of which one end at least is of the
 * body; returns how many. upper [n]: the cells beyond. */
static int64_t cut_axis(struct lattice_cells *cells, const struct region_shape *shape, int body,
    int axis, const int32_t *upper)
{
    int64_t n = 0;
    for (int64_t i = 0; i < cells->n; i++) {
        int64_t j = upper[i];
        if (!(cells->bits[i] & CELL_LINK(2 * axis + 1)) ||
            (cells->body[i] != body && cells->body[j] != body))
            continue;
        double h = cells->grid[cells->kind[cells->kind_of[i]].grid].h, x[3];
        lattice_cells_centre(cells, i, x);
        x[axis] += 0.5 * h;
        if (!region_holds(shape, x, -LATTICE_SLACK * h)) continue;
        cells->bits[i] &= (uint16_t)~CELL_LINK(2 * axis + 1);
        cells->bits[j] &= (uint16_t)~CELL_LINK(2 * axis);
        n++;
    }
    return n;
}

void lattice_cracks_cut(
    const struct scene *scene, struct lattice_cells *cells, struct scene_errors *errors)
{
    int32_t *upper[3];
    for (int a = 0; a < 3; a++) upper[a] = fail_alloc((size_t)cells->n * sizeof **upper);
    for (int a = 0; a < 3; a++) lattice_cells_upper(cells, a, upper[a]);
    for (int b = 0; b < scene->n_body; b++) {
        const struct body *body = &scene->body[b];
        for (int c = 0; c < body->n_crack; c++) {
            struct region_shape shape;
            char *text = region_open(&shape, &body->crack[c]);
            int64_t n = 0;
            for (int a = 0; a < 3 && !text; a++) n += cut_axis(cells, &shape, b, a, upper[a]);
            if (text)
                lattice_fault(scene, errors, body->line, body->column, "bodies[%d].cracks[%d]: %s",
                    b, c, text);
            else if (n == 0)
                lattice_fault(scene, errors, body->line, body->column,
                    "bodies[%d].cracks[%d]: no link is in it", b, c);
            free(text);
            region_close(&shape);
        }
    }
    for (int a = 0; a < 3; a++) free(upper[a]);
}
