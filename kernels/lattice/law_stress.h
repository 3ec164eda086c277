/* Stress of one cell from the forces through its six faces (links, loads; a free face has none), so
 * it is the stress of the very forces that move it.
 *
 * Row a is the force per area across the faces with normal a: (f^{a+} - f^{a-})/(2 h^2), f the
 * force on the cell through that face. This is the Love-Weber average over the volume, exact for
 * constant stress with all tractions on. At a free face it is the true average, half of the inside
 * for components that vanish at the surface; `extrapolate` divides by the number of faces with a
 * force instead: better for peaks, needed at clamps.
 *
 * The symmetric part is the stress, the antisymmetric part shows the error (what the couples of the
 * links carry). An axis without any force on its faces has no shear of its own, as across a plate
 * of one layer: the other axis' is taken then, not half of it.
 *
 * WITH_TURN: normals turn with the cell, forces are in world components; stress_in_cell makes both
 * the cell's, stress_in_world both the world's. */
#ifndef DEMOCLES_LAW_STRESS_H
#define DEMOCLES_LAW_STRESS_H

#include "common/quat.h"

/* [Pa]; x.y is sigma_xy: normal x, direction y. */
struct stress_rows {
    vec3 x, y, z;
};

struct stress {
    real xx, yy, zz, yz, zx, xy; /* symmetric part [Pa] */
    vec3 skew;                   /* (yz - zy, zx - xz, xy - yx)/2 [Pa] */
};

/* Whether a face along the axis carries a force; faces: mask of links and loaded faces, bits -x,
 * +x, -y, +y, -z, +z. */
LAW int stress_faces(int faces, int axis)
{
    return (faces >> (2 * axis) & 1) + (faces >> (2 * axis + 1) & 1);
}

/* plus, minus: force on the cell through the faces +a, -a [N]; per_area: 1/h^2 [1/m2]. */
LAW vec3 stress_row(vec3 plus, vec3 minus, int axis, int faces, int extrapolate, real per_area)
{
    real scale = extrapolate && stress_faces(faces, axis) == 1 ? per_area : (real)0.5 * per_area;
    return v3_scale(scale, v3_sub(plus, minus));
}

/* Rows with world components to components along the cell's axes. */
LAW struct stress_rows stress_in_cell(struct stress_rows r, struct quat q)
{
    r.x = v3_of_p3(quat_unrotate(q, p3_of_v3(r.x)));
    r.y = v3_of_p3(quat_unrotate(q, p3_of_v3(r.y)));
    r.z = v3_of_p3(quat_unrotate(q, p3_of_v3(r.z)));
    return r;
}

/* R S R^T: a stress in the cell's axes to the world's. */
LAW struct stress_rows stress_in_world(struct stress_rows r, struct quat q)
{
    vec3 x = v3_of_p3(quat_rotate(q, p3_of_v3(r.x))), y = v3_of_p3(quat_rotate(q, p3_of_v3(r.y))),
         z = v3_of_p3(quat_rotate(q, p3_of_v3(r.z)));
    vec3 c_x = v3_of_p3(quat_rotate(q, p3_of_v3(v3(x.x, y.x, z.x)))),
         c_y = v3_of_p3(quat_rotate(q, p3_of_v3(v3(x.y, y.y, z.y)))),
         c_z = v3_of_p3(quat_rotate(q, p3_of_v3(v3(x.z, y.z, z.z))));
    r.x = v3(c_x.x, c_y.x, c_z.x);
    r.y = v3(c_x.y, c_y.y, c_z.y);
    r.z = v3(c_x.z, c_y.z, c_z.z);
    return r;
}

/* The two parts of rows in one frame, that of the faces. */
LAW struct stress stress_parts(struct stress_rows r, int faces)
{
    struct stress s;
    int x = stress_faces(faces, 0) > 0, y = stress_faces(faces, 1) > 0,
        z = stress_faces(faces, 2) > 0;

    s.xx = r.x.x;
    s.yy = r.y.y;
    s.zz = r.z.z;
    s.yz = (y && z ? (real)0.5 : (real)1) * (r.y.z + r.z.y);
    s.zx = (z && x ? (real)0.5 : (real)1) * (r.z.x + r.x.z);
    s.xy = (x && y ? (real)0.5 : (real)1) * (r.x.y + r.y.x);
    s.skew = v3(y && z ? (real)0.5 * (r.y.z - r.z.y) : (real)0,
        z && x ? (real)0.5 * (r.z.x - r.x.z) : (real)0,
        x && y ? (real)0.5 * (r.x.y - r.y.x) : (real)0);
    return s;
}

/* Both indices once more, as rows. */
LAW struct stress_rows stress_symmetric(struct stress s)
{
    struct stress_rows r;
    r.x = v3(s.xx, s.xy, s.zx);
    r.y = v3(s.xy, s.yy, s.yz);
    r.z = v3(s.zx, s.yz, s.zz);
    return r;
}

/* Of the symmetric part [Pa]; the same in every frame. */
LAW real stress_von_mises(struct stress s)
{
    real a = s.xx - s.yy, b = s.yy - s.zz, c = s.zz - s.xx;
    real shear = r_fma(s.yz, s.yz, r_fma(s.zx, s.zx, s.xy * s.xy));
    return r_sqrt(r_fma((real)0.5, r_fma(a, a, r_fma(b, b, c * c)), (real)3 * shear));
}

#endif
