#include "lattice_halo.h"

#include <stdlib.h>

#include "comm/fail.h"

static void bind(struct launch *launch, const struct lattice_layout *layout, const struct buffer *x,
    const struct buffer *v, const struct buffer *word)
{
    launch_set_long(launch, "plane", layout->plane);
    launch_bind_buffer(launch, "x", x);
    launch_bind_buffer(launch, "v", v);
    if (word) launch_bind_buffer(launch, "word", word);
}

static void upload(
    struct device *dev, struct buffer *buffer, const char *name, const int *data, int64_t n)
{
    buffer_init(buffer, dev, name);
    buffer_reserve(buffer, (size_t)n * sizeof *data);
    buffer_write(buffer, 0, (size_t)n * sizeof *data, data);
}

struct lattice_halo *lattice_halo_create(struct device *dev, const struct comm *comm,
    const struct program *program, const struct lattice_layout *layout, const struct buffer *x,
    int n_x, size_t x_bytes, const struct buffer *v, int n_v, size_t v_bytes,
    const struct buffer *word)
{
    static const char *const name[] = {
        "lattice packed", "lattice arrived", "lattice send staging", "lattice receive staging"};
    struct lattice_halo *h = fail_alloc(sizeof *h);
    struct exchange *out = &h->exchange;
    upload(dev, &h->send, "lattice send", layout->send, layout->n_send);
    upload(dev, &h->recv, "lattice receive", layout->recv, layout->n_recv);
    exchange_init(out, dev, name);
    exchange_plan(out, comm, layout->count_to);
    exchange_bind(
        out, (size_t)n_x * x_bytes + (size_t)n_v * v_bytes + (word ? sizeof(int32_t) : 0), true);
    h->pack = launch_create(program, "lattice_pack");
    h->unpack = launch_create(program, "lattice_unpack");
    bind(h->pack, layout, x, v, word);
    bind(h->unpack, layout, x, v, word);
    launch_set_count(h->pack, "n", layout->n_send);
    launch_set_count(h->unpack, "n", layout->n_recv);
    launch_bind_buffer(h->pack, "index", &h->send);
    launch_bind_buffer(h->unpack, "index", &h->recv);
    launch_bind_buffer(h->pack, "record", &out->packed);
    launch_bind_buffer(h->unpack, "record", &out->arrived);
    return h;
}

void lattice_halo_free(struct lattice_halo *h)
{
    if (!h) return;
    exchange_free(&h->exchange);
    buffer_free(&h->send);
    buffer_free(&h->recv);
    launch_free(h->pack);
    launch_free(h->unpack);
    free(h);
}

void lattice_halo_begin(struct lattice_halo *h, int64_t x_in, int64_t v_in, struct timers *timers)
{
    launch_set_long(h->pack, "x_in", x_in);
    launch_set_long(h->pack, "v_in", v_in);
    launch_set_long(h->unpack, "x_in", x_in);
    launch_set_long(h->unpack, "v_in", v_in);
    exchange_begin(&h->exchange, h->pack, timers);
}

void lattice_halo_swap(struct lattice_halo *h, cl_event *nearly_done, struct timers *timers)
{
    const cl_event *arrived =
        exchange_swap(&h->exchange, &h->exchange.arrived, 0, nearly_done, timers);
    launch_run_on(h->unpack, h->exchange.dev->compute, h->exchange.n_recv, arrived, NULL);
}
