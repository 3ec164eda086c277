#include "sim.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "output.h"
#include "record.h"
#include "resume.h"
#include "base/signals.h"
#include "base/wake.h"

/* Steps between two looks at the limit of the time step, which cost as much as several steps. */
enum { LIMIT_EVERY = 500 };

/* The larger arrays, and what the others take together. */
static void print_memory(struct sim *s)
{
    struct memory_table table = s->dev->memory;
    double all = (double)s->dev->counters.now_bytes, rest = all,
           n = fmax((double)s->ops->n_element(s) / s->comm->n_rank, 1);
    memory_table_sort(&table);
    log_print(s->log, "device memory on rank 0: %.1f MiB, %.0f bytes per element", all / 1048576,
        all / n);
    log_print(s->log, "    %-24s %12s %18s", "array", "KiB", "bytes per element");
    for (int i = 0; i < table.n && (double)table.row[i].bytes > 0.02 * all; i++) {
        double bytes = (double)table.row[i].bytes;
        log_print(s->log, "    %-24s %12.1f %18.1f", table.row[i].name, bytes / 1024, bytes / n);
        rest -= bytes;
    }
    log_print(s->log, "    %-24s %12.1f %18.1f", "all others", rest / 1024, rest / n);
}

/* Where device and host, or several ranks, compute on the same cores, the host sleeps while it
 * waits. A sleep of 5 us takes 50; a host that computes itself, on a core of its own, therefore
 * looks on for as long as messages within a node take first. After the device has been opened and
 * has its threads. */
static void share_cores(struct sim *s)
{
    const double spin_ns = s->dev->at_once && s->dev->own_core ? 1e5 : 0;
    if (!device_shares_cores(s->dev) || s->comm->n_rank == 1) return;
    comm_set_naps(s->comm, true, spin_ns);
    wake_at_once();
}

static void count_steps(struct sim *s)
{
    if (!(s->scene->time.end / s->dt <= SCENE_STEPS_MOST))
        fail_stop_together(EXIT_SCENE,
            "%s: time.step: auto is %.3g s, too many steps until time.end; give a value",
            s->scene->path, s->dt);
    s->n_step = (int64_t)ceil(s->scene->time.end / s->dt * (1 - 1e-12));
    if (s->options->n_step >= 0 && s->options->n_step < s->n_step) s->n_step = s->options->n_step;
    if (s->from && s->from->step > s->n_step)
        fail_stop_together(s->n_step == s->options->n_step ? EXIT_USAGE : EXIT_SCENE,
            "'%s' is of step %lld, after step %lld, with which the run shall end", s->from->path,
            (long long)s->from->step, (long long)s->n_step);
}

/* At the start of a run; one that goes on has looked at its limit already. */
static void begin(struct sim *s)
{
    if (!s->from) {
        s->ops->check_limit(s);
        return;
    }
    resume_close(s->from);
    s->begun_at = s->step;
    log_print(s->log, "resumes from step %lld, t = %.9g s, of '%s'", (long long)s->step,
        (double)s->step * s->dt, s->from->path);
    if (s->step == s->n_step || s->rest.reached) log_print(s->log, "the run is already complete");
}

/* Without a contact nothing limits the step of particles yet. */
static void print_step(const struct sim *s)
{
    if (isfinite(s->dt_limit))
        log_print(s->log, "time step %.4g s (%.2g of the critical time step, %.4g s), %lld steps",
            s->dt, s->dt / s->dt_limit, s->dt_limit, (long long)s->n_step);
    else
        log_print(s->log, "time step %.4g s (no contact limits it yet), %lld steps", s->dt,
            (long long)s->n_step);
}

struct sim *sim_create(struct scene *scene, struct comm *comm, struct log *log,
    const struct step_ops *ops, struct resume *from, const struct sim_options *options)
{
    struct sim *s = fail_alloc(sizeof *s);
    s->options = options;
    s->from = from;
    s->scene = scene;
    s->comm = comm;
    s->log = log;
    s->ops = ops;
    s->started = timer_now();
    s->observed = true; /* the state that the set-up leaves */
    s->rest.left = (double)NAN;
    s->balance = balance_create(comm, &scene->partition);
    timer_begin(&s->timers, TIMER_SETUP);
    s->ops->read(s);
    s->ops->plan(s);
    if (s->from) resume_check_inputs(s);
    count_steps(s);
    s->dev = device_open(comm, options->device, scene->precision != PRECISION_SINGLE,
        options->profile || options->trace);
    s->dev->profile = options->profile; /* a trace wants the queues' times alone */
    share_cores(s);
    s->output = output_create(s);
    fail_tell(record_error, s);
    s->dev->dump_dir = options->dir;
    log_print(log, "%s", scene->title ? scene->title : scene->name);
    record_print_devices(s);
    s->ops->setup(s);
    begin(s);
    print_step(s);
    if (s->ops->warn) s->ops->warn(s);
    print_memory(s);
    if (options->trace)
        s->trace = trace_create(
            comm, s->dev, options->dir, options->trace_from, options->trace_steps, s->n_step);
    timer_end(&s->timers, TIMER_SETUP);
    return s;
}

static void progress(struct sim *s, bool end)
{
    struct log_progress p = {s->step, s->n_step, (double)s->step * s->dt, (double)s->n_step * s->dt,
        s->ops->n_element(s)};
    if (end) log_progress_end(s->log, &p);
    else log_progress(s->log, &p);
}

/* Does what all ranks have agreed on during the step before: ends a run that has lost elements,
 * rebuilds lists that are used up. Returns whether somebody asks to stop with this step. */
static bool act_on_votes(struct sim *s)
{
    trace_lap(s->dev->trace, NULL);
    timer_begin(&s->timers, TIMER_EXCHANGE);
    timer_begin(&s->timers, TIMER_WAIT);
    int32_t agreed = watch_agreed(&s->watch, s->comm);
    timer_end(&s->timers, TIMER_WAIT);
    timer_end(&s->timers, TIMER_EXCHANGE);
    trace_lap(s->dev->trace, "vote");
    if (agreed & WATCH_LOST) output_stop_numerics(s, "positions or velocities are not numbers");
    if (s->ops->regroup && (agreed & WATCH_STALE || s->ops->stale(s))) {
        timer_begin(&s->timers, TIMER_REGROUP);
        s->ops->regroup(s);
        signals_keep(); /* kernels that ran for the first time may have been compiled */
        timer_end(&s->timers, TIMER_REGROUP);
        trace_lap(s->dev->trace, "regroup");
    }
    return (agreed & WATCH_STOP) != 0;
}

/* The clocks that a trace reads and the file that it writes count as output time. */
static void trace(struct sim *s, int64_t step)
{
    if (!s->trace) return;
    timer_begin(&s->timers, TIMER_OUTPUT);
    trace_step(s->trace, step);
    timer_end(&s->timers, TIMER_OUTPUT);
}

/* Returns the exit code. Who asks for rest and gets none by the scene's end has no result. */
static int close_run(struct sim *s, bool stopped)
{
    bool restless = s->rest.next > 0 && !s->rest.reached && !stopped &&
                    (double)s->step * s->dt >= s->scene->time.end * (1 - 1e-12);
    int code = stopped ? EXIT_STOPPED : restless ? EXIT_NUMERICS : EXIT_DONE;
    if (stopped)
        log_print(s->log,
            "stopped on request at step %lld; a frame was written, `democles resume %s` continues",
            (long long)s->step, s->options->dir);
    if (s->rest.reached)
        log_print(s->log, "static equilibrium after step %lld", (long long)s->step);
    output_close(s, code);
    if (restless)
        fail_stop_together(EXIT_NUMERICS,
            "no static equilibrium by time.end, %g s: the residual force was %.3g at the last "
            "convergence check, relax.tolerance is %g",
            s->scene->time.end, s->rest.left, s->scene->lattice.tolerance);
    return code;
}

static void begin_loop(struct sim *s)
{
    double *total = s->timers.total;
    struct step_counts counts;
    signals_pass(); /* held since the program began */
    total[TIMER_EXCHANGE] = total[TIMER_WAIT] = total[TIMER_REGROUP] = 0; /* those of the set-up */
    s->ops->count(s, &counts);
    s->sent_before = counts.sent;
    timer_begin(&s->timers, TIMER_LOOP);
    if (!s->from) output_write(s, s->n_step == 0);
}

static void end_loop(struct sim *s)
{
    double *total = s->timers.total;
    trace(s, -1);
    device_finish(s->dev);
    timer_end(&s->timers, TIMER_LOOP);
    total[TIMER_LOOP] -= total[TIMER_OUTPUT];
    total[TIMER_COMPUTE] = total[TIMER_LOOP] - total[TIMER_EXCHANGE] - total[TIMER_REGROUP];
    progress(s, true);
}

static bool is_limit_due(const struct sim *s)
{
    return s->step - s->limit_at >= LIMIT_EVERY;
}

/* Everything that reads the state of a full step. */
static void observe(struct sim *s, bool stop)
{
    device_finish(s->dev); /* the time of the steps is theirs, not the output's */
    if (is_limit_due(s)) s->ops->check_limit(s);
    if (s->step == s->rest.next) s->rest.reached = s->ops->is_at_rest(s);
    output_write(s, stop || s->rest.reached || s->step == s->n_step);
}

/* The main loop. The states that a step begins and ends with are drawn in step.h. */
int sim_run(struct sim *s)
{
    bool stop = false;
    begin_loop(s);
    while (s->step < s->n_step && !stop && !s->rest.reached) {
        trace(s, s->step + 1);
        account_begin(&s->account, s);
        if (s->observed) s->ops->begin_step(s);
        s->step++;
        stop = act_on_votes(s); /* rebuilds lists too */
        s->observed = stop || s->step == s->n_step || output_due(s, s->step) || is_limit_due(s) ||
                      s->step == s->rest.next;
        s->ops->advance(s, s->observed);
        account_end(&s->account, s);
        if (s->observed) observe(s, stop);
        progress(s, false);
    }
    end_loop(s);
    return close_run(s, stop && !s->rest.reached && s->step < s->n_step);
}

void sim_require_double(const struct sim *s)
{
    if (s->dev->fp64) return;
    fail_stop_together(EXIT_DEVICE,
        "%s: a measure of energy needs double precision on every rank, and a device here does not "
        "have it (`democles devices` shows which); take "
        "another device, or leave the measure out",
        s->scene->path);
}

void sim_free(struct sim *s)
{
    if (!s) return;
    fail_tell(NULL, s);
    s->ops->free(s);
    output_free(s->output);
    trace_free(s->trace);
    balance_free(s->balance);
    device_free(s->dev);
    free(s);
}
