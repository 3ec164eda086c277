/* Whether a cell fails, by the largest principal value s1 of its stress (law_stress.h), and which
 * of its links breaks then. A criterion of the cell's stress does not know how the grid lies, where
 * limits of single links do.
 *
 * s1 >= sigma_c where sigma_c I - S is not positive definite: the leading minors say so (Sylvester)
 * without roots or angles. Of the links the one breaks that the principal direction d pulls most:
 *     q = (f.d) sign(n.d), n the outward normal of the face, f the force on the cell through it,
 * in a uniform stress h^2 s1 |n.d|: the link most normal to the crack that opens. The first in the
 * order of the mask of those that are equal.
 *
 * A strength that stands for a fracture energy depends on d: the layers of cells ahead of a crack
 * lie closer where it is inclined to the grid. It is sigma_c (1 + rise q^2), q = 1 - (d_x^4 + d_y^4
 * + d_z^4) with |d| = 1: 0 along the grid, 1/2 across {110}, 2/3 across {111}.
 *
 * A plane of normal d crosses links of normal n in proportion to |n.d|, and a crack that always
 * takes the largest goes along the grid wherever d is within 45 degrees of an axis. Drawn by lot
 * (E. Louis, F. Guinea, Europhys. Lett. 3 (1987) 871), a link goes with the probability q over the
 * sum of all q > 0: the staircase then has the direction of its plane in the mean. The lot is a
 * function of the cell's place on its grid, so the same on any ranks and devices. */
#ifndef DEMOCLES_LAW_PRINCIPAL_H
#define DEMOCLES_LAW_PRINCIPAL_H

#include "law_stress.h"

/* Squarings of the stress for its direction: two principal values that differ by 1/1000 of the
 * largest are then told apart by e^-4. */
#define PRINCIPAL_SQUARINGS 12

/* s1 >= sigma_c; inverse: 1/sigma_c [1/Pa], 0: no limit. */
LAW int principal_fails(struct stress s, real inverse)
{
    real x = r_fma(-inverse, s.xx, (real)1), y = r_fma(-inverse, s.yy, (real)1),
         z = r_fma(-inverse, s.zz, (real)1);
    real yz = inverse * s.yz, zx = inverse * s.zx, xy = inverse * s.xy;
    real second = r_fma(x, y, -xy * xy);
    real across = r_fma(x, yz * yz, r_fma(y, zx * zx, (real)2 * (yz * zx) * xy));
    return !(x > 0 && second > 0 && r_fma(z, second, -across) > 0);
}

/* Along the principal direction of s1, any length but 0; in the plane of two that are equal some
 * direction. The powers of S + |S| I, which has no negative value, tend to the projector on it. */
LAW vec3 principal_direction(struct stress s)
{
    real size = r_sqrt(r_fma(s.xx, s.xx,
        r_fma(s.yy, s.yy,
            r_fma(s.zz, s.zz, (real)2 * r_fma(s.yz, s.yz, r_fma(s.zx, s.zx, s.xy * s.xy))))));
    struct stress m = s;
    m.xx += size;
    m.yy += size;
    m.zz += size;
    for (int k = 0; k < PRINCIPAL_SQUARINGS; k++) {
        real scale = (real)1 / (m.xx + m.yy + m.zz);
        vec3 x = v3_scale(scale, v3(m.xx, m.xy, m.zx)), y = v3_scale(scale, v3(m.xy, m.yy, m.yz)),
             z = v3_scale(scale, v3(m.zx, m.yz, m.zz));
        m.xx = v3_dot(x, x);
        m.yy = v3_dot(y, y);
        m.zz = v3_dot(z, z);
        m.yz = v3_dot(y, z);
        m.zx = v3_dot(z, x);
        m.xy = v3_dot(x, y);
    }
    return m.xx >= m.yy && m.xx >= m.zz ? v3(m.xx, m.xy, m.zx)
           : m.yy >= m.zz               ? v3(m.xy, m.yy, m.yz)
                                        : v3(m.zx, m.yz, m.zz);
}

/* s1 >= sigma_c (1 + rise q^2) for a stress of which s1 >= sigma_c is known. d: its direction;
 * rise 0: a strength that does not depend on it. */
LAW int principal_runs(struct stress s, vec3 d, real inverse, real rise)
{
    real x = d.x * d.x, y = d.y * d.y, z = d.z * d.z, size = x + (y + z);
    real across = (real)2 * r_fma(x, y, r_fma(y, z, z * x)) / (size * size);
    real pull = r_fma(s.xx, x,
        r_fma(s.yy, y,
            r_fma(s.zz, z,
                (real)2 * r_fma(s.yz, d.y * d.z, r_fma(s.zx, d.z * d.x, s.xy * (d.x * d.y))))));
    return !(rise > 0) || inverse * pull >= size * r_fma(rise, across * across, (real)1);
}

/* q of a face; outward: component of d on its outward normal. */
LAW real principal_pull(vec3 force, vec3 d, real outward)
{
    real pull = v3_dot(force, d);
    return outward < 0 ? -pull : pull;
}

#endif
