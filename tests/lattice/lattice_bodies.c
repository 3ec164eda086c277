#include "lattice_bodies.h"

#include <stdlib.h>

#include "comm/fail.h"
#include "tests/mpi_check.h"

bool bodies_block(int grid, const int at[3], struct bodies_cell *cell)
{
    (void)grid;
    (void)at;
    (void)cell;
    return true;
}

static uint64_t hash(int grid, const int at[3])
{
    return mpi_check_random((uint64_t)(((grid * 1000 + at[2]) * 1000 + at[1]) * 1000 + at[0]));
}

bool bodies_voxels(int grid, const int at[3], struct bodies_cell *cell)
{
    (void)cell;
    return hash(grid, at) % 3 != 0;
}

bool bodies_mixed(int grid, const int at[3], struct bodies_cell *cell)
{
    uint64_t h = hash(grid, at);
    /* a layer of the first, grains of the second in it */
    cell->kind = at[1] >= 4 || h >> 40 & 15 ? at[1] < 4 : 1;
    cell->fixed = at[0] == 0 ? 63 : h >> 20 & 31 ? 0 : (int)(h >> 30 & 63);
    cell->row = h >> 50 & 3 ? 0 : 1 + (int)(h >> 52 & 3);
    return h % 3 != 0;
}

struct lattice_cells *bodies_create(
    int n_grid, const int size[3], double h, int n_material, bodies_solid *solid)
{
    struct lattice_cells *c = fail_alloc(sizeof *c);
    int64_t most = (int64_t)n_grid * size[0] * size[1] * size[2],
            *seen = fail_alloc((size_t)most * sizeof *seen);
    c->n_grid = n_grid;
    c->n_kind = n_grid * n_material;
    c->grid = fail_alloc((size_t)n_grid * sizeof *c->grid);
    c->kind = fail_alloc((size_t)c->n_kind * sizeof *c->kind);
    c->at = fail_alloc((size_t)most * sizeof *c->at);
    c->kind_of = fail_alloc((size_t)most);
    c->body = fail_alloc((size_t)most * sizeof *c->body);
    c->bits = fail_alloc((size_t)most * sizeof *c->bits);
    c->row = fail_alloc((size_t)most * sizeof *c->row);
    for (int g = 0; g < n_grid; g++) {
        c->grid[g] = (struct lattice_grid){g % 2 ? h / 2 : h, {20 * h * g, 0, 0}};
        for (int m = 0; m < n_material; m++)
            c->kind[g * n_material + m] = (struct lattice_kind){m, g};
        const int less = g % 2, n[3] = {size[0] - less, size[1] - less, size[2] - less},
                  step[3] = {1, n[0], n[0] * n[1]};
        for (int k = 0; k < n[0] * n[1] * n[2]; k++) {
            const int at[3] = {k % n[0], k / n[0] % n[1], k / (n[0] * n[1])};
            struct bodies_cell cell = {0, 0, 0};
            seen[k] = -1;
            if (!solid(g, at, &cell)) continue;
            int64_t i = c->n++;
            seen[k] = i;
            for (int a = 0; a < 3; a++) {
                c->at[i][a] = at[a];
                int64_t j = at[a] > 0 ? seen[k - step[a]] : -1;
                if (j < 0) continue;
                c->bits[i] |= (uint16_t)CELL_LINK(2 * a);
                c->bits[j] |= (uint16_t)CELL_LINK(2 * a + 1);
            }
            c->kind_of[i] = (uint8_t)(g * n_material + cell.kind % n_material);
            c->bits[i] |= (uint16_t)(cell.fixed << 6);
            c->row[i] = cell.row;
        }
    }
    free(seen);
    return c;
}

static double part(int64_t i, int what)
{
    return 0.2 +
           0.8 * (double)(mpi_check_random((uint64_t)(64 * i + what)) >> 11) / 9007199254740992.0;
}

void bodies_cut(struct lattice_cells *c)
{
    int32_t *upper = fail_alloc((size_t)c->n * sizeof *upper);
    c->share_of = fail_alloc((size_t)c->n * sizeof *c->share_of);
    c->share = fail_alloc((size_t)(c->n + 1) * sizeof *c->share);
    c->share[c->n_share++] =
        (struct lattice_share){.face = {1, 1, 1, 1, 1, 1}, .volume = 1, .mass = 1};
    for (int64_t i = 0; i < c->n; i++) {
        if (c->at[i][1] > 2) continue;
        struct lattice_share *s = &c->share[c->n_share];
        c->share_of[i] = c->n_share++;
        *s = (struct lattice_share){.volume = part(i, 1), .mass = part(i, 2)};
        for (int f = 0; f < 6; f++) {
            s->face[f] = part(i, 3 + f);
            for (int k = 0; k < 2; k++) s->offset[f][k] = part(i, 9 + 2 * f + k) - 0.6;
        }
    }
    for (int a = 0; a < 3; a++) {
        lattice_cells_upper(c, a, upper);
        for (int64_t i = 0; i < c->n; i++) {
            if (upper[i] < 0 || !c->share_of[i]) continue;
            struct lattice_share *s = &c->share[c->share_of[i]],
                                 *t = &c->share[c->share_of[upper[i]]];
            if (!c->share_of[upper[i]]) s->face[2 * a + 1] = 1;
            else t->face[2 * a] = s->face[2 * a + 1];
            for (int k = 0; k < 2; k++) {
                if (!c->share_of[upper[i]]) s->offset[2 * a + 1][k] = 0;
                else t->offset[2 * a][k] = s->offset[2 * a + 1][k];
            }
        }
    }
    free(upper);
}

void bodies_free(struct lattice_cells *c)
{
    if (!c) return;
    free(c->grid);
    free(c->kind);
    free(c->at);
    free(c->kind_of);
    free(c->body);
    free(c->bits);
    free(c->row);
    free(c->share_of);
    free(c->share);
    free(c->v);
    free(c->w);
    free(c);
}

void bodies_shake(struct lattice_cells *c, double v, double w)
{
    c->v = fail_alloc((size_t)c->n * sizeof *c->v);
    c->w = fail_alloc((size_t)c->n * sizeof *c->w);
    for (int64_t i = 0; i < c->n; i++)
        for (int a = 0; a < 6; a++) {
            double r =
                (double)(mpi_check_random((uint64_t)(6 * i + a + 77)) >> 11) / 4503599627370496.0 -
                1;
            if (c->bits[i] & CELL_FIX(a)) r = 0;
            if (a < 3) c->v[i][a] = v * r;
            else c->w[i][a - 3] = w * r;
        }
}

struct lattice_motion bodies_motion(int64_t n)
{
    size_t s = (size_t)n;
    struct lattice_motion m = {fail_alloc(s * sizeof *m.u), fail_alloc(s * sizeof *m.theta),
        fail_alloc(s * sizeof *m.q), fail_alloc(s * sizeof *m.v), fail_alloc(s * sizeof *m.w)};
    for (int64_t i = 0; i < n; i++) m.q[i][0] = 1;
    return m;
}

void bodies_motion_free(struct lattice_motion *m)
{
    free(m->u);
    free(m->theta);
    free(m->q);
    free(m->v);
    free(m->w);
}
