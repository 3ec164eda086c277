/* Runs on every rank against brute force: each link's neighbour is where the kernel looks, words,
 * ghosts of one and two layers, what is interior, and lists of what is sent that match what is
 * received. Host only. */
#include "tests/limit/limit_test.h"

#include "comm/fail.h"
#include "lattice_bodies.h"
#include "kernels/lattice/lattice_words.h"
#include "tests/mpi_check.h"

enum { MOST_RANKS = 8 };

struct world {
    struct lattice_cells *cells;
    int *owner, n_rank, depth;
    int *where; /* [n_rank][n] index on that rank, -1 */
    struct lattice_layout *l[MOST_RANKS];
};

/* Without the layout's own search. */
static int64_t brute(const struct lattice_cells *c, int64_t i, int face)
{
    int at[3] = {c->at[i][0], c->at[i][1], c->at[i][2]}, grid = c->kind[c->kind_of[i]].grid;
    at[face / 2] += face % 2 ? 1 : -1;
    for (int64_t j = 0; j < c->n; j++)
        if (c->kind[c->kind_of[j]].grid == grid && c->at[j][0] == at[0] && c->at[j][1] == at[1] &&
            c->at[j][2] == at[2])
            return j;
    return -1;
}

/* Fewest links from a cell to one of the rank's: 0, 1, 2, or 3 for more. */
static int distance(const struct world *w, int64_t i, int rank)
{
    int best = 3;
    if (w->owner[i] == rank) return 0;
    for (int f = 0; f < 6; f++) {
        if (!(w->cells->bits[i] & CELL_LINK(f))) continue;
        int64_t j = brute(w->cells, i, f);
        if (w->owner[j] == rank) return 1;
        for (int g = 0; g < 6; g++)
            if (w->cells->bits[j] & CELL_LINK(g) && w->owner[brute(w->cells, j, g)] == rank)
                best = 2;
    }
    return best;
}

static bool is_in(const int *list, int n, int value)
{
    for (int k = 0; k < n; k++)
        if (list[k] == value) return true;
    return false;
}

/* Where cells of all ranks are: owned from the layout, ghosts from the two ends of each message. */
static void find_places(struct world *w)
{
    int64_t n = w->cells->n;
    for (int64_t k = 0; k < n * w->n_rank; k++) w->where[k] = -1;
    for (int r = 0; r < w->n_rank; r++)
        for (int64_t k = 0; k < w->l[r]->n_owned; k++)
            w->where[r * n + w->l[r]->gid[k]] = w->l[r]->index[k];
    for (int to = 0; to < w->n_rank; to++) {
        int64_t at = 0;
        for (int from = 0; from < w->n_rank; from++) {
            const struct lattice_layout *s = w->l[from];
            int64_t begin = 0, count = s->count_to[to];
            assert_int_equal(count, w->l[to]->count_from[from]);
            for (int r = 0; r < to; r++) begin += s->count_to[r];
            for (int64_t k = 0; k < count; k++) {
                int64_t gid = 0;
                while (gid < s->n_owned && s->index[gid] != s->send[begin + k]) gid++;
                assert_true(gid < s->n_owned);
                w->where[to * n + s->gid[gid]] = w->l[to]->recv[at++];
            }
        }
        assert_int_equal(at, w->l[to]->n_recv);
    }
}

static void check_cell(const struct world *w, int r, int64_t i)
{
    const struct lattice_layout *l = w->l[r];
    int64_t n = w->cells->n;
    int at = w->where[r * n + i], d = distance(w, i, r);
    assert_int_equal(at >= 0, d <= w->depth);
    if (at < 0) return;
    int word = l->word[at], run = at / l->run;
    assert_int_equal(word >> WORD_OWNED & 1, d == 0);
    assert_int_equal(word >> WORD_KIND & 255, w->cells->kind_of[i]);
    assert_int_equal(word >> WORD_FIX & 63, w->cells->bits[i] >> 6);
    assert_int_equal(word & 63, d <= 1 ? w->cells->bits[i] & 63 : 0);
    assert_int_equal(l->row[at], w->cells->row[i]);
    assert_int_equal(at % l->run, w->cells->at[i][l->axis] % l->run);
    assert_true(
        l->info[run] & RUN_MIXED ||
        (l->info[run] == w->cells->kind_of[i] && !(w->cells->bits[i] >> 6) && !l->row[at]) ||
        d > 1);
    if (d == 0) assert_true(is_in(l->force, l->n_force, run));
    if (w->depth == 2 && d <= 1) assert_true(is_in(l->volume, l->n_volume, run));
    for (int f = 0; f < 6 && d < w->depth; f++) {
        if (!(word >> f & 1)) continue;
        int64_t j = brute(w->cells, i, f);
        int side = f - 2 * (f / 2 > l->axis),
            there = f / 2 == l->axis ? at + (f % 2 ? 1 : -1)
                                     : l->base[side * l->n_run + run] + at % l->run;
        assert_int_equal(there, w->where[r * n + j]);
        if (!(l->info[run] & RUN_MIXED))
            assert_int_equal(w->cells->kind_of[j], w->cells->kind_of[i]);
        if (d == 0 && is_in(l->force, l->n_force_interior, run)) {
            assert_int_equal(w->owner[j], r);
            if (w->depth == 2) assert_true(is_in(l->volume, l->n_volume_interior, there / l->run));
        }
        if (w->depth == 2 && is_in(l->volume, l->n_volume_interior, run))
            assert_int_equal(w->owner[j], r);
    }
    if (w->depth == 2 && is_in(l->force, l->n_force_interior, run) && d == 0)
        assert_true(is_in(l->volume, l->n_volume_interior, run));
}

static void check(
    struct lattice_cells *cells, int n_rank, int depth, int axis, int run, bool scattered)
{
    struct world w = {.cells = cells, .n_rank = n_rank, .depth = depth};
    int64_t n = cells->n, n_owned = 0;
    w.owner = fail_alloc((size_t)n * sizeof *w.owner);
    w.where = fail_alloc((size_t)(n * n_rank) * sizeof *w.where);
    for (int64_t i = 0; i < n; i++)
        w.owner[i] = scattered ? (int)(mpi_check_random((uint64_t)i) % (uint64_t)n_rank)
                               : (int)(cells->at[i][0] / 5 + cells->at[i][2] / 4) % n_rank;
    for (int r = 0; r < n_rank; r++) {
        w.l[r] = lattice_layout_create(
            cells, w.owner, r, n_rank, (struct lattice_lay){axis, run}, depth);
        n_owned += w.l[r]->n_owned;
        if (w.l[r]->n_owned > 1) {
            int *index = w.l[r]->index, first = index[0];
            assert_true(lattice_layout_is_valid(w.l[r], n_rank));
            index[0] = index[1]; /* two cells in one place */
            assert_false(lattice_layout_is_valid(w.l[r], n_rank));
            index[0] = first;
        }
        assert_true(w.l[r]->plane >= (int64_t)w.l[r]->n_run * run && w.l[r]->plane % 1024 == 80);
        for (int k = 0; k < run; k++)
            assert_true(w.l[r]->word[k] == 0 && w.l[r]->word[(w.l[r]->n_run - 1) * run + k] == 0);
    }
    assert_int_equal(n_owned, n);
    find_places(&w);
    for (int r = 0; r < n_rank; r++) {
        int64_t n_place = 0, n_word = 0;
        for (int64_t i = 0; i < n; i++) {
            check_cell(&w, r, i);
            n_place += w.where[r * n + i] >= 0;
        }
        for (int64_t k = 0; k < w.l[r]->plane; k++)
            n_word += w.l[r]->word[k] & (1 << WORD_OWNED) || (w.l[r]->word[k] & 63) > 0;
        assert_true(n_word <= n_place);
        lattice_layout_free(w.l[r]);
    }
    free(w.owner);
    free(w.where);
}

static void one_rank(void **state)
{
    const int size[3] = {37, 5, 4};
    struct lattice_cells *block = bodies_create(1, size, 0.1, 1, bodies_block),
                         *mixed = bodies_create(2, size, 0.1, 2, bodies_mixed);
    (void)state;
    for (int run = 16; run <= 48; run += 16)
        for (int axis = 0; axis < 3; axis++) {
            check(block, 1, 1, axis, run, false);
            check(mixed, 1, 2, axis, run, false);
        }
    bodies_free(block);
    bodies_free(mixed);
}

static void ranks(void **state)
{
    const int size[3] = {21, 6, 5};
    struct lattice_cells *voxels = bodies_create(1, size, 0.1, 1, bodies_voxels),
                         *mixed = bodies_create(2, size, 0.1, 2, bodies_mixed);
    (void)state;
    for (int n = 2; n <= MOST_RANKS; n += n < 4 ? 1 : 4)
        for (int depth = 1; depth <= 2; depth++) {
            check(voxels, n, depth, n % 3, 16, false);
            check(voxels, n, depth, (n + depth) % 3, 24, true);
            check(mixed, n, depth, 0, 32, false);
        }
    bodies_free(voxels);
    bodies_free(mixed);
}

static void run_lengths(void **state)
{
    const int size[5][3] = {{30, 8, 8}, {16, 8, 8}, {64, 8, 8}, {100, 30, 30}, {6, 5, 40}};
    const struct lattice_lay best[5] = {{0, 32}, {0, 16}, {0, 64}, {0, 104}, {2, 40}};
    (void)state;
    for (int k = 0; k < 5; k++) {
        struct lattice_cells *c = bodies_create(1, size[k], 0.1, 1, bodies_block);
        struct lattice_lay run = lattice_layout_run(c);
        assert_int_equal(run.axis, best[k].axis);
        assert_int_equal(run.length, best[k].length);
        for (int64_t i = 0; k < 4 && i < c->n; i++) /* now all runs along x have one */
            if (c->at[i][0] == 0) c->bits[i] |= CELL_FIX(0);
        /* short rows would be half empty along y */
        if (k < 4) assert_int_equal(lattice_layout_run(c).axis, k == 3 ? 1 : 0);
        bodies_free(c);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(one_rank), cmocka_unit_test(ranks), cmocka_unit_test(run_lengths)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
