#include "record.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "results/digest.h"
#include "comm/fail.h"
#include "device/launch.h"
#include "laws/lattice_schemes.h"
#include "results/report.h"
#include "resume.h"
#include "scene/scene_keys.h"
#include "version.h"

struct device_texts {
    char name[DEVICE_TEXT], driver[DEVICE_TEXT], platform[DEVICE_TEXT];
};

/* The devices of all ranks [n_rank], owned by the caller. Collective. */
static struct device_texts *devices_of(const struct sim *s)
{
    struct device_texts mine, *all = fail_alloc((size_t)s->comm->n_rank * sizeof *all);
    memset(&mine, 0, sizeof mine);
    memcpy(mine.name, s->dev->name, DEVICE_TEXT);
    memcpy(mine.driver, s->dev->driver, DEVICE_TEXT);
    memcpy(mine.platform, s->dev->platform_version, DEVICE_TEXT);
    comm_gather(s->comm, &mine, all, sizeof mine);
    return all;
}

void record_print_devices(const struct sim *s)
{
    int n = s->comm->n_rank;
    struct device_texts *all = devices_of(s);
    for (int k = 0; k < n; k++) {
        int n_before = 0, n_same = 0;
        for (int j = 0; j < n; j++) {
            bool same =
                !strcmp(all[j].name, all[k].name) && !strcmp(all[j].platform, all[k].platform);
            n_before += same && j < k;
            n_same += same;
        }
        if (n_before > 0) continue;
        log_print(s->log, "%d rank%s on %s (%s)", n_same, n_same > 1 ? "s" : "", all[k].name,
            all[k].platform);
    }
    free(all);
}

static void add_devices(struct report *r, const struct sim *s)
{
    struct device_texts *all = devices_of(s);
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

/* Of particles: leapfrog. */
static const struct lattice_table *scheme_of(const struct sim *s)
{
    return lattice_schemes_table((enum lattice_scheme)s->scene->time.scheme);
}

static void add_scale(struct report *r, struct sim *s)
{
    double loop = s->timers.total[TIMER_LOOP];
    struct step_counts mine;
    s->ops->count(s, &mine);
    mine.sent.bytes -= s->sent_before.bytes;
    mine.sent.messages -= s->sent_before.messages;
    int64_t sum[3] = {mine.n_interaction, mine.sent.bytes, s->dev->counters.peak_bytes};
    comm_sum_i64(s->comm, sum, 3);
    report_integer(r, "elements", s->n_first);
    report_integer(r, "elements_removed", s->n_removed);
    report_integer(r, "elements_left", s->n_removed); /* the name of 0.1, until 0.3 */
    report_integer(r, "interactions", sum[0]);
    report_integer(r, "steps", s->step);
    report_integer(r, "force_evaluations", s->step * scheme_of(s)->n); /* of all elements */
    report_number(r, "dt", s->dt);
    report_number(r, "dt_limit", s->dt_limit);
    report_number(r, "time_end", (double)s->step * s->dt);
    report_begin(r, "wall_s");
    report_number(r, "setup", s->timers.total[TIMER_SETUP]);
    report_number(r, "loop", loop);
    report_number(r, "output", s->timers.total[TIMER_OUTPUT]);
    report_end(r);
    report_number(r, "element_steps_per_s", loop > 0 ? s->account.element_steps / loop : 0);
    report_timers(r, "timers", s->comm, &s->timers);
    report_integer(r, "rebuilds", s->n_rebuild);
    const struct partition_quality *q = &s->balance->quality;
    report_integer(r, "repartitions", s->balance->n_deal);
    report_integer(r, "migrations", s->balance->n_moved);
    report_begin(r, "imbalance");
    report_number(r, "mean", q->n > 0 ? q->imbalance_sum / (double)q->n : 0);
    report_number(r, "max", q->imbalance_max);
    report_end(r);
    double n = s->step > s->begun_at ? (double)(s->step - s->begun_at) : 1;
    report_number(r, "halo_bytes_per_step", (double)sum[1] / n);
    report_begin(r, "exchange"); /* of each rank; bytes and messages that it sends per step */
    report_spread(r, "bytes", s->comm, (double)mine.sent.bytes / n);
    report_spread(r, "messages", s->comm, (double)mine.sent.messages / n);
    report_spread(r, "neighbours", s->comm, mine.n_neighbour);
    report_spread(r, "elements", s->comm, (double)mine.n_boundary);
    report_end(r);
    report_number(
        r, "device_bytes_per_element", (double)sum[2] / (double)(s->n_first > 0 ? s->n_first : 1));
}

/* Copies and allocations in plain steps (account.h), sums over ranks: what shows that the state
 * stays on the device. */
static void add_plain_steps(struct report *r, const struct sim *s)
{
    const struct device_counters *c = &s->account.plain;
    static const char *const name[] = {"allocations", "to_device", "to_device_bytes", "from_device",
        "from_device_bytes", "launches"};
    int64_t sum[6] = {c->n_alloc, c->n_h2d, c->h2d_bytes, c->n_d2h, c->d2h_bytes, c->n_launch};
    comm_sum_i64(s->comm, sum, 6);
    report_begin(r, "plain_steps");
    report_integer(r, "steps", s->account.n_plain);
    for (int i = 0; i < 6; i++) report_integer(r, name[i], sum[i]);
    report_end(r);
}

/* Times, bytes and plain steps are of this process; steps, energies and counters of the run as a
 * whole. */
static void add_resumed(struct report *r, const struct sim *s)
{
    const char *slash = strrchr(s->from->path, '/');
    report_begin(r, "resumed");
    report_text(r, "frame", slash + 1);
    report_integer(r, "step", s->begun_at);
    report_number(r, "time", (double)s->begun_at * s->dt);
    report_end(r);
}

static void add_rest(struct report *r, const struct sim *s)
{
    report_begin(r, "rest");
    report_flag(r, "reached", s->rest.reached);
    report_number(r, "left", s->rest.left);
    report_number(r, "damping", s->rest.damping);
    report_end(r);
}

/* Device time and number of launches of the kernels of a step, on rank 0. */
static void add_kernels(struct report *r, const struct sim *s)
{
    struct step_launch all[STEP_LAUNCHES];
    int n = s->ops->launches(s, all);
    report_begin(r, "kernels");
    for (int i = 0; i < n; i++) {
        if (!all[i].launch) continue;
        report_begin(r, all[i].name);
        report_number(r, "seconds", launch_seconds(all[i].launch));
        report_integer(r, "launches", all[i].launch->n_run);
        report_end(r);
    }
    report_end(r);
}

/* The same two times and the same rate as in wall_s and element_steps_per_s. */
static void print_rate(const struct sim *s)
{
    char loop[LOG_DURATION_SIZE], output[LOG_DURATION_SIZE];
    const double *total = s->timers.total;
    char *rate =
        log_rate(s->log, total[TIMER_LOOP] > 0 ? s->account.element_steps / total[TIMER_LOOP] : 0);
    log_print(s->log, "%lld steps in %s, and %s for output: %s", (long long)(s->step - s->begun_at),
        log_duration(total[TIMER_LOOP], loop), log_duration(total[TIMER_OUTPUT], output), rate);
    free(rate);
}

static void print_digest(struct sim *s, const char *digest)
{
    if (!digest) log_print(s->log, "no digest: the state holds NaN");
    else if (s->ops->n_element(s) == 0)
        log_print(s->log, "no element is left, so there is no state to digest");
    else log_print(s->log, "digest %s", digest);
}

void record_features(struct report *report, const struct feature_row *row, const void *features)
{
    for (; feature_table_more(row); row++)
        if (row->name) report_integer(report, row->name, feature_table_value(row, features));
}

/* Which run of what this is. */
static void add_head(struct report *r, const struct sim *s)
{
    char *precision = scene_key_word("precision", (int)s->scene->precision),
         *hash = fail_format("%016lx", s->scene->hash);
    report_text(r, "version", DEMOCLES_VERSION);
    report_text(r, "git", DEMOCLES_GIT);
    report_text(r, "scene_hash", hash);
    report_text(r, "title", s->scene->title);
    report_text(r, "method", s->ops->name);
    report_text(r, "precision", precision);
    report_text(r, "scheme", scheme_of(s)->name);
    report_integer(r, "ranks", s->comm->n_rank);
    free(precision);
    free(hash);
}

void record_error(void *sim, int exit_code, const char *text)
{
    struct sim *s = sim;
    if (s->is_recorded) return;
    struct report *r = report_create();
    add_head(r, s);
    report_integer(r, "steps", s->step);
    report_number(r, "time_end", (double)s->step * s->dt);
    report_text(r, "error", text);
    report_integer(r, "exit", exit_code);
    report_text(r, "digest", NULL);
    report_save(r, s->options->dir);
    report_free(r);
}

bool record_write(struct sim *s, int exit_code, bool observed)
{
    char digest[17] = "";
    struct report *r = report_create();
    uint64_t bits = 0;
    bool whole = observed && s->ops->digest(s, &bits);
    digest_text(bits, digest);
    if (observed && !whole) exit_code = EXIT_NUMERICS;
    add_head(r, s);
    add_devices(r, s);
    balance_report(s->balance, r, &s->timers, s->step - s->begun_at, s->ops->n_owned(s));
    report_begin(r, "features");
    s->ops->report_features(s, r);
    report_end(r);
    if (s->from) add_resumed(r, s);
    add_scale(r, s);
    add_plain_steps(r, s);
    if (s->options->profile) { add_kernels(r, s); }
    if (s->rest.next > 0) add_rest(r, s);
    s->ops->report_state(s, r, observed);
    report_integer(r, "exit", exit_code);
    report_text(r, "digest", whole ? digest : NULL);
    bool written = report_write(r, s->comm, s->options->dir);
    if (observed) {
        print_rate(s);
        balance_print(s->balance, s->log);
        print_digest(s, whole ? digest : NULL);
    }
    report_free(r);
    s->is_recorded = true;
    if (!written && exit_code == EXIT_DONE) fail_stop(EXIT_IO, "run.json could not be written");
    return whole || !observed;
}
