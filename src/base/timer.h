/* Wall clocks by name: how much time of a run goes into what, on this rank. A begin and an end cost
 * one reading of the clock each. */
#ifndef DEMOCLES_TIMER_H
#define DEMOCLES_TIMER_H

#include <stdint.h>

enum timer_name {
    TIMER_SETUP, /* from the start to the first step */
    TIMER_LOOP,  /* all steps, output left out */
    /* what is left of the loop: enqueueing kernels and waiting for the own device */
    TIMER_COMPUTE,
    TIMER_EXCHANGE, /* halo: posting, messages, arrival; votes; not the kernels that run under it */
    /* of that, waiting for other ranks, also while the device has work left: at most so much is
     * lost */
    TIMER_WAIT,
    TIMER_REGROUP, /* owners, migration, lists */
    TIMER_OUTPUT,  /* frames, measures */
    TIMER_N
};

struct timers {
    double total[TIMER_N]; /* [s] */
    double begun[TIMER_N]; /* [s] on timer_now's clock; meaningless unless open */
    int64_t n[TIMER_N];    /* times ended */
};

extern const char *const timer_label[TIMER_N];

/* Seconds on a clock that never jumps; its zero means nothing. */
double timer_now(void);

static inline void timer_begin(struct timers *timers, enum timer_name name)
{
    timers->begun[name] = timer_now();
}

/* Adds the time since timer_begin, and returns it [s]. */
static inline double timer_end(struct timers *timers, enum timer_name name)
{
    double t = timer_now() - timers->begun[name];
    timers->total[name] += t;
    timers->n[name]++;
    return t;
}

#endif
