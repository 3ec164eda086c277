#include "record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "digest.h"
#include "energy.h"
#include "fail.h"
#include "report.h"
#include "version.h"

/* Digest of the state as it lies on the device, in its own bits. Returns false if there are NaNs. */
static bool take_digest(struct sim *s, char text[17])
{
    const struct particles *p = s->particles;
    const struct features *f = &s->features;
    size_t n = (size_t)p->n_owned, bytes = p->field[FIELD_STATE].bytes, real = particles_real(f), preal = particles_preal(f);
    int stride = (int)(bytes / real);
    char *state = fail_alloc(n * bytes), *q = fail_alloc(n * 4 * real), *none = fail_alloc(n * 4 * real);
    int64_t *gid = fail_alloc(n * sizeof *gid);
    uint64_t digest;
    buffer_read(s->dev, &p->field[FIELD_STATE].now, 0, n * bytes, state);
    buffer_read(s->dev, &p->field[FIELD_GID].now, 0, n * sizeof *gid, gid);
    if (f->orientation) buffer_read(s->dev, &p->field[FIELD_ORIENTATION].now, 0, n * 4 * real, q);
    for (size_t i = 0; i < n && !f->orientation; i++) {
        if (f->real_is_float) ((float *)(void *)q)[4 * i] = 1;
        else ((double *)(void *)q)[4 * i] = 1;
    }
    const char *motion = state + 4 * preal;
    struct digest_part part[4] = {{state, f->position_is_float, 3, (int)(bytes / preal)}, {motion, f->real_is_float, 3, stride},
        {q, f->real_is_float, 4, 4}, {f->spin ? motion + 4 * real : none, f->real_is_float, 3, f->spin ? stride : 4}};
    int64_t n_nan = digest_of_all(s->comm, gid, p->n_owned, part, 4, &digest);
    digest_text(digest, text);
    void *own[] = {state, q, none, gid};
    for (int i = 0; i < 4; i++) free(own[i]);
    return n_nan == 0;
}

static void add_devices(struct report *r, const struct sim *s)
{
    struct {
        char name[DEVICE_TEXT], driver[DEVICE_TEXT], platform[DEVICE_TEXT];
    } mine, *all;
    all = fail_alloc((size_t)s->comm->n_rank * sizeof *all);
    memset(&mine, 0, sizeof mine);
    memcpy(mine.name, s->dev->name, DEVICE_TEXT);
    memcpy(mine.driver, s->dev->driver, DEVICE_TEXT);
    memcpy(mine.platform, s->dev->platform_version, DEVICE_TEXT);
    comm_gather(s->comm, &mine, all, sizeof mine);
    report_begin_list(r, "devices");
    for (int k = 0; k < s->comm->n_rank; k++) {
        report_begin(r, NULL);
        report_text(r, "name", all[k].name);
        report_text(r, "driver", all[k].driver);
        report_text(r, "platform_version", all[k].platform);
        report_end(r);
    }
    report_end(r);
    free(all);
}

static void add_energy(struct report *r, struct sim *s, bool observed)
{
    struct energy_sums now = s->energy_start;
    if (observed) energy_now(s, &now);
    const struct energy_sums *both[] = {&s->energy_start, &now};
    static const char *const name[] = {"start", "end"};
    report_begin(r, "energy");
    for (int k = 0; k < 2; k++) {
        const struct energy_sums *e = both[k];
        report_begin(r, name[k]);
        report_number(r, "kinetic", e->kinetic);
        report_number(r, "rotational", e->rotational);
        report_number(r, "gravity", e->gravity);
        if (s->features.energy) {
            report_number(r, "elastic", e->elastic);
            report_number(r, "dashpot_normal", e->dashpot_n);
            report_number(r, "dashpot_tangential", e->dashpot_t);
            report_number(r, "sliding", e->sliding);
            report_number(r, "rolling", e->rolling);
            report_number(r, "bonds", e->bonds);
            report_number(r, "wall_work", e->wall_work);
            report_number(r, "removed", e->removed);
        }
        report_end(r);
    }
    report_number(r, "balance_error", s->features.energy && observed ? energy_balance(&s->energy_start, &now) : (double)NAN);
    report_end(r);
    report_numbers(r, "momentum", now.momentum, 3);
}

static void add_scale(struct report *r, struct sim *s)
{
    double loop = s->timers.total[TIMER_LOOP];
    int64_t sum[2] = {s->pairs->now.n_own, s->dev->counters.peak_bytes};
    comm_sum_i64(s->comm, sum, 2);
    report_integer(r, "elements", s->first->n);
    report_integer(r, "elements_left", s->n_removed);
    report_integer(r, "interactions", sum[0]);
    report_integer(r, "steps", s->step);
    report_number(r, "dt", s->dt);
    report_number(r, "dt_limit", s->dt_limit);
    report_number(r, "time_end", (double)s->step * s->dt);
    report_begin(r, "wall_s");
    report_number(r, "setup", s->timers.total[TIMER_SETUP]);
    report_number(r, "loop", loop);
    report_number(r, "output", s->timers.total[TIMER_OUTPUT]);
    report_end(r);
    report_number(r, "element_steps_per_s", loop > 0 ? s->element_steps / loop : 0);
    report_timers(r, "timers", s->comm, &s->timers);
    report_integer(r, "rebuilds", s->n_rebuild);
    report_integer(r, "repartitions", s->n_repartition);
    report_integer(r, "migrations", s->n_moved);
    report_begin(r, "imbalance");
    report_number(r, "mean", s->n_imbalance ? s->imbalance_sum / (double)s->n_imbalance : 0);
    report_number(r, "max", s->imbalance_max);
    report_end(r);
    report_number(r, "halo_bytes_per_step", s->step > 0 ? (double)s->halo_bytes / (double)s->step : 0);
    report_number(r, "device_bytes_per_element", (double)sum[1] / (double)(s->first->n > 0 ? s->first->n : 1));
}

/* Copies and allocations in plain steps (sim.h), sums over ranks: what shows that the state stays on the device. */
static void add_plain_steps(struct report *r, const struct sim *s)
{
    const struct device_counters *c = &s->plain;
    static const char *const name[] = {"allocations", "to_device", "to_device_bytes", "from_device", "from_device_bytes", "launches"};
    int64_t sum[6] = {c->n_alloc, c->n_h2d, c->h2d_bytes, c->n_d2h, c->d2h_bytes, c->n_launch};
    comm_sum_i64(s->comm, sum, 6);
    report_begin(r, "plain_steps");
    report_integer(r, "steps", s->n_plain);
    for (int i = 0; i < 6; i++) report_integer(r, name[i], sum[i]);
    report_end(r);
}

/* Device time and number of launches of the step's kernels on rank 0. */
static void add_kernels(struct report *r, const struct sim *s)
{
    struct launch *all[] = {s->pair_force, s->wall_force, s->wall_contacts ? s->wall_contacts->keep_launch : NULL, s->gather, s->kick_drift,
        s->ghosts->gather, s->pairs->rows, s->pairs->carry, s->wall_contacts ? s->wall_contacts->rows : NULL};
    report_begin(r, "kernels");
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) {
        if (!all[i]) continue;
        report_begin(r, all[i] == s->ghosts->gather ? "pack_ghosts" : all[i]->name);
        report_number(r, "seconds", launch_seconds(all[i]));
        report_integer(r, "launches", all[i]->n_run);
        report_end(r);
    }
    report_end(r);
}

bool record_write(struct sim *s, int exit_code, bool observed)
{
    char digest[17] = "";
    static const char *const precision[] = {"double", "double", "mixed", "single"};
    struct report *r = report_create();
    bool whole = observed && take_digest(s, digest);
    if (observed && !whole) exit_code = EXIT_NUMERICS;
    s->halo_bytes = ghosts_bytes_sent(s->ghosts);
    comm_sum_i64(s->comm, &s->halo_bytes, 1);
    report_text(r, "version", DEMOCLES_VERSION);
    report_text(r, "git", DEMOCLES_GIT);
    char *hash = fail_format("%016lx", s->scene->hash);
    report_text(r, "scene_hash", hash);
    report_text(r, "title", s->scene->title);
    report_text(r, "method", s->ops->name);
    report_text(r, "precision", precision[s->scene->precision]);
    report_text(r, "scheme", "leapfrog");
    report_integer(r, "ranks", s->comm->n_rank);
    add_devices(r, s);
    report_text(r, "partition", "geometric");
    report_begin(r, "features");
    for (int i = 0; features_name(i); i++) report_integer(r, features_name(i), features_value(&s->features, i));
    report_end(r);
    add_scale(r, s);
    add_plain_steps(r, s);
    if (s->options->profile) add_kernels(r, s);
    add_energy(r, s, observed);
    report_integer(r, "exit", exit_code);
    report_text(r, "digest", whole ? digest : NULL);
    bool written = report_write(r, s->comm, s->options->dir);
    if (observed) {
        double loop = s->timers.total[TIMER_LOOP];
        log_print(s->log, "%lld steps of %lld elements in %.2f s: %.3g million element steps per second", (long long)s->step, (long long)s->first->n,
            loop, loop > 0 ? s->element_steps / loop * 1e-6 : 0);
        log_print(s->log, "digest %s", whole ? digest : "none: the state holds NaN");
    }
    report_free(r);
    free(hash);
    if (!written && exit_code == EXIT_DONE) fail_stop(EXIT_IO, "run.json could not be written");
    return whole || !observed;
}
