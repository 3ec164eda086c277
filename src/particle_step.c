/* One step of the particle method. The host only enqueues, except in ghosts_swap, where it moves messages while the device works, and in watch_vote,
 * where
 * it waits for a flag of the step before.
 *
 *   forces at t^n    interior pairs and walls beside the exchange, then pairs with ghosts
 *   gather           sum in fixed order, kick; unless the step is observed also the next kick and drift, to t^{n+1} */
#include "particle.h"

#include "output.h"
#include "signals.h"

static void launch_pairs(struct sim *s, int64_t first, int64_t n, const cl_event *wait)
{
    if (n == 0) return;
    launch_set_int(s->pair_force, "first", (int)first);
    launch_set_int(s->pair_force, "end", (int)(first + n));
    launch_run(s->pair_force, s->dev->compute, n, wait ? 1 : 0, wait, NULL);
}

static void launch_walls(struct sim *s)
{
    struct wall_contacts *w = s->wall_contacts;
    if (!w || w->now.n == 0) return;
    if (s->features.triangle) wall_contacts_select(s->dev, w, s->particles);
    launch_set_int(s->wall_force, "n_candidate", (int)w->now.n);
    launch_run(s->wall_force, s->dev->compute, w->now.n, 0, NULL, NULL);
}

void particle_forces(struct sim *s)
{
    const struct pair_list *l = &s->pairs->now;
    if (s->wall_contacts) wall_contacts_set_step(s->dev, s->wall_contacts, s->step);
    timer_begin(&s->timers, TIMER_EXCHANGE);
    ghosts_begin(s->dev, s->ghosts, s->particles);
    timer_end(&s->timers, TIMER_EXCHANGE);
    launch_pairs(s, 0, l->n_interior, NULL);
    launch_walls(s);
    device_flush(s->dev);
    const cl_event *arrived = ghosts_swap(s->dev, s->ghosts, s->particles, &s->timers);
    launch_pairs(s, l->first_boundary, l->n_boundary, arrived);
}

static void advance(struct sim *s, bool observe)
{
    particle_forces(s);
    watch_vote(&s->watch, s->comm, output_stop_wanted(s) ? WATCH_STOP : 0);
    launch_set_int(s->gather, "observe", observe);
    launch_run(s->gather, s->dev->compute, s->particles->n_owned, 0, NULL, NULL);
    if (!observe) watch_read(s->dev, &s->watch, &s->particles->flags);
}

static void resume(struct sim *s)
{
    launch_run(s->kick_drift, s->dev->compute, s->particles->n_owned, 0, NULL, NULL);
    watch_read(s->dev, &s->watch, &s->particles->flags);
}

static bool stale(struct sim *s)
{
    return s->wall_contacts && wall_contacts_stale(s->wall_contacts, s->step, s->box, s->box + 3);
}

const struct step_ops particle_ops = {
    .name = "particles",
    .setup = particle_setup,
    .stale = stale,
    .regroup = particle_regroup,
    .advance = advance,
    .resume = resume,
    .free = particle_free,
};
