#include "exchange.h"

#include "trace.h"

void exchange_init(struct exchange *x, struct device *dev, const char *const name[4])
{
    struct buffer *all[] = {&x->packed, &x->arrived, &x->send_staging, &x->recv_staging};
    *x = (struct exchange){.dev = dev};
    for (int i = 0; i < 4; i++) buffer_init(all[i], dev, name[i]);
}

void exchange_free(struct exchange *x)
{
    struct buffer *all[] = {&x->packed, &x->arrived, &x->send_staging, &x->recv_staging};
    exchange_settle(x);
    halo_free(x->halo);
    for (int i = 0; i < 4; i++) buffer_free(all[i]);
}

void exchange_plan(struct exchange *x, const struct comm *comm, const int64_t *count_to)
{
    x->before = exchange_sent(x);
    halo_free(x->halo);
    x->halo = halo_create(comm, count_to);
    x->n_send = x->halo->send_begin[x->halo->n_send];
    x->n_recv = x->halo->recv_begin[x->halo->n_recv];
}

void exchange_bind(struct exchange *x, size_t record, bool has_arrived)
{
    x->record = record;
    buffer_reserve(&x->packed, (size_t)x->n_send * record);
    if (has_arrived) buffer_reserve(&x->arrived, (size_t)x->n_recv * record);
    buffer_reserve_staging(&x->send_staging, (size_t)x->n_send * record);
    buffer_reserve_staging(&x->recv_staging, (size_t)x->n_recv * record);
    halo_bind(x->halo, x->send_staging.host, x->recv_staging.host, record);
}

static void release(cl_event *event)
{
    if (!*event) return;
    check_cl(clWaitForEvents(1, event));
    check_cl(clReleaseEvent(*event));
    *event = NULL;
}

/* The queue that reads back what is packed for sending: one beside the kernels, where a device can
 * copy while it computes. One that computes on the host's cores has workers for either; with a
 * queue of its own they would come to the copy after the interior, if they find that first.
 * Measured on one core, two ranks: 46 to 69 % of the steps then had messages under most of the
 * interior, 79 to 83 % with the queue of the kernels. */
static cl_command_queue read_queue(const struct device *dev)
{
    return device_shares_cores(dev) ? dev->compute : dev->copy;
}

static void complete_sends(struct device *dev, struct halo *halo, struct timers *timers)
{
    trace_lap(dev->trace, NULL);
    timer_begin(timers, TIMER_EXCHANGE);
    timer_begin(timers, TIMER_WAIT);
    halo_end(halo);
    timer_end(timers, TIMER_WAIT);
    timer_end(timers, TIMER_EXCHANGE);
}

/* Waits until the send buffer is full, and sends. A host that shares cores with the device sleeps
 * meanwhile; elsewhere it drives MPI, and does not trust the driver's wait, which may be a spin
 * without progress. */
static void send(struct exchange *x, struct timers *timers)
{
    struct device *dev = x->dev;
    struct timespec began = {0};
    trace_lap(dev->trace, "enqueue");
    if (device_shares_cores(dev)) check_cl(clWaitForEvents(1, &x->read_event));
    while (!device_event_done(x->read_event)) {
        halo_poll(x->halo);
        comm_pause(x->halo->comm, &began);
    }
    trace_lap(dev->trace, "read");
    timer_begin(timers, TIMER_EXCHANGE);
    halo_begin_send(x->halo);
    timer_end(timers, TIMER_EXCHANGE);
    trace_lap(dev->trace, "send");
    trace_messages(dev->trace, x->halo->n_send, x->halo->send_rank, true);
}

void exchange_begin(struct exchange *x, struct launch *pack, struct timers *timers)
{
    complete_sends(x->dev, x->halo, timers);
    launch_run_on(pack, x->dev->compute, x->n_send, NULL, &x->packed_event);
    check_cl(clFlush(x->dev->compute));
    buffer_read_begin(&x->packed, read_queue(x->dev), 0, (size_t)x->n_send * x->record,
        x->send_staging.host, &x->packed_event, &x->read_event);
    check_cl(clFlush(read_queue(x->dev)));
    release(&x->written_event); /* long done: the receive staging is free */
    timer_begin(timers, TIMER_EXCHANGE);
    halo_begin_recv(x->halo);
    timer_end(timers, TIMER_EXCHANGE);
    trace_lap(x->dev->trace, "pack");
    if (x->dev->at_once) send(x, timers); /* else the messages would wait for the interior */
}

static void receive(
    struct device *dev, struct halo *halo, cl_event *nearly_done, struct timers *timers)
{
    struct timespec began = {0};
    if (device_shares_cores(dev)) check_cl(clWaitForEvents(1, nearly_done));
    check_cl(clReleaseEvent(*nearly_done));
    trace_lap(dev->trace, "device");
    timer_begin(timers, TIMER_EXCHANGE);
    timer_begin(timers, TIMER_WAIT);
    while (!halo_poll(halo)) comm_pause(halo->comm, &began);
    timer_end(timers, TIMER_WAIT);
    timer_end(timers, TIMER_EXCHANGE);
    trace_lap(dev->trace, "receive");
    trace_messages(dev->trace, halo->n_recv, halo->recv_rank, false);
}

const cl_event *exchange_swap(struct exchange *x, struct buffer *to, size_t offset,
    cl_event *nearly_done, struct timers *timers)
{
    if (!x->dev->at_once) send(x, timers);
    receive(x->dev, x->halo, nearly_done, timers);
    buffer_write_begin(to, x->dev->copy, offset, (size_t)x->n_recv * x->record,
        x->recv_staging.host, NULL, &x->written_event);
    check_cl(clFlush(x->dev->copy));
    release(&x->read_event);
    release(&x->packed_event);
    return &x->written_event;
}

void exchange_settle(struct exchange *x)
{
    if (x->halo) halo_end(x->halo);
    release(&x->written_event);
    release(&x->read_event);
    release(&x->packed_event);
    device_finish(x->dev);
}

struct halo_traffic exchange_sent(const struct exchange *x)
{
    struct halo_traffic sent = x->before;
    if (x->halo) {
        sent.bytes += x->halo->sent.bytes;
        sent.messages += x->halo->sent.messages;
    }
    return sent;
}
