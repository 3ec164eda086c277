#include "owners.h"

#include <stdlib.h>
#include <string.h>

#include "comm/migrate.h"
#include "comm/fail.h"
#include "device/buffers.h"
#include "owners_message.h"

static const struct buffer_spec buffers[] = {{"cut tree", offsetof(struct owners, node)},
    {"cuts", offsetof(struct owners, cut)}, {"domain", offsetof(struct owners, domain)},
    {"owner", offsetof(struct owners, owner)}, {"stay", offsetof(struct owners, stay)},
    {"leave", offsetof(struct owners, leave)}, {"leaving", offsetof(struct owners, index)},
    {"old index", offsetof(struct owners, old_index)}, {"picked", offsetof(struct owners, picked)},
    {0}};

struct owners *owners_create(struct device *dev, const struct comm *comm,
    const struct features *features, const struct program *lists, const double period[3],
    const double domain[6])
{
    struct owners *o = fail_alloc(sizeof *o);
    o->comm = comm;
    o->features = features;
    buffers_create(dev, o, buffers);
    reals_put(&o->domain, features->position_is_float, 6, domain);
    o->select = launch_create(lists, "select_owner");
    o->compact = launch_create(lists, "record_select");
    o->gather = launch_create(lists, "record_gather");
    o->copy = launch_create(lists, "record_copy");
    launch_set_int(o->select, "rank", comm->rank);
    launch_set_int(o->select, "remove", features->remove_outside);
    launch_set_vector_if(o->select, "period", period);
    return o;
}

void owners_free(struct owners *o)
{
    if (!o) return;
    buffers_free(o, buffers);
    struct launch *launch[] = {o->select, o->compact, o->gather, o->copy};
    for (int i = 0; i < 4; i++) launch_free(launch[i]);
    free(o->removed);
    free(o);
}

void owners_set_tree(struct owners *o, const struct rcb *rcb)
{
    size_t n = (size_t)rcb->n_node;
    cl_int *node = fail_alloc(3 * n * sizeof *node);
    for (size_t k = 0; k < n; k++) {
        node[3 * k] = rcb->axis[k];
        node[3 * k + 1] = rcb->left[k];
        node[3 * k + 2] = rcb->right[k];
    }
    o->n_node = rcb->n_node;
    buffer_put(&o->node, 3 * n * sizeof *node, node);
    reals_put(&o->cut, o->features->position_is_float, n, rcb->cut);
    free(node);
}

/* Owner of each element; stay flags; returns how many leave this rank. */
static int64_t find_leaving(struct owners *o, struct scan *scan, struct particles *p)
{
    size_t n = (size_t)p->n_owned;
    buffer_reserve(&o->owner, n * sizeof(cl_int));
    buffer_reserve(&o->stay, n * sizeof(cl_int));
    buffer_reserve(&o->leave, (n + 1) * sizeof(cl_int));
    launch_set_count(o->select, "n", n);
    launch_set_int(o->select, "n_node", o->n_node);
    launch_bind_all(
        o->select, (const struct launch_binding[]){{"position", &p->field[FIELD_STATE].now},
                       {"node", &o->node}, {"cut", &o->cut}, {"domain", &o->domain},
                       {"owner", &o->owner}, {"stay", &o->stay}, {"leave", &o->leave}, {0}});
    launch_run(o->select, p->n_owned);
    return scan_total(scan, &o->leave, p->n_owned);
}

/* Rows of a device array picked by o->index, on the host. */
static void *pick(struct owners *o, const struct buffer *from, size_t bytes, int64_t n)
{
    void *rows = fail_alloc((size_t)n * bytes);
    if (bytes == 0) return rows;
    buffer_reserve(&o->picked, (size_t)n * bytes);
    launch_set_count(o->gather, "n", n);
    launch_set_count(o->gather, "words", bytes / 4);
    launch_bind_all(o->gather, (const struct launch_binding[]){
                                   {"index", &o->index}, {"from", from}, {"to", &o->picked}, {0}});
    launch_run(o->gather, n);
    buffer_read(&o->picked, 0, (size_t)n * bytes, rows);
    return rows;
}

static void remember_removed(
    struct owners *o, const struct owners_leaving *l, const int *owner, int64_t n)
{
    o->n_removed = 0;
    for (int64_t i = 0; i < n; i++) {
        if (owner[i] >= 0) continue;
        o->removed = fail_realloc(o->removed, (size_t)(o->n_removed + 1) * sizeof *o->removed);
        struct owners_removed *r = &o->removed[o->n_removed++];
        r->gid = ((const int64_t *)l->field[FIELD_GID])[i];
        const char *state = (const char *)l->field[FIELD_STATE] + (size_t)i * l->bytes[FIELD_STATE];
        const char *motion = state + 4 * particles_preal(o->features);
        for (size_t a = 0; a < 3; a++) {
            r->x[a] = reals_get(state, o->features->position_is_float, a);
            r->v[a] = reals_get(motion, o->features->real_is_float, a);
            r->w[a] = o->features->spin ? reals_get(motion, o->features->real_is_float, 4 + a) : 0;
        }
        r->radius = reals_get(state, o->features->position_is_float, 3);
        r->inverse_m = reals_get(motion, o->features->real_is_float, 3);
    }
}

/* Takes the leaving elements off this rank and brings in those of others. */
static struct owners_arriving exchange(struct owners *o, struct scan *scan, struct particles *p,
    struct pairs *pairs, struct wall_contacts *walls, int64_t n_leave)
{
    struct owners_leaving l = {.n = n_leave};
    buffer_reserve(&o->index, (size_t)n_leave * sizeof(cl_int));
    launch_set_count(o->compact, "n", p->n_owned);
    launch_bind_buffer(o->compact, "at", &o->leave);
    launch_bind_buffer(o->compact, "index", &o->index);
    launch_run(o->compact, p->n_owned);
    int *owner = pick(o, &o->owner, sizeof *owner, n_leave);
    for (int i = 0; i < FIELD_N; i++) {
        l.bytes[i] = p->field[i].bytes;
        l.field[i] = pick(o, &p->field[i].now, l.bytes[i], n_leave);
    }
    owners_pick_pairs(&l.pair, scan, &o->index, n_leave, pairs);
    owners_pick_walls(&l.wall, scan, &o->index, n_leave, walls);
    remember_removed(o, &l, owner, n_leave);
    int64_t *bytes_to = fail_alloc((size_t)o->comm->n_rank * sizeof *bytes_to),
            *bytes_from = fail_alloc((size_t)o->comm->n_rank * sizeof *bytes_from);
    void *send = owners_pack(&l, owner, o->comm->n_rank, bytes_to),
         *recv = migrate_bytes(o->comm, send, bytes_to, bytes_from);
    int64_t total = 0;
    for (int r = 0; r < o->comm->n_rank; r++) total += bytes_from[r];
    o->n_moved = n_leave - o->n_removed;
    struct owners_arriving a = owners_unpack(&l, recv, total);
    free(send);
    free(recv);
    free(bytes_to);
    free(bytes_from);
    free(owner);
    owners_leaving_free(&l);
    return a;
}

void owners_move(struct owners *o, struct cells *cells, struct scan *scan, struct particles *p,
    struct pairs *pairs, struct wall_contacts *walls, const struct cells_bounds *bounds)
{
    int64_t n_leave = find_leaving(o, scan, p), n_any = n_leave, n_old = p->n_owned;
    struct owners_arriving a = {0};
    o->n_removed = o->n_moved = 0;
    comm_sum_i64(o->comm, &n_any, 1);
    if (n_any > 0) a = exchange(o, scan, p, pairs, walls, n_leave);
    int64_t n_keep = n_old - n_leave, n_new = n_keep + a.n;
    cells_order(cells, scan, p, n_old, bounds, &o->stay);
    particles_reserve_spare(p, n_new);
    particles_permute(p, &cells->member, n_keep);
    buffer_reserve(&o->old_index, (size_t)n_new * sizeof(cl_int));
    if (n_keep > 0) {
        launch_bind_buffer(o->copy, "from", &cells->member);
        launch_bind_buffer(o->copy, "to", &o->old_index);
        launch_set_count(o->copy, "n", n_keep);
        launch_run(o->copy, n_keep);
    }
    particles_swap(p);
    for (int i = 0; i < FIELD_N; i++)
        buffer_write(&p->field[i].now, (size_t)n_keep * p->field[i].bytes,
            (size_t)a.n * p->field[i].bytes, a.field[i]);
    if (a.n > 0) {
        cl_int *number = fail_alloc((size_t)a.n * sizeof *number);
        for (int64_t i = 0; i < a.n; i++) number[i] = (cl_int)(n_old + i);
        buffer_write(
            &o->old_index, (size_t)n_keep * sizeof *number, (size_t)a.n * sizeof *number, number);
        free(number);
    }
    owners_store_pairs(pairs, &a.pair, a.n);
    if (walls) owners_store_walls(walls, &a.wall, a.n);
    p->n_owned = n_new;
    p->n_ghost = 0;
    particles_reserve(p, o->features, n_new, n_new);
    owners_arriving_free(&a);
}
