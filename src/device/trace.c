#include "trace.h"

#include <stdlib.h>
#include <string.h>

#include "device.h"
#include "comm/fail.h"
#include "base/timer.h"
#include "trace_parts.h"

enum { TRIES = 50, FIRST_STEP = 101 /* what compiles and warms up is over by then */ };

static int64_t now(void)
{
    return (int64_t)(timer_now() * 1e9);
}

struct trace *trace_create(const struct comm *comm, struct device *dev, const char *dir,
    int64_t first, int64_t n, int64_t n_step)
{
    struct trace *t = fail_alloc(sizeof *t);
    if (first < 0) {
        int64_t latest = n_step - n + 1;
        first = latest >= FIRST_STEP ? FIRST_STEP : latest >= 1 ? latest : 1;
    }
    t->comm = comm;
    t->dev = dev;
    t->dir = dir;
    t->first = first;
    t->n = n;
    t->span = fail_alloc(TRACE_SPANS * sizeof *t->span);
    return t;
}

void trace_free(struct trace *t)
{
    if (!t) return;
    for (int64_t i = 0; i < t->n_span; i++)
        if (t->span[i].event) check_cl(clReleaseEvent(t->span[i].event));
    free(t->span);
    free(t);
}

static void narrow(struct trace_bounds *bounds, int64_t low, int64_t high)
{
    if (low > bounds->low) bounds->low = low;
    if (high < bounds->high) bounds->high = high;
}

static int64_t device_time(cl_event event, cl_profiling_info what)
{
    cl_ulong ns = 0;
    check_cl(clGetEventProfilingInfo(event, what, sizeof ns, &ns, NULL));
    return (int64_t)ns;
}

/* Host clock minus the device's, by reads of one byte: before the call <= queued, end <= after the
 * wait. */
static void compare_device(struct trace *t, int k)
{
    char byte = 0;
    cl_int error;
    cl_mem small = clCreateBuffer(t->dev->context, CL_MEM_READ_ONLY, 1, NULL, &error);
    check_cl(error);
    check_cl(clEnqueueWriteBuffer(t->dev->compute, small, CL_TRUE, 0, 1, &byte, 0, NULL, NULL));
    t->device[k] = (struct trace_bounds){INT64_MIN, INT64_MAX};
    for (int i = 0; i < TRIES; i++) {
        cl_event event;
        int64_t before = now();
        check_cl(
            clEnqueueReadBuffer(t->dev->compute, small, CL_FALSE, 0, 1, &byte, 0, NULL, &event));
        check_cl(clWaitForEvents(1, &event));
        int64_t after = now();
        narrow(&t->device[k], before - device_time(event, CL_PROFILING_COMMAND_QUEUED),
            after - device_time(event, CL_PROFILING_COMMAND_END));
        check_cl(clReleaseEvent(event));
    }
    t->device_at[k] = now();
    check_cl(clReleaseMemObject(small));
}

/* Clock of rank 0 minus the own. Nobody leaves a gather before all have entered: entry of rank 0 <=
 * own exit, own entry <= exit of rank 0. */
static void compare_ranks(struct trace *t)
{
    size_t n = (size_t)t->comm->n_rank;
    int64_t *entry = fail_alloc(n * sizeof *entry), *exit = fail_alloc(n * sizeof *exit);
    t->first_rank = (struct trace_bounds){INT64_MIN, INT64_MAX};
    for (int i = 0; i < TRIES; i++) {
        int64_t before = now();
        comm_gather(t->comm, &before, entry, sizeof before);
        int64_t after = now();
        comm_gather(t->comm, &after, exit, sizeof after);
        narrow(&t->first_rank, entry[0] - after, exit[0] - before);
    }
    free(entry);
    free(exit);
}

/* Times of the commands, whose events are done, on the host's clock. */
static void settle(struct trace *t)
{
    int64_t offset = trace_offset(&t->device[0]), change = trace_offset(&t->device[1]) - offset,
            length = t->device_at[1] - t->device_at[0];
    for (int64_t i = 0; i < t->n_span; i++) {
        struct trace_span *span = &t->span[i];
        if (!span->event) continue;
        int64_t begin = device_time(span->event, CL_PROFILING_COMMAND_START),
                end = device_time(span->event, CL_PROFILING_COMMAND_END);
        double passed =
            length > 0 ? (double)(begin + offset - t->device_at[0]) / (double)length : 0;
        int64_t shift = offset + (int64_t)((double)change * passed);
        span->begin = begin + shift;
        span->end = end + shift;
        check_cl(clReleaseEvent(span->event));
        span->event = NULL;
    }
}

void trace_step(struct trace *t, int64_t step)
{
    if (!t || t->is_done) return;
    t->step = step;
    if (!t->is_open && step >= t->first) {
        t->first = step;
        device_finish(t->dev);
        compare_device(t, 0);
        compare_ranks(t);
        t->dev->trace = t;
        t->is_open = true;
        t->lap[1] = now();
    }
    if (t->is_open && (step < 0 || step == t->first + t->n)) {
        t->dev->trace = NULL;
        device_finish(t->dev);
        compare_device(t, 1);
        settle(t);
        trace_write(t);
        t->is_done = true;
    }
    if (step < 0 && !t->is_open)
        fail_warn("--trace: the run ended before step %lld, from which on it was to be traced: no "
                  "trace.json",
            (long long)t->first);
}

static struct trace_span *add(struct trace *t, enum trace_lane lane, const char *name)
{
    if (t->n_span == TRACE_SPANS) {
        t->n_lost++;
        return NULL;
    }
    struct trace_span *span = &t->span[t->n_span++];
    strncpy(span->name, name, sizeof span->name - 1);
    span->part = t->part;
    span->step = t->step;
    span->lane = lane;
    return span;
}

cl_event *trace_own_event(struct trace *t)
{
    return &t->own;
}

void trace_add_command(
    struct trace *t, cl_command_queue queue, const char *name, size_t size, cl_event *event)
{
    struct trace_span *span = add(t, queue == t->dev->copy ? TRACE_COPY : TRACE_COMPUTE, name);
    if (span) {
        span->size = (int64_t)size;
        span->event = *event;
        check_cl(clRetainEvent(*event));
    }
    if (event == &t->own) check_cl(clReleaseEvent(t->own));
}

void trace_add_lap(struct trace *t, const char *name)
{
    int64_t end = now();
    struct trace_span *span = name ? add(t, TRACE_HOST, name) : NULL;
    if (span) {
        span->begin = t->lap[1];
        span->end = end;
    }
    t->lap[0] = t->lap[1];
    t->lap[1] = end;
}

void trace_set_part(struct trace *t, const char *part)
{
    t->part = part;
}

void trace_add_messages(struct trace *t, int n, const int *rank, bool is_sent)
{
    for (int k = 0; k < n; k++) {
        struct trace_span *span = add(t, is_sent ? TRACE_SENT : TRACE_ARRIVED, "message");
        if (!span) continue;
        /* within the lap, or readers take another one */
        span->begin = span->end = is_sent ? t->lap[0] + 1 : t->lap[1] - 1;
        span->size = t->n_exchange[is_sent];
        span->rank = rank[k];
    }
    t->n_exchange[is_sent]++;
}
