/* The particle method before there is a device: walls and elements from the scene, their extent, the time step. */
#include "particle.h"

#include <math.h>
#include <stdlib.h>

#include "fail.h"
#include "scene_report.h"

void particle_read(struct sim *s)
{
    struct scene_errors errors = {NULL, 0};
    s->walls = walls_create(s->scene, &errors);
    s->first = generate_elements(s->scene, &errors);
    if (s->walls && s->first) generate_check_walls(s->scene, s->walls, s->first, &errors);
    scene_report_errors(s->comm, &errors);
    if (s->first->n > INT32_MAX / 2) fail_stop_together(EXIT_SCENE, "more than %d elements", INT32_MAX / 2);
}

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

static void set_step(struct sim *s)
{
    const struct scene_time *t = &s->scene->time;
    double limit = particle_limit_dense(s);
    s->dt = t->step > 0 ? t->step : t->safety * limit;
    if (!(s->dt > 0) || isinf(s->dt))
        fail_stop_together(EXIT_SCENE, "%s: time.step: auto finds no limit in this scene; give a value", s->scene->path);
}

void particle_plan(struct sim *s)
{
    s->features = features_of(s->scene, s->walls, s->first);
    set_domain(s);
    set_step(s);
}

void particle_warn(struct sim *s)
{
    struct scene_errors warnings = {NULL, 0};
    limit_warnings(s->scene, s->first, limit_speed(s->scene, s->walls, s->first), s->dt, &warnings);
    for (int i = 0; i < warnings.n; i++) log_warn(s->log, "%s", warnings.text[i]);
    scene_errors_free(&warnings);
}
