/* The measures of the lattice method: probes, energy, momentum, largest stress, broken links. */
#include "lattice_method.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "comm/fail.h"
#include "run/energy_watch.h"
#include "run/measures.h"
#include "scene/measure_columns.h"

/* What several measures of a step look at. */
struct view {
    struct lattice_state *state;  /* NULL where no due measure asks for it */
    struct lattice_energy energy; /* likewise */
};

/* The cell whose centre at the start is nearest, the first of several; the same on every rank. */
static int64_t nearest(const struct lattice_cells *cells, const double at[3])
{
    int64_t best = 0;
    double least = HUGE_VAL, x[3];
    for (int64_t i = 0; i < cells->n; i++) {
        lattice_cells_centre(cells, i, x);
        double d = (x[0] - at[0]) * (x[0] - at[0]) + (x[1] - at[1]) * (x[1] - at[1]) +
                   (x[2] - at[2]) * (x[2] - at[2]);
        if (d < least) {
            least = d;
            best = i;
        }
    }
    return best;
}

/* What the fields of a probe add to the columns that all probes have. */
static const struct probe_part {
    const char *field;
    bool in_finite, in_small; /* kinds of rotation under which it is that */
    const struct scene_item *column;
    size_t at; /* offset of the array in struct lattice_state, NULL where it is not asked for */
    int stride;
} probe_part[] = {
    {"rotation", true, false, measure_columns_rotation, offsetof(struct lattice_state, turn), 4},
    {"rotation", false, true, measure_columns_small_rotation, offsetof(struct lattice_state, turn),
        4},
    {"stress", true, true, measure_columns_stress, offsetof(struct lattice_state, stress), 9},
    {"von_mises", true, true, measure_columns_von_mises, offsetof(struct lattice_state, von_mises),
        1},
};
enum { N_PROBE_PART = sizeof probe_part / sizeof *probe_part, PROBE_COLUMNS = 12 };

/* The parts of a probe in the order of its fields; returns how many. */
static int probe_parts(
    const struct sim *s, const struct measure *measure, const struct probe_part *part[N_PROBE_PART])
{
    bool is_finite = s->scene->lattice.rotation == ROTATION_FINITE;
    int n = 0;
    for (int i = 0; i < measure->n_field; i++)
        for (int k = 0; k < N_PROBE_PART; k++)
            if (!strcmp(probe_part[k].field, measure->field[i]) &&
                (is_finite ? probe_part[k].in_finite : probe_part[k].in_small))
                part[n++] = &probe_part[k];
    return n;
}

/* Cell i's numbers of the parts, as bits. */
static void probe_more(const struct sim *s, const struct measure *measure,
    const struct lattice_state *t, int64_t i, int64_t *bits)
{
    const struct probe_part *part[N_PROBE_PART];
    int n_part = probe_parts(s, measure, part), n = 0;
    for (int k = 0; k < n_part; k++) {
        const double *all;
        memcpy(&all, (const char *)t + part[k]->at, sizeof all);
        for (int c = 0; part[k]->column[c].name; c++)
            memcpy(&bits[n++], &all[i * part[k]->stride + c], sizeof *all);
    }
}

/* The cell's owner gives the bits, the others zeros. */
static void measure_probe(struct sim *s, int m, const struct view *view, double *value)
{
    const struct lattice_state *t = view->state;
    int64_t gid = nearest(s->lattice->cells, s->scene->measure[m].at),
            bits[STEP_MEASURE_COLUMNS] = {0};
    for (int64_t i = 0; i < t->n; i++) {
        if (t->gid[i] != gid) continue;
        double x[3];
        for (int a = 0; a < 3; a++) x[a] = t->centre[i][a] + t->u[i][a];
        memcpy(bits, x, sizeof x);
        memcpy(bits + 3, t->u[i], sizeof x);
        memcpy(bits + 6, t->v[i], sizeof x);
        memcpy(bits + 9, t->w[i], sizeof x);
        probe_more(s, &s->scene->measure[m], t, i, bits + PROBE_COLUMNS);
    }
    comm_sum_i64(s->comm, bits, STEP_MEASURE_COLUMNS);
    memcpy(value, bits, sizeof bits);
}

/* The largest von Mises stress, and the centre at the start of the cell that has it, the first of
 * several. */
static void measure_peak(struct sim *s, int m, const struct view *view, double *value)
{
    const struct lattice_state *t = view->state;
    (void)m;
    double largest = -1;
    int64_t gid = INT64_MAX;
    for (int64_t i = 0; i < t->n; i++) largest = fmax(largest, t->von_mises[i]);
    comm_max_f64(s->comm, &largest, 1);
    for (int64_t i = t->n; i-- > 0;)
        if (t->von_mises[i] >= largest) gid = t->gid[i];
    comm_min_i64(s->comm, &gid, 1);
    value[0] = gid == INT64_MAX ? (double)NAN : largest;
    if (gid < INT64_MAX) lattice_cells_centre(s->lattice->cells, gid, value + 1);
}

static void measure_broken(struct sim *s, int m, const struct view *view, double *value)
{
    (void)m;
    (void)view;
    int64_t count[LATTICE_BREAK_MODES] = {0};
    if (s->lattice->lattice->breakage) lattice_break_count(s->lattice->lattice->breakage, count);
    for (int mode = 0; mode < LATTICE_BREAK_MODES; mode++) value[mode] = (double)count[mode];
}

static void check_energy(struct sim *s, const struct lattice_energy *now)
{
    const struct lattice_energy *start = &s->lattice->energy_start;
    energy_watch(s, lattice_energy_balance(start, now), lattice_energy_supplied(start, now),
        ENERGY_WATCH_SPARE(now->gravity));
}

static void measure_energy(struct sim *s, int m, const struct view *view, double *value)
{
    (void)m;
    check_energy(s, &view->energy);
    energy_terms_columns(lattice_energy_table, &s->lattice->energy_start, &view->energy, value);
}

static void measure_momentum(struct sim *s, int m, const struct view *view, double *value)
{
    (void)s;
    (void)m;
    memcpy(value, view->energy.momentum, sizeof view->energy.momentum);
    memcpy(value + 3, view->energy.angular, sizeof view->energy.angular);
}

/* The measures of the method, a row each; those of the other method alone are empty. */
static const struct measure_row {
    const struct scene_item *column;
    bool by_cell, by_energy; /* what it needs of struct view */
    void (*measure)(struct sim *s, int m, const struct view *view, double *value);
} measure_row[] = {
    [MEASURE_ENERGY] = {measure_columns_energy_lattice, false, true, measure_energy},
    [MEASURE_MOMENTUM] = {measure_columns_momentum, false, true, measure_momentum},
    [MEASURE_PROBE] = {measure_columns_probe_lattice, true, false, measure_probe},
    [MEASURE_STRESS_MAX] = {measure_columns_stress_max, true, false, measure_peak},
    [MEASURE_BROKEN] = {measure_columns_broken, false, false, measure_broken},
};

int lattice_method_measure_columns(const struct sim *s, const struct measure *measure,
    struct series_column column[STEP_MEASURE_COLUMNS])
{
    int n = measures_columns(column, 0, measure_row[measure->kind].column);
    const struct probe_part *part[N_PROBE_PART];
    int n_part = probe_parts(s, measure, part); /* only a probe has fields */
    for (int k = 0; k < n_part; k++) n = measures_columns(column, n, part[k]->column);
    return n;
}

void lattice_method_measure(struct sim *s, const bool *due, double (*value)[STEP_MEASURE_COLUMNS])
{
    struct view view = {NULL};
    bool by_cell = false, by_energy = false;
    for (int m = 0; m < s->scene->n_measure; m++) {
        by_cell |= due[m] && measure_row[s->scene->measure[m].kind].by_cell;
        by_energy |= due[m] && measure_row[s->scene->measure[m].kind].by_energy;
    }
    if (by_energy) lattice_energy_now(s->lattice->account, &view.energy);
    if (by_cell) view.state = lattice_state_create(s);
    for (int m = 0; m < s->scene->n_measure; m++)
        if (due[m]) measure_row[s->scene->measure[m].kind].measure(s, m, &view, value[m]);
    lattice_state_free(view.state);
}
