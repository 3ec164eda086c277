#include "assigned.h"

#include <assert.h>
#include <stdlib.h>

#include "comm/fail.h"
#include "device/buffers.h"

/* Pairs that one side computes for the other, and what it needs for them. */
struct side {
    struct buffer pair;          /* their places here */
    struct buffer element;       /* numbers of the elements whose states travel */
    int64_t *n_pair, *n_element; /* [n_rank] by rank */
};

struct assigned {
    const struct comm *comm;
    size_t real;
    struct exchange exchange[ASSIGNED_N];
    struct launch *pack[ASSIGNED_N], *unpack[ASSIGNED_N];
    /* this rank for others, with ghosts; others for this rank, with owned elements */
    struct side here, there;
    struct buffer segment;     /* int [ranks + 1], see assign.cl */
    struct buffer range;       /* int2 [ranks] */
    struct buffer theirs;      /* int [n_boundary + 1] */
    struct buffer copy, place; /* int2, int [n_boundary] */
    struct buffer ghost;       /* int [n_ghost] their numbers */
    struct buffer begin, used; /* int [elements + 1] */
    struct launch *rule, *order, *link, *list, *use, *pick, *number;
};

static const struct buffer_spec buffers[] = {{"segments", offsetof(struct assigned, segment)},
    {"segment range", offsetof(struct assigned, range)},
    {"pairs of others", offsetof(struct assigned, theirs)},
    {"boundary copy", offsetof(struct assigned, copy)},
    {"boundary place", offsetof(struct assigned, place)},
    {"ghost numbers", offsetof(struct assigned, ghost)},
    {"pairs begin", offsetof(struct assigned, begin)},
    {"elements used", offsetof(struct assigned, used)}, {0}};

static const struct buffer_spec side_buffers[] = {{"assigned pairs", offsetof(struct side, pair)},
    {"assigned elements", offsetof(struct side, element)}, {0}};

static void side_init(struct device *dev, struct side *side, int n_rank)
{
    buffers_create(dev, side, side_buffers);
    side->n_pair = fail_alloc((size_t)n_rank * sizeof *side->n_pair);
    side->n_element = fail_alloc((size_t)n_rank * sizeof *side->n_element);
}

static void side_free(struct side *side)
{
    buffers_free(side, side_buffers);
    free(side->n_pair);
    free(side->n_element);
}

struct assigned *assigned_create(struct device *dev, const struct comm *comm,
    const struct program *assign, const struct program *lists, size_t real)
{
    static const char *const exchanged[ASSIGNED_N][4] = {
        {"states packed", "states arrived", "states send", "states receive"},
        {"results packed", "results arrived", "results send", "results receive"}};
    struct assigned *a = fail_alloc(sizeof *a);
    a->comm = comm;
    a->real = real;
    side_init(dev, &a->here, comm->n_rank);
    side_init(dev, &a->there, comm->n_rank);
    buffers_create(dev, a, buffers);
    for (int w = 0; w < ASSIGNED_N; w++) {
        exchange_init(&a->exchange[w], dev, exchanged[w]);
        a->pack[w] = launch_create(assign, "assign_move");
        a->unpack[w] = launch_create(assign, "assign_move");
    }
    a->rule = launch_create(assign, "assign_rule");
    a->order = launch_create(assign, "assign_place");
    a->link = launch_create(assign, "assign_link");
    a->list = launch_create(assign, "assign_list");
    a->use = launch_create(assign, "assign_use");
    a->pick = launch_create(assign, "assign_pick");
    a->number = launch_create(lists, "record_number");
    return a;
}

void assigned_free(struct assigned *a)
{
    if (!a) return;
    struct launch *launch[] = {a->rule, a->order, a->link, a->list, a->use, a->pick, a->number};
    for (int w = 0; w < ASSIGNED_N; w++) {
        exchange_free(&a->exchange[w]);
        launch_free(a->pack[w]);
        launch_free(a->unpack[w]);
    }
    side_free(&a->here);
    side_free(&a->there);
    buffers_free(a, buffers);
    for (size_t i = 0; i < sizeof launch / sizeof *launch; i++) launch_free(launch[i]);
    free(a);
}

/* Elements in segments by rank, begin [n + 1]. */
static void write_segments(struct assigned *a, const int64_t *begin, int n)
{
    cl_int *at = fail_alloc(((size_t)n + 1) * sizeof *at);
    for (int s = 0; s <= n; s++) at[s] = (cl_int)begin[s];
    buffer_put(&a->segment, ((size_t)n + 1) * sizeof *at, at);
    free(at);
}

/* Boundary pairs of this rank first, then those of others. */
static void order(
    struct assigned *a, struct scan *scan, struct pair_list *l, const struct halo *halo)
{
    struct launch *k[] = {a->rule, a->order, a->link};
    size_t n = (size_t)l->n_boundary;
    buffer_reserve(&a->theirs, (n + 1) * sizeof(cl_int));
    buffer_reserve(&a->copy, n * sizeof(cl_int2));
    buffer_reserve(&a->place, n * sizeof(cl_int));
    write_segments(a, halo->recv_begin, halo->n_recv);
    launch_set_count(a->rule, "n_owned", l->n_owned);
    launch_set_int(a->rule, "n_segment", halo->n_recv);
    launch_set_count(a->link, "n_incidence", l->n_incidence);
    for (int i = 0; i < 3; i++) {
        launch_set_count(k[i], "n", l->n_boundary);
        launch_set_count(k[i], "first", l->first_boundary);
        launch_bind_all_if(
            k[i], (const struct launch_binding[]){{"segment", &a->segment},
                      {"row_begin", &l->row_begin}, {"row", &l->row}, {"pair_i", &l->pair_i},
                      {"pair_j", &l->pair_j}, {"copy", &a->copy}, {"theirs", &a->theirs},
                      {"place", &a->place}, {"incidence", &l->incidence}, {0}});
    }
    launch_run(a->rule, l->n_boundary);
    l->n_mine = l->n_boundary - scan_total(scan, &a->theirs, l->n_boundary);
    l->n_lower = l->n_all; /* who computes a pair counts it */
    launch_set_count(a->order, "n_mine", l->n_mine);
    launch_run(a->order, l->n_boundary);
    launch_run(a->link, l->n_incidence);
}

/* Elements in segments by rank, and for each segment the partners that count. */
struct elements {
    const struct buffer *number;
    int n_segment;
    const int *rank;      /* [n_segment] */
    const int64_t *begin; /* [n_segment + 1] */
    cl_int2 *range;       /* [n_segment] */
};

/* Adds up by rank what begin [n + 1] counts of each element on the device. */
static void read_counts(const struct elements *e, const struct buffer *begin, int64_t *n_of_rank)
{
    int64_t n = e->begin[e->n_segment];
    cl_int *at = fail_alloc(((size_t)n + 1) * sizeof *at);
    buffer_read(begin, 0, ((size_t)n + 1) * sizeof *at, at);
    for (int s = 0; s < e->n_segment; s++)
        n_of_rank[e->rank[s]] = at[e->begin[s + 1]] - at[e->begin[s]];
    free(at);
}

/* The elements that have pairs in the list, a->begin counts how many. */
static void list_elements(
    struct assigned *a, struct scan *scan, const struct elements *e, struct side *side)
{
    int64_t n = e->begin[e->n_segment];
    buffer_reserve(&a->used, ((size_t)n + 1) * sizeof(cl_int));
    launch_set_count(a->use, "n", n);
    launch_bind_buffer(a->use, "begin", &a->begin);
    launch_bind_buffer(a->use, "used", &a->used);
    launch_run(a->use, n);
    buffer_reserve(&side->element, (size_t)scan_total(scan, &a->used, n) * sizeof(cl_int));
    launch_set_count(a->pick, "n", n);
    launch_bind_all(a->pick, (const struct launch_binding[]){{"used", &a->used},
                                 {"element", e->number}, {"list", &side->element}, {0}});
    launch_run(a->pick, n);
    read_counts(e, &a->used, side->n_element);
}

static void list_side(struct assigned *a, struct scan *scan, const struct particles *p,
    const struct pair_list *l, const struct elements *e, struct side *side)
{
    struct launch *k = a->list;
    int64_t n = e->begin[e->n_segment];
    write_segments(a, e->begin, e->n_segment);
    buffer_put(&a->range, (size_t)e->n_segment * sizeof *e->range, e->range);
    buffer_reserve(&a->begin, ((size_t)n + 1) * sizeof(cl_int));
    launch_bind_all(k,
        (const struct launch_binding[]){{"segment", &a->segment}, {"range", &a->range},
            {"element", e->number}, {"gid", &p->field[FIELD_GID].now}, {"row_begin", &l->row_begin},
            {"row", &l->row}, {"row_gid", &l->row_gid}, {"incidence_begin", &l->incidence_begin},
            {"incidence", &l->incidence}, {"begin", &a->begin}, {"list", &side->pair}, {0}});
    launch_set_count(k, "n_element", n);
    launch_set_count(k, "n_owned", l->n_owned);
    launch_set_count(k, "first_theirs", l->first_boundary + l->n_mine);
    launch_set_int(k, "is_theirs", side == &a->there);
    launch_set_int(k, "n_segment", e->n_segment);
    launch_set_int(k, "fill", 0);
    launch_run(k, n);
    buffer_reserve(&side->pair, (size_t)scan_total(scan, &a->begin, n) * sizeof(cl_int));
    launch_set_int(k, "fill", 1);
    launch_run(k, n);
    for (int r = 0; r < a->comm->n_rank; r++) side->n_pair[r] = side->n_element[r] = 0;
    read_counts(e, &a->begin, side->n_pair);
    list_elements(a, scan, e, side);
}

/* For the owners of ghosts, by the ghosts in their order. */
static void list_here(struct assigned *a, struct scan *scan, const struct particles *p,
    const struct pair_list *l, const struct halo *halo)
{
    size_t n = (size_t)halo->n_recv;
    struct elements ghosts = {&a->ghost, halo->n_recv, halo->recv_rank, halo->recv_begin,
        fail_alloc(n * sizeof *ghosts.range)};
    for (size_t s = 0; s < n; s++) ghosts.range[s] = (cl_int2){{0, (cl_int)l->n_owned}};
    buffer_reserve(&a->ghost, (size_t)p->n_ghost * sizeof(cl_int));
    launch_set_count(a->number, "n", p->n_ghost);
    launch_set_count(a->number, "first", l->n_owned);
    launch_bind_buffer(a->number, "value", &a->ghost);
    launch_run(a->number, p->n_ghost);
    list_side(a, scan, p, l, &ghosts, &a->here);
    free(ghosts.range);
}

/* For the elements that are ghosts elsewhere, in the order in which they are sent there. */
static void list_there(struct assigned *a, struct scan *scan, const struct particles *p,
    const struct pair_list *l, const struct ghosts *ghosts)
{
    const struct halo *halo = ghosts->exchange.halo;
    size_t n = (size_t)halo->n_send;
    struct elements sent = {&ghosts->index, halo->n_send, halo->send_rank, halo->send_begin,
        fail_alloc(n * sizeof *sent.range)};
    for (size_t s = 0; s < n; s++)
        for (int r = 0; r < halo->n_recv; r++)
            if (halo->recv_rank[r] == halo->send_rank[s])
                sent.range[s] = (cl_int2){{(cl_int)(l->n_owned + halo->recv_begin[r]),
                    (cl_int)(l->n_owned + halo->recv_begin[r + 1])}};
    list_side(a, scan, p, l, &sent, &a->there);
    free(sent.range);
}

/* Between planes of numbers of so many bytes and the records that are sent, for what travels along
 * this way. */
static void set_moves(struct assigned *a, enum assigned_way way, const struct buffer *plane,
    int width, size_t number, int64_t capacity)
{
    struct exchange *x = &a->exchange[way];
    struct launch *k[] = {a->pack[way], a->unpack[way]};
    bool results = way == ASSIGNED_RESULTS;
    for (int back = 0; back < 2; back++) {
        launch_set_count(k[back], "n", back ? x->n_recv : x->n_send);
        launch_set_int(k[back], "is_pack", !back);
        launch_set_int(k[back], "width", width);
        launch_set_count(k[back], "words", number / 4);
        launch_set_count(k[back], "capacity", capacity);
        const struct side *side = results == !back ? &a->here : &a->there;
        launch_bind_all(k[back],
            (const struct launch_binding[]){{"index", results ? &side->pair : &side->element},
                {"plane", plane}, {"record", back ? &x->arrived : &x->packed}, {0}});
    }
}

/* count_from: what this rank expects, for both ranks have decided alike. */
static void plan(struct assigned *a, enum assigned_way way, const int64_t *count_to,
    const int64_t *count_from, const struct buffer *plane, size_t record)
{
    struct exchange *x = &a->exchange[way];
    int64_t n = 0;
    exchange_plan(x, a->comm, count_to);
    for (int k = 0; k < x->halo->n_recv; k++)
        assert(count_from[x->halo->recv_rank[k]] ==
               x->halo->recv_begin[k + 1] - x->halo->recv_begin[k]);
    for (int r = 0; r < a->comm->n_rank; r++) n += count_from[r];
    assert(n == x->n_recv);
    exchange_bind(x, record, true);
    set_moves(a, way, plane, 1, record, 0);
}

void assigned_build(struct assigned *a, struct scan *scan, const struct particles *p,
    struct pairs *pairs, const struct ghosts *ghosts)
{
    struct pair_list *l = &pairs->now;
    const struct field *state = &p->field[FIELD_STATE];
    order(a, scan, l, ghosts->exchange.halo);
    assert(pairs_is_valid(l));
    list_here(a, scan, p, l, ghosts->exchange.halo);
    list_there(a, scan, p, l, ghosts);
    plan(a, ASSIGNED_STATES, a->there.n_element, a->here.n_element, &state->now, state->bytes);
    plan(a, ASSIGNED_RESULTS, a->here.n_pair, a->there.n_pair, &pairs->result,
        (size_t)pairs->layout.result * a->real);
}

void assigned_begin(struct assigned *a, enum assigned_way way, struct timers *timers)
{
    exchange_begin(&a->exchange[way], a->pack[way], timers);
}

void assigned_swap(
    struct assigned *a, enum assigned_way way, cl_event *nearly_done, struct timers *timers)
{
    struct exchange *x = &a->exchange[way];
    const cl_event *arrived = exchange_swap(x, &x->arrived, 0, nearly_done, timers);
    launch_run_on(a->unpack[way], x->dev->compute, x->n_recv, arrived, NULL);
}

/* One array of planes, along the way of results. */
static void send_planes(
    struct assigned *a, const struct buffer *plane, int width, size_t number, int64_t capacity)
{
    struct exchange *x = &a->exchange[ASSIGNED_RESULTS];
    size_t bytes = (size_t)width * number, n_send = (size_t)x->n_send * bytes,
           n_recv = (size_t)x->n_recv * bytes;
    if (width == 0) return;
    char *send = fail_alloc(n_send), *recv = fail_alloc(n_recv);
    buffer_reserve(&x->packed, n_send);
    buffer_reserve(&x->arrived, n_recv);
    set_moves(a, ASSIGNED_RESULTS, plane, width, number, capacity);
    launch_run(a->pack[ASSIGNED_RESULTS], x->n_send);
    buffer_read(&x->packed, 0, n_send, send);
    halo_exchange(x->halo, send, recv, bytes);
    buffer_write(&x->arrived, 0, n_recv, recv);
    launch_run(a->unpack[ASSIGNED_RESULTS], x->n_recv);
    free(send);
    free(recv);
}

void assigned_complete(struct assigned *a, struct pairs *pairs)
{
    struct pair_list *l = &pairs->now;
    for (int w = 0; w < ASSIGNED_N; w++) exchange_settle(&a->exchange[w]);
    if (!pairs->layout.remembers) return;
    send_planes(a, &l->state, 1, sizeof(cl_int), l->capacity);
    send_planes(a, &l->history, pairs->layout.history, a->real, l->capacity);
}

const struct exchange *assigned_exchange(const struct assigned *a, enum assigned_way way)
{
    return &a->exchange[way];
}
