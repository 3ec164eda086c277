/* Tables and start of the lattice on the host. */
#include "lattice_host.h"

#include <stdlib.h>

#include "comm/fail.h"
#include "lattice/lattice_places.h"

_Static_assert((int)CRITERION_SUM == BREAK_SUM && (int)CRITERION_LARGEST == BREAK_LARGEST &&
                   (int)CRITERION_STRESS == BREAK_STRESS,
    "scene and law");

static real *reals(double *value, int64_t n)
{
    real *r = fail_alloc((size_t)n * sizeof *r);
    for (int64_t i = 0; i < n; i++) r[i] = (real)value[i];
    free(value);
    return r;
}

struct host *host_create(const struct lattice_cells *cells, const struct lattice_options *options)
{
    struct host *h = fail_alloc(sizeof *h);
    struct lattice_places *places = lattice_places_create(cells, (struct lattice_lay){0, 16});
    size_t n = (size_t)cells->n;
    int k = cells->n_kind;
    h->cells = cells;
    h->options = *options;
    h->scheme = lattice_schemes_table(options->scheme);
    h->n = cells->n;
    h->neighbour = fail_alloc(n * sizeof *h->neighbour);
    h->now = fail_alloc(n * sizeof *h->now);
    h->next = fail_alloc(n * sizeof *h->next);
    h->start = fail_alloc(n * sizeof *h->start);
    h->sums = fail_alloc(n * sizeof *h->sums);
    h->p = fail_alloc(n * sizeof *h->p);
    h->links = fail_alloc(n * sizeof *h->links);
    h->fate = fail_alloc(n * sizeof *h->fate);
    h->p_still = fail_alloc(n * sizeof *h->p_still);
    h->ledger = fail_alloc(n * sizeof *h->ledger);
    h->last_a = fail_alloc(n * sizeof *h->last_a);
    h->last_b = fail_alloc(n * sizeof *h->last_b);
    h->link = reals(lattice_features_links(cells, options), (int64_t)k * k * LINK_WIDTH);
    h->cell = reals(lattice_features_cells(cells, options), (int64_t)k * CELL_WIDTH);
    if (WITH_SHARES)
        h->share =
            reals(lattice_features_shares(cells, options), (int64_t)cells->n_share * SHARE_WIDTH);
    if (!h->scheme->is_rk)
        h->kick = reals(
            lattice_features_kicks(cells, options), (int64_t)(h->scheme->n + 2) * k * KICK_WIDTH);
    if (options->strength)
        h->limit = reals(lattice_features_limits(cells, options), (int64_t)k * k * BREAK_WIDTH);
    if (WITH_PRINCIPAL) h->inverse = reals(lattice_features_principal(cells, options), 2 * k);
    h->due = fail_alloc(n * sizeof *h->due);
    if (WITH_LOADS) {
        h->rows = fail_alloc((size_t)options->n_row * LOAD_WIDTH * sizeof *h->rows);
        h->rows_double = fail_alloc((size_t)options->n_row * LOAD_WIDTH * sizeof *h->rows_double);
    }
    for (int64_t i = 0; i < h->n; i++) {
        h->now[i].q = quat_of(1, 0, 0, 0);
        h->links[i] = cells->bits[i] & CELL_LINKS;
        if (cells->v)
            h->now[i].v = v3((real)cells->v[i][0], (real)cells->v[i][1], (real)cells->v[i][2]);
        if (cells->w)
            h->now[i].w = v3((real)cells->w[i][0], (real)cells->w[i][1], (real)cells->w[i][2]);
        for (int f = 0; f < 6; f++)
            h->neighbour[i][f] =
                cells->bits[i] & CELL_LINK(f) ? lattice_places_neighbour(places, cells, i, f) : -1;
    }
    lattice_places_free(places);
    return h;
}

void host_free(struct host *h)
{
    void *all[] = {h->neighbour, h->now, h->next, h->start, h->sums, h->p, h->p_still, h->links,
        h->fate, h->due, h->inverse, h->ledger, h->last_a, h->last_b, h->limit, h->link, h->cell,
        h->kick, h->rows, h->rows_double, h->share};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
    free(h);
}
