#include "lattice_energy.h"

#include <stdlib.h>
#include <string.h>

#include "kernels/lattice/lattice_words.h"
#include "comm/fail.h"
#include "device/integer_sums.h"
#include "lattice_break.h"
#include "lattice_observed.h"
#include "scene/measure_columns.h"

struct lattice_account {
    struct lattice *l;
    struct program *program; /* NULL: no double precision */
    struct launch *launch;
    struct buffer place, partial;
    /* what work and damping of links and of masses were when it was opened [J]; others are 0 */
    struct lattice_energy opened;
};

/* Where the centre of each run's first cell is, there or not, and the edge of its cells: [n_run][4]
 * [m]. From the grid alone, so the same on any rank; runs without own cells stay 0. The caller
 * frees. */
static double *places(const struct lattice *l, const struct lattice_cells *cells)
{
    const struct lattice_layout *c = l->layout;
    double *place = fail_alloc((size_t)c->n_run * 4 * sizeof *place);
    for (int64_t k = 0; k < c->n_owned; k++) {
        const struct lattice_grid *g = &cells->grid[cells->kind[cells->kind_of[c->gid[k]]].grid];
        double *p = place + (int64_t)(c->index[k] / c->run) * 4;
        for (int a = 0; a < 3; a++) {
            int at = cells->at[c->gid[k]][a] - (a == c->axis ? c->index[k] % c->run : 0);
            p[a] = g->origin[a] + (at + 0.5) * g->h;
        }
        p[3] = g->h;
    }
    return place;
}

struct lattice_account *lattice_energy_create(struct lattice *l, const struct lattice_cells *cells)
{
    static const char *const source[] = {"link_energy.cl", NULL};
    struct lattice_account *a = fail_alloc(sizeof *a);
    a->l = l;
    buffer_init(&a->place, l->dev, "lattice places");
    buffer_init(&a->partial, l->dev, "lattice sums");
    if (!l->dev->fp64) return a;
    char *text = lattice_features_options(&l->features, l->layout),
         *options = fail_format("%s -DWITH_SUMS=1", text);
    a->program = program_build(l->dev, l->comm, "energy", options, source);
    free(text);
    free(options);
    double *place = places(l, cells);
    size_t bytes = (size_t)l->layout->n_run * 4 * sizeof *place;
    buffer_put(&a->place, bytes, place);
    free(place);
    buffer_reserve(&a->partial, (size_t)SUMS_GROUPS * ACCOUNT_WIDTH * SUMS_WIDTH * sizeof(int64_t));
    a->launch = lattice_launch(l, a->program, "link_energies", &l->force_list);
    launch_set_batch(a->launch, SUMS_GROUP);
    launch_bind_buffer(a->launch, "place", &a->place);
    launch_bind_buffer(a->launch, "partial", &a->partial);
    launch_set_int(a->launch, "n", l->layout->n_force);
    if (l->features.energy && l->breakage) lattice_break_bind(l->breakage, a->launch);
    launch_set_vector(a->launch, "gravity", l->options.gravity);
    struct lattice_energy start;
    lattice_energy_now(a, &start);
    lattice_energy_reopen(a, (const double[]){start.work, start.link_damping, start.mass_damping});
    return a;
}

void lattice_energy_free(struct lattice_account *a)
{
    if (!a) return;
    device_finish(a->l->dev);
    launch_free(a->launch);
    program_free(a->program);
    buffer_free(&a->place);
    buffer_free(&a->partial);
    free(a);
}

void lattice_energy_opened(const struct lattice_account *a, double with[LATTICE_ENERGY_OPENED])
{
    with[0] = a->opened.work;
    with[1] = a->opened.link_damping;
    with[2] = a->opened.mass_damping;
}

void lattice_energy_reopen(struct lattice_account *a, const double with[LATTICE_ENERGY_OPENED])
{
    a->opened.work = with[0];
    a->opened.link_damping = with[1];
    a->opened.mass_damping = with[2];
}

#define TERM(name, sign, known, source, text)                                                      \
    ENERGY_TERM(struct lattice_energy, name, sign, known, source),
const struct energy_term lattice_energy_table[] = {MEASURE_ENERGY_LATTICE(TERM){NULL, 0, 0, 0, 0}};

void lattice_energy_now(struct lattice_account *a, struct lattice_energy *out)
{
    struct sum sum[ACCOUNT_WIDTH] = {{0}};
    double v[ACCOUNT_WIDTH];
    if (a->program) {
        lattice_observed_refresh(a->l, false);
        lattice_observed_bind(a->l, a->launch);
        integer_sums_run(a->launch, &a->partial, ACCOUNT_WIDTH, sum);
    }
    for (int k = 0; k < ACCOUNT_WIDTH; k++) sum[k].bad += !a->program;
    for (int k = ACCOUNT_WORK; k <= ACCOUNT_RELEASED; k++) sum[k].bad += !a->l->features.energy;
    integer_sums_all(a->l->comm, sum, ACCOUNT_WIDTH, v);
    for (const struct energy_term *term = lattice_energy_table; term->name; term++)
        *energy_terms_at(term, out) = v[term->source] - energy_terms_value(term, &a->opened);
    memcpy(out->momentum, v + ACCOUNT_MOMENTUM, sizeof out->momentum);
    memcpy(out->angular, v + ACCOUNT_ANGULAR, sizeof out->angular);
    out->n_strained = v[ACCOUNT_STRAINED];
}

double lattice_energy_balance(const struct lattice_energy *start, const struct lattice_energy *now)
{
    return energy_terms_balance(lattice_energy_table, start, now);
}

double lattice_energy_supplied(const struct lattice_energy *start, const struct lattice_energy *now)
{
    return start->kinetic + start->rotational + start->elastic + fabs(now->work) +
           fabs(now->gravity - start->gravity);
}
