#include "pairs.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "device/buffers.h"
#include "kernels/particle/particle_words.h"

static const struct buffer_spec list_buffers[] = {
    {"row begin", offsetof(struct pair_list, row_begin)}, {"rows", offsetof(struct pair_list, row)},
    {"row gids", offsetof(struct pair_list, row_gid)},
    {"row split", offsetof(struct pair_list, split)},
    {"up begin", offsetof(struct pair_list, up_begin)},
    {"incidence begin", offsetof(struct pair_list, incidence_begin)},
    {"incidence", offsetof(struct pair_list, incidence)},
    {"pair i", offsetof(struct pair_list, pair_i)}, {"pair j", offsetof(struct pair_list, pair_j)},
    {"pair state", offsetof(struct pair_list, state)},
    {"pair history", offsetof(struct pair_list, history)}, {0}};
static const struct buffer_spec own_buffers[] = {
    {"interior pairs", offsetof(struct pairs, interior)},
    {"boundary pairs", offsetof(struct pairs, boundary)},
    {"pair results", offsetof(struct pairs, result)},
    {"pair ledger", offsetof(struct pairs, ledger)},
    {"neighbours found", offsetof(struct pairs, found)}, {0}};

struct pairs *pairs_create(struct device *dev, const struct features *features,
    const struct program *lists, const struct program *force)
{
    struct pairs *pairs = fail_alloc(sizeof *pairs);
    pairs->features = features;
    pairs->layout = contact_layout(dev, force);
    buffers_create(dev, &pairs->now, list_buffers);
    buffers_create(dev, &pairs->old, list_buffers);
    contact_arrivals_init(dev, &pairs->arrivals, "arrived pairs");
    buffers_create(dev, pairs, own_buffers);
    pairs->rows = launch_create(lists, "rows");
    pairs->count = launch_create(lists, "pair_count");
    pairs->fill = launch_create(lists, "pair_fill");
    pairs->link = launch_create(lists, "pair_link");
    pairs->carry = launch_create(lists, "pair_carry");
    pairs->leave = launch_create(lists, "pair_leave");
    return pairs;
}

void pairs_free(struct pairs *pairs)
{
    if (!pairs) return;
    buffers_free(&pairs->now, list_buffers);
    buffers_free(&pairs->old, list_buffers);
    buffers_free(pairs, own_buffers);
    contact_arrivals_free(&pairs->arrivals);
    struct launch *launch[] = {
        pairs->rows, pairs->count, pairs->fill, pairs->link, pairs->carry, pairs->leave};
    for (int i = 0; i < 6; i++) launch_free(launch[i]);
    free(pairs);
}

static void build_rows(
    struct pairs *pairs, struct cells *cells, struct scan *scan, const struct particles *p)
{
    struct pair_list *l = &pairs->now;
    struct launch *rows = pairs->rows;
    buffer_reserve(&l->row_begin, ((size_t)l->n_all + 1) * sizeof(cl_int));
    launch_set_count(rows, "n_owned", l->n_owned);
    launch_set_count(rows, "n_all", l->n_all);
    launch_set_int(rows, "n_level", cells->n_level);
    launch_bind_all(rows, (const struct launch_binding[]){{"position", &p->field[FIELD_STATE].now},
                              {"gid", &p->field[FIELD_GID].now}, {"reach", &p->reach},
                              {"grid_real", &cells->grid_real}, {"grid_int", &cells->grid_int},
                              {"cell_begin", &cells->begin}, {"member", &cells->member}, {0}});
    launch_set_vector_if(rows, "period", cells->period);
    buffer_reserve(&pairs->found, (size_t)l->n_all * ROW_FOUND * sizeof(cl_int));
    launch_bind_all(
        rows, (const struct launch_binding[]){{"found", &pairs->found}, {"begin", &l->row_begin},
                  {"row", &l->row}, {"row_gid", &l->row_gid}, {0}});
    for (int fill = 0; fill < 2; fill++) {
        launch_set_int(rows, "fill", fill);
        launch_run(rows, l->n_all);
        if (fill) break;
        l->n_row = scan_total(scan, &l->row_begin, l->n_all);
        buffer_reserve(&l->row, (size_t)l->n_row * sizeof(cl_int));
        buffer_reserve(&l->row_gid, (size_t)l->n_row * sizeof(cl_long));
    }
}

static void count_pairs(struct pairs *pairs, struct scan *scan, const struct particles *p)
{
    struct pair_list *l = &pairs->now;
    size_t per_element = ((size_t)l->n_all + 1) * sizeof(cl_int);
    struct buffer *counted[] = {&l->split, &l->up_begin, &pairs->interior, &pairs->boundary};
    for (int i = 0; i < 4; i++) buffer_reserve(counted[i], per_element);
    buffer_reserve(&l->incidence_begin, ((size_t)l->n_owned + 1) * sizeof(cl_int));
    launch_set_count(pairs->count, "n_owned", l->n_owned);
    launch_set_count(pairs->count, "n_all", l->n_all);
    launch_bind_all(
        pairs->count, (const struct launch_binding[]){{"gid", &p->field[FIELD_GID].now},
                          {"row_begin", &l->row_begin}, {"row", &l->row}, {"row_gid", &l->row_gid},
                          {"split", &l->split}, {"interior", &pairs->interior},
                          {"boundary", &pairs->boundary}, {"incidence", &l->incidence_begin}, {0}});
    launch_run(pairs->count, l->n_all);
    l->n_interior = scan_total(scan, &pairs->interior, l->n_all);
    l->n_boundary = l->n_mine = scan_total(scan, &pairs->boundary, l->n_all);
    l->n_lower = l->n_owned;
    cl_int own; /* rows of owned elements come first */
    buffer_read(&pairs->boundary, (size_t)l->n_owned * sizeof own, sizeof own, &own);
    l->n_own = l->n_interior + own;
    l->n_incidence = scan_total(scan, &l->incidence_begin, l->n_owned);
    l->first_boundary = (l->n_interior + PAIR_ALIGN - 1) / PAIR_ALIGN * PAIR_ALIGN;
    int64_t n = l->first_boundary + l->n_boundary;
    if (n > INT32_MAX / 2 - 4 * PAIR_ALIGN || l->n_row > INT32_MAX / 2)
        fail_stop(EXIT_DEVICE,
            "%lld pairs on one rank are more than its lists can number; use more ranks",
            (long long)n);
    /* not a power of two, so that planes do not fall onto each other in caches */
    l->capacity = (n + PAIR_ALIGN - 1) / PAIR_ALIGN * PAIR_ALIGN + 16;
}

/* Room for a record per pair; the last one stays zero, for the blank pair of
 * kernels/particle/incidence.h. */
static void reserve_results(struct pairs *pairs, size_t real)
{
    size_t capacity = (size_t)pairs->now.capacity, bytes = (size_t)pairs->layout.result * real;
    char *zero = fail_alloc(bytes);
    buffer_reserve(&pairs->result, capacity * bytes);
    buffer_write(&pairs->result, (capacity - 1) * bytes, bytes, zero);
    free(zero);
}

static void fill_pairs(struct pairs *pairs, const struct particles *p)
{
    struct pair_list *l = &pairs->now;
    size_t real = particles_real(pairs->features), capacity = (size_t)l->capacity;
    buffer_reserve(&l->pair_i, capacity * sizeof(cl_int));
    buffer_reserve(&l->pair_j, capacity * sizeof(cl_int));
    buffer_reserve(&l->incidence, (size_t)l->n_incidence * sizeof(cl_int));
    reserve_results(pairs, real);
    launch_set_count(pairs->fill, "n_all", l->n_all);
    launch_set_count(pairs->fill, "first_boundary", l->first_boundary);
    launch_set_count(pairs->link, "n_owned", l->n_owned);
    launch_bind_buffer(pairs->link, "gid", &p->field[FIELD_GID].now);
    launch_bind_buffer(pairs->link, "row_gid", &l->row_gid);
    launch_set_count(pairs->link, "blank", l->capacity - 1);
    launch_bind_buffer(pairs->link, "incidence_begin", &l->incidence_begin);
    launch_bind_buffer(pairs->link, "incidence", &l->incidence);
    struct launch *both[] = {pairs->fill, pairs->link};
    for (int i = 0; i < 2; i++) {
        launch_bind_all(
            both[i], (const struct launch_binding[]){{"row_begin", &l->row_begin}, {"row", &l->row},
                         {"split", &l->split}, {"up_begin", &l->up_begin}, {0}});
    }
    launch_bind_all(pairs->fill,
        (const struct launch_binding[]){{"interior", &pairs->interior},
            {"boundary", &pairs->boundary}, {"pair_i", &l->pair_i}, {"pair_j", &l->pair_j}, {0}});
    launch_run(pairs->fill, l->n_all);
    launch_run(pairs->link, l->n_owned);
    if (!pairs->layout.remembers) return;
    buffer_reserve(&l->state, capacity * sizeof(cl_int));
    buffer_reserve(&l->history, capacity * (size_t)pairs->layout.history * real);
    buffer_zero(&l->state);
    buffer_zero(&l->history);
}

void pairs_build(
    struct pairs *pairs, struct cells *cells, struct scan *scan, const struct particles *p)
{
    struct pair_list older = pairs->old;
    pairs->old = pairs->now;
    pairs->now = older;
    pairs->now.n_owned = p->n_owned;
    pairs->now.n_all = p->n_owned + p->n_ghost;
    build_rows(pairs, cells, scan, p);
    count_pairs(pairs, scan, p);
    fill_pairs(pairs, p);
    if (pairs->features->energy) {
        buffer_reserve(
            &pairs->ledger, (size_t)pairs->now.capacity * CONTACT_LEDGER_WIDTH * sizeof(cl_double));
        buffer_zero(&pairs->ledger);
    }
    assert(pairs_is_valid(&pairs->now));
}

bool pairs_is_valid(const struct pair_list *l)
{
    bool elements = l->n_owned >= 0 && l->n_owned <= l->n_all,
         interior = l->n_interior >= 0 && l->first_boundary % PAIR_ALIGN == 0 &&
                    l->n_interior <= l->first_boundary &&
                    l->first_boundary < l->n_interior + PAIR_ALIGN,
         boundary = l->n_mine >= 0 && l->n_mine <= l->n_boundary,
         /* the last place is the blank pair's */
        room = l->first_boundary + l->n_boundary < l->capacity,
         counted = l->n_own >= 0 && l->n_own <= l->n_interior + l->n_boundary &&
                   (l->n_lower == l->n_all || l->n_mine == l->n_boundary);
    return elements && interior && boundary && room && counted;
}

void pairs_carry(struct pairs *pairs, const struct particles *p, const struct buffer *old_index)
{
    struct pair_list *l = &pairs->now, *o = &pairs->old;
    struct launch *k = pairs->carry;
    if (!pairs->layout.remembers) return;
    launch_set_count(k, "n_owned", l->n_owned);
    launch_set_count(k, "n_interior", l->n_interior);
    launch_set_count(k, "first_boundary", l->first_boundary);
    launch_set_count(k, "end", l->first_boundary + l->n_boundary);
    launch_set_count(k, "n_old", o->n_owned);
    launch_set_int(k, "width", pairs->layout.history);
    launch_set_count(k, "capacity", l->capacity);
    launch_set_count(k, "old_capacity", o->capacity);
    launch_set_count(k, "arrival_capacity", pairs->arrivals.n_contact);
    launch_bind_all(k,
        (const struct launch_binding[]){{"gid", &p->field[FIELD_GID].now}, {"pair_i", &l->pair_i},
            {"pair_j", &l->pair_j}, {"old_index", old_index}, {"old_row_begin", &o->row_begin},
            {"old_row_gid", &o->row_gid}, {"old_incidence_begin", &o->incidence_begin},
            {"old_incidence", &o->incidence}, {"arrival_begin", &pairs->arrivals.begin},
            {"arrival_gid", &pairs->arrivals.key}, {"arrival_state", &pairs->arrivals.state},
            {"arrival_history", &pairs->arrivals.history}, {"old_state", &o->state},
            {"old_history", &o->history}, {"state", &l->state}, {"history", &l->history}, {0}});
    launch_run(k, l->first_boundary + l->n_boundary);
}
