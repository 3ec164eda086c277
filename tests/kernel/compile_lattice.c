/* compile_lattice lattice PRECISION small|turn [volume] [rk4|rkn4] [energy]: one step of a small
 * block, so that the driver compiles its kernels. Leaves with 77 where the platform is not pocl or
 * has no doubles. */
#include <stdio.h>
#include <string.h>

#include "comm/fail.h"
#include "tests/lattice/lattice_bodies.h"

int main(int argc, char **argv)
{
    struct comm *comm = comm_create(&argc, &argv);
    struct link_material m = {7900, 2.1e11, 0, 0};
    struct lattice_options o = {.dt = 1e-8, .material = &m, .n_material = 1, .n_row = 1};
    const int size[3] = {16, 4, 4};
    if (argc < 4) return EXIT_USAGE;
    o.position_is_float = !strcmp(argv[2], "single");
    o.real_is_float = o.position_is_float || !strcmp(argv[2], "mixed");
    bool is_cut = false;
    for (int i = 3; i < argc; i++) {
        is_cut |= !strcmp(argv[i], "shares");
        o.turn |= !strcmp(argv[i], "turn");
        if (!strcmp(argv[i], "volume")) m.poisson = 0.3;
        if (!strcmp(argv[i], "rk4")) o.scheme = LATTICE_RK4;
        if (!strcmp(argv[i], "rkn4")) o.scheme = LATTICE_RKN4;
        o.energy |= !strcmp(argv[i], "energy");
    }
    struct device *dev = device_open(comm, NULL, false, false);
    if (!dev->is_pocl || (!o.position_is_float && !dev->fp64)) {
        printf("%s on %s\n", dev->name, dev->platform_name);
        return 77;
    }
    struct lattice_cells *cells = bodies_create(1, size, 0.01, 1, bodies_block);
    if (is_cut) bodies_cut(cells);
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    lattice_begin_step(l);
    lattice_advance(l, false);
    lattice_free(l);
    bodies_free(cells);
    device_free(dev);
    comm_free(comm);
    return 0;
}
