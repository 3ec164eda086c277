#include "exchange.h"

#include "trace.h"

void exchange_settle(struct device *dev, struct halo *halo, struct timers *timers)
{
    trace_lap(dev->trace, NULL);
    timer_begin(timers, TIMER_EXCHANGE);
    timer_begin(timers, TIMER_WAIT);
    halo_end(halo);
    timer_end(timers, TIMER_WAIT);
    timer_end(timers, TIMER_EXCHANGE);
}

void exchange_post(struct device *dev, struct halo *halo, struct timers *timers)
{
    timer_begin(timers, TIMER_EXCHANGE);
    halo_begin_recv(halo);
    timer_end(timers, TIMER_EXCHANGE);
    trace_lap(dev->trace, "pack");
}

void exchange_send(struct device *dev, struct halo *halo, cl_event read, struct timers *timers)
{
    trace_lap(dev->trace, "enqueue");
    if (device_shares_cores(dev)) check_cl(clWaitForEvents(1, &read));
    while (!device_event_done(read)) {
        halo_poll(halo);
        comm_pause(halo->comm);
    }
    trace_lap(dev->trace, "read");
    timer_begin(timers, TIMER_EXCHANGE);
    halo_begin_send(halo);
    timer_end(timers, TIMER_EXCHANGE);
    trace_lap(dev->trace, "send");
    trace_messages(dev->trace, halo->n_send, halo->send_rank, true);
}

void exchange_receive(struct device *dev, struct halo *halo, cl_event *most, struct timers *timers)
{
    if (device_shares_cores(dev)) check_cl(clWaitForEvents(1, most));
    check_cl(clReleaseEvent(*most));
    trace_lap(dev->trace, "device");
    timer_begin(timers, TIMER_EXCHANGE);
    timer_begin(timers, TIMER_WAIT);
    while (!halo_poll(halo)) comm_pause(halo->comm);
    timer_end(timers, TIMER_WAIT);
    timer_end(timers, TIMER_EXCHANGE);
    trace_lap(dev->trace, "receive");
    trace_messages(dev->trace, halo->n_recv, halo->recv_rank, false);
}

void exchange_release(cl_event *event)
{
    if (!*event) return;
    check_cl(clWaitForEvents(1, event));
    check_cl(clReleaseEvent(*event));
    *event = NULL;
}
