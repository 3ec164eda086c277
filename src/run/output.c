#include "output.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "comm/fail.h"
#include "measures.h"
#include "results/frame_list.h"
#include "results/output_dir.h"
#include "results/snapshot.h"
#include "record.h"
#include "resume.h"
#include "base/signals.h"
#include "base/whole.h"
#include "version.h"

struct outputs {
    struct measures *measures;
    struct frame_list *list;
    int64_t frame_every, checkpoint_every; /* steps; 0: first and last only */
    int64_t n_frame;
    int64_t frame_step; /* of the last frame; -1: none */
    double looked_at;   /* clock of the last look for `stop` */
    bool stop_seen;
};

static int64_t steps_of(const struct sim *s, double every)
{
    return every > 0 ? whole_steps(every, s->dt) : 0;
}

/* Frames that output.every asks for, at equal distances; without it the first and the last. */
static bool is_listed(const struct sim *s, int64_t step)
{
    int64_t every = s->output->frame_every;
    if (every > 0) return step % every == 0;
    return step == 0 || step == s->n_step || s->rest.reached;
}

static void list_frame(struct sim *s, int64_t index)
{
    if (is_listed(s, s->output->frame_step))
        frame_list_add(s->output->list, index, (double)s->output->frame_step * s->dt);
}

struct outputs *output_create(struct sim *s)
{
    struct outputs *out = fail_alloc(sizeof *out);
    const char **name = fail_alloc((size_t)s->scene->n_measure * sizeof *name);
    for (int i = 0; i < s->scene->n_measure; i++) name[i] = s->scene->measure[i].name;
    struct output_request request = {s->options->dir, s->options->force, s->options->trace,
        s->scene->given, s->scene->n_given, s->scene->resolved, name, s->scene->n_measure};
    if (s->from) measures_check(s);
    if (s->from) output_dir_resume(s->comm, &request, s->from->index);
    else output_dir_create(s->comm, &request);
    log_attach(s->log, s->options->dir, s->from != NULL,
        LOG_FIRST_LINE DEMOCLES_VERSION " (" DEMOCLES_GIT ")\n");
    out->measures = measures_create(s);
    out->frame_every = steps_of(s, s->scene->output.every);
    out->checkpoint_every = steps_of(s, s->scene->output.checkpoint_every);
    out->frame_step = s->from ? s->from->step : -1;
    out->n_frame = s->from ? s->from->index + 1 : 0;
    out->list = frame_list_create(s->comm, s->options->dir, out->n_frame - 1);
    s->output = out;
    /* the run before may have been killed before it could list its last frame */
    if (s->from) list_frame(s, s->from->index);
    free(name);
    return out;
}

void output_free(struct outputs *out)
{
    if (!out) return;
    measures_free(out->measures);
    frame_list_free(out->list);
    free(out);
}

static bool frame_due(const struct sim *s, int64_t step)
{
    const int64_t every[] = {s->output->frame_every, s->output->checkpoint_every};
    for (int k = 0; k < 2; k++)
        if (every[k] > 0 && step % every[k] == 0) return true;
    return step == 0;
}

bool output_due(const struct sim *s, int64_t step)
{
    if (frame_due(s, step)) return true;
    for (int i = 0; i < s->scene->n_measure; i++)
        if (step % measures_every(s, i) == 0) return true;
    return false;
}

void output_write(struct sim *s, bool last)
{
    struct outputs *out = s->output;
    const struct timers before = s->timers;
    trace_lap(s->dev->trace, NULL);
    timer_begin(&s->timers, TIMER_OUTPUT);
    measures_write(s, out->measures);
    if ((last || frame_due(s, s->step)) && out->frame_step != s->step) {
        measures_flush(out->measures);
        s->ops->frame(s, out->n_frame++);
        out->frame_step = s->step;
        list_frame(s, out->n_frame - 1);
    }
    timer_end(&s->timers, TIMER_OUTPUT);
    /* what the output exchanges is the output's */
    s->timers.total[TIMER_EXCHANGE] = before.total[TIMER_EXCHANGE];
    s->timers.total[TIMER_WAIT] = before.total[TIMER_WAIT];
    trace_lap(s->dev->trace, "output");
}

/* The clock is read at every step, the folder is looked at twice a second. */
bool output_stop_wanted(struct sim *s)
{
    struct outputs *out = s->output;
    double now = timer_now();
    if (signals_seen() || now - s->started > s->options->max_time) out->stop_seen = true;
    if (s->comm->rank == 0 && now - out->looked_at > 0.5) {
        out->looked_at = now;
        if (output_dir_stop_asked(s->options->dir)) out->stop_seen = true;
    }
    return out->stop_seen;
}

void output_frame(struct sim *s, const struct frame *frame)
{
    if (!snapshot_is_finite(s->comm, frame))
        output_stop_numerics(s,
            "the last state holds NaN: positions or velocities are not numbers, and there is no "
            "frame of it");
    snapshot_write(s->comm, s->options->dir, frame);
}

_Noreturn void output_stop_numerics(struct sim *s, const char *what, ...)
{
    char text[1024];
    va_list args;
    va_start(args, what);
    vsnprintf(text, sizeof text, what, args);
    va_end(args);
    measures_flush(s->output->measures);
    trace_step(s->trace, -1);
    record_write(s, EXIT_NUMERICS, false);
    fail_stop_together(EXIT_NUMERICS, "step %lld, t = %.9g s: %s", (long long)s->step,
        (double)s->step * s->dt, text);
}

void output_close(struct sim *s, int exit_code)
{
    measures_flush(s->output->measures);
    if (!record_write(s, exit_code, true))
        fail_stop_together(EXIT_NUMERICS, "step %lld, t = %.9g s: the last state holds NaN",
            (long long)s->step, (double)s->step * s->dt);
}
