/* Poisson's ratio: one scalar per cell, its volumetric strain Th, with the energy lambda h^3
 * Th^2/2. Pair springs alone have nu = 0 and nothing else.
 *
 * Th is the sum over the six faces of eps/2, eps = normal gap/h. A face without link (free surface,
 * broken link, loaded face) has an eps that its outward normal traction t fixes, 2 G eps + lambda
 * Th = t [Pa]. Put in:
 *     Th = [sum over links of r g/(2 h) + sum over the others of t/(4 G)]
 *          /(1 + n_miss lambda/(4 G)),   p = lambda Th
 * which is the minimum of an energy: stiffness stays symmetric and positive for nu > -1, and a
 * broken link is n_miss + 1 on both sides. r is the share of the gap in the cell's own half
 * (law_link.h). The principle is that of movable cellular automata (Smolin et al. 2016, PSI 2,
 * 1781); the face without link is this project's.
 *
 * WITH_SHARES: the cell is covered to the share f, its faces to the shares s. Of the length f along
 * an axis the links take (s^- + s^+)/2, the rest ends at the surface and is what a missing face is
 * to a whole cell. With `missing` = 6 f - sum of the s with a link, and in t each part by its size,
 *     Th = [sum over links of s r g/(2 h) + sum of t/(4 G)]/D,   D = f + missing lambda/(4 G)
 * A link to a sliver, f < 1/2, is longer than what it stands for: `missing` is negative there, and
 * D must not come near 0. It is at least a quarter of what it is with one face missing. */
#ifndef DEMOCLES_LAW_VOLUME_H
#define DEMOCLES_LAW_VOLUME_H

#include "common/types.h"
#include "lattice_words.h"

struct volume_constants {
    real lambda; /* [Pa] */
    real per_4g; /* 1/(4 G) [1/Pa] */
    real per_2h; /* 1/(2 h) [1/m] */
    real volume; /* h^3 [m3] */
    /* WITH_SHARES: f, 6 f less the shares of the faces with a link, least D [1] */
    real share, missing, least;
};

/* Faces without link; a mask of six bits. */
LAW int volume_missing(int links)
{
    return 6 - (links & 1) - (links >> 1 & 1) - (links >> 2 & 1) - (links >> 3 & 1) -
           (links >> 4 & 1) - (links >> 5 & 1);
}

/* What one link adds to the sum of stretches [m]: r (link_stretch), or nothing. */
LAW real volume_part(int exists, real r, real stretch) { return exists ? r * stretch : (real)0; }

/* D [1]: 1 + n_miss lambda/(4 G). */
LAW real volume_size(int links, struct volume_constants c)
{
    if (WITH_SHARES) return r_max(r_fma(c.missing, c.lambda * c.per_4g, c.share), c.least);
    real missing = (real)volume_missing(links);
    return r_fma(missing, c.lambda * c.per_4g, (real)1);
}

/* Th [1]. stretch: sum over the links, in the order of the mask [m]; traction: sum of t over the
 * faces without link [Pa]. p is lambda Th. */
LAW real volume_strain(real stretch, real traction, int links, struct volume_constants c)
{
    return r_fma(stretch, c.per_2h, traction * c.per_4g) / volume_size(links, c);
}

/* Energy [J] of the cell beyond its links: lambda h^3 Th^2/2, and (G h^3/2) eps^2 in each half
 * without link, eps = (t - lambda Th)/(2 G).
 * squares: sum of t^2 over these faces [Pa2]. Without tractions lambda h^3 Th^2 (1 + n_miss
 * lambda/(4 G))/2. */
LAW real volume_energy(
    real strain, real traction, real squares, int links, struct volume_constants c)
{
    real p = c.lambda * strain, missing = (real)volume_missing(links);
    if (WITH_SHARES)
        return (real)0.5 * c.volume *
               r_fma(p * volume_size(links, c), strain,
                   c.per_4g * r_fma((real)-2 * traction, p, squares));
    real faces = r_fma(p, r_fma(missing, p, (real)-2 * traction), squares);
    return (real)0.5 * c.volume * r_fma(p, strain, c.per_4g * faces);
}

#endif
