#include "lattice_layout.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "kernels/lattice/lattice_words.h"
#include "comm/fail.h"

/* What a run costs beside its places, in places. One with cells of several kinds, loads or fixed
 * DOF counts twice: 60^3 cells of which all runs are so took 1.2 (fixed DOF), 2.6 (loads) and 3.2
 * times (kinds) as long as without. */
enum { RUN_COST = 6 };
/* Lengths that are tried: whole vectors of any processor, and work-groups that any device takes. */
enum { RUN_SHORTEST = 16, RUN_LONGEST = 128, RUN_STEP = 8 };
/* Planes begin this many cells beyond a multiple of 1024: aligned for any vector, and in different
 * sets of a cache. */
enum { PLANE_SHIFT = 80 };
/* Cells in one layer of a tile, see order_runs. On 100^3 cells in double precision, pocl 3.1, AMD
 * Zen 5 with 1 MiB per core: without tiles 48 million cells/s, with 800 cells 50, with 1,600 cells
 * 52, with 3,200 cells 50. */
enum { TILE_CELLS = 1600 };
enum { NOTHING, OWNED, FIRST_GHOST, SECOND_GHOST };

struct build {
    const struct lattice_cells *cells;
    const int *owner;
    int rank, n_rank, depth;
    struct lattice_places *places;
    uint8_t *mark; /* [n] */
    int *local;    /* [places->n_run] number on this rank, 0: not here */
    struct lattice_layout *l;
};

struct lattice_lay lattice_layout_run(const struct lattice_cells *cells)
{
    struct lattice_lay best = {0, RUN_SHORTEST};
    int64_t least = INT64_MAX;
    for (int axis = 0; axis < 3; axis++) {
        int32_t *order = lattice_places_order(cells, axis);
        for (int length = RUN_SHORTEST; length <= RUN_LONGEST; length += RUN_STEP) {
            struct lattice_lay run = {axis, length};
            int64_t n_mixed, n = lattice_places_count(cells, run, order, &n_mixed),
                             cost = (n + n_mixed) * (length + RUN_COST);
            bool better = cost < least || (cost == least && axis == best.axis);
            if (better) best = run;
            if (better) least = cost;
        }
        free(order);
    }
    return best;
}

/* The linked neighbour, or -1. */
static int64_t linked(const struct build *b, int64_t gid, int face)
{
    if (!(b->cells->bits[gid] & CELL_LINK(face))) return -1;
    int64_t j = lattice_places_neighbour(b->places, b->cells, gid, face);
    assert(j >= 0);
    return j;
}

static void mark(struct build *b)
{
    b->mark = fail_alloc((size_t)b->cells->n);
    for (int64_t i = 0; i < b->cells->n; i++) b->mark[i] = b->owner[i] == b->rank ? OWNED : NOTHING;
    for (int layer = OWNED; layer <= b->depth; layer++)
        for (int64_t i = 0; i < b->cells->n; i++)
            for (int f = 0; f < 6 && b->mark[i] == layer; f++) {
                int64_t j = linked(b, i, f);
                if (j >= 0 && b->mark[j] == NOTHING) b->mark[j] = (uint8_t)(layer + 1);
            }
}

static int index_of(const struct build *b, int64_t gid)
{
    return b->local[b->places->run_of[gid]] * b->l->run +
           lattice_places_lane(b->places, b->cells, gid);
}

static void number_runs(struct build *b)
{
    struct lattice_layout *l = b->l;
    int n = 1, axis = b->places->run.axis;
    b->local = fail_alloc((size_t)b->places->n_run * sizeof *b->local);
    for (int64_t i = 0; i < b->cells->n; i++)
        if (b->mark[i]) b->local[b->places->run_of[i]] = 1;
    for (int r = 0; r < b->places->n_run; r++)
        if (b->local[r]) b->local[r] = n++;
    l->axis = axis;
    l->run = b->places->run.length;
    l->n_run = n + 1;
    l->plane = ((int64_t)l->n_run * l->run + 1023 - PLANE_SHIFT) / 1024 * 1024 + PLANE_SHIFT;
    l->base = fail_alloc(4 * (size_t)l->n_run * sizeof *l->base);
    for (int r = 0; r < b->places->n_run; r++)
        for (int f = 0; f < 4 && b->local[r]; f++) {
            int other = f / 2 + (f / 2 >= axis),
                beside = lattice_places_beside(b->places, r, other, f % 2 ? 1 : -1);
            if (beside >= 0) l->base[f * l->n_run + b->local[r]] = b->local[beside] * l->run;
        }
}

static void fill_words(struct build *b)
{
    struct lattice_layout *l = b->l;
    l->word = fail_alloc((size_t)l->plane * sizeof *l->word);
    l->row = fail_alloc((size_t)l->plane * sizeof *l->row);
    l->share = fail_alloc((size_t)l->plane * sizeof *l->share);
    l->gid = fail_alloc((size_t)b->cells->n * sizeof *l->gid);
    l->index = fail_alloc((size_t)b->cells->n * sizeof *l->index);
    for (int64_t i = 0; i < b->cells->n; i++) {
        if (!b->mark[i]) continue;
        int at = index_of(b, i), has_links = b->mark[i] <= FIRST_GHOST;
        l->word[at] = (has_links ? b->cells->bits[i] & 63 : 0) |
                      (b->cells->bits[i] & 63 << WORD_FIX) | (b->mark[i] == OWNED) << WORD_OWNED |
                      b->cells->kind_of[i] << WORD_KIND;
        l->row[at] = b->cells->row ? b->cells->row[i] : 0;
        l->share[at] = b->cells->share ? b->cells->share_of[i] : 0;
        if (b->mark[i] != OWNED) continue;
        l->gid[l->n_owned] = i;
        l->index[l->n_owned++] = at;
    }
}

/* Whether a run is of one kind, neighbours included, without loads, fixed DOF and cells that a
 * surface cuts. That one has shares does not depend on which of its cells a rank has. */
static void fill_info(struct build *b)
{
    struct lattice_layout *l = b->l;
    l->info = fail_alloc((size_t)l->n_run * sizeof *l->info);
    for (int r = 0; r < l->n_run; r++) l->info[r] = -1;
    for (int64_t i = 0; i < b->cells->n; i++) {
        if (b->mark[i] != OWNED && b->mark[i] != FIRST_GHOST) continue;
        int *info = &l->info[b->local[b->places->run_of[i]]], kind = b->cells->kind_of[i];
        if (*info < 0) *info = kind;
        bool apart = (*info & (RUN_MIXED - 1)) != kind || b->cells->bits[i] >> WORD_FIX ||
                     (b->cells->row && b->cells->row[i]);
        for (int f = 0; f < 6; f++) {
            int64_t j = linked(b, i, f);
            apart |= j >= 0 && b->cells->kind_of[j] != kind;
        }
        if (apart) *info |= RUN_MIXED;
    }
    for (int r = 0; r < l->n_run; r++)
        if (l->info[r] < 0) l->info[r] = 0;
    for (int64_t i = 0; i < b->cells->n && b->cells->share; i++) {
        int r = b->local[b->places->run_of[i]];
        if (r && b->cells->share_of[i]) l->info[r] |= RUN_MIXED;
    }
}

/* A run and where it comes in the order of kernels. */
struct tile {
    int32_t grid, rows; /* rows: number of the tile along the near axis */
    int run;
};

static int compare_tiles(const void *a, const void *b)
{
    const struct tile *p = a, *q = b;
    if (p->grid != q->grid) return p->grid < q->grid ? -1 : 1;
    if (p->rows != q->rows) return p->rows < q->rows ? -1 : 1;
    return p->run < q->run ? -1 : p->run > q->run; /* runs are sorted by grid, far, near, along */
}

/* The runs of this rank in the order in which kernels take them: tiles of some rows along the near
 * axis, each through all layers along the far one, so that the three layers that the links of a row
 * reach stay in a core's cache. */
static int *order_runs(const struct build *b)
{
    const struct lattice_place *p = b->places->place;
    struct tile *tile = fail_alloc((size_t)b->l->n_run * sizeof *tile);
    int *order = fail_alloc((size_t)b->l->n_run * sizeof *order), n = 0, row = 0, longest = 1;
    for (int r = 0; r < b->places->n_run; r++) {
        row = r > 0 && p[r].grid == p[r - 1].grid && p[r].far == p[r - 1].far &&
                      p[r].near == p[r - 1].near
                  ? row + 1
                  : 1;
        if (row > longest) longest = row;
    }
    int rows = TILE_CELLS / (longest * b->l->run);
    if (rows < 1) rows = 1;
    for (int r = 0; r < b->places->n_run; r++)
        if (b->local[r]) tile[n++] = (struct tile){p[r].grid, p[r].near / rows, b->local[r]};
    qsort(tile, (size_t)n, sizeof *tile, compare_tiles);
    for (int k = 0; k < n; k++) order[k] = tile[k].run;
    free(tile);
    return order;
}

/* Runs with mark `yes`, first those without `late`. order: all but the first and last, which are
 * empty. */
static int *list(const struct lattice_layout *l, const int *order, const bool *yes,
    const bool *late, int *n, int *n_first)
{
    int *list = fail_alloc((size_t)l->n_run * sizeof *list);
    *n = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int k = 0; k < l->n_run - 2; k++)
            if (yes[order[k]] && late[order[k]] == (pass == 1)) list[(*n)++] = order[k];
        if (pass == 0) *n_first = *n;
    }
    return list;
}

static void list_runs(struct build *b)
{
    struct lattice_layout *l = b->l;
    bool *owned = fail_alloc((size_t)l->n_run), *needed = fail_alloc((size_t)l->n_run),
         *late_p = fail_alloc((size_t)l->n_run), *late_f = fail_alloc((size_t)l->n_run);
    /* p first: forces ask whether the p of their neighbours is late */
    for (int pass = 0; pass < 2; pass++)
        for (int64_t i = 0; i < b->cells->n; i++) {
            int r = b->local[b->places->run_of[i]];
            if (b->mark[i] != OWNED && b->mark[i] != FIRST_GHOST) continue;
            owned[r] |= b->mark[i] == OWNED;
            needed[r] |= b->depth == 2;
            late_p[r] |= b->mark[i] != OWNED;
            for (int f = 0; f < 6; f++) {
                int64_t j = linked(b, i, f);
                if (j < 0) continue;
                late_p[r] |= pass == 0 && b->mark[j] != OWNED;
                if (b->mark[i] != OWNED) continue;
                late_f[r] |= b->mark[j] != OWNED ||
                             (b->depth == 2 && pass == 1 && late_p[b->local[b->places->run_of[j]]]);
            }
            late_f[r] |= b->depth == 2 && pass == 1 && late_p[r];
        }
    int *order = order_runs(b);
    l->force = list(l, order, owned, late_f, &l->n_force, &l->n_force_interior);
    l->volume = list(l, order, needed, late_p, &l->n_volume, &l->n_volume_interior);
    free(order);
    free(owned);
    free(needed);
    free(late_p);
    free(late_f);
}

static void add(int **list, int64_t *n, int index)
{
    if ((*n & (*n - 1)) == 0)
        *list = fail_realloc(*list, (size_t)(*n > 0 ? 2 * *n : 16) * sizeof **list);
    (*list)[(*n)++] = index;
}

/* Marks with r the owned cells within `depth` links of the cell i. */
static void stamp_around(const struct build *b, int *stamp, int64_t i, int r, int depth)
{
    for (int f = 0; f < 6; f++) {
        int64_t j = linked(b, i, f);
        if (j < 0) continue;
        if (b->mark[j] == OWNED) stamp[j] = r;
        if (depth > 1) stamp_around(b, stamp, j, r, depth - 1);
    }
}

/* Links and layers are symmetric: a rank needs those of my cells that lie within `depth` links of
 * what I have as a ghost from it. */
static void list_ghosts(struct build *b)
{
    struct lattice_layout *l = b->l;
    int *stamp = fail_alloc((size_t)b->cells->n * sizeof *stamp);
    l->count_to = fail_alloc((size_t)b->n_rank * sizeof *l->count_to);
    l->count_from = fail_alloc((size_t)b->n_rank * sizeof *l->count_from);
    for (int64_t i = 0; i < b->cells->n; i++) {
        stamp[i] = -1;
        if (b->mark[i] > OWNED) l->count_from[b->owner[i]]++;
    }
    for (int r = 0; r < b->n_rank; r++) {
        if (l->count_from[r] == 0) continue;
        for (int64_t i = 0; i < b->cells->n; i++) {
            if (b->mark[i] <= OWNED || b->owner[i] != r) continue;
            add(&l->recv, &l->n_recv, index_of(b, i));
            stamp_around(b, stamp, i, r, b->depth);
        }
        int64_t before = l->n_send;
        for (int64_t k = 0; k < l->n_owned; k++)
            if (stamp[l->gid[k]] == r) add(&l->send, &l->n_send, l->index[k]);
        l->count_to[r] = l->n_send - before;
    }
    free(stamp);
}

struct lattice_layout *lattice_layout_create(const struct lattice_cells *cells, const int *owner,
    int rank, int n_rank, struct lattice_lay run, int depth)
{
    struct lattice_layout *l = fail_alloc(sizeof *l);
    struct build b = {
        .cells = cells, .owner = owner, .rank = rank, .n_rank = n_rank, .depth = depth, .l = l};
    b.places = lattice_places_create(cells, run);
    mark(&b);
    number_runs(&b);
    fill_words(&b);
    fill_info(&b);
    list_runs(&b);
    list_ghosts(&b);
    lattice_places_free(b.places);
    free(b.mark);
    free(b.local);
    assert(lattice_layout_is_valid(l, n_rank));
    return l;
}

static bool all_within(const int *list, int64_t n, int64_t low, int64_t high)
{
    bool is = true;
    for (int64_t k = 0; k < n; k++) is &= list[k] >= low && list[k] < high;
    return is;
}

bool lattice_layout_is_valid(const struct lattice_layout *l, int n_rank)
{
    int64_t n_place = (int64_t)l->n_run * l->run, n_send = 0, n_recv = 0;
    /* runs between the empty ones */
    bool is = n_place <= l->plane && all_within(l->force, l->n_force, 1, l->n_run - 1) &&
              all_within(l->volume, l->n_volume, 1, l->n_run - 1) &&
              all_within(l->index, l->n_owned, l->run, n_place - l->run) &&
              all_within(l->send, l->n_send, l->run, n_place - l->run) &&
              all_within(l->recv, l->n_recv, l->run, n_place - l->run) &&
              l->n_force_interior <= l->n_force && l->n_volume_interior <= l->n_volume;
    for (int r = 0; r < n_rank; r++) {
        n_send += l->count_to[r];
        n_recv += l->count_from[r];
    }
    is &= n_send == l->n_send && n_recv == l->n_recv;
    unsigned char *taken = fail_alloc((size_t)n_place);
    for (int64_t k = 0; k < l->n_owned && is; k++)
        is &= (k == 0 || l->gid[k - 1] < l->gid[k]) && !taken[l->index[k]]++;
    free(taken);
    return is;
}

void lattice_layout_free(struct lattice_layout *l)
{
    if (!l) return;
    void *all[] = {l->base, l->info, l->word, l->row, l->share, l->gid, l->index, l->force,
        l->volume, l->count_to, l->count_from, l->send, l->recv};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) free(all[k]);
    free(l);
}
