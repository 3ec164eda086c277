/* From the bodies of a scene to cells, their links and velocities. */
#include "lattice_cells.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "lattice_loads.h"
#include "lattice_parts.h"
#include "kernels/lattice/loads.h"

static int by_key(const void *a, const void *b)
{
    const struct lattice_cell *p = a, *q = b;
    if (p->key != q->key) return p->key < q->key ? -1 : 1;
    if (p->has_centre != q->has_centre) return p->has_centre ? 1 : -1;
    return p->body < q->body ? -1 : p->body > q->body;
}

/* Cells of one grid, sorted, each place once: the later body has it, of those that have its centre
 * if there are any. */
static void merge(struct lattice_list *list)
{
    bool sorted = true;
    for (size_t k = 1; k < list->n && sorted; k++)
        sorted = list->cell[k - 1].key < list->cell[k].key;
    if (sorted) return;
    qsort(list->cell, list->n, sizeof *list->cell, by_key);
    size_t n = 0;
    for (size_t k = 0; k < list->n; k++)
        if (k + 1 == list->n || list->cell[k].key != list->cell[k + 1].key)
            list->cell[n++] = list->cell[k];
    list->n = n;
}

static int kind_of(struct lattice_cells *cells, int material, int grid)
{
    int k = 0;
    while (
        k < cells->n_kind && (cells->kind[k].material != material || cells->kind[k].grid != grid))
        k++;
    if (k < cells->n_kind) return k;
    cells->kind = fail_realloc(cells->kind, (size_t)(k + 1) * sizeof *cells->kind);
    cells->kind[k] = (struct lattice_kind){material, grid};
    return cells->n_kind++;
}

static void append(struct lattice_cells *cells, const struct scene *scene, int grid,
    const struct lattice_list *list)
{
    size_t n = (size_t)cells->n + list->n;
    cells->at = fail_realloc(cells->at, n * sizeof *cells->at);
    cells->kind_of = fail_realloc(cells->kind_of, n * sizeof *cells->kind_of);
    cells->body = fail_realloc(cells->body, n * sizeof *cells->body);
    cells->share_of = fail_realloc(cells->share_of, n * sizeof *cells->share_of);
    /* of each body, 0: not yet known */
    int *kind = fail_alloc((size_t)scene->n_body * sizeof *kind);
    for (size_t k = 0; k < list->n; k++, cells->n++) {
        int b = list->cell[k].body;
        if (!kind[b]) kind[b] = kind_of(cells, scene->body[b].material, grid) + 1;
        for (int a = 0; a < 3; a++)
            cells->at[cells->n][a] =
                (int32_t)(list->cell[k].key >> (LATTICE_BITS * a) & LATTICE_MOST);
        cells->kind_of[cells->n] = (uint8_t)(kind[b] - 1);
        cells->body[cells->n] = (int16_t)b;
        cells->share_of[cells->n] = list->cell[k].share;
        cells->n_of_body[b]++;
    }
    free(kind);
}

static void check_counts(const struct scene *scene, const struct lattice_cells *cells,
    const struct lattice_cut *cut, struct scene_errors *errors)
{
    for (int b = 0; b < scene->n_body; b++) {
        const struct body *body = &scene->body[b];
        if (cells->n_of_body[b] > 0) continue;
        lattice_fault(scene, errors, body->line, body->column, "bodies[%d]: '%s' has no cell: %s",
            b, body->name,
            cut[b].n_sliver > 0 ? "it covers less than half of each; take smaller ones"
            : cut[b].span.n > 0 ? "later bodies have taken them all"
                                : "its shape contains no cell centre");
    }
    if (cells->n_kind > UINT8_MAX)
        scene_errors_add(
            errors, "%s: bodies: more than 255 kinds of material and grid", scene->path);
    if (cells->n > INT32_MAX / 2)
        scene_errors_add(errors, "%s: bodies: more than %d cells", scene->path, INT32_MAX / 2);
}

static void link_cells(struct lattice_cells *cells)
{
    int32_t *upper = fail_alloc((size_t)cells->n * sizeof *upper);
    cells->bits = fail_alloc((size_t)cells->n * sizeof *cells->bits);
    for (int a = 0; a < 3; a++) {
        lattice_cells_upper(cells, a, upper);
        for (int64_t i = 0; i < cells->n; i++) {
            if (upper[i] < 0) continue;
            cells->bits[i] |= (uint16_t)(2 << (2 * a));
            cells->bits[upper[i]] |= (uint16_t)(1 << (2 * a));
        }
    }
    free(upper);
}

/* v0 + w0 x (x - x0) about the centre of mass x0 of each body; what is fixed stands, what is
 * prescribed starts as prescribed. */
static void set_velocities(const struct scene *scene, struct lattice_cells *cells)
{
    double(*middle)[3] = fail_alloc((size_t)scene->n_body * sizeof *middle), x[3];
    double *rows = fail_alloc((size_t)cells->loads->n_row * LOAD_WIDTH * sizeof *rows),
           *all = fail_alloc((size_t)scene->n_body * sizeof *all); /* masses, in whole cells */
    bool moves = false;
    for (int64_t i = 0; i < cells->n; i++) {
        lattice_cells_centre(cells, i, x);
        double mass = lattice_cells_share(cells, i)->mass;
        all[cells->body[i]] += mass;
        for (int a = 0; a < 3; a++)
            middle[cells->body[i]][a] += x[a] * mass / (double)cells->n_of_body[cells->body[i]];
    }
    for (int b = 0; b < scene->n_body; b++)
        for (int a = 0; a < 3; a++) middle[b][a] *= (double)cells->n_of_body[b] / all[b];
    lattice_loads_at(cells->loads, scene, 0, 0, 0, rows);
    cells->v = fail_alloc((size_t)cells->n * sizeof *cells->v);
    cells->w = fail_alloc((size_t)cells->n * sizeof *cells->w);
    for (int64_t i = 0; i < cells->n; i++) {
        const struct body *body = &scene->body[cells->body[i]];
        const double *w = body->angular_velocity,
                     *given = rows + (int64_t)cells->row[i] * LOAD_WIDTH + LOAD_VELOCITY;
        lattice_cells_centre(cells, i, x);
        for (int a = 0; a < 3; a++) x[a] -= middle[cells->body[i]][a];
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            double v = body->velocity[a] + (w[b] * x[c] - w[c] * x[b]);
            cells->v[i][a] = cells->bits[i] & CELL_FIX(a) ? given[a] : v;
            cells->w[i][a] = cells->bits[i] & CELL_FIX(3 + a) ? given[3 + a] : w[a];
            moves = moves || cells->v[i][a] < 0 || cells->v[i][a] > 0 || cells->w[i][a] < 0 ||
                    cells->w[i][a] > 0;
        }
    }
    free(middle);
    free(rows);
    free(all);
    if (moves) return;
    free(cells->v);
    free(cells->w);
    cells->v = cells->w = NULL;
}

struct lattice_cells *lattice_cells_create(const struct scene *scene, struct scene_errors *errors)
{
    int before = errors->n;
    struct lattice_cells *cells = fail_alloc(sizeof *cells);
    struct lattice_cut *cut = fail_alloc((size_t)scene->n_body * sizeof *cut);
    struct lattice_list list = {.share = fail_alloc(sizeof *list.share), .n_share = 1};
    list.share[0] = *lattice_cells_share(cells, 0);
    cells->n_of_body = fail_alloc((size_t)scene->n_body * sizeof *cells->n_of_body);
    if (scene->n_body > INT16_MAX)
        scene_errors_add(errors, "%s: bodies: more than %d", scene->path, INT16_MAX);
    for (int b = 0; b < scene->n_body; b++) lattice_cut_open(&cut[b], scene, b, errors);
    if (errors->n == before) lattice_cut_place(cut, scene, cells, errors);
    for (int g = 0; g < cells->n_grid && errors->n == before; g++) {
        list.n = 0;
        for (int b = 0; b < scene->n_body; b++)
            if (cut[b].grid == g && cut[b].is_curved)
                lattice_cover_append(cut, scene->n_body, b, &list);
            else if (cut[b].grid == g) lattice_cut_append(&cut[b], &list);
        merge(&list);
        append(cells, scene, g, &list);
    }
    cells->share = list.share;
    cells->n_share = list.n_share;
    lattice_shares_prune(cells, cut);
    if (errors->n == before) check_counts(scene, cells, cut, errors);
    cells->fit = fail_alloc((size_t)scene->n_body * sizeof *cells->fit);
    for (int b = 0; b < scene->n_body; b++) {
        if (errors->n == before) cells->fit[b] = lattice_fit_of(&cut[b]);
        lattice_cut_close(&cut[b]);
    }
    free(cut);
    free(list.cell);
    if (errors->n == before) {
        link_cells(cells);
        lattice_shares_settle(cells);
        lattice_cracks_cut(scene, cells, errors);
        lattice_loads_create(scene, cells, errors);
    }
    if (errors->n == before) {
        set_velocities(scene, cells);
        if (scene->lattice.relax) lattice_floating_settle(scene, cells, errors);
    }
    if (errors->n == before) return cells;
    lattice_cells_free(cells);
    return NULL;
}

void lattice_cells_free(struct lattice_cells *cells)
{
    if (!cells) return;
    lattice_loads_free(cells->loads);
    free(cells->grid);
    free(cells->kind);
    free(cells->at);
    free(cells->kind_of);
    free(cells->body);
    free(cells->bits);
    free(cells->row);
    free(cells->share_of);
    free(cells->share);
    free(cells->v);
    free(cells->w);
    free(cells->n_of_body);
    free(cells->fit);
    free(cells);
}
