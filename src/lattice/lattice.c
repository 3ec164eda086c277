/* Widths of numbers and launches of kernels, shared by the files of the lattice. */
#include "lattice.h"

#include <stdlib.h>

#include "comm/fail.h"

size_t lattice_x_bytes(const struct lattice *l)
{
    return reals_size(l->features.position_is_float);
}

size_t lattice_v_bytes(const struct lattice *l)
{
    return reals_size(l->features.real_is_float);
}

struct launch *lattice_launch(
    struct lattice *l, const struct program *program, const char *kernel, const struct buffer *list)
{
    struct launch *k = launch_create(program, kernel);
    static const char *const name[] = {"info", "base", "word", "x", "v", "link", "cell", "p", "row",
        "rows", "sum_x", "sum_v", "kick_table", "ledger", NULL};
    const struct buffer *buffer[] = {&l->info, &l->base, &l->word, &l->x, &l->v, &l->link, &l->cell,
        &l->pressure, &l->row, &l->rows.buffer, &l->sum_x, &l->sum_v, &l->kick, &l->ledger};
    static const char *const gravity[] = {"gravity_x", "gravity_y", "gravity_z"};
    int64_t plane = l->layout->plane;
    launch_set_batch(k, (size_t)l->layout->run);
    for (int i = 0; name[i]; i++) launch_bind_buffer_if(k, name[i], buffer[i]);
    if (list) launch_bind_buffer(k, "list", list);
    launch_set_if(k, "plane", &plane, sizeof plane);
    launch_set_int_if(k, "n_run", l->layout->n_run);
    launch_set_int_if(k, "n_kind", l->n_kind);
    launch_set_int_if(k, "at_rows", 0);
    for (int a = 0; a < 3; a++) launch_set_real_if(k, gravity[a], l->options.gravity[a]);
    if (launch_has(k, "start_x")) {
        launch_set_long(k, "start_x", 0);
        launch_set_long(k, "start_v", 0);
    }
    return k;
}
