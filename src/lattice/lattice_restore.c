#include "lattice_restore.h"

#include <stdlib.h>
#include <string.h>

#include "kernels/lattice/lattice_words.h"
#include "results/digest.h"
#include "comm/fail.h"
#include "results/frame_table.h"
#include "results/h5_check.h"
#include "run/resume.h"

static bool has_before(const struct lattice *l)
{
    return l->scheme->ends_with_kick;
}

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

void lattice_restore_columns(struct sim *s, struct sheet *t)
{
    const struct lattice *l = s->lattice->lattice;
    size_t n = (size_t)l->layout->n_owned;
    if (has_before(l)) {
        struct lattice_motion m = {.v = sheet_keep(t, fail_alloc(n * sizeof *m.v)),
            .w = sheet_keep(t, fail_alloc(n * sizeof *m.w))};
        lattice_read_before(l, &m);
        sheet_add(
            t, "velocity_before", "m/s", "before the kick that ends the step", COLUMN_F64, 3, m.v);
        sheet_add(t, "angular_velocity_before", "rad/s", "likewise", COLUMN_F64, 3, m.w);
    }
    if (!l->features.energy) return;
    sheet_add(t, "ledger", "J", "see kernels/lattice/lattice_work.h", COLUMN_F64, LATTICE_LEDGER,
        sheet_keep(t, read_ledger(l)));
    if (!l->breakage) return;
    int32_t *fresh = sheet_keep(t, fail_alloc(n * sizeof *fresh));
    double *released = sheet_keep(t, fail_alloc(n * sizeof *released));
    lattice_break_read_release(l->breakage, fresh, released);
    sheet_add(t, "fresh", "1",
        "links that went with the last step, see kernels/lattice/link_release.cl", COLUMN_I32, 1,
        fresh);
    sheet_add(t, "released", "J", "by links that broke", COLUMN_F64, 1, released);
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

static uint64_t add(uint64_t sum, enum column_type type, const void *data, int64_t n)
{
    return digest_mix((sum ^ h5_check_sum(type, data, n, 0)) + DIGEST_G);
}

int64_t lattice_restore_inputs(const struct sim *s)
{
    const struct lattice_cells *c = s->lattice->cells;
    int64_t inputs;
    uint64_t sum = add((uint64_t)c->n, COLUMN_I32, c->at, 3 * c->n);
    sum = add(sum, COLUMN_U8, c->kind_of, c->n);
    sum = add(sum, COLUMN_U8, c->bits, 2 * c->n);
    sum = add(sum, COLUMN_I32, c->row, c->n);
    for (int k = 0; k < s->scene->n_boundary; k++) {
        const struct history *h = &s->scene->boundary[k].history;
        if (h->n_point > 0) sum = add(sum, COLUMN_F64, h->point, 2 * (int64_t)h->n_point);
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

/* Columns of the frame's cells, of this rank's share. */
static struct frame_table read_cells(const struct sim *s)
{
    const struct lattice *l = s->lattice->lattice;
    const struct h5_reader *reader = s->from->reader;
    bool before = has_before(l), energy = l->features.energy, breakage = l->breakage != NULL;
    const struct {
        const char *name;
        enum column_type type;
        int width;
        bool there;
    } column[] = {{"id", COLUMN_I64, 1, true}, {"displacement", COLUMN_F64, 3, true},
        {"rotation", COLUMN_F64, 4, true}, {"velocity", COLUMN_F64, 3, true},
        {"angular_velocity", COLUMN_F64, 3, true}, {"links", COLUMN_I32, 1, breakage},
        {"fate", COLUMN_I32, 1, breakage}, {"velocity_before", COLUMN_F64, 3, before},
        {"angular_velocity_before", COLUMN_F64, 3, before},
        {"ledger", COLUMN_F64, LATTICE_LEDGER, energy},
        {"fresh", COLUMN_I32, 1, energy && breakage},
        {"released", COLUMN_F64, 1, energy && breakage}};
    struct frame_table t = frame_table_begin(s->comm, reader, "cells", "id");
    for (size_t k = 0; k < sizeof column / sizeof *column; k++)
        if (column[k].there)
            frame_table_add(&t, s->comm, reader, column[k].name, column[k].type, column[k].width);
    return t;
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
static void sort_rows(struct frame_table *t, const struct lattice_layout *c, const char *path)
{
    const int64_t *id = frame_table_get(t, "id");
    int64_t *to = fail_alloc((size_t)t->n * sizeof *to);
    for (int64_t i = 0; i < t->n; i++) to[i] = place_of(c, id[i]);
    if (t->n != c->n_owned) fail_stop(EXIT_IO, "'%s' does not have every cell", path);
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
static void write_motion(struct sim *s, const struct frame_table *t)
{
    struct lattice *l = s->lattice->lattice;
    double(*turn)[4] = frame_table_get(t, "rotation"),
    (*theta)[3] = fail_alloc((size_t)t->n * sizeof *theta);
    for (int64_t i = 0; i < t->n; i++) memcpy(theta[i], turn[i], sizeof *theta);
    struct lattice_motion m = {.u = frame_table_get(t, "displacement"),
        .theta = theta,
        .q = turn,
        .v = frame_table_get(t, "velocity"),
        .w = frame_table_get(t, "angular_velocity")};
    struct lattice_motion before = {.v = frame_table_get(t, "velocity_before"),
        .w = frame_table_get(t, "angular_velocity_before")};
    lattice_write_observed(l, s->from->step, &m, &before);
    free(theta);
}

void lattice_restore_cells(struct sim *s)
{
    struct lattice *l = s->lattice->lattice;
    struct frame_table t = read_cells(s);
    int32_t *owner = frame_table_owners(s->comm, l->layout->gid, l->layout->n_owned, s->n_first),
            *to = fail_alloc((size_t)t.n * sizeof *to);
    const int64_t *id = frame_table_get(&t, "id");
    for (int64_t i = 0; i < t.n; i++) to[i] = owner[id[i]];
    frame_table_send(&t, s->comm, to, 1);
    free(to);
    free(owner);
    sort_rows(&t, l->layout, s->from->path);
    write_motion(s, &t);
    if (l->breakage)
        lattice_break_write(l->breakage, frame_table_get(&t, "links"), frame_table_get(&t, "fate"));
    const double *ledger = frame_table_get(&t, "ledger");
    for (int k = 0; k < LATTICE_LEDGER && ledger; k++)
        lattice_write_plane(l, &l->ledger, false, k, ledger + k, LATTICE_LEDGER);
    if (l->breakage && ledger)
        lattice_break_write_release(
            l->breakage, frame_table_get(&t, "fresh"), frame_table_get(&t, "released"));
    frame_table_free(&t);
}

void lattice_restore_run(struct sim *s)
{
    struct totals t;
    h5_read_rows(s->from->reader, "totals", "number", COLUMN_F64, 1, 0, LATTICE_RESTORE_TOTALS, &t);
    s->step = s->from->step;
    s->lattice->energy_start = t.start;
    lattice_energy_reopen(s->lattice->account, t.opened);
    if (s->lattice->relax) lattice_relax_recall(s->lattice->relax, t.relax);
    s->rest.next = (int64_t)t.rest_next;
    s->rest.left = t.rest_left;
    s->rest.damping = t.rest_damping;
    double asked = s->scene->lattice.tolerance, before = s->from->before->lattice.tolerance;
    s->rest.reached = t.rest_reached > 0 && asked >= before;
    resume_recall(s);
}
