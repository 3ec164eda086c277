/* What trace.c, which records a timeline, hands to trace_write.c, which writes it. */
#ifndef DEMOCLES_TRACE_PARTS_H
#define DEMOCLES_TRACE_PARTS_H

#include "trace.h"

enum trace_lane {
    TRACE_HOST,
    TRACE_COMPUTE,
    TRACE_COPY,
    TRACE_LANES,
    TRACE_SENT = TRACE_LANES,
    TRACE_ARRIVED
};

struct trace_span {
    char name[32];
    const char *part;   /* a literal; NULL: none */
    int64_t begin, end; /* [ns] of the own host's clock */
    int64_t step;
    int64_t size; /* bytes of a copy, items of a kernel; of a message its exchange's number */
    enum trace_lane lane;
    int rank;       /* the other one of a message */
    cl_event event; /* times are not known yet; NULL: they are */
};

/* What another clock lacks to one's own lies within [ns]. */
struct trace_bounds {
    int64_t low, high;
};

struct trace {
    const struct comm *comm;
    struct device *dev;
    const char *dir;
    int64_t first, n, step; /* steps asked for; now */
    const char *part;
    int64_t lap[2];                 /* [ns] begin and end of the lap before */
    int64_t n_exchange[2];          /* sent, arrived */
    struct trace_bounds device[2];  /* host minus device, before and after the steps */
    int64_t device_at[2];           /* [ns] when, on the host's clock */
    struct trace_bounds first_rank; /* host of rank 0 minus own */
    struct trace_span *span;        /* [n_span], room for TRACE_SPANS */
    int64_t n_span, n_lost;         /* lost: no room */
    cl_event own;                   /* trace_own_event */
    bool is_open, is_done;
};

/* 0 if the bounds allow it, else their middle. */
static inline int64_t trace_offset(const struct trace_bounds *bounds)
{
    return bounds->low <= 0 && bounds->high >= 0 ? 0
                                                 : bounds->low + (bounds->high - bounds->low) / 2;
}

/* Writes what all ranks have recorded. Collective. */
void trace_write(const struct trace *trace);

#endif
