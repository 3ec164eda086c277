#include "lattice_input.h"

#include <stdlib.h>
#include <string.h>

#include "fail.h"
#include "lattice_frequency.h"
#include "lattice_loads.h"

static void rows_at(void *context, double t, double from, double to, double *rows)
{
    struct lattice_input *input = context;
    lattice_loads_at(input->loads, input->scene, t, from, to, rows);
}

struct lattice_input *lattice_input_create(const struct scene *scene, const struct lattice_cells *cells, double dt)
{
    struct lattice_input *input = fail_alloc(sizeof *input);
    size_t n = (size_t)scene->n_material;
    input->material = fail_alloc(n * sizeof *input->material);
    input->alpha = fail_alloc(n * sizeof *input->alpha);
    input->scene = scene;
    input->loads = cells->loads;
    for (size_t m = 0; m < n; m++) {
        input->material[m] = lattice_frequency_material(&scene->material[m]);
        input->alpha[m] = scene->material[m].mass_damping;
    }
    input->options = (struct lattice_options){.dt = dt,
        .scheme = (enum lattice_scheme)scene->time.scheme,
        .turn = scene->lattice.rotation == ROTATION_FINITE,
        .real_is_float = scene->precision == PRECISION_SINGLE || scene->precision == PRECISION_MIXED,
        .position_is_float = scene->precision == PRECISION_SINGLE,
        .set = (enum link_set)scene->lattice.law,
        .material = input->material,
        .alpha = input->alpha,
        .n_material = scene->n_material,
        .n_row = cells->loads->n_row,
        .rows_at = rows_at,
        .context = input};
    for (int m = 0; m < scene->n_measure; m++) input->options.energy |= scene->measure[m].kind == MEASURE_ENERGY;
    memcpy(input->options.gravity, scene->gravity, sizeof input->options.gravity);
    return input;
}

void lattice_input_free(struct lattice_input *input)
{
    if (!input) return;
    free(input->material);
    free(input->alpha);
    free(input);
}
