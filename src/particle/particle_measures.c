/* The measures of the particle method: counts, energy, momentum, forces on walls, probes. */
#include "particle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "energy.h"
#include "comm/fail.h"
#include "kernels/particle/particle_words.h"
#include "run/energy_watch.h"
#include "run/measures.h"
#include "scene/measure_columns.h"

/* What several measures of a step look at. */
struct view {
    const struct particles_host *host; /* NULL where no due measure asks for it */
    struct energy_sums energy;         /* likewise */
};

static bool holds(const struct measure *m, const double x[3])
{
    for (int a = 0; a < 3; a++)
        if (x[a] >= m->below[a] || x[a] <= m->above[a]) return false;
    return true;
}

void particle_note_removed(struct sim *s, const double x[3])
{
    for (int i = 0; i < s->scene->n_measure; i++)
        if (s->scene->measure[i].kind == MEASURE_COUNT && holds(&s->scene->measure[i], x))
            s->particle->n_removed_in[i]++;
}

static void measure_count(struct sim *s, int i, const struct view *view, double *value)
{
    const struct particles_host *h = view->host;
    int64_t n[2] = {0, s->particle->n_removed_in[i]};
    for (int64_t k = 0; k < h->n; k++) n[0] += holds(&s->scene->measure[i], h->x + 3 * k);
    comm_sum_i64(s->comm, n, 2);
    value[0] = (double)(n[0] + n[1]);
    value[1] = (double)n[0];
    value[2] = (double)n[1];
}

/* What an element does to a wall: minus the force f that the wall has on it, or the moment of that
 * force about a point and minus the torque f[4..6] that the wall has on the element about its
 * centre x [m] (NULL: none). */
static void act_on_wall(
    const double *f, bool turns, const double x[3], const double about[3], double out[3])
{
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        if (!x) out[a] = -f[a];
        else
            out[a] =
                -((x[b] - about[b]) * f[c] - (x[c] - about[c]) * f[b]) - (turns ? f[4 + a] : 0);
    }
}

/* Sums over the contacts of a wall what they do to it, in units of 2^-60 N or N m times 2^20 so
 * that the order does not matter. host: the elements, for the torque; NULL: the force. Returns how
 * many contacts have a force. */
static int64_t sum_at_wall(
    struct sim *s, const struct measure *what, const struct particles_host *host, double total[3])
{
    struct particle_run *run = s->particle;
    const struct wall_contacts *w = run->wall_contacts;
    int64_t sum[8] = {0}; /* the last: how many are too large to add, or no numbers */
    size_t n = w ? (size_t)w->now.n : 0,
           width = WALL_RESULT_WIDTH(w && w->layout.result > WALL_RESULT_WIDTH(false));
    cl_int *candidate = fail_alloc(n * sizeof *candidate),
           *element = fail_alloc(n * sizeof *element);
    double *result =
        n > 0 ? reals_read(&w->result, run->features.real_is_float, 0, n * width) : NULL;
    if (n > 0) buffer_read(&w->now.candidate, 0, n * sizeof *candidate, candidate);
    if (n > 0) buffer_read(&w->now.element, 0, n * sizeof *element, element);
    for (size_t k = 0; k < n; k++) {
        const double *f = result + k * width;
        double part[3];
        if (w->walls->wall_of[candidate[k]] != what->wall) continue;
        act_on_wall(f, width > 4, host ? host->x + 3 * element[k] : NULL, what->about, part);
        for (int a = 0; a < 3; a++) {
            if (!(fabs(part[a]) < 0x1p40)) {
                sum[7]++;
                continue;
            }
            double high = floor(part[a] * 0x1p20);
            sum[2 * a] += (int64_t)high;
            sum[2 * a + 1] += (int64_t)((part[a] * 0x1p20 - high) * 0x1p40);
        }
        sum[6] += fabs(f[0]) > 0 || fabs(f[1]) > 0 || fabs(f[2]) > 0;
    }
    comm_sum_i64(s->comm, sum, 8);
    for (int a = 0; a < 3; a++)
        total[a] =
            sum[7] ? (double)NAN : (double)sum[2 * a] * 0x1p-20 + (double)sum[2 * a + 1] * 0x1p-60;
    free(candidate);
    free(element);
    free(result);
    return sum[6];
}

static void measure_wall(struct sim *s, int i, const struct view *view, double *value)
{
    (void)view;
    value[3] = (double)sum_at_wall(s, &s->scene->measure[i], NULL, value);
}

static void measure_wall_torque(struct sim *s, int i, const struct view *view, double *value)
{
    sum_at_wall(s, &s->scene->measure[i], view->host, value);
}

/* The element's owner gives the bits, the others zeros; NaN once it has left the run. */
static void measure_probe(struct sim *s, int i, const struct view *view, double *value)
{
    const struct particles_host *h = view->host;
    int64_t gid = s->scene->measure[i].element;
    int64_t bits[10] = {0};
    for (int64_t k = 0; k < h->n; k++) {
        if (h->gid[k] != gid) continue;
        memcpy(bits, h->x + 3 * k, 3 * sizeof(double));
        memcpy(bits + 3, h->v + 3 * k, 3 * sizeof(double));
        memcpy(bits + 6, h->w + 3 * k, 3 * sizeof(double));
        bits[9] = 1;
    }
    comm_sum_i64(s->comm, bits, 10);
    memcpy(value, bits, 9 * sizeof(double));
    for (int k = 0; k < 9 && !bits[9]; k++) value[k] = NAN;
}

static void check_energy(struct sim *s, const struct energy_sums *e)
{
    const struct energy_sums *start = &s->particle->energy_start;
    energy_watch(
        s, energy_balance(start, e), energy_supplied(start, e), ENERGY_WATCH_SPARE(e->gravity));
}

static void measure_energy(struct sim *s, int i, const struct view *view, double *value)
{
    (void)i;
    check_energy(s, &view->energy);
    energy_terms_columns(energy_table, &s->particle->energy_start, &view->energy, value);
}

static void measure_momentum(struct sim *s, int i, const struct view *view, double *value)
{
    (void)s;
    (void)i;
    memcpy(value, view->energy.momentum, sizeof view->energy.momentum);
    memcpy(value + 3, view->energy.angular, sizeof view->energy.angular);
}

/* The measures of the method, a row each; those of the other method alone are empty. */
static const struct measure_row {
    const struct scene_item *column;
    bool by_element, by_energy; /* what it needs of struct view */
    void (*measure)(struct sim *s, int i, const struct view *view, double *value);
} measure_row[] = {
    [MEASURE_COUNT] = {measure_columns_count, true, false, measure_count},
    [MEASURE_ENERGY] = {measure_columns_energy_particles, false, true, measure_energy},
    [MEASURE_MOMENTUM] = {measure_columns_momentum, false, true, measure_momentum},
    [MEASURE_WALL_FORCE] = {measure_columns_wall_force, false, false, measure_wall},
    [MEASURE_WALL_TORQUE] = {measure_columns_wall_torque, true, false, measure_wall_torque},
    [MEASURE_PROBE] = {measure_columns_probe_particles, true, false, measure_probe},
};

int particle_measure_columns(const struct sim *s, const struct measure *measure,
    struct series_column column[STEP_MEASURE_COLUMNS])
{
    (void)s;
    return measures_columns(column, 0, measure_row[measure->kind].column);
}

void particle_measure(struct sim *s, const bool *due, double (*value)[STEP_MEASURE_COLUMNS])
{
    struct particle_run *run = s->particle;
    struct particles_host *host = NULL;
    struct view view = {NULL};
    bool by_element = false, by_energy = false;
    for (int i = 0; i < s->scene->n_measure; i++) {
        by_element |= due[i] && measure_row[s->scene->measure[i].kind].by_element;
        by_energy |= due[i] && measure_row[s->scene->measure[i].kind].by_energy;
    }
    if (by_energy) energy_now(s, &view.energy);
    if (by_element) host = particles_download(run->particles, &run->features, s->scene, run->first);
    view.host = host;
    for (int i = 0; i < s->scene->n_measure; i++)
        if (due[i]) measure_row[s->scene->measure[i].kind].measure(s, i, &view, value[i]);
    particles_host_free(host);
}
