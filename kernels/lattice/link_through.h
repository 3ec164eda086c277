/* Forces through the faces of a cell on the device: those of its links, and its row of loads. */
#ifndef DEMOCLES_LINK_THROUGH_H
#define DEMOCLES_LINK_THROUGH_H

#include "lattice_through.h"
#include "lattice_view.h"

LAW struct lattice_through lattice_through_of(
    int mixed, struct lattice_view s, size_t l, int word, struct link_cell me)
{
    struct lattice_through f;
    f.x[0] = lattice_face(0, mixed, s, l, word, me).force;
    f.x[1] = lattice_face(1, mixed, s, l, word, me).force;
    f.y[0] = lattice_face(2, mixed, s, l, word, me).force;
    f.y[1] = lattice_face(3, mixed, s, l, word, me).force;
    f.z[0] = lattice_face(4, mixed, s, l, word, me).force;
    f.z[1] = lattice_face(5, mixed, s, l, word, me).force;
    return f;
}

/* Stress of a cell from the forces through its links. */
LAW struct stress lattice_stress_at(int mixed, struct lattice_view s, size_t l, int word,
    struct lattice_through f, struct link_cell me, struct lattice_load load, int extrapolate)
{
    if (WITH_SHARES && mixed && s.share[s.begin + l])
        return lattice_stress_cut(f, me, LATTICE_LINKS(word), s.k.h, lattice_share(s, s.begin + l));
    return lattice_stress_of(f, me, load, LATTICE_LINKS(word), s.k.h, extrapolate);
}

/* Loads of cell i; names of the kernel's arguments. */
#if WITH_LOADS
LAW struct lattice_load lattice_load_at(__global const real *at)
{
    struct lattice_load load;
    load = lattice_load_of(at);
    return load;
}
#define LOAD_OF(i) lattice_load_at(rows + at_rows + (size_t)row[i] * LOAD_WIDTH)
#else
#define LOAD_OF(i)                                                                                 \
    {                                                                                              \
        .traction = 0                                                                              \
    }
#endif

#endif
