/* Where walls are, and how fast. */
#include "walls.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

struct place {
    /* R; where the rotation centre has come to [m], and how fast it is [m/s] */
    double rotation[9], centre[3], velocity[3];
};

/* R = cos I + sin [a]x + (1 - cos) a a^T about the unit vector a, by rows (Rodrigues). */
static void rotation_about(const double a[3], double angle, double rotation[9])
{
    /* 1 - cos without cancellation */
    double c = cos(angle), s = sin(angle), half = sin(0.5 * angle), versine = 2 * half * half;
    double cross[9] = {0, -a[2], a[1], a[2], 0, -a[0], -a[1], a[0], 0};
    for (int k = 0; k < 9; k++)
        rotation[k] = (k % 4 == 0 ? c : 0) + s * cross[k] + versine * a[k / 3] * a[k % 3];
}

static struct place place_at(const struct wall *wall, double time)
{
    struct place place = {.rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1}};
    double rate = 2 * pi * wall->frequency, angle = rate * time + wall->phase;
    double swing = sin(angle), swing_rate = rate * cos(angle);
    for (int a = 0; a < 3; a++) {
        place.centre[a] =
            wall->rotation_center[a] + (wall->velocity[a] * time + wall->amplitude[a] * swing);
        place.velocity[a] = wall->velocity[a] + wall->amplitude[a] * swing_rate;
    }
    if (wall->rotation_rate > 0 || wall->rotation_rate < 0)
        rotation_about(wall->rotation_axis, wall->rotation_rate * time, place.rotation);
    return place;
}

/* First step at or after `time`; a billionth of a step forgives the rounding of time/dt. */
static double step_of(double time, double dt)
{
    return ceil(time / dt - 1e-9);
}

static struct wall_pose pose_between(const struct wall *wall, const struct place *before,
    const struct place *after, double dt, int64_t step)
{
    struct wall_pose pose = {.active = (double)step >= step_of(wall->appear_at, dt) &&
                                       (double)step < step_of(wall->remove_at, dt)};
    /* a turn by th moves a point by 2 tan(th/2) a x (mean of its two places) */
    double chord = 2 * tan(0.5 * wall->rotation_rate * dt) / dt;
    for (int k = 0; k < 9; k++) pose.rotation[k] = after->rotation[k];
    for (int a = 0; a < 3; a++) {
        double turned = 0;
        for (int b = 0; b < 3; b++) turned += after->rotation[3 * a + b] * wall->rotation_center[b];
        pose.translation[a] = after->centre[a] - turned;
        pose.velocity[a] = (after->centre[a] - before->centre[a]) / dt;
        pose.centre[a] = 0.5 * (after->centre[a] + before->centre[a]);
        pose.spin[a] = chord * wall->rotation_axis[a];
        pose.velocity_end[a] = after->velocity[a];
        pose.spin_end[a] = wall->rotation_rate * wall->rotation_axis[a];
        pose.centre_end[a] = after->centre[a];
    }
    return pose;
}

void walls_poses(
    const struct walls *walls, double dt, int64_t first_step, int n, struct wall_pose *out)
{
    for (int w = 0; w < walls->n_wall; w++) {
        const struct wall *wall = walls->wall + w;
        struct place before = place_at(wall, (double)(first_step - 1) * dt);
        for (int s = 0; s < n; s++) {
            struct place after = place_at(wall, (double)(first_step + s) * dt);
            out[(size_t)s * (size_t)walls->n_wall + (size_t)w] =
                pose_between(wall, &before, &after, dt, first_step + s);
            before = after;
        }
    }
}

static void to_world(const struct wall_pose *pose, const double q[3], double p[3])
{
    const double *r = pose->rotation;
    for (int a = 0; a < 3; a++)
        p[a] = r[3 * a] * q[0] + r[3 * a + 1] * q[1] + r[3 * a + 2] * q[2] + pose->translation[a];
}

static void pick_corner(int k, const double low[3], const double high[3], double p[3])
{
    for (int a = 0; a < 3; a++) p[a] = k >> a & 1 ? high[a] : low[a];
}

/* (x - p).m at a pose, for a plane through p0 with normal m0 in its frame. */
static double plane_distance(const double *row, const struct wall_pose *pose, const double x[3])
{
    double point[3], tip[3], end[3] = {row[0] + row[3], row[1] + row[4], row[2] + row[5]},
                             distance = 0;
    to_world(pose, row, point);
    to_world(pose, end, tip);
    for (int a = 0; a < 3; a++) distance += (x[a] - point[a]) * (tip[a] - point[a]);
    return distance;
}

/* Both distances are affine in x, so their difference is largest at a corner of the box. */
static double planes_displacement(const struct walls *walls, int w, const struct wall_pose *a,
    const struct wall_pose *b, const double low[3], const double high[3])
{
    double largest = 0, x[3];
    for (int k = walls->first[w]; k < walls->first[w + 1]; k++)
        for (int corner = 0; corner < 8; corner++) {
            pick_corner(corner, low, high, x);
            const double *row = walls->primitive + 12 * k;
            largest = fmax(largest, fabs(plane_distance(row, b, x) - plane_distance(row, a, x)));
        }
    return largest;
}

double walls_displacement(const struct walls *walls, int w, const struct wall_pose *a,
    const struct wall_pose *b, const double low[3], const double high[3])
{
    if (walls->wall[w].kind == SURFACE_PLANE || walls->wall[w].kind == SURFACE_BOX)
        return planes_displacement(walls, w, a, b, low, high);
    double largest = 0;
    /* |p_b - p_a| is convex in q: largest at a corner of the wall's own box */
    for (int corner = 0; corner < 8; corner++) {
        double q[3], pa[3], pb[3];
        pick_corner(corner, walls->wall_low + 3 * w, walls->wall_high + 3 * w, q);
        to_world(a, q, pa);
        to_world(b, q, pb);
        largest = fmax(
            largest, sqrt((pb[0] - pa[0]) * (pb[0] - pa[0]) + (pb[1] - pa[1]) * (pb[1] - pa[1]) +
                          (pb[2] - pa[2]) * (pb[2] - pa[2])));
    }
    return largest;
}
