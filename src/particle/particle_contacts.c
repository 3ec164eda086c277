/* The memory of contacts, of pairs and of elements at walls, to frames and back. */
#include "particle_contacts.h"

#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "results/frame_table.h"
#include "run/resume.h"

/* The contacts of a list on this rank, by their places in it. */
struct list {
    int64_t n, capacity;
    /* [n] lower element of a pair and higher; element and primitive; -1 in gaps */
    int64_t *id, *other;
    unsigned char *mine; /* [n] whether the contact counts on this rank */
    struct contact_layout layout;
    struct buffer *state, *history, *ledger;
};

static struct list list_of(int64_t n)
{
    size_t room = (size_t)n;
    struct list l = {.n = n};
    l.id = fail_alloc(room * sizeof *l.id);
    l.other = fail_alloc(room * sizeof *l.other);
    l.mine = fail_alloc(room);
    return l;
}

static struct list pairs_of(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct pair_list *p = &run->pairs->now;
    struct list l = list_of(p->first_boundary + p->n_boundary);
    size_t n = (size_t)l.n, all = (size_t)p->n_all;
    cl_int *i = fail_alloc(n * sizeof *i), *j = fail_alloc(n * sizeof *j);
    int64_t *gid = fail_alloc(all * sizeof *gid);
    buffer_read(&p->pair_i, 0, n * sizeof *i, i);
    buffer_read(&p->pair_j, 0, n * sizeof *j, j);
    buffer_read(&run->particles->field[FIELD_GID].now, 0, all * sizeof *gid, gid);
    for (size_t k = 0; k < n; k++) {
        bool gap = k >= (size_t)p->n_interior && k < (size_t)p->first_boundary;
        l.mine[k] = !gap && k < (size_t)(p->first_boundary + p->n_mine) && i[k] < p->n_lower;
        l.id[k] = gap ? -1 : gid[i[k]];
        l.other[k] = gap ? -1 : gid[j[k]];
    }
    l.capacity = p->capacity;
    l.layout = run->pairs->layout;
    l.state = &p->state;
    l.history = &p->history;
    l.ledger = &run->pairs->ledger;
    free(i);
    free(j);
    free(gid);
    return l;
}

static struct list walls_of(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct wall_contacts *w = run->wall_contacts;
    struct list l = list_of(w ? w->now.n : 0);
    size_t n = (size_t)l.n;
    if (!w) return l;
    cl_int *e = fail_alloc(n * sizeof *e), *k = fail_alloc(n * sizeof *k);
    int64_t *gid = fail_alloc((size_t)w->now.n_owned * sizeof *gid);
    buffer_read(&w->now.element, 0, n * sizeof *e, e);
    buffer_read(&w->now.candidate, 0, n * sizeof *k, k);
    buffer_read(
        &run->particles->field[FIELD_GID].now, 0, (size_t)w->now.n_owned * sizeof *gid, gid);
    for (size_t c = 0; c < n; c++) {
        l.id[c] = gid[e[c]];
        l.other[c] = k[c];
        l.mine[c] = 1;
    }
    l.capacity = w->now.capacity;
    l.layout = w->layout;
    l.state = &w->now.state;
    l.history = &w->now.history;
    l.ledger = &w->ledger;
    free(e);
    free(k);
    free(gid);
    return l;
}

static void list_free(struct list *l)
{
    free(l->id);
    free(l->other);
    free(l->mine);
}

/* Columns of a table of contacts in a frame. */
enum { ID, OTHER, STATE, HISTORY, LEDGER, N_COLUMN };
struct columns {
    struct {
        const char *name, *unit, *text;
        enum column_type type;
        int width; /* 0: not there */
    } of[N_COLUMN];
};

static const char *other_name(bool wall)
{
    return wall ? "primitive" : "partner";
}

static struct columns columns_of(const struct sim *s, const struct list *l, bool wall)
{
    return (struct columns){{
        [ID] = {"id", "1", "global id of the element; of the lower one in a pair", COLUMN_I64, 1},
        [OTHER] = {other_name(wall), "1", "the other element, or the primitive of the wall",
            COLUMN_I64, 1},
        [STATE] = {"state", "1", "bit 1: touching, bit 2: bonded", COLUMN_I32, 1},
        [HISTORY] = {"history", "m",
            "springs and dashpot forces, see kernels/contact/contact_memory.h", COLUMN_F64,
            l->layout.history},
        [LEDGER] = {"ledger", "J",
            "taken since the sums were last made, see kernels/contact/ledger.h", COLUMN_F64,
            s->particle->features.energy ? LEDGER_WIDTH : 0},
    }};
}

/* Rows under construction. */
struct rows {
    int64_t n, *id, *other;
    int32_t *state;
    double *history, *ledger;
};

/* Takes contact k, if it has anything to remember. Planes have `capacity` numbers each. */
static void take(struct rows *r, const struct list *l, int64_t k, int32_t state,
    const double *history, const double *ledger)
{
    int width = l->layout.history, any = state != 0;
    double *h = r->history + r->n * width, *e = r->ledger + r->n * LEDGER_WIDTH;
    for (int c = 0; c < width; c++) any |= (h[c] = history[c * l->capacity + k]) != 0;
    for (int c = 0; c < LEDGER_WIDTH && ledger; c++)
        any |= (e[c] = ledger[c * l->capacity + k]) != 0;
    if (!any) return;
    r->id[r->n] = l->id[k];
    r->other[r->n] = l->other[k];
    r->state[r->n++] = state;
}

static void read_rows(struct sim *s, const struct list *l, struct rows *r)
{
    struct particle_run *run = s->particle;
    size_t n = (size_t)l->n, planes = (size_t)l->capacity;
    if (!l->layout.remembers || n == 0) return;
    cl_int *state = fail_alloc(n * sizeof *state);
    double *history =
        reals_read(l->history, run->features.real_is_float, 0, (size_t)l->layout.history * planes);
    double *ledger =
        run->features.energy ? reals_read(l->ledger, false, 0, LEDGER_WIDTH * planes) : NULL;
    buffer_read(l->state, 0, n * sizeof *state, state);
    for (int64_t k = 0; k < l->n; k++)
        if (l->mine[k]) take(r, l, k, state[k], history, ledger);
    free(state);
    free(history);
    free(ledger);
}

int64_t particle_contacts_sheet(struct sim *s, struct sheet *t, bool wall)
{
    struct particle_run *run = s->particle;
    struct list l = wall ? walls_of(s) : pairs_of(s);
    size_t n = (size_t)l.n + 1, width = (size_t)l.layout.history;
    struct rows r = {.id = sheet_keep(t, fail_alloc(n * sizeof *r.id)),
        .other = sheet_keep(t, fail_alloc(n * sizeof *r.other)),
        .state = sheet_keep(t, fail_alloc(n * sizeof *r.state)),
        .history = sheet_keep(t, fail_alloc(n * width * sizeof *r.history)),
        .ledger = sheet_keep(
            t, fail_alloc((run->features.energy ? n * LEDGER_WIDTH : 0) * sizeof *r.ledger))};
    read_rows(s, &l, &r);
    const struct columns c = columns_of(s, &l, wall);
    void *const data[] = {r.id, r.other, r.state, r.history, r.ledger};
    for (int k = 0; k < N_COLUMN; k++) {
        if (c.of[k].width == 0) continue;
        if (k == HISTORY)
            sheet_add_real(t, run->features.real_is_float, c.of[k].name, c.of[k].unit, c.of[k].text,
                c.of[k].width, r.history, (size_t)r.n);
        else
            sheet_add(
                t, c.of[k].name, c.of[k].unit, c.of[k].text, c.of[k].type, c.of[k].width, data[k]);
    }
    list_free(&l);
    return r.n;
}

/* A row of the frame, to be found by its two numbers. */
struct key {
    int64_t id, other, row;
};

static int by_key(const void *a, const void *b)
{
    const struct key *x = a, *y = b;
    if (x->id != y->id) return x->id < y->id ? -1 : 1;
    return (x->other > y->other) - (x->other < y->other);
}

static struct key *sort_keys(const struct frame_table *t, bool wall)
{
    const int64_t *id = frame_table_get(t, "id"), *other = frame_table_get(t, other_name(wall));
    struct key *key = fail_alloc((size_t)t->n * sizeof *key);
    for (int64_t i = 0; i < t->n; i++) key[i] = (struct key){id[i], other[i], i};
    qsort(key, (size_t)t->n, sizeof *key, by_key);
    return key;
}

static void spread(double *plane, const double *row, int width, int64_t capacity, int64_t k)
{
    for (int c = 0; c < width && row; c++) plane[c * capacity + k] = row[c];
}

/* Puts the rows into the places of the list; returns how many of them count here. */
static int64_t fill(struct sim *s, const struct list *l, const struct frame_table *t, bool wall)
{
    struct particle_run *run = s->particle;
    size_t planes = (size_t)l->capacity;
    int width = l->layout.history;
    int64_t n_found = 0;
    if (!l->layout.remembers || l->n == 0) return 0;
    struct key *key = sort_keys(t, wall);
    const int32_t *state_of = frame_table_get(t, "state");
    const double *history_of = frame_table_get(t, "history"),
                 *ledger_of = frame_table_get(t, "ledger");
    cl_int *state = fail_alloc(planes * sizeof *state);
    double *history = fail_alloc((size_t)width * planes * sizeof *history),
           *ledger = fail_alloc(LEDGER_WIDTH * planes * sizeof *ledger);
    for (int64_t k = 0; k < l->n; k++) {
        const struct key wanted = {l->id[k], l->other[k], 0},
                         *found = bsearch(&wanted, key, (size_t)t->n, sizeof *key, by_key);
        if (!found) continue;
        state[k] = state_of[found->row];
        spread(history, history_of ? history_of + found->row * width : NULL, width, l->capacity, k);
        spread(ledger, ledger_of ? ledger_of + found->row * LEDGER_WIDTH : NULL, LEDGER_WIDTH,
            l->capacity, k);
        n_found += l->mine[k];
    }
    buffer_write(l->state, 0, planes * sizeof *state, state);
    reals_write(l->history, run->features.real_is_float, 0, (size_t)width * planes, history);
    if (run->features.energy) reals_write(l->ledger, false, 0, LEDGER_WIDTH * planes, ledger);
    void *own[] = {key, state, history, ledger};
    for (int i = 0; i < 4; i++) free(own[i]);
    return n_found;
}

/* A pair that a border cuts is known to both ranks. */
static void send(struct sim *s, struct frame_table *t, const int32_t *owner, bool wall)
{
    const int64_t *id = frame_table_get(t, "id"), *other = frame_table_get(t, other_name(wall));
    int32_t *to = fail_alloc(2 * (size_t)t->n * sizeof *to);
    for (int64_t i = 0; i < t->n; i++) {
        to[2 * i] = owner[id[i]];
        to[2 * i + 1] = wall ? -1 : owner[other[i]];
    }
    frame_table_send(t, s->comm, to, 2);
    free(to);
}

void particle_contacts_restore(struct sim *s, const int32_t *owner, bool wall)
{
    const struct h5_reader *reader = s->from->reader;
    struct list l = wall ? walls_of(s) : pairs_of(s);
    struct frame_table t =
        frame_table_begin(s->comm, reader, wall ? "wall_contacts" : "pairs", "id");
    const struct columns c = columns_of(s, &l, wall);
    for (int k = 0; k < N_COLUMN; k++)
        if (c.of[k].width > 0)
            frame_table_add(&t, reader, c.of[k].name, c.of[k].type, c.of[k].width);
    frame_table_check_range(&t, s->comm, "id", 0, s->n_first - 1);
    if (!wall) frame_table_check_range(&t, s->comm, other_name(wall), 0, s->n_first - 1);
    frame_table_check_finite(&t, s->comm);
    int64_t n[2] = {t.n, 0};
    send(s, &t, owner, wall);
    n[1] = fill(s, &l, &t, wall);
    comm_sum_i64(s->comm, n, 2);
    if (n[0] != n[1])
        fail_stop_together(EXIT_IO,
            "'%s': %lld of %lld contacts of table %s are missing from the neighbour list",
            s->from->path, (long long)(n[0] - n[1]), (long long)n[0], t.name);
    frame_table_free(&t);
    list_free(&l);
}
