/* What the particle method measures. */
#include "particle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "energy.h"
#include "comm/fail.h"
#include "run/output.h"

int particle_measure_columns(enum measure_kind kind, const struct series_column **column)
{
    static const struct series_column count[] = {
        {"count", "1"}, {"present", "1"}, {"removed", "1"}};
    static const struct series_column energy[] = {{"kinetic", "J"}, {"rotational", "J"},
        {"gravity", "J"}, {"elastic", "J"}, {"dashpot_normal", "J"}, {"dashpot_tangential", "J"},
        {"sliding", "J"}, {"rolling", "J"}, {"bonds", "J"}, {"wall_work", "J"}, {"removed", "J"},
        {"balance", "J"}};
    static const struct series_column momentum[] = {{"p_x", "N s"}, {"p_y", "N s"}, {"p_z", "N s"},
        {"l_x", "N m s"}, {"l_y", "N m s"}, {"l_z", "N m s"}};
    static const struct series_column wall[] = {
        {"force_x", "N"}, {"force_y", "N"}, {"force_z", "N"}, {"contacts", "1"}};
    static const struct series_column probe[] = {{"x", "m"}, {"y", "m"}, {"z", "m"}, {"v_x", "m/s"},
        {"v_y", "m/s"}, {"v_z", "m/s"}, {"w_x", "rad/s"}, {"w_y", "rad/s"}, {"w_z", "rad/s"}};
    switch (kind) {
    case MEASURE_COUNT: *column = count; return 3;
    case MEASURE_ENERGY: *column = energy; return 12;
    case MEASURE_MOMENTUM: *column = momentum; return 6;
    case MEASURE_WALL_FORCE: *column = wall; return 4;
    case MEASURE_PROBE:
    case MEASURE_STRESS_MAX:
    case MEASURE_BROKEN: break; /* of method lattice */
    }
    *column = probe;
    return 9;
}

static bool holds(const struct measure *m, const double x[3])
{
    for (int a = 0; a < 3; a++)
        if (x[a] >= m->below[a] || x[a] <= m->above[a]) return false;
    return true;
}

void particle_left(struct sim *s, const double x[3])
{
    for (int i = 0; i < s->scene->n_measure; i++)
        if (s->scene->measure[i].kind == MEASURE_COUNT && holds(&s->scene->measure[i], x))
            s->particle->left[i]++;
}

static void measure_count(struct sim *s, int i, const struct particles_host *h, double *value)
{
    int64_t n[2] = {0, s->particle->left[i]};
    for (int64_t k = 0; k < h->n; k++) n[0] += holds(&s->scene->measure[i], h->x + 3 * k);
    comm_sum_i64(s->comm, n, 2);
    value[0] = (double)(n[0] + n[1]);
    value[1] = (double)n[0];
    value[2] = (double)n[1];
}

/* Force of the elements on a wall: minus the sum of the result records, in units of 2^-60 N times
 * 2^20 so that the order does not matter. */
static void measure_wall(struct sim *s, int wall, double *value)
{
    struct particle_run *run = s->particle;
    const struct wall_contacts *w = run->wall_contacts;
    int64_t sum[7] = {0};
    /* WALL_RESULT_WIDTH of wall_force.cl, whatever that of pairs */
    size_t n = w ? (size_t)w->now.n : 0, width = w && w->layout.result > 4 ? 8 : 4;
    cl_int *candidate = fail_alloc(n * sizeof *candidate);
    double *result =
        n > 0 ? particles_read(s->dev, &w->result, run->features.real_is_float, 0, n * width)
              : NULL;
    if (n > 0) buffer_read(s->dev, &w->now.candidate, 0, n * sizeof *candidate, candidate);
    for (size_t k = 0; k < n; k++) {
        const double *f = result + k * width;
        if (w->walls->wall_of[candidate[k]] != wall) continue;
        for (int a = 0; a < 3; a++) {
            double high = floor(-f[a] * 0x1p20);
            sum[2 * a] += (int64_t)high;
            sum[2 * a + 1] += (int64_t)((-f[a] * 0x1p20 - high) * 0x1p40);
        }
        sum[6] += fabs(f[0]) > 0 || fabs(f[1]) > 0 || fabs(f[2]) > 0;
    }
    comm_sum_i64(s->comm, sum, 7);
    for (int a = 0; a < 3; a++)
        value[a] = (double)sum[2 * a] * 0x1p-20 + (double)sum[2 * a + 1] * 0x1p-60;
    value[3] = (double)sum[6];
    free(candidate);
    free(result);
}

/* The element's owner gives the bits, the others zeros; NaN once it has left the run. */
static void measure_probe(struct sim *s, int64_t gid, const struct particles_host *h, double *value)
{
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

static void measure_energy(
    struct sim *s, enum measure_kind kind, const struct energy_sums *e, double *value)
{
    if (kind == MEASURE_MOMENTUM) {
        memcpy(value, e->momentum, sizeof e->momentum);
        memcpy(value + 3, e->angular, sizeof e->angular);
        return;
    }
    const double all[] = {e->kinetic, e->rotational, e->gravity, e->elastic, e->dashpot_n,
        e->dashpot_t, e->sliding, e->rolling, e->bonds, e->wall_work, e->removed,
        energy_balance(&s->particle->energy_start, e)};
    memcpy(value, all, sizeof all);
}

/* Energy from nowhere: the budget is off by more than ten times of what was there at the start and
 * has come in since. (Coarse steps, still stable, may be off by about once while a contact lasts.)
 * The same on every rank. */
static void check_energy(struct sim *s, const struct energy_sums *e)
{
    const struct energy_sums *start = &s->particle->energy_start;
    double wrong = fabs(energy_balance(start, e)),
           in = start->kinetic + start->rotational + start->elastic + fabs(e->wall_work) +
                fabs(e->removed) + fabs(e->gravity - start->gravity);
    if (isnan(wrong))
        output_stop_numerics(
            s, "the energy is not a number, or too large to measure; use a smaller time.step");
    if (wrong > 10 * in + 1e-9 * fabs(e->gravity) && !s->scene->time.allow_unstable)
        output_stop_numerics(s,
            "the energy runs away: its balance error is %.3g J, although only %.3g J were "
            "supplied; use a smaller time.step",
            wrong, in);
}

void particle_measure(struct sim *s, const bool *due, double (*value)[STEP_MEASURE_COLUMNS])
{
    struct particle_run *run = s->particle;
    struct particles_host *h = NULL;
    struct energy_sums energy;
    bool have_energy = false;
    for (int i = 0; i < s->scene->n_measure; i++) {
        const struct measure *what = &s->scene->measure[i];
        if (!due[i]) continue;
        bool by_element = what->kind == MEASURE_COUNT || what->kind == MEASURE_PROBE;
        if (by_element && !h)
            h = particles_download(s->dev, run->particles, &run->features, s->scene, run->first);
        if ((what->kind == MEASURE_ENERGY || what->kind == MEASURE_MOMENTUM) && !have_energy) {
            energy_now(s, &energy);
            have_energy = true;
            if (what->kind == MEASURE_ENERGY) check_energy(s, &energy);
        }
        switch (what->kind) {
        case MEASURE_COUNT: measure_count(s, i, h, value[i]); break;
        case MEASURE_WALL_FORCE: measure_wall(s, what->wall, value[i]); break;
        case MEASURE_PROBE: measure_probe(s, what->element, h, value[i]); break;
        case MEASURE_ENERGY:
        case MEASURE_MOMENTUM: measure_energy(s, what->kind, &energy, value[i]); break;
        case MEASURE_STRESS_MAX:
        case MEASURE_BROKEN: break; /* of method lattice */
        }
    }
    particles_host_free(h);
}
