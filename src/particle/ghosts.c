#include "ghosts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "device/buffers.h"

static const struct buffer_spec buffers[] = {{"ghost index", offsetof(struct ghosts, index)},
    {"ghost pick", offsetof(struct ghosts, pick)}, {0}};

struct ghosts *ghosts_create(struct device *dev, const struct comm *comm,
    const struct features *features, const struct program *lists, const double period[3])
{
    struct ghosts *g = fail_alloc(sizeof *g);
    g->comm = comm;
    g->features = features;
    memcpy(g->period, period, sizeof g->period);
    static const char *const name[] = {
        "ghost pack", "ghosts arrived", "ghost send", "ghost receive"};
    exchange_init(&g->exchange, dev, name);
    buffers_create(dev, g, buffers);
    g->select = launch_create(lists, "select_ghosts");
    g->compact = launch_create(lists, "record_select");
    g->gather = launch_create(lists, "record_gather");
    g->pack = launch_create(lists, "record_gather");
    launch_set_vector_if(g->select, "period", period);
    return g;
}

void ghosts_free(struct ghosts *g)
{
    if (!g) return;
    exchange_free(&g->exchange);
    buffers_free(g, buffers);
    launch_free(g->select);
    launch_free(g->compact);
    launch_free(g->gather);
    launch_free(g->pack);
    free(g);
}

/* What a rank tells the others about the elements that it owns. */
struct box {
    double low[3], high[3], reach;
    int64_t n;
};

static double gap(double low_a, double high_a, double low_b, double high_b, double period)
{
    double d = fmax(fmax(low_b - high_a, low_a - high_b), 0);
    if (period > 0)
        d = fmin(d, fmin(fmax(low_b + period - high_a, 0), fmax(low_a + period - high_b, 0)));
    return d;
}

static bool may_meet(const struct ghosts *g, const struct box *a, const struct box *b)
{
    double sum = 0, reach = (a->reach + b->reach) * 1.001;
    if (a->n == 0 || b->n == 0) return false;
    for (int k = 0; k < 3; k++) {
        double d = gap(a->low[k], a->high[k], b->low[k], b->high[k], g->period[k]);
        sum += d * d;
    }
    return sum < reach * reach;
}

/* The owned elements that `rank` with `box` needs, into `piece`; returns how many. */
static int64_t select_for(struct ghosts *g, struct scan *scan, const struct particles *p, int rank,
    const struct box *box, struct buffer *piece)
{
    launch_set_count(g->select, "n", p->n_owned);
    launch_set_int(g->select, "rank", rank);
    launch_bind_all(
        g->select, (const struct launch_binding[]){{"position", &p->field[FIELD_STATE].now},
                       {"reach", &p->reach}, {"at", &g->pick}, {0}});
    launch_set_vector(g->select, "low", box->low);
    launch_set_vector(g->select, "high", box->high);
    launch_set_real(g->select, "far_reach", box->reach);
    launch_run(g->select, p->n_owned);
    int64_t n = scan_total(scan, &g->pick, p->n_owned);
    buffer_reserve(piece, (size_t)n * sizeof(cl_int));
    launch_set_count(g->compact, "n", p->n_owned);
    launch_bind_buffer(g->compact, "at", &g->pick);
    launch_bind_buffer(g->compact, "index", piece);
    launch_run(g->compact, p->n_owned);
    return n;
}

/* Rows of `from` picked by g->index to where they are sent from. */
static void bind_gather(
    struct ghosts *g, struct launch *gather, const struct buffer *from, size_t bytes)
{
    launch_set_count(gather, "n", g->exchange.n_send);
    launch_set_count(gather, "words", bytes / 4);
    launch_bind_all(gather, (const struct launch_binding[]){{"index", &g->index}, {"from", from},
                                {"to", &g->exchange.packed}, {0}});
}

/* Sends rows of `from` picked by g->index to their neighbours and stores what comes in at row
 * n_owned of it. */
static void exchange_rows(
    struct ghosts *g, const struct particles *p, struct buffer *from, size_t bytes)
{
    struct exchange *x = &g->exchange;
    char *send = fail_alloc((size_t)x->n_send * bytes),
         *recv = fail_alloc((size_t)x->n_recv * bytes);
    buffer_reserve(&x->packed, (size_t)x->n_send * bytes);
    bind_gather(g, g->gather, from, bytes);
    launch_run(g->gather, x->n_send);
    buffer_read(&x->packed, 0, (size_t)x->n_send * bytes, send);
    halo_exchange(x->halo, send, recv, bytes);
    buffer_write(from, (size_t)p->n_owned * bytes, (size_t)x->n_recv * bytes, recv);
    free(send);
    free(recv);
}

/* The index lists for all neighbours, one after the other, on the device. */
static void choose(struct ghosts *g, struct scan *scan, const struct particles *p,
    const struct box *all, int64_t *count_to)
{
    const struct comm *comm = g->comm;
    cl_int *index = NULL;
    int64_t n_send = 0;
    struct buffer piece;
    buffer_init(&piece, g->index.dev, "ghost piece");
    buffer_reserve(&g->pick, ((size_t)p->n_owned + 1) * sizeof(cl_int));
    for (int r = 0; r < comm->n_rank; r++) {
        count_to[r] = 0;
        if (r == comm->rank || !may_meet(g, &all[comm->rank], &all[r])) continue;
        count_to[r] = select_for(g, scan, p, r, &all[r], &piece);
        index = fail_realloc(index, (size_t)(n_send + count_to[r]) * sizeof *index);
        buffer_read(&piece, 0, (size_t)count_to[r] * sizeof *index, index + n_send);
        n_send += count_to[r];
    }
    buffer_put(&g->index, (size_t)n_send * sizeof(cl_int), index);
    buffer_free(&piece);
    free(index);
}

void ghosts_refresh(struct ghosts *g, struct particles *p)
{
    exchange_rows(g, p, &p->field[FIELD_STATE].now, p->field[FIELD_STATE].bytes);
}

void ghosts_plan(struct ghosts *g, const struct owners *owners, struct scan *scan,
    struct particles *p, const struct cells_bounds *own)
{
    const struct comm *comm = g->comm;
    p->n_ghost = 0;
    if (comm->n_rank == 1) return;
    struct box mine = {{0}, {0}, own->reach_max, p->n_owned},
               *all = fail_alloc((size_t)comm->n_rank * sizeof *all);
    int64_t *count_to = fail_alloc((size_t)comm->n_rank * sizeof *count_to);
    memcpy(mine.low, own->low, sizeof mine.low);
    memcpy(mine.high, own->high, sizeof mine.high);
    comm_gather(comm, &mine, all, sizeof mine);
    launch_set_int(g->select, "n_node", owners->n_node);
    launch_bind_all(g->select, (const struct launch_binding[]){{"node", &owners->node},
                                   {"cut", &owners->cut}, {"domain", &owners->domain}, {0}});
    choose(g, scan, p, all, count_to);
    exchange_plan(&g->exchange, comm, count_to);
    p->n_ghost = g->exchange.n_recv;
    particles_reserve(p, g->features, p->n_owned + p->n_ghost, p->n_owned);
    exchange_rows(g, p, &p->field[FIELD_GID].now, p->field[FIELD_GID].bytes);
    exchange_rows(g, p, &p->reach, particles_preal(g->features));
    ghosts_refresh(g, p);
    bind_gather(g, g->pack, &p->field[FIELD_STATE].now, p->field[FIELD_STATE].bytes);
    exchange_bind(&g->exchange, p->field[FIELD_STATE].bytes, false);
    free(count_to);
    free(all);
}

void ghosts_begin(struct ghosts *g, struct timers *timers)
{
    if (g->comm->n_rank > 1) exchange_begin(&g->exchange, g->pack, timers);
}

const cl_event *ghosts_swap(
    struct ghosts *g, struct particles *p, cl_event *nearly_done, struct timers *timers)
{
    if (g->comm->n_rank == 1) return NULL;
    return exchange_swap(&g->exchange, &p->field[FIELD_STATE].now,
        (size_t)p->n_owned * g->exchange.record, nearly_done, timers);
}
