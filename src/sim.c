#include "sim.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "energy.h"
#include "fail.h"
#include "limit.h"
#include "output.h"
#include "particle.h"
#include "scene_report.h"
#include "signals.h"
#include "wake.h"

/* Steps between two looks at the limit of the time step, which cost as much as several steps. */
enum { LIMIT_EVERY = 500 };

/* Box of the domain: as given, else around elements and walls with room beyond, so that what falls out of sight is out of it. */
static void set_domain(struct sim *s)
{
    const struct domain *d = &s->scene->domain;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, size = 0, r = 0;
    for (int64_t i = 0; i < s->first->n; i++) {
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], s->first->x[3 * i + a]);
            high[a] = fmax(high[a], s->first->x[3 * i + a]);
        }
        r = fmax(r, s->first->radius[i]);
    }
    for (int w = 0; w < s->walls->n_wall; w++)
        for (int a = 0; a < 3; a++) {
            double b[2] = {s->walls->wall_low[3 * w + a], s->walls->wall_high[3 * w + a]};
            if (isfinite(b[0])) low[a] = fmin(low[a], b[0]);
            if (isfinite(b[1])) high[a] = fmax(high[a], b[1]);
        }
    for (int a = 0; a < 3; a++) size = fmax(size, high[a] - low[a]);
    for (int a = 0; a < 3; a++) {
        s->domain[a] = d->has_box ? d->min[a] : low[a] - 0.05 * size - 4 * r;
        s->domain[3 + a] = d->has_box ? d->max[a] : high[a] + 0.05 * size + 4 * r;
        s->period[a] = d->periodic[a] ? d->max[a] - d->min[a] : 0;
    }
}

static void read_inputs(struct sim *s)
{
    struct scene_errors errors = {NULL, 0};
    s->walls = walls_create(s->scene, &errors);
    s->first = generate_elements(s->scene, &errors);
    if (s->walls && s->first) generate_check_walls(s->scene, s->walls, s->first, &errors);
    scene_report_errors(s->comm, &errors);
    if (s->first->n > INT32_MAX / 2) fail_stop_together(EXIT_SCENE, "more than %d elements", INT32_MAX / 2);
}

static void set_step(struct sim *s)
{
    const struct scene_time *t = &s->scene->time;
    double limit = particle_limit_dense(s);
    s->dt = t->step > 0 ? t->step : t->safety * limit;
    if (!(s->dt > 0) || isinf(s->dt))
        fail_stop_together(EXIT_SCENE, "%s: time.step: auto finds no limit in this scene; give a value", s->scene->path);
    if (!(t->end / s->dt <= SCENE_STEPS_MOST))
        fail_stop_together(EXIT_SCENE, "%s: time.step: auto takes %.3g s, too many steps until time.end; give a value", s->scene->path, s->dt);
    s->n_step = (int64_t)ceil(t->end / s->dt * (1 - 1e-12));
    if (s->options->n_step >= 0 && s->options->n_step < s->n_step) s->n_step = s->options->n_step;
}

static void print_warnings(struct sim *s)
{
    struct scene_errors warnings = {NULL, 0};
    limit_warnings(s->scene, s->first, limit_speed(s->scene, s->walls, s->first), s->dt, &warnings);
    for (int i = 0; i < warnings.n; i++) log_warn(s->log, "%s", warnings.text[i]);
    scene_errors_free(&warnings);
}

static void print_memory(struct sim *s)
{
    double mine = (double)s->dev->counters.now_bytes;
    log_print(s->log, "device memory on rank 0: %.1f MiB, %.0f bytes per element", mine / 1048576,
        mine / (double)(s->particles->n_owned > 0 ? s->particles->n_owned : 1));
}

/* Where device and host compute on the same cores, the host sleeps while it waits. After the device has been opened and has its threads. */
static void share_cores(struct sim *s)
{
    if (!(s->dev->type & CL_DEVICE_TYPE_CPU) || s->comm->n_rank == 1) return;
    comm_set_naps(s->comm, true);
    wake_at_once();
}

struct sim *sim_create(struct scene *scene, struct comm *comm, struct log *log, const struct sim_options *options)
{
    struct sim *s = fail_alloc(sizeof *s);
    s->options = options;
    s->scene = scene;
    s->comm = comm;
    s->log = log;
    s->started = timer_now();
    timer_begin(&s->timers, TIMER_SETUP);
    read_inputs(s);
    s->features = features_of(scene, s->walls, s->first);
    set_domain(s);
    set_step(s);
    s->dev = device_open(comm, options->device, !s->features.real_is_float || !s->features.position_is_float, options->profile);
    share_cores(s);
    s->output = output_create(s);
    s->dev->dump_dir = options->dir;
    s->ops = &particle_ops;
    log_print(log, "%s", scene->title ? scene->title : scene->name);
    log_print(log, "%lld elements, %d walls, %d rank%s on %s (%s)", (long long)s->first->n, scene->n_wall, comm->n_rank, comm->n_rank > 1 ? "s" : "",
        s->dev->name, s->dev->platform_version);
    s->ops->setup(s);
    output_check_limit(s);
    energy_now(s, &s->energy_start);
    log_print(log, "time step %.4g s (%.2g of the limit %.4g s of the present contacts), %lld steps", s->dt, s->dt / s->dt_limit, s->dt_limit,
        (long long)s->n_step);
    print_warnings(s);
    print_memory(s);
    timer_end(&s->timers, TIMER_SETUP);
    return s;
}

static void progress(struct sim *s, bool end)
{
    struct log_progress p = {s->step, s->n_step, (double)s->step * s->dt, (double)s->n_step * s->dt, s->particles->n_global};
    if (end) log_progress_end(s->log, &p);
    else log_progress(s->log, &p);
}

/* Lists, lost elements and requests, as agreed beside the step before. Returns whether this step is to be the last. */
static bool look_around(struct sim *s)
{
    int32_t agreed = watch_agreed(&s->watch, s->comm);
    if (agreed & WATCH_LOST) output_stop_numerics(s, "positions or velocities are not numbers any more");
    if (agreed & WATCH_STALE || s->ops->stale(s)) {
        timer_begin(&s->timers, TIMER_REGROUP);
        s->ops->regroup(s);
        signals_keep(); /* kernels that ran for the first time may have been compiled */
        timer_end(&s->timers, TIMER_REGROUP);
    }
    if (s->step - s->limit_at >= LIMIT_EVERY) output_check_limit(s);
    return (agreed & WATCH_STOP) != 0;
}

/* Adds what a plain step has moved and allocated to the account that shows that it moves ghosts and flags alone, and allocates nothing. */
static void count_plain(struct sim *s, const struct device_counters *before)
{
    const struct device_counters *now = &s->dev->counters;
    s->n_plain++;
    s->plain.n_alloc += now->n_alloc - before->n_alloc;
    s->plain.n_h2d += now->n_h2d - before->n_h2d;
    s->plain.h2d_bytes += now->h2d_bytes - before->h2d_bytes;
    s->plain.n_d2h += now->n_d2h - before->n_d2h;
    s->plain.d2h_bytes += now->d2h_bytes - before->d2h_bytes;
    s->plain.n_launch += now->n_launch - before->n_launch;
}

int sim_run(struct sim *s)
{
    double output = 0;
    bool stop = false;
    signals_keep();
    timer_begin(&s->timers, TIMER_LOOP);
    output_write(s, s->n_step == 0);
    while (s->step < s->n_step && !stop) {
        const struct device_counters before = s->dev->counters;
        int64_t n_rebuild = s->n_rebuild, limit_at = s->limit_at;
        bool plain = s->step > 0 && !s->observed;
        if (!plain) s->ops->resume(s);
        s->step++;
        stop = look_around(s);
        s->observed = output_due(s, s->step) || s->step == s->n_step || stop;
        s->ops->advance(s, s->observed);
        s->element_steps += (double)s->particles->n_global;
        if (plain && !s->observed && s->n_rebuild == n_rebuild && s->limit_at == limit_at) count_plain(s, &before);
        if (s->observed) output_write(s, stop || s->step == s->n_step);
        progress(s, false);
    }
    device_finish(s->dev);
    output = s->timers.total[TIMER_OUTPUT];
    timer_end(&s->timers, TIMER_LOOP);
    s->timers.total[TIMER_LOOP] -= output;
    s->timers.total[TIMER_COMPUTE] = s->timers.total[TIMER_LOOP] - s->timers.total[TIMER_EXCHANGE] - s->timers.total[TIMER_REGROUP];
    progress(s, true);
    bool stopped = stop && s->step < s->n_step;
    if (stopped) log_print(s->log, "stopped on request at step %lld; a frame was written", (long long)s->step);
    output_close(s, stopped ? EXIT_STOPPED : EXIT_DONE);
    return stopped ? EXIT_STOPPED : EXIT_DONE;
}

void sim_free(struct sim *s)
{
    if (!s) return;
    s->ops->free(s);
    output_free(s->output);
    device_free(s->dev);
    walls_free(s->walls);
    generate_free(s->first);
    free(s);
}
