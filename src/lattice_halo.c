#include "lattice_halo.h"

#include <stdlib.h>

#include "fail.h"

static void bind(
    struct launch *launch, const struct lattice_layout *layout, const struct buffer *x, const struct buffer *v, const struct buffer *word)
{
    launch_set_long(launch, "plane", layout->plane);
    launch_bind_buffer(launch, "x", x);
    launch_bind_buffer(launch, "v", v);
    if (word) launch_bind_buffer(launch, "word", word);
}

static void upload(struct device *dev, struct buffer *buffer, const char *name, const int *data, int64_t n)
{
    buffer_init(buffer, name);
    buffer_reserve(dev, buffer, (size_t)n * sizeof *data);
    buffer_write(dev, buffer, 0, (size_t)n * sizeof *data, data);
}

struct lattice_halo *lattice_halo_create(struct device *dev, const struct comm *comm, const struct program *program,
    const struct lattice_layout *layout, const struct buffer *x, int n_x, size_t x_bytes, const struct buffer *v, int n_v, size_t v_bytes,
    const struct buffer *word)
{
    struct lattice_halo *h = fail_alloc(sizeof *h);
    h->comm = comm;
    h->n_send = layout->n_send;
    h->n_recv = layout->n_recv;
    h->record = (size_t)n_x * x_bytes + (size_t)n_v * v_bytes + (word ? sizeof(int32_t) : 0);
    upload(dev, &h->send, "lattice send", layout->send, h->n_send);
    upload(dev, &h->recv, "lattice receive", layout->recv, h->n_recv);
    buffer_init(&h->packed, "lattice packed");
    buffer_init(&h->arrived, "lattice arrived");
    buffer_init(&h->send_staging, "lattice send staging");
    buffer_init(&h->recv_staging, "lattice receive staging");
    buffer_reserve(dev, &h->packed, (size_t)h->n_send * h->record);
    buffer_reserve(dev, &h->arrived, (size_t)h->n_recv * h->record);
    buffer_reserve_staging(dev, &h->send_staging, (size_t)h->n_send * h->record);
    buffer_reserve_staging(dev, &h->recv_staging, (size_t)h->n_recv * h->record);
    h->pack = launch_create(program, "lattice_pack");
    h->unpack = launch_create(program, "lattice_unpack");
    bind(h->pack, layout, x, v, word);
    bind(h->unpack, layout, x, v, word);
    launch_set_int(h->pack, "n", (int)h->n_send);
    launch_set_int(h->unpack, "n", (int)h->n_recv);
    launch_bind_buffer(h->pack, "index", &h->send);
    launch_bind_buffer(h->unpack, "index", &h->recv);
    launch_bind_buffer(h->pack, "record", &h->packed);
    launch_bind_buffer(h->unpack, "record", &h->arrived);
    h->halo = halo_create(comm, layout->count_to);
    halo_bind(h->halo, h->send_staging.host, h->recv_staging.host, h->record);
    return h;
}

void lattice_halo_free(struct device *dev, struct lattice_halo *h)
{
    if (!h) return;
    struct buffer *all[] = {&h->send, &h->recv, &h->packed, &h->arrived, &h->send_staging, &h->recv_staging};
    halo_end(h->halo);
    exchange_release(&h->written_event);
    exchange_release(&h->read_event);
    exchange_release(&h->packed_event);
    device_finish(dev);
    halo_free(h->halo);
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) buffer_free(dev, all[k]);
    launch_free(h->pack);
    launch_free(h->unpack);
    free(h);
}

void lattice_halo_begin(struct device *dev, struct lattice_halo *h, int64_t x_in, int64_t v_in, struct timers *timers)
{
    exchange_settle(dev, h->halo, timers);
    launch_set_long(h->pack, "x_in", x_in);
    launch_set_long(h->pack, "v_in", v_in);
    launch_set_long(h->unpack, "x_in", x_in);
    launch_set_long(h->unpack, "v_in", v_in);
    launch_run(h->pack, dev->compute, h->n_send, 0, NULL, &h->packed_event);
    check_cl(clFlush(dev->compute));
    buffer_read_begin(
        dev, exchange_queue(dev), &h->packed, 0, (size_t)h->n_send * h->record, h->send_staging.host, 1, &h->packed_event, &h->read_event);
    check_cl(clFlush(exchange_queue(dev)));
    exchange_release(&h->written_event); /* long done: the receive staging is free */
    exchange_post(dev, h->halo, timers);
}

void lattice_halo_swap(struct device *dev, struct lattice_halo *h, cl_event *most, struct timers *timers)
{
    exchange_send(dev, h->halo, h->read_event, timers);
    exchange_receive(dev, h->halo, most, timers);
    buffer_write_begin(dev, dev->copy, &h->arrived, 0, (size_t)h->n_recv * h->record, h->recv_staging.host, 0, NULL, &h->written_event);
    check_cl(clFlush(dev->copy));
    launch_run(h->unpack, dev->compute, h->n_recv, 1, &h->written_event, NULL);
    exchange_release(&h->read_event);
    exchange_release(&h->packed_event);
}
