/* One step of the particle method. The host only enqueues, except in ghosts_swap and assigned_swap,
 * where it moves messages while the device works, and in watch_vote, where it waits for a flag of
 * the step before.
 *
 *   forces at t^n    interior pairs and walls beside the exchange, then pairs with ghosts; where
 *                    those are assigned to one side (assigned.h) some interior pairs are left for
 *                    the time in which their results travel
 *   gather           sum in fixed order, kick; unless the step is observed also the next kick and
 *                    drift, to t^{n+1} */
#include "particle.h"

#include "kernels/common/batch.h"
#include "run/output.h"
#include "base/signals.h"
#include "device/trace.h"

static void launch_pairs(
    struct sim *s, int64_t first, int64_t n, const cl_event *wait, cl_event *done)
{
    struct particle_run *run = s->particle;
    if (n > 0) {
        launch_set_count(run->pair_force, "first", first);
        launch_set_count(run->pair_force, "end", first + n);
    }
    if (n > 0 || done) launch_run_on(run->pair_force, s->dev->compute, n, wait, done);
}

/* Interior pairs first <= p < end. With messages to come, `nearly_done` is the event of their
 * larger part: when it is over the host has time to pass on what came, while the device does the
 * rest. */
static void launch_interior(struct sim *s, int64_t first, int64_t end, cl_event *nearly_done)
{
    int64_t middle = s->comm->n_rank > 1 ? first + (end - first) * 3 / 4 / BATCH * BATCH : end;
    trace_part(s->dev->trace, "interior");
    launch_pairs(s, first, middle - first, NULL, s->comm->n_rank > 1 ? nearly_done : NULL);
    launch_pairs(s, middle, end - middle, NULL, NULL);
    trace_part(s->dev->trace, NULL);
}

/* Results of boundary pairs to and from the ranks that do not compute them, under the interior
 * pairs from `first` on. */
static void send_back(struct sim *s, int64_t first)
{
    struct particle_run *run = s->particle;
    cl_event nearly_done = NULL;
    assigned_begin(run->assigned, ASSIGNED_RESULTS, &s->timers);
    launch_interior(s, first, run->pairs->now.n_interior, &nearly_done);
    device_flush(s->dev);
    assigned_swap(run->assigned, ASSIGNED_RESULTS, &nearly_done, &s->timers);
}

static void launch_walls(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct wall_contacts *w = run->wall_contacts;
    if (!w || w->now.n == 0) return;
    if (run->features.joined) wall_contacts_select(w, run->particles);
    launch_set_count(run->wall_force, "n_candidate", w->now.n);
    launch_run(run->wall_force, w->now.n);
}

void particle_forces(struct sim *s)
{
    struct particle_run *run = s->particle;
    const struct pair_list *l = &run->pairs->now;
    int64_t n_first = run->assigned ? l->n_interior / 2 / BATCH * BATCH : l->n_interior;
    cl_event nearly_done = NULL;
    if (run->wall_contacts) wall_contacts_set_step(run->wall_contacts, s->step);
    if (run->assigned) assigned_begin(run->assigned, ASSIGNED_STATES, &s->timers);
    else ghosts_begin(run->ghosts, &s->timers);
    launch_interior(s, 0, n_first, &nearly_done);
    launch_walls(s);
    device_flush(s->dev);
    const cl_event *arrived = NULL;
    if (run->assigned) assigned_swap(run->assigned, ASSIGNED_STATES, &nearly_done, &s->timers);
    else arrived = ghosts_swap(run->ghosts, run->particles, &nearly_done, &s->timers);
    trace_part(s->dev->trace, "boundary");
    launch_pairs(s, l->first_boundary, l->n_mine, arrived, NULL);
    trace_part(s->dev->trace, NULL);
    if (run->assigned) send_back(s, n_first);
}

/* After the drift to the next step. */
static void read_flags(struct sim *s)
{
    if (watch_due(s->step + 1)) watch_read(&s->watch, &s->particle->particles->flags);
    else device_flush(s->dev);
}

void particle_advance(struct sim *s, bool observe)
{
    struct particle_run *run = s->particle;
    particle_forces(s);
    if (watch_due(s->step)) watch_vote(&s->watch, s->comm, output_stop_wanted(s) ? WATCH_STOP : 0);
    launch_set_int(run->gather, "observe", observe);
    launch_run(run->gather, run->particles->n_owned);
    if (!observe) read_flags(s);
}

void particle_begin_step(struct sim *s)
{
    struct particle_run *run = s->particle;
    launch_run(run->kick_drift, run->particles->n_owned);
    read_flags(s);
}
