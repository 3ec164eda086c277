#include "lattice_restore.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "lattice_fields.h"
#include "kernels/lattice/lattice_words.h"
#include "base/whole.h"
#include "comm/fail.h"
#include "results/h5_check.h"
#include "run/resume.h"

static double *read_ledger(const struct lattice *l)
{
    size_t n = (size_t)l->layout->n_owned;
    double *ledger = fail_alloc(n * LATTICE_LEDGER * sizeof *ledger);
    for (int k = 0; k < LATTICE_LEDGER; k++) {
        double *plane = lattice_read_plane(l, &l->ledger, false, k);
        for (size_t i = 0; i < n; i++) ledger[LATTICE_LEDGER * i + (size_t)k] = plane[i];
        free(plane);
    }
    return ledger;
}

void lattice_restore_take(const struct sim *s, struct lattice_state *state)
{
    const struct lattice *l = s->lattice->lattice;
    size_t n = (size_t)state->n;
    if (l->scheme->ends_with_kick) {
        state->v_before = fail_alloc(n * sizeof *state->v_before);
        state->w_before = fail_alloc(n * sizeof *state->w_before);
        struct lattice_motion m = {.v = state->v_before, .w = state->w_before};
        lattice_read_before(l, &m);
    }
    if (!l->features.energy) return;
    state->ledger = read_ledger(l);
    if (!l->breakage) return;
    state->fresh = fail_alloc(n * sizeof *state->fresh);
    state->released = fail_alloc(n * sizeof *state->released);
    lattice_break_read_release(l->breakage, state->fresh, state->released);
}

/* The numbers of the table `totals`, in this order. */
struct totals {
    struct lattice_energy start;
    double opened[LATTICE_ENERGY_OPENED], relax[LATTICE_RELAX_NOTES], rest_next, rest_reached,
        rest_left, rest_damping;
};
_Static_assert(
    sizeof(struct totals) == LATTICE_RESTORE_TOTALS * sizeof(double), "numbers and nothing else");

double *lattice_restore_totals(const struct sim *s)
{
    struct totals *t = fail_alloc(sizeof *t);
    t->start = s->lattice->energy_start;
    lattice_energy_opened(s->lattice->account, t->opened);
    if (s->lattice->relax) lattice_relax_note(s->lattice->relax, t->relax);
    t->rest_next = (double)s->rest.next;
    t->rest_reached = s->rest.reached;
    t->rest_left = s->rest.left;
    t->rest_damping = s->rest.damping;
    return (double *)t;
}

int64_t lattice_restore_inputs(const struct sim *s)
{
    const struct lattice_cells *c = s->lattice->cells;
    int64_t inputs;
    uint64_t sum = h5_check_add((uint64_t)c->n, COLUMN_I32, c->at, 3 * c->n);
    sum = h5_check_add(sum, COLUMN_U8, c->kind_of, c->n);
    sum = h5_check_add(sum, COLUMN_U8, c->bits, 2 * c->n);
    sum = h5_check_add(sum, COLUMN_I32, c->row, c->n);
    for (int k = 0; k < s->scene->n_boundary; k++) {
        const struct history *h = &s->scene->boundary[k].history;
        if (h->n_point > 0) sum = h5_check_add(sum, COLUMN_F64, h->point, 2 * (int64_t)h->n_point);
    }
    memcpy(&inputs, &sum, sizeof inputs);
    return inputs;
}

bool lattice_restore_energy(const struct sim *s, bool asked)
{
    bool has = h5_has(s->from->reader, "cells", "ledger");
    if (asked && !has)
        fail_stop_together(EXIT_SCENE,
            "a measure of energy cannot be added to a restarted run: '%s' has no record of its "
            "earlier values",
            s->from->path);
    return has;
}

static int64_t place_of(const struct lattice_layout *c, int64_t gid)
{
    int64_t low = 0, high = c->n_owned;
    while (low < high) {
        int64_t mid = low + (high - low) / 2;
        if (c->gid[mid] < gid) low = mid + 1;
        else high = mid;
    }
    return low;
}

/* Rows into ascending id, as layout->gid has them. */
static void sort_rows(struct frame_table *t, const struct lattice_layout *c)
{
    const int64_t *id = frame_table_get(t, "id");
    int64_t *to = fail_alloc((size_t)t->n * sizeof *to);
    for (int64_t i = 0; i < t->n; i++) to[i] = place_of(c, id[i]);
    for (int k = 0; k < t->n_column; k++) {
        size_t bytes = (size_t)t->column[k].width * column_type_size(t->column[k].type);
        char *sorted = fail_alloc((size_t)t->n * bytes);
        for (int64_t i = 0; i < t->n; i++)
            memcpy(sorted + (size_t)to[i] * bytes,
                (const char *)t->column[k].data + (size_t)i * bytes, bytes);
        free(t->column[k].data);
        t->column[k].data = sorted;
    }
    free(to);
}

/* Small rotations lie in rows of four. */
static void write_motion(struct sim *s, const struct lattice_state *t)
{
    double(*theta)[3] = fail_alloc((size_t)t->n * sizeof *theta);
    for (int64_t i = 0; i < t->n; i++) memcpy(theta[i], t->turn[i], sizeof *theta);
    struct lattice_motion m = {.u = t->u, .theta = theta, .q = t->turn, .v = t->v, .w = t->w},
                          before = {.v = t->v_before, .w = t->w_before};
    lattice_write_observed(s->lattice->lattice, s->from->step, &m, &before);
    free(theta);
}

/* Links and fates of a cell that its body can have. */
static bool may_break_so(int32_t bits, int32_t links, int32_t fate)
{
    bool good = !(links & ~(bits & CELL_LINKS)) && !(fate >> FATE_DUE_AT & ~links);
    for (int axis = 0; axis < 3; axis++) good &= FATE_MODE(fate, axis) <= LATTICE_BREAK_MODES;
    return good;
}

/* Indices and numbers of the table may be used. */
static void check_cells(struct sim *s, const struct frame_table *table)
{
    frame_table_check_range(table, s->comm, "id", 0, s->n_first - 1);
    frame_table_check_unique(table, s->comm, "id", s->n_first);
    frame_table_check_finite(table, s->comm);
    struct lattice_state t = lattice_fields_rows(s, table);
    int64_t wrong = -1;
    for (int64_t i = table->n - 1; i >= 0 && t.links; i--)
        if (!may_break_so(s->lattice->cells->bits[t.gid[i]], t.links[i], t.fate[i])) wrong = i;
    frame_table_check_row(table, s->comm, "links", wrong, "are links that the cell does not have");
    for (int64_t i = table->n - 1; i >= 0 && t.fresh; i--)
        if (t.fresh[i] & ~(s->lattice->cells->bits[t.gid[i]] & CELL_LINKS)) wrong = i;
    frame_table_check_row(table, s->comm, "fresh", wrong, "are links that the cell does not have");
    if (table->n_total != s->n_first)
        fail_stop_together(
            EXIT_IO, "'%s' cannot be used: it does not have every cell", table->path);
}

void lattice_restore_cells(struct sim *s)
{
    struct lattice *l = s->lattice->lattice;
    struct frame_table table = frame_table_begin(s->comm, s->from->reader, "cells", "id");
    lattice_fields_read(s, &table);
    check_cells(s, &table);
    int32_t *owner = frame_table_owners(s->comm, l->layout->gid, l->layout->n_owned, s->n_first),
            *to = fail_alloc((size_t)table.n * sizeof *to);
    const int64_t *id = lattice_fields_rows(s, &table).gid;
    for (int64_t i = 0; i < table.n; i++) to[i] = owner[id[i]];
    frame_table_send(&table, s->comm, to, 1);
    free(to);
    free(owner);
    sort_rows(&table, l->layout);
    struct lattice_state t = lattice_fields_rows(s, &table);
    write_motion(s, &t);
    if (l->breakage) lattice_break_write(l->breakage, t.links, t.fate);
    for (int k = 0; k < LATTICE_LEDGER && t.ledger; k++)
        lattice_write_plane(l, &l->ledger, false, k, t.ledger + k, LATTICE_LEDGER);
    if (t.fresh) lattice_break_write_release(l->breakage, t.fresh, t.released);
    frame_table_free(&table);
}

/* What steers the way to rest: the step of the next look, and the damping. */
static void check_totals(const struct sim *s, const struct totals *t)
{
    const double from_zero[] = {t->rest_next, t->rest_damping, t->relax[0]}; /* the last: alpha */
    bool good = t->rest_next <= SCENE_STEPS_MOST;
    for (int k = 0; k < 3; k++) good &= from_zero[k] >= 0 && isfinite(from_zero[k]);
    if (!good)
        fail_stop_together(EXIT_IO,
            "'%s' cannot be used: totals/number: what leads to rest is no number from 0 on",
            s->from->path);
}

void lattice_restore_run(struct sim *s)
{
    struct totals t;
    h5_read_rows(s->from->reader, "totals", "number", COLUMN_F64, 1, 0, LATTICE_RESTORE_TOTALS, &t);
    check_totals(s, &t);
    s->step = s->from->step;
    s->lattice->energy_start = t.start;
    lattice_energy_reopen(s->lattice->account, t.opened);
    if (s->lattice->relax) lattice_relax_recall(s->lattice->relax, t.relax);
    s->rest.next = whole_i64(t.rest_next);
    s->rest.left = t.rest_left;
    s->rest.damping = t.rest_damping;
    double asked = s->scene->lattice.tolerance, before = s->from->before->lattice.tolerance;
    s->rest.reached = t.rest_reached > 0 && asked >= before;
    resume_recall(s);
}
