#include "lattice_input.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "lattice_frequency.h"
#include "lattice_loads.h"

static void rows_at(void *context, double t, double from, double to, double *rows)
{
    struct lattice_input *input = context;
    lattice_loads_at(input->loads, input->scene, t, from, to, rows);
}

/* What cells of a kind bear. */
static struct link_strength strength_of(
    const struct scene *scene, const struct lattice_cells *cells, int kind)
{
    const struct material *m = &scene->material[cells->kind[kind].material];
    struct link_strength s = {HUGE_VAL, HUGE_VAL, CRITERION_SUM, 0, 0, false};
    struct link_material own = lattice_frequency_material(m);
    double h = cells->grid[cells->kind[kind].grid].h;
    bool is_strain = m->plane == PLANE_STRAIN, by_energy = m->energy > 0;
    if (!m->has_strength) return s;
    if (m->criterion == CRITERION_PRINCIPAL) {
        double stress =
            by_energy ? link_constants_principal(own, m->energy, h, is_strain) : m->tension;
        s.principal = isfinite(stress) ? stress : 0;
        s.rise = by_energy ? link_constants_rise() : 0;
        s.drawn = m->crack_path == PATH_DRAWN;
        return s;
    }
    s.criterion = (int)m->criterion;
    s.shear = m->shear;
    s.tension = by_energy ? link_constants_tension(own, m->energy, h, is_strain) : m->tension;
    return s;
}

struct lattice_input *lattice_input_create(
    const struct scene *scene, const struct lattice_cells *cells, double dt)
{
    struct lattice_input *input = fail_alloc(sizeof *input);
    size_t n = (size_t)scene->n_material;
    input->material = fail_alloc(n * sizeof *input->material);
    input->alpha = fail_alloc(n * sizeof *input->alpha);
    input->scene = scene;
    input->loads = cells->loads;
    for (size_t m = 0; m < n; m++) {
        input->material[m] = lattice_frequency_material(&scene->material[m]);
        /* lattice_relax.h sets it anew */
        input->alpha[m] =
            scene->lattice.relax ? 1 / scene->time.end : scene->material[m].mass_damping;
    }
    input->options = (struct lattice_options){.dt = dt,
        .scheme = (enum lattice_scheme)scene->time.scheme,
        .turn = scene->lattice.rotation == ROTATION_FINITE,
        .real_is_float =
            scene->precision == PRECISION_SINGLE || scene->precision == PRECISION_MIXED,
        .position_is_float = scene->precision == PRECISION_SINGLE,
        .set = (enum link_set)scene->lattice.law,
        .material = input->material,
        .alpha = input->alpha,
        .n_material = scene->n_material,
        .n_row = cells->loads->n_row,
        .rows_at = rows_at,
        .context = input};
    input->strength = fail_alloc((size_t)cells->n_kind * sizeof *input->strength);
    for (int k = 0; k < cells->n_kind; k++) {
        input->strength[k] = strength_of(scene, cells, k);
        if (isfinite(input->strength[k].tension) || isfinite(input->strength[k].shear) ||
            input->strength[k].principal > 0)
            input->options.strength = input->strength;
    }
    for (int m = 0; m < scene->n_measure; m++)
        input->options.energy |= scene->measure[m].kind == MEASURE_ENERGY;
    memcpy(input->options.gravity, scene->gravity, sizeof input->options.gravity);
    return input;
}

void lattice_input_free(struct lattice_input *input)
{
    if (!input) return;
    free(input->material);
    free(input->alpha);
    free(input->strength);
    free(input);
}
