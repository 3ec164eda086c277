#include "owners_message.h"

#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"

/* Planes [width][capacity] to rows [n][width]. */
static char *rows_of_planes(const char *plane, int width, int64_t capacity, int64_t n, size_t real)
{
    char *row = fail_alloc((size_t)n * (size_t)width * real);
    for (int64_t k = 0; k < n; k++)
        for (int c = 0; c < width; c++)
            memcpy(row + ((size_t)k * (size_t)width + (size_t)c) * real,
                plane + ((size_t)c * (size_t)capacity + (size_t)k) * real, real);
    return row;
}

/* What contacts leave from: pairs or walls. */
struct source {
    struct launch *leave; /* bound to the lists */
    const char *key;      /* argument of `leave` that takes the keys */
    size_t key_bytes;     /* 8 for gids, 4 for primitives */
    const struct contact_layout *layout;
    size_t real;
};

static void no_contacts(struct owners_contacts *c, int64_t n)
{
    *c = (struct owners_contacts){.begin = fail_alloc(((size_t)n + 1) * sizeof *c->begin)};
}

static void pick(struct owners_contacts *c, struct scan *scan, const struct buffer *index,
    int64_t n, const struct source *from)
{
    struct launch *k = from->leave;
    int width = from->layout->history;
    size_t begin_bytes = ((size_t)n + 1) * sizeof(cl_int);
    no_contacts(c, n);
    c->history_bytes = (size_t)width * from->real;
    if (!from->layout->remembers || n == 0) return;
    struct contact_arrivals out;
    contact_arrivals_init(index->dev, &out, "leaving contacts");
    buffer_reserve(&out.begin, begin_bytes);
    launch_set_count(k, "n", n);
    launch_set_int(k, "fill", 0);
    launch_set_int(k, "width", width);
    launch_set_int(k, "leave_capacity", 0);
    launch_bind_all(k, (const struct launch_binding[]){{"index", index}, {"begin", &out.begin},
                           {from->key, &out.key}, {"leave_state", &out.state},
                           {"leave_history", &out.history}, {0}});
    launch_run(k, n);
    size_t total = (size_t)scan_total(scan, &out.begin, n);
    buffer_reserve(&out.key, total * from->key_bytes);
    buffer_reserve(&out.state, total * sizeof(cl_int));
    buffer_reserve(&out.history, total * c->history_bytes);
    launch_set_int(k, "fill", 1);
    launch_set_count(k, "leave_capacity", (int64_t)total);
    launch_run(k, n);
    char *key = fail_alloc(total * from->key_bytes), *plane = fail_alloc(total * c->history_bytes);
    c->key = fail_alloc(total * sizeof *c->key);
    c->state = fail_alloc(total * sizeof *c->state);
    buffer_read(&out.begin, 0, begin_bytes, c->begin);
    buffer_read(&out.key, 0, total * from->key_bytes, key);
    buffer_read(&out.state, 0, total * sizeof(cl_int), c->state);
    buffer_read(&out.history, 0, total * c->history_bytes, plane);
    for (size_t i = 0; i < total; i++)
        c->key[i] = from->key_bytes == sizeof *c->key ? ((int64_t *)(void *)key)[i]
                                                      : ((cl_int *)(void *)key)[i];
    c->history = rows_of_planes(plane, width, (int64_t)total, (int64_t)total, from->real);
    free(key);
    free(plane);
    contact_arrivals_free(&out);
}

void owners_pick_pairs(struct owners_contacts *c, struct scan *scan, const struct buffer *index,
    int64_t n, const struct pairs *pairs)
{
    const struct pair_list *l = &pairs->now;
    launch_bind_all(pairs->leave,
        (const struct launch_binding[]){{"row_begin", &l->row_begin}, {"row_gid", &l->row_gid},
            {"incidence_begin", &l->incidence_begin}, {"incidence", &l->incidence},
            {"state", &l->state}, {"history", &l->history}, {0}});
    launch_set_count(pairs->leave, "capacity", l->capacity);
    pick(c, scan, index, n,
        &(struct source){pairs->leave, "leave_gid", sizeof(int64_t), &pairs->layout,
            particles_real(pairs->features)});
}

void owners_pick_walls(struct owners_contacts *c, struct scan *scan, const struct buffer *index,
    int64_t n, const struct wall_contacts *walls)
{
    if (!walls) {
        no_contacts(c, n);
        return;
    }
    const struct wall_list *l = &walls->now;
    launch_bind_all(walls->leave,
        (const struct launch_binding[]){{"wall_begin", &l->begin}, {"candidate", &l->candidate},
            {"state", &l->state}, {"history", &l->history}, {0}});
    launch_set_count(walls->leave, "capacity", l->capacity);
    pick(c, scan, index, n,
        &(struct source){walls->leave, "leave_candidate", sizeof(cl_int), &walls->layout,
            particles_real(walls->features)});
}

static size_t contact_bytes(const struct owners_contacts *c)
{
    return sizeof *c->key + sizeof *c->state + c->history_bytes;
}

static char *put(char *to, const void *from, size_t bytes)
{
    if (bytes > 0) memcpy(to, from, bytes);
    return to + bytes;
}

static char *put_contacts(char *to, const struct owners_contacts *c, int64_t i)
{
    for (int k = c->begin[i]; k < c->begin[i + 1]; k++) {
        to = put(to, &c->key[k], sizeof *c->key);
        to = put(to, &c->state[k], sizeof *c->state);
        to = put(to, c->history + (size_t)k * c->history_bytes, c->history_bytes);
    }
    return to;
}

static size_t element_bytes(const struct owners_leaving *l, int64_t i)
{
    size_t bytes = 2 * sizeof(int32_t);
    for (int f = 0; f < FIELD_N; f++) bytes += l->bytes[f];
    return bytes + (size_t)(l->pair.begin[i + 1] - l->pair.begin[i]) * contact_bytes(&l->pair) +
           (size_t)(l->wall.begin[i + 1] - l->wall.begin[i]) * contact_bytes(&l->wall);
}

void *owners_pack(const struct owners_leaving *l, const int *owner, int n_rank, int64_t *bytes_to)
{
    size_t total = 0;
    memset(bytes_to, 0, (size_t)n_rank * sizeof *bytes_to);
    for (int64_t i = 0; i < l->n; i++) {
        if (owner[i] < 0) continue;
        bytes_to[owner[i]] += (int64_t)element_bytes(l, i);
        total += element_bytes(l, i);
    }
    char *data = fail_alloc(total), **at = fail_alloc((size_t)n_rank * sizeof *at), *end = data;
    for (int r = 0; r < n_rank; r++) {
        at[r] = end;
        end += bytes_to[r];
    }
    for (int64_t i = 0; i < l->n; i++) {
        if (owner[i] < 0) continue;
        char *to = at[owner[i]];
        int32_t n[2] = {
            l->pair.begin[i + 1] - l->pair.begin[i], l->wall.begin[i + 1] - l->wall.begin[i]};
        for (int f = 0; f < FIELD_N; f++)
            to = put(to, (const char *)l->field[f] + (size_t)i * l->bytes[f], l->bytes[f]);
        to = put(to, n, sizeof n);
        to = put_contacts(to, &l->pair, i);
        at[owner[i]] = put_contacts(to, &l->wall, i);
    }
    free(at);
    return data;
}

static const char *take(void *to, const char *from, size_t bytes)
{
    if (bytes > 0) memcpy(to, from, bytes);
    return from + bytes;
}

/* Two passes over the bytes: how many elements and contacts, then their contents. */
static const char *take_contacts(struct owners_contacts *c, const char *from, int64_t i, int n)
{
    c->begin[i + 1] = c->begin[i] + n;
    for (int k = c->begin[i]; k < c->begin[i + 1]; k++) {
        from = take(&c->key[k], from, sizeof *c->key);
        from = take(&c->state[k], from, sizeof *c->state);
        from = take(c->history + (size_t)k * c->history_bytes, from, c->history_bytes);
    }
    return from;
}

static void make_contacts(
    struct owners_contacts *c, size_t history_bytes, int64_t n, size_t n_contact)
{
    c->history_bytes = history_bytes;
    c->begin = fail_alloc(((size_t)n + 1) * sizeof *c->begin);
    c->key = fail_alloc(n_contact * sizeof *c->key);
    c->state = fail_alloc(n_contact * sizeof *c->state);
    c->history = fail_alloc(n_contact * history_bytes);
}

struct owners_arriving owners_unpack(
    const struct owners_leaving *like, const void *data, int64_t bytes)
{
    struct owners_arriving a = {0};
    const char *from = data, *end = from + bytes;
    size_t fields = 0, n_pair = 0, n_wall = 0;
    for (int f = 0; f < FIELD_N; f++) fields += like->bytes[f];
    for (const char *at = from; at < end; a.n++) {
        int32_t n[2];
        at = take(n, at + fields, sizeof n);
        at += (size_t)n[0] * contact_bytes(&like->pair) + (size_t)n[1] * contact_bytes(&like->wall);
        n_pair += (size_t)n[0];
        n_wall += (size_t)n[1];
    }
    for (int f = 0; f < FIELD_N; f++) a.field[f] = fail_alloc((size_t)a.n * like->bytes[f]);
    make_contacts(&a.pair, like->pair.history_bytes, a.n, n_pair);
    make_contacts(&a.wall, like->wall.history_bytes, a.n, n_wall);
    for (int64_t i = 0; i < a.n; i++) {
        int32_t n[2];
        for (int f = 0; f < FIELD_N; f++)
            from = take(a.field[f] + (size_t)i * like->bytes[f], from, like->bytes[f]);
        from = take(n, from, sizeof n);
        from = take_contacts(&a.pair, from, i, n[0]);
        from = take_contacts(&a.wall, from, i, n[1]);
    }
    return a;
}

/* key_bytes: 8 for gids, 4 for primitives; real: bytes of a number of the histories. */
static void store(struct contact_arrivals *a, const struct owners_contacts *c, int64_t n,
    size_t key_bytes, size_t real)
{
    size_t total = n > 0 ? (size_t)c->begin[n] : 0, width = c->history_bytes / real;
    a->n = n;
    a->n_contact = (int64_t)total;
    if (n == 0) return;
    char *plane = fail_alloc(total * c->history_bytes);
    cl_int *small = fail_alloc(total * sizeof *small);
    for (size_t k = 0; k < total; k++) {
        small[k] = (cl_int)c->key[k];
        for (size_t w = 0; w < width; w++)
            memcpy(
                plane + (w * total + k) * real, c->history + k * c->history_bytes + w * real, real);
    }
    buffer_put(&a->begin, ((size_t)n + 1) * sizeof(cl_int), c->begin);
    buffer_put(
        &a->key, total * key_bytes, key_bytes == sizeof *c->key ? (const void *)c->key : small);
    buffer_put(&a->state, total * sizeof(cl_int), c->state);
    buffer_put(&a->history, total * c->history_bytes, plane);
    free(plane);
    free(small);
}

void owners_store_pairs(struct pairs *pairs, const struct owners_contacts *c, int64_t n)
{
    store(&pairs->arrivals, c, n, sizeof(int64_t), particles_real(pairs->features));
}

void owners_store_walls(struct wall_contacts *walls, const struct owners_contacts *c, int64_t n)
{
    store(&walls->arrivals, c, n, sizeof(cl_int), particles_real(walls->features));
}

static void free_contacts(struct owners_contacts *c)
{
    free(c->begin);
    free(c->key);
    free(c->state);
    free(c->history);
}

void owners_leaving_free(struct owners_leaving *l)
{
    for (int f = 0; f < FIELD_N; f++) free(l->field[f]);
    free_contacts(&l->pair);
    free_contacts(&l->wall);
}

void owners_arriving_free(struct owners_arriving *a)
{
    for (int f = 0; f < FIELD_N; f++) free(a->field[f]);
    free_contacts(&a->pair);
    free_contacts(&a->wall);
}
