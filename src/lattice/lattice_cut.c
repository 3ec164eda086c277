/* Cuts a body into cells, and finds bodies whose grids agree. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "lattice_parts.h"

enum { MOST_CELLS = INT32_MAX / 2 };

static void fault_at(const struct lattice_cut *cut, const struct scene *scene,
    struct scene_errors *errors, const char *key, const char *text)
{
    lattice_fault(scene, errors, cut->body->line, cut->body->column, "bodies[%d].%s: %s",
        cut->index, key, text);
}

/* Whether surfaces of the body do not lie along the grid. */
static bool is_curved(const struct body *body)
{
    bool is = body->shape.kind != REGION_BOX;
    for (int m = 0; m < body->n_minus; m++) is |= body->minus[m].kind != REGION_BOX;
    return is;
}

/* Cells along each axis: those with their centre inside the bounding box, of curved bodies all that
 * reach into it. */
static bool count(struct lattice_cut *cut, const struct scene *scene, struct scene_errors *errors)
{
    double h = cut->body->cell, all = 1;
    for (int a = 0; a < 3; a++) {
        double length = cut->shape.high[a] - cut->shape.low[a],
               n = cut->is_curved ? ceil(length / h - LATTICE_SLACK)
                                  : floor(length / h + 0.5 + LATTICE_SLACK);
        if (length < h * (1 - LATTICE_SLACK)) {
            char *text = fail_format("%g m, and '%s' has only %.4g m in %c: thinner than a cell", h,
                cut->body->name, length, "xyz"[a]);
            fault_at(cut, scene, errors, "cell", text);
            free(text);
            return false;
        }
        all *= n;
        if (n > LATTICE_MOST || all > MOST_CELLS) {
            char *text = fail_format(
                "%g m cuts the bounding box of '%s' into too many cells", h, cut->body->name);
            fault_at(cut, scene, errors, "cell", text);
            free(text);
            return false;
        }
        cut->size[a] = (int)n;
    }
    return true;
}

bool lattice_cut_open(
    struct lattice_cut *cut, const struct scene *scene, int index, struct scene_errors *errors)
{
    const struct body *body = &scene->body[index];
    *cut = (struct lattice_cut){.body = body,
        .index = index,
        .is_curved = scene->lattice.surface == CURVED_CUT && is_curved(body)};
    cut->minus = fail_alloc((size_t)body->n_minus * sizeof *cut->minus);
    char *text = region_open(&cut->shape, &body->shape);
    bool good = !text;
    if (text) fault_at(cut, scene, errors, "shape", text);
    free(text);
    for (int m = 0; m < body->n_minus; m++) {
        text = region_open(&cut->minus[m], &body->minus[m]);
        if (text)
            lattice_fault(scene, errors, body->line, body->column, "bodies[%d].minus[%d]: %s",
                index, m, text);
        good = good && !text;
        free(text);
    }
    return good && count(cut, scene, errors);
}

void lattice_cut_close(struct lattice_cut *cut)
{
    for (int m = 0; cut->body && m < cut->body->n_minus; m++) region_close(&cut->minus[m]);
    free(cut->minus);
    region_close(&cut->shape);
}

/* Whether the body fits the grid of the first body there; its offset in cells. */
static bool agrees(const struct lattice_cut *cut, const struct lattice_cut *first, int64_t shift[3])
{
    double h = first->body->cell;
    if (cut->body->cell < h || cut->body->cell > h) return false;
    for (int a = 0; a < 3; a++) {
        double offset = (cut->shape.low[a] - first->shape.low[a]) / h, whole = nearbyint(offset);
        if (!(fabs(whole) < 2.0 * LATTICE_MOST) || fabs(offset - whole) > LATTICE_SLACK)
            return false;
        shift[a] = (int64_t)whole;
    }
    return true;
}

/* Shifts count from the lowest cell of the grid; its corner is that of the body that reaches
 * lowest. */
static bool settle(struct lattice_cut *cut, const struct scene *scene, int g,
    struct lattice_grid *grid, struct scene_errors *errors)
{
    for (int a = 0; a < 3; a++) {
        int64_t low = INT64_MAX;
        for (int b = 0; b < scene->n_body; b++) {
            if (cut[b].grid != g || cut[b].shift[a] >= low) continue;
            low = cut[b].shift[a];
            grid->origin[a] = cut[b].shape.low[a];
        }
        for (int b = 0; b < scene->n_body; b++) {
            if (cut[b].grid != g) continue;
            cut[b].shift[a] -= low;
            if (cut[b].shift[a] + cut[b].size[a] <= LATTICE_MOST) continue;
            fault_at(&cut[b], scene, errors, "cell",
                "the grid that this body shares with others has too many cells along an edge");
            return false;
        }
    }
    return true;
}

bool lattice_cut_place(struct lattice_cut *cut, const struct scene *scene,
    struct lattice_cells *cells, struct scene_errors *errors)
{
    int *first = fail_alloc((size_t)scene->n_body * sizeof *first); /* body of each grid */
    bool good = true;
    cells->grid = fail_alloc((size_t)scene->n_body * sizeof *cells->grid);
    for (int b = 0; b < scene->n_body; b++) {
        int g = 0;
        while (g < cells->n_grid && !agrees(&cut[b], &cut[first[g]], cut[b].shift)) g++;
        cut[b].grid = g;
        if (g < cells->n_grid) continue;
        memset(cut[b].shift, 0, sizeof cut[b].shift);
        first[g] = b;
        cells->grid[cells->n_grid++].h = cut[b].body->cell;
    }
    for (int g = 0; g < cells->n_grid; g++)
        good = settle(cut, scene, g, &cells->grid[g], errors) && good;
    free(first);
    return good;
}

/* Each column is one walk through the surfaces. */
uint8_t *lattice_cut_fill(const struct lattice_cut *cut, bool corners)
{
    double h = cut->body->cell, inset = -LATTICE_SLACK * h, first = corners ? 0 : 0.5;
    const double *low = cut->shape.low;
    size_t nx = (size_t)(cut->size[0] + corners), ny = (size_t)(cut->size[1] + corners),
           nz = (size_t)(cut->size[2] + corners);
    uint8_t *there = fail_alloc(nx * ny * nz), *holds = fail_alloc(nz), *hole = fail_alloc(nz);
    double *z = fail_alloc(nz * sizeof *z);
    for (size_t k = 0; k < nz; k++) z[k] = low[2] + ((double)k + first) * h;
    for (size_t j = 0; j < ny; j++)
        for (size_t i = 0; i < nx; i++) {
            double x = low[0] + ((double)i + first) * h, y = low[1] + ((double)j + first) * h;
            region_column(&cut->shape, x, y, z, (int)nz, inset, holds);
            for (int m = 0; m < cut->body->n_minus; m++) {
                region_column(&cut->minus[m], x, y, z, (int)nz, inset, hole);
                for (size_t k = 0; k < nz; k++) holds[k] &= !hole[k];
            }
            for (size_t k = 0; k < nz; k++) there[(k * ny + j) * nx + i] = holds[k];
        }
    free(holds);
    free(hole);
    free(z);
    return there;
}

static void widen(struct lattice_span *span, int i, int j, int k)
{
    int at[3] = {i, j, k};
    for (int a = 0; a < 3; a++) {
        if (span->n == 0 || at[a] < span->low[a]) span->low[a] = at[a];
        if (span->n == 0 || at[a] > span->high[a]) span->high[a] = at[a];
    }
    span->n++;
}

void lattice_cut_add(struct lattice_cut *cut, struct lattice_list *list, const int at[3],
    bool has_centre, const struct lattice_share *share)
{
    if (list->n == list->room) {
        list->room = list->room ? 2 * list->room : 4096;
        list->cell = fail_realloc(list->cell, list->room * sizeof *list->cell);
    }
    if (share) {
        if ((list->n_share & (list->n_share - 1)) == 0)
            list->share =
                fail_realloc(list->share, 2 * (size_t)list->n_share * sizeof *list->share);
        list->share[list->n_share++] = *share;
    }
    uint64_t x = (uint64_t)(at[0] + cut->shift[0]), y = (uint64_t)(at[1] + cut->shift[1]),
             z = (uint64_t)(at[2] + cut->shift[2]);
    list->cell[list->n++] = (struct lattice_cell){(z << LATTICE_BITS | y) << LATTICE_BITS | x,
        (int16_t)cut->index, has_centre, share ? list->n_share - 1 : 0};
    widen(&cut->span, at[0], at[1], at[2]);
}

void lattice_cut_append(struct lattice_cut *cut, struct lattice_list *list)
{
    uint8_t *there = lattice_cut_fill(cut, false), *at = there;
    for (int k = 0; k < cut->size[2]; k++)
        for (int j = 0; j < cut->size[1]; j++)
            for (int i = 0; i < cut->size[0]; i++)
                if (*at++) lattice_cut_add(cut, list, (const int[]){i, j, k}, true, NULL);
    free(there);
}
