/* Stress of one cell from the forces through its faces (law_stress.h): links, and loads on faces
 * without link. Host and device alike.
 *
 * Of the loads on the two faces of an axis the row of the stress needs the force on the upper face
 * less that on the lower: twice the lever over h of those that keep their direction, and, along the
 * turned axis, what is left of the sum of t.n: pressures. Loads on a cell's centre cross no face.
 *
 * A face is loaded while the traction on it is not 0. Of an axis without links both faces count
 * then: the other one, if free, is known to bear 0. */
#ifndef DEMOCLES_LATTICE_THROUGH_H
#define DEMOCLES_LATTICE_THROUGH_H

#include "lattice_state.h"
#include "law_principal.h"

/* Forces on the cell through its links, by the mask's order; 0 where there is none [N]. */
struct lattice_through {
    vec3 x[2], y[2], z[2];
};

LAW vec3 lattice_load_pair(int axis, struct link_cell c, struct lattice_load l, real h)
{
    vec3 pair = v3_scale((real)2 / h, l.lever[axis]);
    real normal = v3_cycle(v3_add(l.lower, l.upper), axis).x,
         pressed = r_fma(h * h, normal, -v3_cycle(pair, axis).x);
    return v3_fma(pressed, lattice_turned(c, v3_uncycle(v3(1, 0, 0), axis)), pair);
}

/* The two bits of an axis whose faces bear the load. */
LAW int lattice_load_faces(int axis, vec3 pair)
{
    int is_loaded =
        pair.x > 0 || pair.x < 0 || pair.y > 0 || pair.y < 0 || pair.z > 0 || pair.z < 0;
    return is_loaded ? 3 << (2 * axis) : 0;
}

/* In the cell's axes with WITH_TURN, else in the world's [Pa]. links: mask; h: edge of the cell
 * [m]. */
LAW struct stress lattice_stress_of(struct lattice_through f, struct link_cell c,
    struct lattice_load load, int links, real h, int extrapolate)
{
    struct stress_rows r;
    real per_area = (real)1 / (h * h);
    int faces = links;

    if (WITH_LOADS) {
        vec3 x = lattice_load_pair(0, c, load, h), y = lattice_load_pair(1, c, load, h),
             z = lattice_load_pair(2, c, load, h);
        faces |= lattice_load_faces(0, x) | lattice_load_faces(1, y) | lattice_load_faces(2, z);
        f.x[1] = v3_add(f.x[1], x);
        f.y[1] = v3_add(f.y[1], y);
        f.z[1] = v3_add(f.z[1], z);
    }
    r.x = stress_row(f.x[1], f.x[0], 0, faces, extrapolate, per_area);
    r.y = stress_row(f.y[1], f.y[0], 1, faces, extrapolate, per_area);
    r.z = stress_row(f.z[1], f.z[0], 2, faces, extrapolate, per_area);
    return stress_parts(WITH_TURN ? stress_in_cell(r, c.q) : r, faces);
}

/* The same of a cell that the surface cuts: the force through the covered parts of the two faces of
 * an axis, over their area. Inside and outside of the surface alike this is exact for a constant
 * stress, and it is well conditioned in a sliver, where an average over the volume is not. share:
 * row of the table. */
LAW struct stress lattice_stress_cut(
    struct lattice_through f, struct link_cell c, int links, real h, __global const real *share)
{
    struct stress_rows r;
    real area[3];
    for (int a = 0; a < 3; a++) {
        real sum = (links >> (2 * a) & 1 ? share[SHARE_FACE + 2 * a] : (real)0) +
                   (links >> (2 * a + 1) & 1 ? share[SHARE_FACE + 2 * a + 1] : (real)0);
        area[a] = sum > 0 ? (real)1 / (sum * h * h) : (real)0;
    }
    r.x = v3_scale(area[0], v3_sub(f.x[1], f.x[0]));
    r.y = v3_scale(area[1], v3_sub(f.y[1], f.y[0]));
    r.z = v3_scale(area[2], v3_sub(f.z[1], f.z[0]));
    return stress_parts(WITH_TURN ? stress_in_cell(r, c.q) : r, links);
}

/* The link that breaks of a cell that fails, as a mask; 0 where none is pulled, or where the cell
 * bears more in this direction (law_principal.h). s: as lattice_stress_of gives it; lot: below 0,
 * the one pulled most. */
LAW int lattice_principal(struct lattice_through f, struct stress s, struct link_cell c, int links,
    real inverse, real rise, real lot)
{
    vec3 d = principal_direction(s),
         world = WITH_TURN ? v3_of_p3(quat_rotate(c.q, p3_of_v3(d))) : d;
    const real pull[6] = {principal_pull(f.x[0], world, -d.x), principal_pull(f.x[1], world, d.x),
        principal_pull(f.y[0], world, -d.y), principal_pull(f.y[1], world, d.y),
        principal_pull(f.z[0], world, -d.z), principal_pull(f.z[1], world, d.z)};
    real most = 0, sum = 0, passed = 0;
    int link = 0;
    links = principal_runs(s, d, inverse, rise) ? links : 0;
    for (int face = 0; face < 6; face++)
        if (links >> face & 1 && pull[face] > 0) sum += pull[face];
    for (int face = 0; face < 6; face++) {
        real share = links >> face & 1 ? r_max(pull[face], (real)0) : (real)0;
        if (lot < 0 ? share > most : share > 0 && passed <= lot * sum) {
            most = share;
            link = 1 << face;
        }
        passed += share;
    }
    return link;
}

/* Symmetric part in the world's axes. */
LAW struct stress lattice_stress_world(struct stress s, struct link_cell c)
{
    return WITH_TURN ? stress_parts(stress_in_world(stress_symmetric(s), c.q), 63) : s;
}

#endif
