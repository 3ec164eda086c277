#include "lattice_energy.h"

#include <stdlib.h>

#include "kernels/lattice/lattice_words.h"
#include "comm/fail.h"
#include "device/integer_sums.h"
#include "lattice_break.h"
#include "lattice_observed.h"

struct lattice_account {
    struct lattice *l;
    struct program *program; /* NULL: no double precision */
    struct launch *launch;
    struct buffer place, partial;
    double work, links, mass; /* when it was opened [J] */
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
    static const char *const source[] = {"link_energy.cl", NULL}, *const gravity[] = {"gravity_x",
                                                                      "gravity_y", "gravity_z"};
    struct lattice_account *a = fail_alloc(sizeof *a);
    a->l = l;
    buffer_init(&a->place, "lattice places");
    buffer_init(&a->partial, "lattice sums");
    if (!l->dev->fp64) return a;
    char *text = lattice_features_options(&l->features, l->layout),
         *options = fail_format("%s -DWITH_SUMS=1", text);
    a->program = program_build(l->dev, l->comm, "energy", options, source);
    free(text);
    free(options);
    double *place = places(l, cells);
    size_t bytes = (size_t)l->layout->n_run * 4 * sizeof *place;
    buffer_reserve(l->dev, &a->place, bytes);
    buffer_write(l->dev, &a->place, 0, bytes, place);
    free(place);
    buffer_reserve(
        l->dev, &a->partial, (size_t)SUMS_GROUPS * ACCOUNT_WIDTH * SUMS_WIDTH * sizeof(int64_t));
    a->launch = lattice_launch(l, a->program, "link_energies", &l->force_list);
    launch_set_batch(a->launch, SUMS_GROUP);
    launch_bind_buffer(a->launch, "place", &a->place);
    launch_bind_buffer(a->launch, "partial", &a->partial);
    launch_set_int(a->launch, "n", l->layout->n_force);
    if (l->features.energy && l->breakage) lattice_break_bind(l->breakage, a->launch);
    for (int k = 0; k < 3; k++) launch_set_real(a->launch, gravity[k], l->options.gravity[k]);
    struct lattice_energy start;
    lattice_energy_now(a, &start);
    a->work = start.work;
    a->links = start.links;
    a->mass = start.mass;
    return a;
}

void lattice_energy_free(struct lattice_account *a)
{
    if (!a) return;
    device_finish(a->l->dev);
    launch_free(a->launch);
    program_free(a->program);
    buffer_free(a->l->dev, &a->place);
    buffer_free(a->l->dev, &a->partial);
    free(a);
}

void lattice_energy_opened(const struct lattice_account *a, double with[LATTICE_ENERGY_OPENED])
{
    with[0] = a->work;
    with[1] = a->links;
    with[2] = a->mass;
}

void lattice_energy_reopen(struct lattice_account *a, const double with[LATTICE_ENERGY_OPENED])
{
    a->work = with[0];
    a->links = with[1];
    a->mass = with[2];
}

void lattice_energy_now(struct lattice_account *a, struct lattice_energy *out)
{
    struct sum sum[ACCOUNT_WIDTH] = {{0}};
    double v[ACCOUNT_WIDTH];
    if (a->program) {
        lattice_observed_refresh(a->l, false);
        lattice_observed_bind(a->l, a->launch);
        integer_sums_run(a->l->dev, a->launch, &a->partial, ACCOUNT_WIDTH, sum);
    }
    for (int k = 0; k < ACCOUNT_WIDTH; k++) sum[k].bad += !a->program;
    for (int k = ACCOUNT_WORK; k <= ACCOUNT_RELEASED; k++) sum[k].bad += !a->l->features.energy;
    integer_sums_all(a->l->comm, sum, ACCOUNT_WIDTH, v);
    *out = (struct lattice_energy){v[ACCOUNT_KINETIC], v[ACCOUNT_ROTATIONAL], v[ACCOUNT_GRAVITY],
        v[ACCOUNT_ELASTIC], v[ACCOUNT_WORK] - a->work, v[ACCOUNT_LINKS] - a->links,
        v[ACCOUNT_MASS] - a->mass, v[ACCOUNT_RELEASED],
        {v[ACCOUNT_MOMENTUM], v[ACCOUNT_MOMENTUM + 1], v[ACCOUNT_MOMENTUM + 2]},
        {v[ACCOUNT_ANGULAR], v[ACCOUNT_ANGULAR + 1], v[ACCOUNT_ANGULAR + 2]}};
}

static double account(const struct lattice_energy *e)
{
    return e->kinetic + e->rotational + e->gravity + e->elastic + e->links + e->mass + e->released -
           e->work;
}

double lattice_energy_balance(const struct lattice_energy *start, const struct lattice_energy *now)
{
    return account(now) - account(start);
}
