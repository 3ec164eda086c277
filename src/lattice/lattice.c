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
    int64_t plane = l->layout->plane;
    launch_set_batch(k, (size_t)l->layout->run);
    launch_bind_all_if(
        k, (const struct launch_binding[]){{"info", &l->info}, {"base", &l->base},
               {"word", &l->word}, {"x", &l->x}, {"v", &l->v}, {"link", &l->link},
               {"cell", &l->cell}, {"p", &l->pressure}, {"row", &l->row}, {"rows", &l->rows.buffer},
               {"sum_x", &l->sum_x}, {"sum_v", &l->sum_v}, {"kick_table", &l->kick},
               {"ledger", &l->ledger}, {"share", &l->share}, {"shares", &l->shares}, {0}});
    if (list) launch_bind_buffer(k, "list", list);
    launch_set_if(k, "plane", &plane, sizeof plane);
    launch_set_int_if(k, "n_run", l->layout->n_run);
    launch_set_int_if(k, "n_kind", l->n_kind);
    launch_set_int_if(k, "at_rows", 0);
    launch_set_vector_if(k, "gravity", l->options.gravity);
    if (launch_has(k, "start_x")) {
        launch_set_long(k, "start_x", 0);
        launch_set_long(k, "start_v", 0);
    }
    return k;
}
