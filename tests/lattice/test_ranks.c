/* The same bits on any number of ranks as on one: each rank runs the whole body alone, then its
 * part of it, and compares digests. Argument: `some` leaves out what schemes share,
 * and what runs of the program show. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "lattice_bodies.h"
#include "lattice/lattice_break.h"
#include "tests/mpi_check.h"

static void rows_at(void *context, double t, double from, double to, double *rows)
{
    (void)context;
    for (int r = 1; r < 5; r++)
        for (int k = 0; k < LOAD_WIDTH; k++)
            rows[r * LOAD_WIDTH + k] = (k < LOAD_VELOCITY ? 50 : 3) *
                                       sin(r + k + 3e3 * (k < LOAD_VELOCITY ? t : from + to));
}

static struct device *dev;
static struct comm *comm, alone;

/* count: links broken by mode. */
static uint64_t digest(const struct comm *who, const struct lattice_cells *cells,
    const struct lattice_options *o, int n_step, bool observe, int64_t *count)
{
    struct lattice *l = lattice_create(dev, who, cells, o);
    uint64_t value = 0;
    int64_t n_nan;
    lattice_begin_step(l);
    for (int step = 1; step <= n_step; step++) {
        bool look = step == n_step || (observe && step % 3 == 0);
        lattice_advance(l, look);
        if (look && step < n_step) lattice_begin_step(l);
    }
    n_nan = lattice_digest(l, &value);
    CHECK(n_nan == 0);
    if (who->n_rank > 1 && cells->n > 200) {
        int64_t sent = l->halo->exchange.halo->sent.bytes;
        comm_sum_i64(who, &sent, 1);
        CHECK(sent > 0);
    }
    memset(count, 0, LATTICE_BREAK_MODES * sizeof *count);
    if (l->breakage) lattice_break_count(l->breakage, count);
    lattice_free(l);
    return value;
}

static void check(
    const int size[3], bodies_solid *solid, int n_grid, int n_material, struct lattice_options o)
{
    struct link_material material[2] = {{1000, 2e7, 0.3, 0}, {700, 1e7, 0.1, 0}};
    const double alpha[2] = {20, 50};
    bool damped = o.scheme == LATTICE_LEAPFROG || o.scheme == LATTICE_RK4;
    material[0].damping = damped && n_material > 1 ? 2e-5 : 0;
    if (n_material == 1) material[0].poisson = 0;
    o.dt = 1e-4;
    o.material = material;
    o.n_material = n_material;
    o.alpha = damped && n_material > 1 ? alpha : NULL;
    o.n_row = n_material > 1 ? 5 : 1;
    o.rows_at = rows_at;
    o.gravity[2] = -9.81;
    struct lattice_cells *cells = bodies_create(n_grid, size, 0.1, n_material, solid);
    if (n_material == 1)
        for (int64_t i = 0; i < cells->n; i++) cells->row[i] = 0;
    bodies_shake(cells, 5, 100);
    int64_t count[3][LATTICE_BREAK_MODES];
    uint64_t one = digest(&alone, cells, &o, 10, false, count[0]),
             all = digest(comm, cells, &o, 10, false, count[1]);
    CHECK(one == all);
    CHECK(one == digest(comm, cells, &o, 10, true, count[2]));
    CHECK(!memcmp(count[0], count[1], sizeof count[0]) &&
          !memcmp(count[0], count[2], sizeof count[0]));
    bool by_link = o.strength && !(o.strength->principal > 0);
    if (o.strength) CHECK(count[0][0] > 20);
    if (by_link) CHECK(count[0][1] > 20 && count[0][2] > 20);
    o.dt = 1.0001e-4;
    CHECK(digest(comm, cells, &o, 10, false, count[0]) != one); /* the digest sees what happens */
    bodies_free(cells);
}

int main(int argc, char **argv)
{
    const int size[3] = {41, 9, 7}, thin[3] = {70, 1, 1}, tiny[3] = {2, 1, 1};
    const enum lattice_scheme scheme[5] = {
        LATTICE_LEAPFROG, LATTICE_RK4, LATTICE_PEFRL, LATTICE_RKN4, LATTICE_VEFRL};
    comm = comm_create(&argc, &argv);
    alone =
        (struct comm){.world = MPI_COMM_SELF, .node = MPI_COMM_SELF, .n_rank = 1, .n_node_rank = 1};
    dev = device_open(comm, NULL, true, false);
    bool some = argc > 1 && strcmp(argv[1], "some") == 0;
    if (!some) check(size, bodies_block, 1, 1, (struct lattice_options){0});
    if (!some) check(thin, bodies_block, 1, 1, (struct lattice_options){.turn = true});
    check(tiny, bodies_block, 1, 1, (struct lattice_options){0});
    const struct link_strength strength[4] = {{4e5, 8e5, 2, 0, 0, 0}, {6e5, 6e5, 0, 0, 0, 0},
        {8e5, 4e5, 1, 0, 0, 0}, {10e5, 2e5, 2, 0, 0, 0}};
    for (int k = 0; k < (some ? 0 : 5); k++)
        check(
            size, bodies_mixed, 2, 2, (struct lattice_options){.turn = true, .scheme = scheme[k]});
    for (int k = 0; k < (some ? 0 : 5); k++)
        check(size, bodies_mixed, 2, 2,
            (struct lattice_options){.turn = true, .scheme = scheme[k], .strength = strength});
    if (!some) check(size, bodies_block, 1, 1, (struct lattice_options){.strength = strength});
    const double none = HUGE_VAL;
    const struct link_strength principal[4] = {{none, none, 0, 2e5, 0, true},
        {none, none, 0, 3e5, 0.16, false}, {8e5, 4e5, 1, 0, 0, false},
        {none, none, 0, 2e5, 0.16, true}};
    for (int k = 0; k < (some ? 0 : 3); k++)
        check(size, bodies_mixed, 2, 2,
            (struct lattice_options){.turn = true, .scheme = scheme[k], .strength = principal});
    if (!some) check(size, bodies_mixed, 2, 2, (struct lattice_options){.real_is_float = true});
    check(size, bodies_voxels, 1, 2,
        (struct lattice_options){.turn = true, .real_is_float = true, .position_is_float = true});
    device_free(dev);
    comm_free(comm);
    return 0;
}
