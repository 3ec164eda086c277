/* Walls have no images: a wall that can be touched across a periodic face has to be the same on
 * either side, one period apart.
 *
 * Elements reach a largest radius R beyond a face. There a plane has to be parallel to the period,
 * a cylinder too, and to reach as far; triangles and rectangles have to repeat: what the slab
 * within R of one face cuts out of them lies, shifted by the period, on the wall, tested at the
 * corners and the middle of each cut. Walls that move are tested at places along their way. */
#include <math.h>
#include <stdlib.h>

#include "comm/fail.h"
#include "generate_parts.h"
#include "kernels/contact/law_wall.h"
#include "shape/bvh.h"
#include "shape/walls.h"

enum { PLACES = 33, CORNERS_MOST = 12 };
#define ROUNDING 1e-9 /* of coordinates that are just out of reach */
#define PARALLEL 1e-9 /* component of a unit vector */
#define SAME 1e-3     /* share of the radius within which a surface repeats */

/* A wall at one of its places, and the faces of one direction. */
struct face {
    const struct scene *scene;
    const struct walls *walls;
    const struct bvh *bvh; /* NULL: planes alone */
    int w, axis;
    struct wall_frame frame;
    double low, high, reach; /* [m] */
};

/* Least distance of a point to the wall. */
struct nearest {
    const struct face *face;
    pvec3 x; /* in the wall's frame [m] */
    double distance;
};

static void visit(int item, void *context)
{
    struct nearest *n = context;
    const struct walls *walls = n->face->walls;
    struct wall_primitive p = WALL_PRIMITIVE(walls->primitive, walls->first[n->face->w] + item);
    n->distance = fmin(n->distance, fabs(wall_closest(p, n->x).distance));
}

static bool is_on_wall(const struct face *f, pvec3 world)
{
    double near = SAME * f->reach;
    struct nearest n = {f, wall_to_reference(f->frame, world), HUGE_VAL};
    double low[3] = {n.x.x - near, n.x.y - near, n.x.z - near},
           high[3] = {n.x.x + near, n.x.y + near, n.x.z + near};
    bvh_visit(f->bvh, low, high, visit, &n);
    return n.distance <= near;
}

static double part(pvec3 x, int axis)
{
    return axis == 0 ? x.x : axis == 1 ? x.y : x.z;
}

/* The part of a polygon with sign (x_axis - at) >= 0; returns its number of corners. */
static int cut(const pvec3 *in, int n, int axis, double at, double sign, pvec3 *out)
{
    int n_out = 0;
    for (int k = 0; k < n; k++) {
        pvec3 a = in[k], b = in[(k + 1) % n];
        double da = sign * (part(a, axis) - at), db = sign * (part(b, axis) - at);
        if (da >= 0) out[n_out++] = a;
        if ((da >= 0) != (db >= 0)) out[n_out++] = p3_fma(da / (da - db), p3_sub(b, a), a);
    }
    return n_out;
}

static pvec3 shifted(pvec3 x, int axis, double by)
{
    return p3_add(x, p3(axis == 0 ? by : 0, axis == 1 ? by : 0, axis == 2 ? by : 0));
}

/* Bounds along coordinate a of what can be touched near the face `at`: within reach of it, and,
 * along the others, not far beyond the domain, which nothing leaves but by mistake. */
static void bounds_of(const struct face *f, double at, int a, double *low, double *high)
{
    const struct domain *d = &f->scene->domain;
    *low = a == f->axis ? at - f->reach : d->min[a] - 2 * f->reach;
    *high = a == f->axis ? at + f->reach : d->max[a] + 2 * f->reach;
}

/* Whether what a polygon has near the face `at` is on the wall at the other face, too. */
static bool repeats_at(const struct face *f, const pvec3 *corner, int n, double at, double other)
{
    pvec3 some[CORNERS_MOST], rest[CORNERS_MOST], middle = p3(0, 0, 0);
    for (int k = 0; k < n; k++) rest[k] = corner[k];
    for (int a = 0; a < 3; a++) {
        double low, high;
        bounds_of(f, at, a, &low, &high);
        n = cut(rest, n, a, low, 1, some);
        n = cut(some, n, a, high, -1, rest);
    }
    if (n == 0) return true;
    for (int k = 0; k < n; k++) {
        middle = p3_fma(1.0 / n, rest[k], middle);
        if (!is_on_wall(f, shifted(rest[k], f->axis, other - at))) return false;
    }
    return is_on_wall(f, shifted(middle, f->axis, other - at));
}

static bool polygon_repeats(const struct face *f, struct wall_primitive p)
{
    pvec3 corner[4] = {p.a, p.b, p.c, p.c};
    int n = 3;
    if (p.kind == WALL_RECTANGLE) {
        n = 4;
        for (int k = 0; k < 4; k++) {
            double u = k == 0 || k == 3 ? -p.r : p.r, v = k < 2 ? -p.s : p.s;
            corner[k] = p3_fma(u, p.b, p3_fma(v, p.c, p.a));
        }
    }
    for (int k = 0; k < n; k++) corner[k] = wall_to_world(f->frame, corner[k]);
    return repeats_at(f, corner, n, f->low, f->high) && repeats_at(f, corner, n, f->high, f->low);
}

/* A cylinder reaches radius (1 - axis_a^2)^(1/2) past its ends along coordinate a. */
static bool cylinder_repeats(const struct face *f, struct wall_primitive p)
{
    pvec3 direction = wall_turn(f->frame, p.b), from = wall_to_world(f->frame, p.a);
    bool is_near[2] = {true, true}, goes_through = false;
    for (int a = 0; a < 3; a++) {
        double along = part(direction, a), start = part(from, a), end = start + p.s * along,
               more = p.r * sqrt(fmax(0, 1 - along * along)), low, high;
        for (int side = 0; side < 2; side++) {
            bounds_of(f, side ? f->high : f->low, a, &low, &high);
            is_near[side] =
                is_near[side] && fmax(start, end) + more > low && fmin(start, end) - more < high;
        }
        if (a == f->axis)
            goes_through = fabs(along) > 1 - PARALLEL && fmin(start, end) <= f->low - f->reach &&
                           fmax(start, end) >= f->high + f->reach;
    }
    return goes_through || (!is_near[0] && !is_near[1]);
}

/* Parallel to the period, or out of reach of the whole domain. */
static bool plane_repeats(const struct face *f, struct wall_primitive p)
{
    const struct domain *d = &f->scene->domain;
    pvec3 normal = wall_turn(f->frame, p.b), point = wall_to_world(f->frame, p.a);
    double least = HUGE_VAL;
    if (fabs(part(normal, f->axis)) < PARALLEL) return true;
    for (int k = 0; k < 8; k++) {
        pvec3 x = p3(k & 1 ? d->max[0] : d->min[0], k & 2 ? d->max[1] : d->min[1],
            k & 4 ? d->max[2] : d->min[2]);
        least = fmin(least, p3_dot(p3_sub(x, point), normal));
    }
    return least >= f->reach;
}

static bool wall_repeats(const struct face *f)
{
    for (int k = f->walls->first[f->w]; k < f->walls->first[f->w + 1]; k++) {
        struct wall_primitive p = WALL_PRIMITIVE(f->walls->primitive, k);
        bool repeats = p.kind == WALL_PLANE                        ? plane_repeats(f, p)
                       : p.kind == WALL_PIPE || p.kind == WALL_ROD ? cylinder_repeats(f, p)
                                                                   : polygon_repeats(f, p);
        if (!repeats) return false;
    }
    return true;
}

/* False after a message. */
static bool check_place(struct face *f, double time, struct scene_errors *errors)
{
    const struct wall *wall = f->walls->wall + f->w;
    const struct domain *d = &f->scene->domain;
    for (f->axis = 0; f->axis < 3; f->axis++) {
        if (!d->periodic[f->axis]) continue;
        f->low = d->min[f->axis];
        f->high = d->max[f->axis];
        if (wall_repeats(f)) continue;
        scene_errors_add(errors,
            "%s:%d: wall '%s' reaches over a periodic face, %c = %g m or %g m, or comes within %g "
            "m of it (the largest radius), at t = %g s, and is not the same beyond the other one: "
            "walls have no images; let it end before that, or go on beyond both faces",
            f->scene->path, wall->line, wall->name, "xyz"[f->axis], f -> low, f -> high, f -> reach,
            time);
        return false;
    }
    return true;
}

static void check_wall(struct face *f, struct wall_pose *pose, struct scene_errors *errors)
{
    const struct wall *wall = f->walls->wall + f->w;
    double begin = wall->appear_at, end = fmin(wall->remove_at, f->scene->time.end);
    int n = f->walls->moves[f->w] ? PLACES : 1;
    for (int k = 0; k < n; k++) {
        double time = n > 1 ? begin + (end - begin) * k / (n - 1) : begin;
        /* places do not depend on the step, so one step leads there */
        if (time > 0) walls_poses(f->walls, time, 1, 1, pose);
        else walls_poses(f->walls, 1e-9, 0, 1, pose);
        const double *r = pose[f->w].rotation, *t = pose[f->w].translation;
        f->frame = (struct wall_frame){
            p3(r[0], r[1], r[2]), p3(r[3], r[4], r[5]), p3(r[6], r[7], r[8]), p3(t[0], t[1], t[2])};
        if (!check_place(f, time, errors)) return;
    }
}

void generate_check_periodic(const struct scene *scene, const struct walls *walls,
    const struct elements_host *elements, struct scene_errors *errors)
{
    const bool *periodic = scene->domain.periodic;
    struct face face = {.scene = scene, .walls = walls};
    struct wall_pose *pose = fail_alloc((size_t)walls->n_wall * sizeof *pose);
    for (int64_t i = 0; i < elements->n; i++) face.reach = fmax(face.reach, elements->radius[i]);
    face.reach *= 1 - ROUNDING;
    for (int w = 0; w < walls->n_wall && (periodic[0] || periodic[1] || periodic[2]); w++) {
        bool is_finite = walls->wall[w].kind != SURFACE_PLANE && walls->wall[w].kind != SURFACE_BOX;
        struct bvh *bvh = is_finite ? bvh_create(walls->low + 3 * walls->first[w],
                                          walls->high + 3 * walls->first[w],
                                          walls->first[w + 1] - walls->first[w])
                                    : NULL;
        face.w = w;
        face.bvh = bvh;
        check_wall(&face, pose, errors);
        bvh_free(bvh);
    }
    free(pose);
}
