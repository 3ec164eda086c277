/* The lattice as a method of the main loop (step.h). */
#include "lattice_method.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "lattice_fields.h"
#include "lattice_frequency.h"
#include "lattice_restore.h"
#include "run/energy_watch.h"
#include "run/output.h"
#include "results/report.h"
#include "run/record.h"
#include "run/resume.h"
#include "run/trust.h"
#include "scene/scene_report.h"

/* Steps to measure the speed of the ranks by, and those before. */
enum { MEASURED_STEPS = 20, FIRST_STEPS = 5 };

static bool wants_stress(const struct scene *scene)
{
    bool wants = lattice_fields_need_stress(scene->output.field, scene->output.n_field);
    for (int m = 0; m < scene->n_measure; m++) {
        const struct measure *what = &scene->measure[m];
        wants |= what->kind == MEASURE_STRESS_MAX ||
                 lattice_fields_need_stress(what->field, what->n_field);
    }
    return wants;
}

static void read(struct sim *s)
{
    struct scene_errors errors = {NULL, 0};
    s->lattice = fail_alloc(sizeof *s->lattice);
    s->lattice->cells = lattice_cells_create(s->scene, &errors);
    scene_report_errors(s->comm, &errors);
    s->n_first = s->lattice->cells->n;
}

static void plan(struct sim *s)
{
    const struct scene_time *t = &s->scene->time;
    s->dt_limit = lattice_frequency_step(s->scene, s->lattice->cells);
    s->dt = s->from ? s->from->dt : t->step > 0 ? t->step : t->safety * s->dt_limit;
    if (!(s->dt > 0) || isinf(s->dt))
        fail_stop_together(EXIT_SCENE,
            "%s: time.step: auto: no two cells are linked, so nothing limits the time step; give "
            "a value",
            s->scene->path);
    s->lattice->input = lattice_input_create(s->scene, s->lattice->cells, s->dt);
    s->inputs = lattice_restore_inputs(s);
    if (s->from)
        s->lattice->input->options.energy =
            lattice_restore_energy(s, s->lattice->input->options.energy);
}

static struct lattice *create(struct sim *s)
{
    struct lattice *l =
        lattice_create(s->dev, s->comm, s->lattice->cells, &s->lattice->input->options);
    l->timers = &s->timers;
    balance_add(s->balance, l->part);
    return l;
}

/* Steps that nobody keeps, with equal shares: what each rank does in a second is its share of the
 * cells then. The first ones compile kernels. */
static void measure(struct sim *s)
{
    struct lattice *l = create(s);
    lattice_begin_step(l);
    for (int k = 0; k < FIRST_STEPS; k++) lattice_advance(l, false);
    device_finish(s->dev);
    balance_go_on(s->balance, &s->timers, 0);
    for (int k = 0; k < MEASURED_STEPS; k++) lattice_advance(l, false);
    device_finish(s->dev);
    balance_look(s->balance, &s->timers, MEASURED_STEPS);
    lattice_free(l);
}

/* Only rank 0 speaks, and of a run that begins. */
static void warn(struct sim *s)
{
    struct scene_errors warnings = {NULL, 0};
    if (s->from || s->comm->rank != 0) return;
    lattice_fit_warnings(s->scene, s->lattice->cells, &warnings);
    for (int i = 0; i < warnings.n; i++) log_warn(s->log, "%s", warnings.text[i]);
    scene_errors_free(&warnings);
}

static void setup(struct sim *s)
{
    struct lattice_run *r = s->lattice;
    log_element(s->log, "cell");
    log_print(s->log, "%lld cells in %d %s", (long long)s->n_first, s->scene->n_body,
        s->scene->n_body == 1 ? "body" : "bodies");
    warn(s);
    if (r->input->options.energy) sim_require_double(s);
    r->input->options.partition = s->scene->partition;
    r->input->options.share = s->balance->share;
    if (s->scene->partition.weights == WEIGHTS_MEASURED && s->comm->n_rank > 1) measure(s);
    r->lattice = create(s);
    balance_restart(s->balance);
    if (s->from) lattice_restore_cells(s);
    r->account = lattice_energy_create(r->lattice, r->cells);
    if (wants_stress(s->scene))
        r->stress =
            lattice_stress_create(r->lattice, s->scene->lattice.stress == STRESS_EXTRAPOLATED);
    if (s->scene->lattice.relax) {
        r->relax = lattice_relax_create(r->lattice, r->cells, s->scene->time.end);
        s->rest.next = s->scene->lattice.look_every - 1;
    }
    if (s->from) lattice_restore_run(s);
    else lattice_energy_now(r->account, &r->energy_start);
}

static void release(struct sim *s)
{
    if (!s->lattice) return;
    lattice_energy_free(s->lattice->account);
    lattice_stress_free(s->lattice->stress);
    lattice_relax_free(s->lattice->relax);
    lattice_free(s->lattice->lattice);
    lattice_input_free(s->lattice->input);
    lattice_cells_free(s->lattice->cells);
    free(s->lattice);
}

static void advance(struct sim *s, bool observe)
{
    lattice_advance(s->lattice->lattice, observe);
    if (watch_due(s->step)) watch_vote(&s->watch, s->comm, output_stop_wanted(s) ? WATCH_STOP : 0);
}

static void begin_step(struct sim *s)
{
    lattice_begin_step(s->lattice->lattice);
}

static bool is_at_rest(struct sim *s)
{
    struct lattice_relax *relax = s->lattice->relax;
    int64_t every = s->scene->lattice.look_every;
    bool is_second = s->step % every == 0, yes = false;
    if (is_second) {
        yes = lattice_relax_second(relax, s->scene->lattice.tolerance);
        const struct lattice_rest *rest = lattice_relax_rest(relax);
        s->rest.left = rest->left > 0 ? rest->left / rest->scale : 0;
        s->rest.damping = rest->alpha;
    } else {
        lattice_relax_first(relax);
    }
    s->rest.next += is_second ? every - 1 : 1;
    return yes;
}

static bool digest(struct sim *s, uint64_t *digest)
{
    return lattice_digest(s->lattice->lattice, digest) == 0;
}

static void check_limit(struct sim *s)
{
    uint64_t unused;
    s->limit_at = s->step;
    if (s->dt > s->dt_limit && !s->scene->time.allow_unstable)
        output_stop_numerics(s,
            "the time step %.4g s exceeds the critical time step %.4g s; use a smaller "
            "time.step, or set time.allow_unstable",
            s->dt, s->dt_limit);
    if (!digest(s, &unused))
        output_stop_numerics(s,
            "displacements or velocities are not numbers; the time step %.4g s is %.3g of the "
            "critical one",
            s->dt, s->dt / s->dt_limit);
}

static int64_t number(const struct sim *s)
{
    return s->n_first;
}

static int64_t owned(const struct sim *s)
{
    return s->lattice->lattice->layout->n_owned;
}

/* Interactions: links whose lower cell this rank has. */
static void count(const struct sim *s, struct step_counts *counts)
{
    const struct lattice *l = s->lattice->lattice;
    *counts = (struct step_counts){0};
    for (int64_t i = 0; i < l->layout->n_owned; i++)
        for (int face = 1; face < 6; face += 2)
            counts->n_interaction += s->lattice->cells->bits[l->layout->gid[i]] >> face & 1;
    if (!l->halo) return;
    counts->sent = exchange_sent(&l->halo->exchange);
    counts->n_neighbour = l->halo->exchange.halo->n_send;
    counts->n_boundary = l->halo->exchange.n_send;
}

static void report_features(const struct sim *s, struct report *r)
{
    record_features(r, lattice_features_table, &s->lattice->lattice->features);
}

/* Links broken so far, by mode. Collective. */
static void report_broken(struct sim *s, struct report *r)
{
    int64_t count[LATTICE_BREAK_MODES];
    if (!s->lattice->lattice->breakage) return;
    lattice_break_count(s->lattice->lattice->breakage, count);
    report_begin(r, "broken");
    for (int mode = 0; mode < LATTICE_BREAK_MODES; mode++)
        report_integer(r, lattice_break_name(mode), count[mode]);
    report_end(r);
}

/* The law of links is linear: beyond small strains its force is no longer that of a material. */
static void report_strained(struct sim *s, struct report *r, double n)
{
    report_number(r, "strained_links", n);
    if (n > 0)
        log_warn(s->log,
            "%.0f links are strained by more than 10 %% or turned by more than 0.5 rad at the end, "
            "where the linear law of links does not hold",
            n);
}

/* now: NULL where the energy is not measured. */
static void report_trust(const struct sim *s, struct report *r, const struct lattice_energy *now)
{
    const struct lattice_energy *start = &s->lattice->energy_start;
    struct trust trust = trust_unknown;
    if (now)
        trust.energy_error = trust_energy(lattice_energy_balance(start, now),
            lattice_energy_supplied(start, now), ENERGY_WATCH_SPARE(now->gravity));
    trust_report(s, r, trust);
}

static void report_state(struct sim *s, struct report *r, bool observed)
{
    struct lattice_energy now = s->lattice->energy_start;
    bool by_work = s->lattice->lattice->features.energy;
    if (observed) lattice_energy_now(s->lattice->account, &now);
    energy_terms_report(
        lattice_energy_table, r, &s->lattice->energy_start, &now, by_work, by_work && observed);
    report_numbers(r, "momentum", now.momentum, 3);
    if (observed) report_strained(s, r, now.n_strained);
    report_broken(s, r);
    if (observed) report_trust(s, r, by_work ? &now : NULL);
}

static int launches(const struct sim *s, struct step_launch launch[STEP_LAUNCHES])
{
    const struct lattice *l = s->lattice->lattice;
    struct launch *all[] = {l->force, l->volume, l->first};
    for (int i = 0; i < 3; i++)
        launch[i] = (struct step_launch){all[i] ? all[i]->name : NULL, all[i]};
    return 3;
}

const struct step_ops lattice_ops = {
    .name = "lattice",
    .read = read,
    .plan = plan,
    .setup = setup,
    .free = release,
    .regroup = NULL, /* cells keep their neighbours and their rank */
    .advance = advance,
    .begin_step = begin_step,
    .check_limit = check_limit,
    .is_at_rest = is_at_rest,
    .n_element = number,
    .frame = lattice_method_frame,
    .measure_columns = lattice_method_measure_columns,
    .measure = lattice_method_measure,
    .digest = digest,
    .n_owned = owned,
    .count = count,
    .report_features = report_features,
    .report_state = report_state,
    .launches = launches,
};
