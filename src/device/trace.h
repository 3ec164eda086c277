/* A timeline of some steps: what the host, the compute queue and the copy queue of each rank did,
 * and when, as DIR/trace.json in Chrome's Trace Event Format, which Perfetto and chrome://tracing
 * open. pid: rank; tid: host, compute, copy; arrows: messages.
 *
 * Costs a look at a NULL pointer where it is off: device.trace is NULL then, as it is outside of
 * the steps asked for. Its size is bounded: so many steps, and at most TRACE_SPANS spans per rank.
 *
 * Clocks. All times are brought to the host clock of rank 0 (timer_now). OpenCL 1.2 cannot tell how
 * a device's counter lies to it, so this is bounded by commands: one is queued after the host has
 * asked for it and ends before the host knows, and the closest of many tries count; in the same way
 * ranks by collectives, which nobody leaves before all have entered. 0 is taken for the offset
 * where the bounds allow it, for then the clocks are taken to be one; else their middle. The file's
 * `otherData` has the bounds. Bounds of a device are taken before and after the steps; an offset
 * that changes between them is interpolated. */
#ifndef DEMOCLES_TRACE_H
#define DEMOCLES_TRACE_H

#include "device.h"

enum { TRACE_STEPS = 20 /* unless told otherwise */, TRACE_SPANS = 1 << 16 };

struct trace;

/* n_step: last step of the run. first: of the steps to be traced, -1: 101, or earlier so that all n
 * fit in. The device must have been opened with profiling. Borrows all, dir too. Not collective. */
struct trace *trace_create(const struct comm *comm, struct device *dev, const char *dir,
    int64_t first, int64_t n, int64_t n_step);
void trace_free(struct trace *trace); /* NULL is fine */

/* The step that begins; -1: the run is over. With the first of the steps asked for recording
 * begins, after the last it ends and the file is written (collective then). NULL is fine. */
void trace_step(struct trace *trace, int64_t step);

/* The rest is called from within steps, with device.trace, and does nothing if that is NULL. */

/* Where a command to be enqueued shall put its event: where the caller wants it, else in a place of
 * the trace's. NULL where nobody wants it. */
cl_event *trace_own_event(struct trace *trace);
static inline cl_event *trace_event(struct trace *trace, cl_event *wanted)
{
    return wanted || !trace ? wanted : trace_own_event(trace);
}

/* A command has been enqueued with the event of trace_event. `size`: bytes of a copy, items of a
 * kernel. */
void trace_add_command(
    struct trace *trace, cl_command_queue queue, const char *name, size_t size, cl_event *event);
static inline void trace_command(
    struct trace *trace, cl_command_queue queue, const char *name, size_t size, cl_event *event)
{
    if (trace) trace_add_command(trace, queue, name, size, event);
}

/* What the host did since the call before; NULL: nothing worth a span. */
void trace_add_lap(struct trace *trace, const char *name);
static inline void trace_lap(struct trace *trace, const char *name)
{
    if (trace) trace_add_lap(trace, name);
}

/* What kind of interactions the commands that follow are about: "interior", "boundary"; NULL:
 * neither. */
void trace_set_part(struct trace *trace, const char *part);
static inline void trace_part(struct trace *trace, const char *part)
{
    if (trace) trace_set_part(trace, part);
}

/* A message to (is_sent) or from each of these ranks: in the lap before. */
void trace_add_messages(struct trace *trace, int n, const int *rank, bool is_sent);
static inline void trace_messages(struct trace *trace, int n, const int *rank, bool is_sent)
{
    if (trace) trace_add_messages(trace, n, rank, is_sent);
}

#endif
