/* The particle method before there is a device: walls and elements from the scene, their extent,
 * the time step. */
#include "particle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "results/h5_check.h"
#include "run/resume.h"
#include "scene/scene_report.h"

void particle_read(struct sim *s)
{
    struct particle_run *run = s->particle = fail_alloc(sizeof *s->particle);
    struct scene_errors errors = {NULL, 0};
    run->walls = walls_create(s->scene, &errors);
    run->first = generate_elements(s->scene, &errors);
    if (run->walls && run->first) generate_check_walls(s->scene, run->walls, run->first, &errors);
    scene_report_errors(s->comm, &errors);
    if (run->first->n > INT32_MAX / 2)
        fail_stop_together(EXIT_SCENE, "more than %d elements", INT32_MAX / 2);
}

static void sum_inputs(struct sim *s)
{
    struct particle_run *run = s->particle;
    const struct elements_host *e = run->first;
    uint64_t sum = (uint64_t)e->n;
    sum = h5_check_add(sum, COLUMN_F64, e->x, 3 * e->n);
    sum = h5_check_add(sum, COLUMN_F64, e->radius, e->n);
    sum = h5_check_add(sum, COLUMN_I32, e->material, e->n);
    sum =
        h5_check_add(sum, COLUMN_F64, run->walls->primitive, 12 * (int64_t)run->walls->n_primitive);
    memcpy(&s->inputs, &sum, sizeof sum);
}

/* Box of the domain: as given, else around elements and walls with room beyond, so that what falls
 * out of sight is out of it. */
static void set_domain(struct sim *s)
{
    struct particle_run *run = s->particle;
    const struct domain *d = &s->scene->domain;
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY},
           size = 0, r = 0;
    for (int64_t i = 0; i < run->first->n; i++) {
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], run->first->x[3 * i + a]);
            high[a] = fmax(high[a], run->first->x[3 * i + a]);
        }
        r = fmax(r, run->first->radius[i]);
    }
    for (int w = 0; w < run->walls->n_wall; w++)
        for (int a = 0; a < 3; a++) {
            double b[2] = {run->walls->wall_low[3 * w + a], run->walls->wall_high[3 * w + a]};
            if (isfinite(b[0])) low[a] = fmin(low[a], b[0]);
            if (isfinite(b[1])) high[a] = fmax(high[a], b[1]);
        }
    for (int a = 0; a < 3; a++) size = fmax(size, high[a] - low[a]);
    for (int a = 0; a < 3; a++) {
        run->domain[a] = d->has_box ? d->min[a] : low[a] - 0.05 * size - 4 * r;
        run->domain[3 + a] = d->has_box ? d->max[a] : high[a] + 0.05 * size + 4 * r;
        run->period[a] = d->periodic[a] ? d->max[a] - d->min[a] : 0;
    }
}

static void set_step(struct sim *s)
{
    const struct scene_time *t = &s->scene->time;
    s->dt = s->from ? s->from->dt : t->step > 0 ? t->step : t->safety * particle_limit_dense(s);
    if (!(s->dt > 0) || isinf(s->dt))
        fail_stop_together(EXIT_SCENE, "%s: time.step: auto: %s; give a value", s->scene->path,
            limit_missing(s->scene, s->particle->first));
}

/* What the run has kept account of it goes on to; what it has not cannot begin now. */
static void keep_features(struct sim *s)
{
    bool orientation = h5_has(s->from->reader, "elements", "orientation"),
         energy = h5_has(s->from->reader, "pairs", "ledger");
    const char *missing = s->particle->features.energy && !energy ? "a measure of energy"
                          : s->particle->features.orientation && !orientation ? "orientation"
                                                                              : NULL;
    if (missing)
        fail_stop_together(EXIT_SCENE,
            "%s cannot be added to a restarted run: '%s' has no record of its earlier values",
            missing, s->from->path);
    s->particle->features.orientation = orientation;
    s->particle->features.energy = energy;
}

void particle_plan(struct sim *s)
{
    struct particle_run *run = s->particle;
    run->features = features_of(s->scene, run->walls, run->first);
    sum_inputs(s);
    if (s->from) keep_features(s);
    set_domain(s);
    set_step(s);
}

/* Of a run that begins; only rank 0 speaks. */
static void warn_of_overlaps(struct sim *s)
{
    if (s->from || s->comm->rank != 0) return;
    struct generate_overlaps all = s->particle->first->overlaps;
    if (all.share > GENERATE_DEEP)
        log_warn(s->log,
            "%lld pairs overlap at the start, elements %lld and %lld by %.3g m, %.3g of the "
            "smaller radius; unless something presses them together, they fly apart",
            (long long)all.n, (long long)all.element[0], (long long)all.element[1], all.depth,
            all.share);
    else if (all.n > 0)
        log_print(s->log, "%lld pairs overlap at the start, by up to %.3g of the smaller radius",
            (long long)all.n, all.share);
}

/* Of a step that its first contacts may allow, as `check` says it. */
static void warn_of_step(struct sim *s)
{
    double limit = particle_limit_dense(s);
    if (!(s->dt > limit)) return;
    log_warn(s->log,
        "the time step %.4g s exceeds %.4g s, the critical time step of the densest packing of "
        "these particles at the largest speed that this scene allows: the run %s",
        s->dt, limit,
        s->scene->time.allow_unstable ? "continues, as time.allow_unstable asks"
                                      : "stops when its contacts are as stiff as that");
}

void particle_warn(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct scene_errors warnings = {NULL, 0};
    limit_warnings(s->scene, run->walls, run->first, limit_speed(s->scene, run->walls, run->first),
        s->dt, &warnings);
    for (int i = 0; i < warnings.n; i++) log_warn(s->log, "%s", warnings.text[i]);
    scene_errors_free(&warnings);
    warn_of_step(s);
    warn_of_overlaps(s);
}
