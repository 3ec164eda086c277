#include "lattice_halo.h"

#include <stdlib.h>

#include "comm/fail.h"

struct lattice_halo *lattice_halo_create(const struct comm *comm, const struct program *program,
    const struct lattice_layout *layout, struct lattice_planes x, struct lattice_planes v,
    const struct buffer *word)
{
    static const char *const name[] = {
        "lattice packed", "lattice arrived", "lattice send staging", "lattice receive staging"};
    struct lattice_halo *h = fail_alloc(sizeof *h);
    struct device *dev = program->dev;
    struct exchange *out = &h->exchange;
    buffer_init(&h->send, dev, "lattice send");
    buffer_init(&h->recv, dev, "lattice receive");
    buffer_put(&h->send, (size_t)layout->n_send * sizeof *layout->send, layout->send);
    buffer_put(&h->recv, (size_t)layout->n_recv * sizeof *layout->recv, layout->recv);
    exchange_init(out, dev, name);
    exchange_plan(out, comm, layout->count_to);
    exchange_bind(
        out, (size_t)x.n * x.bytes + (size_t)v.n * v.bytes + (word ? sizeof(int32_t) : 0), true);
    h->pack = launch_create(program, "lattice_pack");
    h->unpack = launch_create(program, "lattice_unpack");
    const struct {
        struct launch *launch;
        int64_t n;
        const struct buffer *index, *record;
    } way[] = {{h->pack, layout->n_send, &h->send, &out->packed},
        {h->unpack, layout->n_recv, &h->recv, &out->arrived}};
    for (int i = 0; i < 2; i++) {
        launch_set_long(way[i].launch, "plane", layout->plane);
        launch_set_count(way[i].launch, "n", way[i].n);
        launch_bind_all(
            way[i].launch, (const struct launch_binding[]){{"x", x.buffer}, {"v", v.buffer},
                               {"index", way[i].index}, {"record", way[i].record}, {0}});
        if (word) launch_bind_buffer(way[i].launch, "word", word);
    }
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
