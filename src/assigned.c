#include "assigned.h"

#include <assert.h>
#include <stdlib.h>

#include "fail.h"

enum { SCRATCH = 7 };

struct assigned {
    const struct comm *comm;
    size_t real;
    struct exchange exchange;  /* of results */
    struct buffer send, recv;  /* places of the pairs whose results are sent; received */
    struct buffer segment;     /* int [ranks + 1], see assign.cl */
    struct buffer range;       /* int2 [ranks] */
    struct buffer theirs;      /* int [n_boundary + 1] */
    struct buffer copy, place; /* int2, int [n_boundary] */
    struct buffer element;     /* int [n_ghost] */
    struct buffer begin;       /* int [elements + 1] */
    struct launch *rule, *order, *link, *list, *number, *pack, *unpack;
};

static void scratch(struct assigned *a, struct buffer *all[SCRATCH])
{
    struct buffer *b[SCRATCH] = {&a->segment, &a->range, &a->theirs, &a->copy, &a->place, &a->element, &a->begin};
    for (int i = 0; i < SCRATCH; i++) all[i] = b[i];
}

struct assigned *assigned_create(struct device *dev, const struct comm *comm, const struct program *assign, const struct program *lists, size_t real)
{
    static const char *const exchanged[] = {"results packed", "results arrived", "results send", "results receive"};
    static const char *const name[] = {
        "segments", "segment range", "pairs of others", "boundary copy", "boundary place", "ghost numbers", "list begin"};
    struct assigned *a = fail_alloc(sizeof *a);
    struct buffer *all[SCRATCH];
    a->comm = comm;
    a->real = real;
    exchange_init(&a->exchange, exchanged);
    buffer_init(&a->send, "pairs sent");
    buffer_init(&a->recv, "pairs received");
    scratch(a, all);
    for (int i = 0; i < SCRATCH; i++) {
        buffer_init(all[i], name[i]);
        buffer_reserve(dev, all[i], 0);
    }
    a->rule = launch_create(assign, "assign_rule");
    a->order = launch_create(assign, "assign_place");
    a->link = launch_create(assign, "assign_link");
    a->list = launch_create(assign, "assign_list");
    a->pack = launch_create(assign, "assign_move");
    a->unpack = launch_create(assign, "assign_move");
    a->number = launch_create(lists, "record_number");
    return a;
}

void assigned_free(struct device *dev, struct assigned *a)
{
    if (!a) return;
    struct buffer *all[SCRATCH];
    struct launch *launch[] = {a->rule, a->order, a->link, a->list, a->number, a->pack, a->unpack};
    exchange_free(dev, &a->exchange);
    buffer_free(dev, &a->send);
    buffer_free(dev, &a->recv);
    scratch(a, all);
    for (int i = 0; i < SCRATCH; i++) buffer_free(dev, all[i]);
    for (int i = 0; i < 7; i++) launch_free(launch[i]);
    free(a);
}

/* Elements in segments by rank, begin [n + 1]. */
static void write_segments(struct device *dev, struct assigned *a, const int64_t *begin, int n)
{
    cl_int *at = fail_alloc(((size_t)n + 1) * sizeof *at);
    for (int s = 0; s <= n; s++) at[s] = (cl_int)begin[s];
    buffer_reserve(dev, &a->segment, ((size_t)n + 1) * sizeof *at);
    buffer_write(dev, &a->segment, 0, ((size_t)n + 1) * sizeof *at, at);
    free(at);
}

/* Boundary pairs of this rank first, then those of others. */
static void order(struct device *dev, struct assigned *a, struct scan *scan, struct pair_list *l, const struct halo *halo)
{
    struct launch *k[] = {a->rule, a->order, a->link};
    size_t n = (size_t)l->n_boundary;
    buffer_reserve(dev, &a->theirs, (n + 1) * sizeof(cl_int));
    buffer_reserve(dev, &a->copy, n * sizeof(cl_int2));
    buffer_reserve(dev, &a->place, n * sizeof(cl_int));
    write_segments(dev, a, halo->recv_begin, halo->n_recv);
    launch_set_int(a->rule, "n_owned", (int)l->n_owned);
    launch_set_int(a->rule, "n_segment", halo->n_recv);
    launch_set_int(a->link, "n_incidence", (int)l->n_incidence);
    for (int i = 0; i < 3; i++) {
        launch_set_int(k[i], "n", (int)l->n_boundary);
        launch_set_int(k[i], "first", (int)l->first_boundary);
        launch_bind_buffer_if(k[i], "segment", &a->segment);
        launch_bind_buffer_if(k[i], "row_begin", &l->row_begin);
        launch_bind_buffer_if(k[i], "row", &l->row);
        launch_bind_buffer_if(k[i], "pair_i", &l->pair_i);
        launch_bind_buffer_if(k[i], "pair_j", &l->pair_j);
        launch_bind_buffer_if(k[i], "copy", &a->copy);
        launch_bind_buffer_if(k[i], "theirs", &a->theirs);
        launch_bind_buffer_if(k[i], "place", &a->place);
        launch_bind_buffer_if(k[i], "incidence", &l->incidence);
    }
    launch_run(a->rule, dev->compute, l->n_boundary, 0, NULL, NULL);
    l->n_mine = l->n_boundary - scan_total(dev, scan, &a->theirs, l->n_boundary);
    l->n_lower = l->n_all; /* who computes a pair counts it */
    launch_set_int(a->order, "n_mine", (int)l->n_mine);
    launch_run(a->order, dev->compute, l->n_boundary, 0, NULL, NULL);
    launch_run(a->link, dev->compute, l->n_incidence, 0, NULL, NULL);
}

/* Elements in segments by rank, and for each segment the partners that count. */
struct elements {
    const struct buffer *number;
    int n_segment;
    const int64_t *begin; /* [n_segment + 1] */
    cl_int2 *range;       /* [n_segment] */
};

/* Places of the pairs that travel into `list`; count [n_segment]: how many in each segment. */
static void list_pairs(struct device *dev, struct assigned *a, struct scan *scan, const struct particles *p, const struct pair_list *l,
    const struct elements *e, bool is_theirs, struct buffer *list, int64_t *count)
{
    struct launch *k = a->list;
    int64_t n = e->begin[e->n_segment];
    cl_int *begin = fail_alloc(((size_t)n + 1) * sizeof *begin);
    write_segments(dev, a, e->begin, e->n_segment);
    buffer_reserve(dev, &a->range, (size_t)e->n_segment * sizeof *e->range);
    buffer_write(dev, &a->range, 0, (size_t)e->n_segment * sizeof *e->range, e->range);
    buffer_reserve(dev, &a->begin, ((size_t)n + 1) * sizeof *begin);
    const struct {
        const char *name;
        const struct buffer *buffer;
    } bind[] = {{"segment", &a->segment}, {"range", &a->range}, {"element", e->number}, {"gid", &p->field[FIELD_GID].now},
        {"row_begin", &l->row_begin}, {"row", &l->row}, {"row_gid", &l->row_gid}, {"incidence_begin", &l->incidence_begin},
        {"incidence", &l->incidence}, {"begin", &a->begin}, {"list", list}};
    buffer_reserve(dev, list, 0);
    for (size_t i = 0; i < sizeof bind / sizeof *bind; i++) launch_bind_buffer(k, bind[i].name, bind[i].buffer);
    launch_set_int(k, "n_element", (int)n);
    launch_set_int(k, "n_owned", (int)l->n_owned);
    launch_set_int(k, "first_theirs", (int)(l->first_boundary + l->n_mine));
    launch_set_int(k, "is_theirs", is_theirs);
    launch_set_int(k, "n_segment", e->n_segment);
    launch_set_int(k, "fill", 0);
    launch_run(k, dev->compute, n, 0, NULL, NULL);
    buffer_reserve(dev, list, (size_t)scan_total(dev, scan, &a->begin, n) * sizeof(cl_int));
    launch_set_int(k, "fill", 1);
    launch_run(k, dev->compute, n, 0, NULL, NULL);
    buffer_read(dev, &a->begin, 0, ((size_t)n + 1) * sizeof *begin, begin);
    for (int s = 0; s < e->n_segment; s++) count[s] = begin[e->begin[s + 1]] - begin[e->begin[s]];
    free(begin);
}

/* What goes to the owners of ghosts, by the ghosts in their order. count_to [n_rank] */
static void list_sent(struct device *dev, struct assigned *a, struct scan *scan, const struct particles *p, const struct pair_list *l,
    const struct halo *halo, int64_t *count_to)
{
    size_t n = (size_t)halo->n_recv;
    int64_t *count = fail_alloc(n * sizeof *count);
    struct elements ghosts = {&a->element, halo->n_recv, halo->recv_begin, fail_alloc(n * sizeof *ghosts.range)};
    for (size_t s = 0; s < n; s++) ghosts.range[s] = (cl_int2){{0, (cl_int)l->n_owned}};
    buffer_reserve(dev, &a->element, (size_t)p->n_ghost * sizeof(cl_int));
    launch_set_int(a->number, "n", (int)p->n_ghost);
    launch_set_int(a->number, "first", (int)l->n_owned);
    launch_bind_buffer(a->number, "value", &a->element);
    launch_run(a->number, dev->compute, p->n_ghost, 0, NULL, NULL);
    list_pairs(dev, a, scan, p, l, &ghosts, false, &a->send, count);
    for (size_t s = 0; s < n; s++) count_to[halo->recv_rank[s]] = count[s];
    free(ghosts.range);
    free(count);
}

/* What comes for the elements that are ghosts elsewhere, in the order in which they are sent there. count_from [n_rank] */
static void list_received(struct device *dev, struct assigned *a, struct scan *scan, const struct particles *p, const struct pair_list *l,
    const struct ghosts *ghosts, int64_t *count_from)
{
    const struct halo *halo = ghosts->exchange.halo;
    size_t n = (size_t)halo->n_send;
    int64_t *count = fail_alloc(n * sizeof *count);
    struct elements sent = {&ghosts->index, halo->n_send, halo->send_begin, fail_alloc(n * sizeof *sent.range)};
    for (size_t s = 0; s < n; s++)
        for (int r = 0; r < halo->n_recv; r++)
            if (halo->recv_rank[r] == halo->send_rank[s])
                sent.range[s] = (cl_int2){{(cl_int)(l->n_owned + halo->recv_begin[r]), (cl_int)(l->n_owned + halo->recv_begin[r + 1])}};
    list_pairs(dev, a, scan, p, l, &sent, true, &a->recv, count);
    for (size_t s = 0; s < n; s++) count_from[halo->send_rank[s]] = count[s];
    free(sent.range);
    free(count);
}

static void set_move(struct launch *k, bool is_pack, int64_t n, int width, size_t number, int64_t capacity, const struct buffer *index,
    const struct buffer *plane, const struct buffer *record)
{
    launch_set_int(k, "n", (int)n);
    launch_set_int(k, "is_pack", is_pack);
    launch_set_int(k, "width", width);
    launch_set_int(k, "words", (int)(number / 4));
    launch_set_int(k, "capacity", (int)capacity);
    launch_bind_buffer(k, "index", index);
    launch_bind_buffer(k, "plane", plane);
    launch_bind_buffer(k, "record", record);
}

void assigned_build(
    struct device *dev, struct assigned *a, struct scan *scan, const struct particles *p, struct pairs *pairs, const struct ghosts *ghosts)
{
    struct pair_list *l = &pairs->now;
    struct exchange *x = &a->exchange;
    size_t n_rank = (size_t)a->comm->n_rank, record = (size_t)pairs->layout.result * a->real;
    int64_t *count_to = fail_alloc(n_rank * sizeof *count_to), *count_from = fail_alloc(n_rank * sizeof *count_from);
    order(dev, a, scan, l, ghosts->exchange.halo);
    list_sent(dev, a, scan, p, l, ghosts->exchange.halo, count_to);
    list_received(dev, a, scan, p, l, ghosts, count_from);
    exchange_plan(x, a->comm, count_to);
    for (int k = 0; k < x->halo->n_recv; k++) count_from[x->halo->recv_rank[k]] -= x->halo->recv_begin[k + 1] - x->halo->recv_begin[k];
    for (size_t r = 0; r < n_rank; r++) assert(count_from[r] == 0); /* both ranks have decided alike */
    exchange_bind(dev, x, record, true);
    set_move(a->pack, true, x->n_send, 1, record, l->capacity, &a->send, &pairs->result, &x->packed);
    set_move(a->unpack, false, x->n_recv, 1, record, l->capacity, &a->recv, &pairs->result, &x->arrived);
    free(count_to);
    free(count_from);
}

void assigned_begin(struct device *dev, struct assigned *a, struct timers *timers)
{
    exchange_begin(dev, &a->exchange, a->pack, timers);
}

void assigned_swap(struct device *dev, struct assigned *a, cl_event *most, struct timers *timers)
{
    const cl_event *arrived = exchange_swap(dev, &a->exchange, &a->exchange.arrived, 0, most, timers);
    launch_run(a->unpack, dev->compute, a->exchange.n_recv, 1, arrived, NULL);
}

/* One array of planes, numbers of so many bytes. */
static void send_planes(struct device *dev, struct assigned *a, const struct buffer *plane, int width, size_t number, int64_t capacity)
{
    struct exchange *x = &a->exchange;
    size_t bytes = (size_t)width * number, n_send = (size_t)x->n_send * bytes, n_recv = (size_t)x->n_recv * bytes;
    if (width == 0) return;
    char *send = fail_alloc(n_send), *recv = fail_alloc(n_recv);
    buffer_reserve(dev, &x->packed, n_send);
    buffer_reserve(dev, &x->arrived, n_recv);
    set_move(a->pack, true, x->n_send, width, number, capacity, &a->send, plane, &x->packed);
    set_move(a->unpack, false, x->n_recv, width, number, capacity, &a->recv, plane, &x->arrived);
    launch_run(a->pack, dev->compute, x->n_send, 0, NULL, NULL);
    buffer_read(dev, &x->packed, 0, n_send, send);
    halo_exchange(x->halo, send, recv, bytes);
    buffer_write(dev, &x->arrived, 0, n_recv, recv);
    launch_run(a->unpack, dev->compute, x->n_recv, 0, NULL, NULL);
    free(send);
    free(recv);
}

void assigned_complete(struct device *dev, struct assigned *a, struct pairs *pairs)
{
    struct pair_list *l = &pairs->now;
    exchange_settle(dev, &a->exchange);
    if (!pairs->layout.remembers) return;
    send_planes(dev, a, &l->state, 1, sizeof(cl_int), l->capacity);
    send_planes(dev, a, &l->history, pairs->layout.history, a->real, l->capacity);
}

struct halo_traffic assigned_sent(const struct assigned *a)
{
    return exchange_sent(&a->exchange);
}
