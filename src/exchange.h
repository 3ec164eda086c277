/* The host's part of an exchange within a step, the same for both methods: when it sleeps, sends and looks for what has arrived, how long that takes
 * (timer.h) and where it stands in the timeline (trace.h). What travels, and how it gets from and to the device, is the caller's business.
 *
 * Order of calls: settle, (pack and read-back enqueued), post, (interior enqueued), send, receive, (arrivals enqueued). */
#ifndef DEMOCLES_EXCHANGE_H
#define DEMOCLES_EXCHANGE_H

#include "../comm/halo.h"
#include "device.h"
#include "timer.h"

/* The queue that reads back what is packed for sending: one beside the kernels, where a device can copy while it computes. One that computes on the
 * host's cores has workers for either; with a queue of its own they would come to the copy after the interior, if they find that first. Measured on
 * one core, two ranks: 46 to 69 % of the steps then had messages under most of the interior, 79 to 83 % with the queue of the kernels. */
static inline cl_command_queue exchange_queue(const struct device *dev)
{
    return device_shares_cores(dev) ? dev->compute : dev->copy;
}

/* Completes the sends of the exchange before: the send buffer may be refilled. */
void exchange_settle(struct device *dev, struct halo *halo, struct timers *timers);
/* Posts receives: the receive buffer has been read. */
void exchange_post(struct device *dev, struct halo *halo, struct timers *timers);
/* Waits until the send buffer is full (event `read`), and sends. A host that shares cores with the device sleeps meanwhile; elsewhere it drives MPI,
 * and does not trust the driver's wait, which may be a spin without progress. So the pack kernel and all before it are done when this returns: what
 * is enqueued then, on whichever queue, cannot overtake kernels that read the ghosts before. */
void exchange_send(struct device *dev, struct halo *halo, cl_event read, struct timers *timers);
/* Waits for arrivals. `most`: of the kernels that run meanwhile, an event shortly before their end, released here: a host that shares cores sleeps
 * until then, instead of taking time from the device by looking. */
void exchange_receive(struct device *dev, struct halo *halo, cl_event *most, struct timers *timers);

/* Waits for an event, if there is one, and forgets it. */
void exchange_release(cl_event *event);

#endif
