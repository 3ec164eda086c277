/* The loop over candidates. Compiled in the precision of the test (types.h). */
#include "wall_reference.h"

#include "comm/fail.h"

#include <stdlib.h>

static pvec3 point_of(const double *p)
{
    return p3((preal)p[0], (preal)p[1], (preal)p[2]);
}

static struct wall_frame frame_of(const struct wall_pose *pose)
{
    const double *r = pose->rotation, *t = pose->translation;
    struct wall_frame frame = {point_of(r), point_of(r + 3), point_of(r + 6), point_of(t)};
    return frame;
}

static struct wall_primitive primitive_of(const struct walls *walls, int k)
{
    preal row[WALL_PRIMITIVE_WIDTH];
    for (int c = 0; c < WALL_PRIMITIVE_WIDTH; c++)
        row[c] = (preal)walls->primitive[WALL_PRIMITIVE_WIDTH * k + c];
    return WALL_PRIMITIVE(row, 0);
}

static bool is_hidden(const struct walls *walls, const int *candidate, int n,
    const struct wall_closest *all, int t, preal radius)
{
    if (all[t].feature == 0 || walls->features[6 * candidate[t]] < 0) return false;
    struct wall_features own = WALL_FEATURES(walls->features, candidate[t]);
    for (int s = 0; s < n; s++)
        if (wall_hides(all[s], WALL_FEATURES(walls->features, candidate[s]), all[t], own, radius))
            return true;
    return false;
}

/* Whether a kept triangle of the same wall has the same point. */
static bool is_double(const struct walls *walls, const int *kept, int n_kept,
    const struct wall_closest *closest, int primitive, struct wall_closest t, preal radius)
{
    if (walls->features[6 * primitive] < 0) return false;
    for (int s = 0; s < n_kept; s++)
        if (walls->wall_of[kept[s]] == walls->wall_of[primitive] &&
            wall_coincides(closest[s], t, radius))
            return true;
    return false;
}

int reference_contacts(const struct walls *walls, const struct wall_pose *pose, const double x[3],
    double radius, const int *candidate, int n_candidate, int *kept, struct wall_closest *closest)
{
    struct wall_closest *all = fail_alloc((size_t)n_candidate * sizeof *all);
    int n_kept = 0;
    for (int t = 0; t < n_candidate; t++)
        all[t] = wall_closest_moved(primitive_of(walls, candidate[t]),
            frame_of(pose + walls->wall_of[candidate[t]]), point_of(x));
    for (int t = 0; t < n_candidate; t++) {
        if (!pose[walls->wall_of[candidate[t]]].active ||
            is_hidden(walls, candidate, n_candidate, all, t, (preal)radius) ||
            is_double(walls, kept, n_kept, closest, candidate[t], all[t], (preal)radius))
            continue;
        kept[n_kept] = candidate[t];
        closest[n_kept++] = all[t];
    }
    free(all);
    return n_kept;
}
