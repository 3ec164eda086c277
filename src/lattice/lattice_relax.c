#include "lattice_relax.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "kernels/lattice/lattice_words.h"
#include "kernels/lattice/loads.h"
#include "comm/fail.h"
#include "device/integer_sums.h"
#include "lattice_stress.h"

typedef double row[LATTICE_V]; /* of v and w of a cell, or their rates */

/* A kind's mass [kg] and inertia [kg m2], what makes a force of m times a rate [1], [1/m], and h^2
 * [m2]. */
struct weight {
    row mass, force;
    double face;
};

struct lattice_relax {
    struct lattice *l;
    const struct lattice_cells *cells;
    struct lattice_stress *stress;
    struct weight *weight; /* [n_kind] */
    double *alpha;         /* [n_material] all the same [1/s] */
    double end;            /* [s] */
    double f, g;           /* of half a step's kick, lattice_state.h */
    /* of the first state: v.m v [J], v.m a [W], with the v of the step that follows */
    double motion, power;
    struct lattice_rest rest;
};

static struct weight *weights(const struct lattice *l, const struct lattice_cells *cells)
{
    double *cell = lattice_features_cells(cells, &l->options);
    struct weight *weight = fail_alloc((size_t)cells->n_kind * sizeof *weight);
    for (int k = 0; k < cells->n_kind; k++) {
        double h = cells->grid[cells->kind[k].grid].h;
        for (int a = 0; a < LATTICE_V; a++) {
            weight[k].mass[a] = 1 / cell[k * CELL_WIDTH + a / 3];
            weight[k].force[a] = a < 3 ? 1 : 2 / h;
        }
        weight[k].face = h * h;
    }
    free(cell);
    return weight;
}

static void set_damping(struct lattice_relax *r, double alpha)
{
    struct lattice *l = r->l;
    r->rest.alpha = alpha;
    for (int m = 0; m < l->options.n_material; m++) r->alpha[m] = alpha;
    int n_kick = (l->scheme->n + 2) * r->cells->n_kind;
    double *table = lattice_features_kicks(r->cells, &l->options),
           *end_only = table + l->scheme->n * r->cells->n_kind * KICK_WIDTH;
    r->f = end_only[0];
    r->g = end_only[1];
    reals_write(&l->kick, l->features.real_is_float, 0, (size_t)n_kick * KICK_WIDTH, table);
    free(table);
}

struct lattice_relax *lattice_relax_create(
    struct lattice *l, const struct lattice_cells *cells, double end)
{
    struct lattice_relax *r = fail_alloc(sizeof *r);
    r->l = l;
    r->cells = cells;
    r->end = end;
    r->weight = weights(l, cells);
    r->stress = lattice_stress_create(l, true);
    r->alpha = fail_alloc((size_t)l->options.n_material * sizeof *r->alpha);
    l->options.alpha = r->alpha;
    set_damping(r, 1 / end);
    return r;
}

void lattice_relax_free(struct lattice_relax *r)
{
    if (!r) return;
    lattice_stress_free(r->stress);
    free(r->weight);
    free(r->alpha);
    free(r);
}

static const struct weight *weight_of(const struct lattice_relax *r, int64_t k)
{
    return &r->weight[r->cells->kind_of[r->l->layout->gid[k]]];
}

/* Mass or inertia of DOF c of cell k. */
static double mass_of(const struct lattice_relax *r, int64_t k, int c)
{
    double share = lattice_cells_share(r->cells, r->l->layout->gid[k])->mass;
    return weight_of(r, k)->mass[c] * (c < 3 ? share : 1);
}

/* Of this rank's cells [n_owned]: velocities of half a step ago, and the accelerations of the
 * observed state, v_now = f v_before + g a. */
static void read_state(const struct lattice_relax *r, row *before, row *a)
{
    struct lattice *l = r->l;
    for (int c = 0; c < LATTICE_V; c++) {
        double *old = lattice_read_plane(
            l, &l->v, l->features.real_is_float, (int64_t)l->v_set * LATTICE_V + c);
        double *now = lattice_read_plane(
            l, &l->v, l->features.real_is_float, (int64_t)l->v_observed * LATTICE_V + c);
        for (int64_t k = 0; k < l->layout->n_owned; k++) {
            before[k][c] = old[k];
            a[k][c] = (now[k] - r->f * old[k]) / r->g;
        }
        free(old);
        free(now);
    }
}

/* x.m y over all ranks, whatever the size of x and y. Collective. */
static double dot(const struct lattice_relax *r, const row *x, const row *y)
{
    double most[3] = {0, 0, 0}, value;
    struct sum sum = {0};
    for (int64_t k = 0; k < r->l->layout->n_owned; k++)
        for (int c = 0; c < LATTICE_V; c++) {
            most[0] = fmax(most[0], mass_of(r, k, c));
            most[1] = fmax(most[1], fabs(x[k][c]));
            most[2] = fmax(most[2], fabs(y[k][c]));
        }
    comm_max_f64(r->l->comm, most, 3);
    if (!(most[1] > 0) || !(most[2] > 0)) return 0;
    for (int64_t k = 0; k < r->l->layout->n_owned; k++)
        for (int c = 0; c < LATTICE_V; c++)
            sums_add(&sum, mass_of(r, k, c) / most[0] * (x[k][c] / most[1]) * (y[k][c] / most[2]));
    integer_sums_all(r->l->comm, &sum, 1, &value);
    return value * most[0] * most[1] * most[2];
}

void lattice_relax_first(struct lattice_relax *r)
{
    size_t n = (size_t)r->l->layout->n_owned;
    row *v = fail_alloc(n * sizeof *v), *a = fail_alloc(n * sizeof *a);
    read_state(r, v, a);
    for (size_t k = 0; k < n; k++)
        for (int c = 0; c < LATTICE_V; c++)
            v[k][c] = r->f * (r->f * v[k][c] + r->g * a[k][c]) + r->g * a[k][c];
    r->motion = dot(r, v, v);
    r->power = dot(r, v, a);
    free(v);
    free(a);
}

/* Whether the loads are those of the end, and lead nothing. */
static bool loads_are_last(const struct lattice_relax *r)
{
    const struct lattice *l = r->l;
    if (!l->features.loads) return true;
    size_t n = (size_t)l->options.n_row * LOAD_WIDTH;
    double *now = fail_alloc(n * sizeof *now), *last = fail_alloc(n * sizeof *last),
           t = (double)l->step * l->options.dt;
    l->options.rows_at(l->options.context, t, t, t, now);
    l->options.rows_at(l->options.context, r->end, r->end, r->end, last);
    bool same = !memcmp(now, last, n * sizeof *now);
    for (size_t i = 0; i < n; i++) same &= i % LOAD_WIDTH < LOAD_VELOCITY || !(fabs(now[i]) > 0);
    free(now);
    free(last);
    return same;
}

/* Not a number counts as infinite. */
static void raise(double *largest, double value)
{
    *largest = isnan(value) ? (double)INFINITY : fmax(*largest, fabs(value));
}

static bool is_unloaded(const struct lattice *l)
{
    const double *g = l->options.gravity;
    return !l->features.loads && !(fabs(g[0]) > 0 || fabs(g[1]) > 0 || fabs(g[2]) > 0);
}

static void measure(struct lattice_relax *r, const row *v, const row *a)
{
    size_t n = (size_t)r->l->layout->n_owned;
    double(*stress)[9] = fail_alloc(n * sizeof *stress), largest[2] = {0, 0};
    lattice_stress_run(r->stress, stress, NULL);
    for (size_t k = 0; k < n; k++) {
        const struct weight *w = weight_of(r, (int64_t)k);
        for (int c = 0; c < LATTICE_V; c++) {
            double mass = mass_of(r, (int64_t)k, c);
            raise(&largest[0], w->force[c] * mass * a[k][c]);
            raise(&largest[0], w->force[c] * mass * r->rest.alpha * v[k][c]);
        }
        for (int c = 0; c < 9; c++) raise(&largest[1], w->face * stress[k][c]);
    }
    comm_max_f64(r->l->comm, largest, 2);
    r->rest.left = largest[0];
    /* what carries nothing comes to rest without stress: the largest so far is the measure then */
    r->rest.scale = is_unloaded(r->l) ? fmax(r->rest.scale, largest[1]) : largest[1];
    free(stress);
}

bool lattice_relax_second(struct lattice_relax *r, double tolerance)
{
    size_t n = (size_t)r->l->layout->n_owned;
    row *v = fail_alloc(n * sizeof *v), *a = fail_alloc(n * sizeof *a);
    read_state(r, v, a);
    double square = (r->power - dot(r, v, a)) / (r->l->options.dt * r->motion);
    measure(r, v, a);
    free(v);
    free(a);
    if (square > 0 && isfinite(square)) set_damping(r, 2 * sqrt(square));
    return isfinite(r->rest.left) && r->rest.left <= tolerance * r->rest.scale && loads_are_last(r);
}

void lattice_relax_note(const struct lattice_relax *r, double note[LATTICE_RELAX_NOTES])
{
    const double all[LATTICE_RELAX_NOTES] = {
        r->rest.alpha, r->rest.left, r->rest.scale, r->motion, r->power};
    memcpy(note, all, sizeof all);
}

void lattice_relax_recall(struct lattice_relax *r, const double note[LATTICE_RELAX_NOTES])
{
    set_damping(r, note[0]);
    r->rest.left = note[1];
    r->rest.scale = note[2];
    r->motion = note[3];
    r->power = note[4];
}

const struct lattice_rest *lattice_relax_rest(const struct lattice_relax *r)
{
    return &r->rest;
}
