/* One step of the lattice: the same exchange before each evaluation of the forces. The host only
 * enqueues, except where it moves messages. */
#include "lattice.h"

#include "kernels/lattice/lattice_words.h"
#include "lattice_break.h"
#include "lattice_observed.h"
#include "device/trace.h"

/* First number of a set of planes. */
static int64_t x_at(const struct lattice *l, int set)
{
    return (int64_t)set * LATTICE_X(l->features.turn) * l->layout->plane;
}
static int64_t v_at(const struct lattice *l, int set)
{
    return (int64_t)set * LATTICE_V * l->layout->plane;
}

static void run(struct lattice *l, struct launch *launch, int first, int n, cl_event *done)
{
    launch_set_int(launch, "first", first);
    launch_set_int(launch, "n", n);
    launch_run_on(launch, l->dev->compute, (int64_t)n * l->layout->run, NULL, done);
}

/* Forces at set x_in with velocities v_in, and what follows, into x_out and v_out. */
static void evaluate(struct lattice *l, int x_in, int x_out, int v_in, int v_out)
{
    const struct lattice_layout *c = l->layout;
    cl_event nearly_done = NULL;
    launch_set_long(l->force, "x_in", x_at(l, x_in));
    launch_set_long(l->force, "x_out", x_at(l, x_out));
    launch_set_long(l->force, "v_in", v_at(l, v_in));
    launch_set_long(l->force, "v_out", v_at(l, v_out));
    if (l->features.volume) {
        launch_set_long(l->volume, "x_in", x_at(l, x_in));
        launch_set_long(l->volume, "v_in", v_at(l, v_in));
    }
    if (l->halo) {
        int n_first = c->n_force_interior * 3 / 4;
        lattice_halo_begin(l->halo, x_at(l, x_in), v_at(l, v_in), l->timers);
        trace_part(l->dev->trace, "interior");
        if (l->features.volume) run(l, l->volume, 0, c->n_volume_interior, NULL);
        run(l, l->force, 0, n_first, &nearly_done);
        run(l, l->force, n_first, c->n_force_interior - n_first, NULL);
        trace_part(l->dev->trace, NULL);
        device_flush(l->dev);
        lattice_halo_swap(l->halo, &nearly_done, l->timers);
    }
    int n_volume = l->halo ? c->n_volume_interior : 0, n_force = l->halo ? c->n_force_interior : 0;
    trace_part(l->dev->trace, "boundary");
    if (l->features.volume) run(l, l->volume, n_volume, c->n_volume - n_volume, NULL);
    run(l, l->force, n_force, c->n_force - n_force, NULL);
    trace_part(l->dev->trace, NULL);
}

/* Breakage, from the state at the step's start, with the ghosts and pressures of the step's first
 * evaluation where that is of this state. Links are gone with the step's end: all its evaluations
 * see the same ones. */
static void judge(struct lattice *l, int x_in, int v_in)
{
    if (l->breakage) lattice_break_judge(l->breakage, x_at(l, x_in), v_at(l, v_in));
}
static void part(struct lattice *l)
{
    if (l->breakage) lattice_break_sever(l->breakage);
}

/* Kicks that an evaluation enters in the ledger (kernels/lattice/lattice_work.h). */
enum { COUNT_END = 1, COUNT_BEGIN = 2 };

/* One evaluation of a splitting. k: row of the table of kicks; the first evaluation's drift is left
 * out if only its first kick is meant. */
static void split(struct lattice *l, int k, const struct lattice_op *op, double at, bool observe)
{
    double dt = l->options.dt, t = ((double)l->step + at) * dt,
           drift = observe ? 0 : op->drift * dt;
    int x_out = 1 - l->x_set, v_out = observe || l->features.link_damping ? 1 - l->v_set : l->v_set;
    launch_set_int(l->force, "at_kick", k * l->n_kind * KICK_WIDTH);
    launch_set_real(l->force, "drift", drift);
    if (l->features.energy)
        launch_set_int(l->force, "count",
            observe                ? COUNT_END
            : k == 0 && l->counted ? COUNT_BEGIN
                                   : COUNT_END | COUNT_BEGIN);
    l->counted = observe;
    lattice_rows_send(l, t, t, t + drift);
    evaluate(l, l->x_set, x_out, l->v_set, v_out);
    l->x_observed = l->x_set;
    l->v_observed = v_out;
    if (observe) return;
    l->x_set = x_out;
    l->v_set = v_out;
}

/* From x at this step, and v at this step or with its kick still due, to x at the next. */
static void split_step(struct lattice *l)
{
    const struct lattice_table *s = l->scheme;
    double at = s->first, dt = l->options.dt;
    if (s->first > 0) {
        if (l->breakage) lattice_observed_refresh(l, true);
        judge(l, l->x_set, l->v_set);
        double t = (double)l->step * dt;
        lattice_rows_send(l, t, t, t + s->first * dt);
        launch_set_real(l->first, "drift", s->first * dt);
        launch_set_long(l->first, "x_in", x_at(l, l->x_set));
        launch_set_long(l->first, "v_in", v_at(l, l->v_set));
        run(l, l->first, 0, l->layout->n_force, NULL);
    }
    for (int k = 0; k < s->n; k++) {
        bool begin_only = k == 0 && s->ends_with_kick && !l->started;
        int x_in = l->x_set, v_in = l->v_set;
        split(l, begin_only ? s->n + 1 : k, &s->op[k], at, false);
        if (k == 0 && s->ends_with_kick) judge(l, x_in, v_in);
        at += s->op[k].drift;
    }
    part(l);
    l->started = true;
    l->x_observed = l->x_set;
    l->v_observed = l->v_set;
}

static void rk_step(struct lattice *l)
{
    const struct lattice_table *s = l->scheme;
    double dt = l->options.dt, square = dt * dt;
    for (int k = 0; k < s->n; k++) {
        const struct lattice_rk *c = &s->rk[k];
        double t = ((double)l->step + c->at) * dt;
        int in = k == 0 ? 0 : 1 + (k - 1) % 2, out = k == s->n - 1 ? 0 : 1 + k % 2;
        launch_set_real(l->force, "c_sum_v", c->sum_v * dt);
        launch_set_real(l->force, "c_sum_a", c->sum_a * square);
        launch_set_real(l->force, "c_next_v", c->next_v * dt);
        launch_set_real(l->force, "c_next_a", c->next_a * square);
        launch_set_real(l->force, "c_next_turn", c->next_turn * dt);
        launch_set_real(l->force, "c_sum_turn", c->sum_turn * dt);
        launch_set_real(l->force, "c_sum_k", c->sum_k * dt);
        launch_set_real(l->force, "c_next_k", c->next_k * dt);
        if (l->features.energy) {
            launch_set_real(l->force, "c_before", c->before * dt);
            launch_set_real(l->force, "c_own", c->own * dt);
        }
        launch_set_int(l->force, "is_first", k == 0);
        launch_set_int(l->force, "is_last", k == s->n - 1);
        /* neighbours read velocities as this stage leaves them */
        double next = ((double)l->step + (k + 1 < s->n ? s->rk[k + 1].at : 1)) * dt;
        lattice_rows_send(l, t, next, next);
        evaluate(l, in, out, in, out);
        if (k == 0) judge(l, in, in);
    }
    part(l);
}

void lattice_advance(struct lattice *l, bool observe)
{
    if (!l->scheme->ends_with_kick) {
        if (l->scheme->is_rk) rk_step(l);
        else split_step(l);
        l->step++;
    } else if (observe) {
        split(l, l->scheme->n, &l->scheme->op[0], 0, true);
    } else {
        split_step(l);
        l->step++;
    }
    device_flush(l->dev);
}

void lattice_begin_step(struct lattice *l)
{
    if (!l->scheme->ends_with_kick) return;
    split_step(l);
    l->step++;
    device_flush(l->dev);
}
