#include "lattice_observed.h"

#include "kernels/lattice/lattice_words.h"

static int64_t x_at(const struct lattice *l)
{
    return (int64_t)l->x_observed * LATTICE_X(l->features.turn) * l->layout->plane;
}

static int64_t v_at(const struct lattice *l)
{
    return (int64_t)l->v_observed * LATTICE_V * l->layout->plane;
}

void lattice_observed_bind(const struct lattice *l, struct launch *launch)
{
    launch_set_long(launch, "x_in", x_at(l));
    launch_set_long(launch, "v_in", v_at(l));
}

/* After a step that ends with drifts, or whose velocities were kicked, ghosts are still those of
 * its last evaluation. Each evaluation fetches its own, so these may be overwritten; so may
 * pressures and rows of loads. */
void lattice_observed_refresh(struct lattice *l, bool with_pressure)
{
    double t = (double)l->step * l->options.dt;
    lattice_rows_send(l, t, t, t);
    if (l->halo) {
        cl_event nothing = NULL;
        lattice_halo_begin(l->halo, x_at(l), v_at(l), l->timers);
        launch_run_on(l->force, l->dev->compute, 0, NULL, &nothing);
        device_flush(l->dev);
        lattice_halo_swap(l->halo, &nothing, l->timers);
    }
    if (!with_pressure || !l->features.volume) return;
    lattice_observed_bind(l, l->volume);
    launch_set_int(l->volume, "first", 0);
    launch_set_int(l->volume, "n", l->layout->n_volume);
    launch_run(l->volume, (int64_t)l->layout->n_volume * l->layout->run);
}
