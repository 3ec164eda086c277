/* Is the start possible? No two elements in one place, none outside the domain, none in a wall.
 * Each costs O(n). */
#include "shape/bvh.h"
#include "comm/fail.h"
#include "generate_parts.h"
#include "kernels/contact/law_wall.h"
#include "shape/walls.h"

#include <math.h>
#include <stdlib.h>

static const char *group_name(const struct scene *scene, const struct elements_host *e, int64_t i)
{
    return scene->group[e->group[i]].name;
}
static int group_line(const struct scene *scene, const struct elements_host *e, int64_t i)
{
    return scene->group[e->group[i]].line;
}

static void check_domain(
    const struct scene *scene, const struct elements_host *e, struct scene_errors *errors)
{
    int64_t n_out = 0, last = 0;
    if (!scene->domain.has_box) return;
    for (int64_t i = 0; i < e->n; i++) {
        const double *x = e->x + 3 * i;
        bool is_in = true;
        for (int a = 0; a < 3; a++)
            is_in = is_in && x[a] >= scene->domain.min[a] && x[a] <= scene->domain.max[a];
        if (is_in) continue;
        last = i;
        if (n_out++ < GENERATE_NAMED)
            scene_errors_add(errors,
                "%s:%d: element %lld of group '%s' at (%g, %g, %g) is outside the domain",
                scene->path, group_line(scene, e, i), (long long)i, group_name(scene, e, i), x[0],
                x[1], x[2]);
    }
    if (n_out > GENERATE_NAMED)
        scene_errors_add(errors, "%s:%d: and %lld more elements are outside the domain",
            scene->path, group_line(scene, e, last), (long long)(n_out - GENERATE_NAMED));
}

static void check_coincidence(
    const struct scene *scene, const struct elements_host *e, struct scene_errors *errors)
{
    const struct generate_overlaps *all = &e->overlaps;
    int64_t last = 0;
    for (int k = 0; k < GENERATE_NAMED && k < all->n_same; k++) {
        int64_t j = all->same[k][0], i = last = all->same[k][1];
        const double *x = e->x + 3 * i;
        scene_errors_add(errors,
            "%s:%d: element %lld of group '%s' and element %lld of group '%s' coincide at "
            "(%g, %g, %g)",
            scene->path, group_line(scene, e, i), (long long)j, group_name(scene, e, j),
            (long long)i, group_name(scene, e, i), x[0], x[1], x[2]);
    }
    if (all->n_same > GENERATE_NAMED)
        scene_errors_add(errors, "%s:%d: and %lld more elements coincide with others", scene->path,
            group_line(scene, e, last), (long long)(all->n_same - GENERATE_NAMED));
}

/* Of all images of a partner an element meets the nearest alone. Two of them can touch it, or it
 * itself, where the period is shorter than this. */
static void check_period(
    const struct scene *scene, const struct elements_host *e, struct scene_errors *errors)
{
    const struct domain *domain = &scene->domain;
    double largest = 0;
    for (int64_t i = 0; i < e->n; i++) largest = fmax(largest, 2 * e->radius[i]);
    for (int a = 0; a < 3; a++) {
        double length = domain->max[a] - domain->min[a];
        if (domain->periodic[a] && length < 2 * largest)
            scene_errors_add(errors,
                "%s: domain: periodic in %c over %g m, which has to be at least twice the largest "
                "diameter, %g m",
                scene->path, "xyz"[a], length, largest);
    }
}

static void check_overlaps(
    const struct scene *scene, const struct elements_host *e, struct scene_errors *errors)
{
    struct generate_overlaps all = e->overlaps;
    if (!(all.share > scene->domain.start_overlap)) return;
    int64_t i = all.element[0], j = all.element[1];
    const double *x = e->x + 3 * j;
    scene_errors_add(errors,
        "%s:%d: element %lld of group '%s' and element %lld of group '%s' at (%g, %g, %g) overlap "
        "by %.3g m, %.3g of the smaller radius, one of %lld pairs that overlap at the start; "
        "domain.start_overlap, the most that is accepted, is %g",
        scene->path, group_line(scene, e, j), (long long)i, group_name(scene, e, i), (long long)j,
        group_name(scene, e, j), x[0], x[1], x[2], all.depth, all.share, (long long)all.n,
        scene->domain.start_overlap);
}

void generate_check(
    const struct scene *scene, struct elements_host *elements, struct scene_errors *errors)
{
    int before = errors->n;
    check_domain(scene, elements, errors);
    check_period(scene, elements, errors);
    elements->overlaps = generate_overlaps(scene, elements);
    check_coincidence(scene, elements, errors);
    if (errors->n == before) check_overlaps(scene, elements, errors);
}

/* One sphere in one wall. */
struct probe {
    const struct walls *walls;
    int first; /* primitive of the wall's item 0 */
    pvec3 x;   /* in the wall's frame [m] */
    double radius;
    double depth;   /* deepest so far [m] */
    bool is_behind; /* of a one-sided surface */
};

static void visit_primitive(int item, void *context)
{
    struct probe *probe = context;
    struct wall_closest closest =
        wall_closest(WALL_PRIMITIVE(probe->walls->primitive, probe->first + item), probe->x);
    probe->depth = fmax(probe->depth, probe->radius - closest.distance);
    probe->is_behind = probe->is_behind || closest.distance < 0;
}

static bool is_in_wall(const struct walls *walls, const struct bvh *bvh, int w,
    const struct wall_pose *pose, const double x[3], double radius)
{
    const double *r = pose->rotation, *t = pose->translation;
    struct wall_frame frame = {
        p3(r[0], r[1], r[2]), p3(r[3], r[4], r[5]), p3(r[6], r[7], r[8]), p3(t[0], t[1], t[2])};
    struct probe probe = {.walls = walls,
        .first = walls->first[w],
        .x = wall_to_reference(frame, p3(x[0], x[1], x[2])),
        .radius = radius};
    double low[3] = {probe.x.x - radius, probe.x.y - radius, probe.x.z - radius},
           high[3] = {probe.x.x + radius, probe.x.y + radius, probe.x.z + radius};
    if (bvh) bvh_visit(bvh, low, high, visit_primitive, &probe);
    else
        for (int k = 0; k < walls->first[w + 1] - walls->first[w]; k++) visit_primitive(k, &probe);
    return probe.is_behind || probe.depth > 0.5 * radius;
}

int64_t generate_in_wall(const struct walls *walls, int w, const struct wall_pose *pose, int64_t n,
    const double *x, const double *radius, bool *is_in)
{
    bool is_finite = walls->wall[w].kind != SURFACE_PLANE && walls->wall[w].kind != SURFACE_BOX;
    int64_t n_in = 0;
    struct bvh *bvh =
        is_finite ? bvh_create(walls->low + 3 * walls->first[w], walls->high + 3 * walls->first[w],
                        walls->first[w + 1] - walls->first[w])
                  : NULL;
    for (int64_t i = 0; i < n; i++) {
        is_in[i] = is_in_wall(walls, bvh, w, pose, x + 3 * i, radius[i]);
        n_in += is_in[i];
    }
    bvh_free(bvh);
    return n_in;
}

void generate_check_walls(const struct scene *scene, const struct walls *walls,
    const struct elements_host *e, struct scene_errors *errors)
{
    struct wall_pose *pose = fail_alloc((size_t)walls->n_wall * sizeof *pose);
    bool *is_in = fail_alloc((size_t)e->n * sizeof *is_in);
    int64_t n_in = 0;
    walls_poses(walls, 1e-9, 0, 1, pose); /* places at t = 0 do not depend on the step */
    for (int w = 0; w < walls->n_wall; w++) {
        if (!pose[w].active) continue;
        generate_in_wall(walls, w, pose + w, e->n, e->x, e->radius, is_in);
        for (int64_t i = 0; i < e->n; i++) {
            const double *x = e->x + 3 * i;
            if (!is_in[i] || n_in++ >= GENERATE_NAMED) continue;
            scene_errors_add(errors,
                "%s:%d: element %lld of group '%s' at (%g, %g, %g) is inside wall '%s'",
                scene->path, walls->wall[w].line, (long long)i, group_name(scene, e, i), x[0], x[1],
                x[2], walls->wall[w].name);
        }
    }
    if (n_in > GENERATE_NAMED)
        scene_errors_add(errors, "%s: and %lld more elements are inside walls", scene->path,
            (long long)(n_in - GENERATE_NAMED));
    free(is_in);
    free(pose);
    generate_check_periodic(scene, walls, e, errors);
}
