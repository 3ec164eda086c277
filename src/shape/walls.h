/* The walls of a scene as one flat table of primitives, ready for a device, and their motion.
 *
 * Primitives are ordered by (wall, triangle); each is a row of kernels/contact/law_wall.h in its
 * wall's own frame, the place at t = 0 without motion. The motion of a wall is a pose per step,
 * computed here on the host (sines and cosines are no business of a device that must give the same
 * bits as another). Knows no device, no element list and no force. Every rank holds all walls. */
#ifndef DEMOCLES_WALLS_H
#define DEMOCLES_WALLS_H

#include "scene/scene.h"

#include <stdint.h>

struct walls {
    const struct wall *wall; /* [n_wall], the scene's; borrowed */
    int n_wall;
    int n_primitive;
    /* [n_wall + 1] primitives of wall w: first[w] <= k < first[w + 1]; k - first[w] is the triangle
     * index */
    int *first;
    int *wall_of;      /* [n_primitive] */
    double *primitive; /* [n_primitive][12] WALL_PRIMITIVE rows [m] */
    /* [n_primitive][3] bounds in the wall's frame [m]; infinite for planes */
    double *low, *high;
    double *wall_low, *wall_high; /* [n_wall][3] of a whole wall */
    /* [n_primitive][6] WALL_FEATURES rows: numbers of edges and vertices; -1 where not a
     * triangle */
    int *features;
    int n_feature; /* edges and vertices of all meshes */
    /* [n_feature + 1] triangles that share feature f: share[share_first[f]] ..., ascending */
    int *share_first;
    int *share; /* [6 x triangles] primitives */
    int *moves; /* [n_wall] 1: its place depends on time */
    int n_moving;
    int n_of_kind[5]; /* by WALL_PLANE ... WALL_TRIANGLE of law_wall.h */
    int n_dropped;    /* degenerate triangles that the files had */
};

/* Builds the table, reading STL files. Messages (file:line of the scene in front) are added to
 * `errors`; NULL if there were any. Not collective. */
struct walls *walls_create(const struct scene *scene, struct scene_errors *errors);
void walls_free(struct walls *walls);

/* The two in-plane axes of a rectangle: leave out the coordinate axis nearest to the normal (z
 * before y before x where equal); the first of the other two, projected into the plane, is u; v is
 * perpendicular to both, on the positive side of the second. A normal +-x gives (y, z), +-y (x, z),
 * +-z (x, y). */
void walls_axes(const double normal[3], double u[3], double v[3]);

/* Whether two flat surfaces, one of them a rectangle, lie in one plane and touch each other there
 * (walls that move: may touch), within some 1e-5 of their coordinates. */
bool walls_flush(const struct walls *walls);

/* Writes the rooms of law_wall.h into the rows of a mesh, from valleys of less than 30 degrees;
 * walls_create calls it. */
void walls_room(struct walls *walls, int w);

/* Rigid place and motion of one wall at one step n: a point q of the wall's frame is at p = R q +
 * t. velocity V, spin W and centre c belong to the half step before n: V + W x (p_h - c) = (p^n -
 * p^(n-1))/dt, p_h = (p^n + p^(n-1))/2, so work closes. */
struct wall_pose {
    double rotation[9];    /* R, by rows */
    double translation[3]; /* t [m] */
    double velocity[3];    /* V [m/s] */
    /* W [rad/s]: 2 tan(rate dt/2)/dt along the axis, the chord's rate and not the arc's */
    double spin[3];
    double centre[3]; /* c [m] */
    int active;       /* between appear_at and remove_at */
    /* the same of step n itself: a point at p moves with V + W x (p - c) */
    double velocity_end[3], spin_end[3], centre_end[3];
};

/* Poses at the steps first_step <= s < first_step + n, time s dt, into out [n][n_wall].
 * Displacement: velocity t + amplitude sin(2 pi frequency t + phase), and a turn by rotation_rate t
 * about the axis through rotation_center, which moves along. A wall is active from the first step
 * at or after appear_at until the first at or after remove_at. Libraries may differ in the last bit
 * of a sine: where ranks run on different machines, let one rank compute and broadcast. */
void walls_poses(
    const struct walls *walls, double dt, int64_t first_step, int n, struct wall_pose *out);

/* An upper bound of how far any point of wall w moves from pose a to pose b [m]. For a plane, which
 * has no end: how much the distance to it changes for any point of the box low..high (the elements'
 * bounds); a plane that only slides in itself gives 0. */
double walls_displacement(const struct walls *walls, int w, const struct wall_pose *a,
    const struct wall_pose *b, const double low[3], const double high[3]);

#endif
