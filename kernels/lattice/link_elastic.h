/* Elastic energy of a lattice cell in device memory, for kernels of double precision. */
#ifndef DEMOCLES_LINK_ELASTIC_H
#define DEMOCLES_LINK_ELASTIC_H

#include "lattice_account.h"
#include "lattice_view.h"

#if WITH_SUMS
LAW real account_face(int face, struct lattice_view s, size_t l, int word, struct link_cell me)
{
    size_t j = lattice_beside(s, face, l);
    return account_link(face, LATTICE_LINKS(word) >> face & 1, me, lattice_cell(s, j),
        lattice_constants(s, face, 1, word, s.begin + l, j));
}

/* Of the cell's link over its upper face along an axis. */
LAW real account_strain(int axis, struct lattice_view s, size_t l, int word, struct link_cell me)
{
    int face = 2 * axis + 1;
    size_t j = lattice_beside(s, face, l);
    return account_strained(axis, LATTICE_LINKS(word) >> face & 1, me, lattice_cell(s, j),
        lattice_constants(s, face, 1, word, s.begin + l, j));
}

/* Links and volume of a cell [J]. */
LAW void account_elastic(struct lattice_view s, size_t l, int word, struct link_cell c,
    struct lattice_load load, __global const real *cell, real *links, real *volume, real *faces)
{
    struct volume_constants k;
    real sum = 0;
    *links = account_face(0, s, l, word, c) + account_face(1, s, l, word, c) +
             account_face(2, s, l, word, c);
    *links += account_face(3, s, l, word, c) + account_face(4, s, l, word, c) +
              account_face(5, s, l, word, c);
    if (WITH_VOLUME) {
        sum = lattice_part(0, 1, s, l, word, c, 0) + lattice_part(1, 1, s, l, word, c, 0) +
              lattice_part(2, 1, s, l, word, c, 0);
        sum += lattice_part(3, 1, s, l, word, c, 0) + lattice_part(4, 1, s, l, word, c, 0) +
               lattice_part(5, 1, s, l, word, c, 0);
    }
    k = lattice_volume_of(cell, WITH_SHARES ? lattice_share(s, s.begin + l) : 0, word & 63);
    *volume = account_volume(sum, load, word & 63, k);
    *faces = WITH_ENERGY && WITH_LOADS ? account_faces(sum, load, word & 63, k) : (real)0;
}

#if WITH_BREAK
/* What the cell has more with the links `gone` than without them [J]; the work that tractions on
 * its faces do as these go is taken off. */
LAW double account_release(struct lattice_view s, size_t l, int word, int gone,
    struct lattice_load load, __global const real *cell)
{
    struct link_cell c = lattice_cell(s, s.begin + l);
    real links[2], volume[2], faces[2];
    account_elastic(s, l, word & ~gone, c, load, cell, &links[0], &volume[0], &faces[0]);
    account_elastic(s, l, word | gone, c, load, cell, &links[1], &volume[1], &faces[1]);
    return 0.5 * ((double)links[1] - (double)links[0]) + ((double)volume[1] - (double)volume[0]) -
           ((double)faces[1] - (double)faces[0]);
}
#endif
#endif

#endif
