/* The loop over candidates. Compiled in the precision of the test (types.h). */
#include "wall_reference.h"

#include "comm/fail.h"

#include <math.h>
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

static bool is_triangle(const struct walls *walls, int primitive)
{
    return walls->features[6 * primitive] >= 0;
}

bool reference_is_flat(const struct walls *walls, int primitive)
{
    return wall_is_flat((int)walls->primitive[WALL_PRIMITIVE_WIDTH * primitive + 11]);
}

/* What the candidates are seen with. */
struct sight {
    const struct walls *walls;
    const struct wall_pose *pose;
    pvec3 x;
    preal radius;
};

static struct wall_closest closest_of(const struct sight *sight, int primitive, pvec3 x)
{
    struct wall_closest c = wall_closest_moved(primitive_of(sight->walls, primitive),
        frame_of(sight->pose + sight->walls->wall_of[primitive]), x);
    c.D = p3_scale(c.distance, c.n);
    return c;
}

/* Whether s takes away that t is a local minimum. */
static bool hides(
    const struct sight *sight, int s, struct wall_closest at_s, int t, struct wall_closest at_t)
{
    const struct walls *walls = sight->walls;
    if (at_t.feature == 0 || !(at_t.distance < (preal)1.5 * sight->radius)) return false;
    if (walls->wall_of[s] == walls->wall_of[t])
        return is_triangle(walls, t) && wall_hides(at_s, WALL_FEATURES(walls->features, s), at_t,
                                            WALL_FEATURES(walls->features, t), sight->radius);
    pvec3 p = p3_add(sight->x, at_t.D);
    preal size = (preal)fmax(fmax(fabs((double)p.x), fabs((double)p.y)), fabs((double)p.z));
    return at_s.distance < at_t.distance - WALL_TIE * sight->radius &&
           wall_is_flush(closest_of(sight, s, p), size, sight->radius);
}

static bool is_minimum(const struct sight *sight, const int *candidate, int n,
    const struct wall_closest *all, int t, const struct reference_contact *kept, int n_kept)
{
    for (int s = 0; s < n; s++)
        if (s != t && hides(sight, candidate[s], all[s], candidate[t], all[t])) return false;
    for (int k = 0; k < n_kept; k++)
        if (reference_is_flat(sight->walls, candidate[t]) &&
            reference_is_flat(sight->walls, kept[k].primitive) &&
            all[t].distance < (preal)1.5 * sight->radius &&
            wall_coincides(kept[k].closest, all[t], sight->radius))
            return false;
    return true;
}

static struct fillet_plane plane_of(
    const struct sight *sight, const struct reference_contact *contact)
{
    struct wall_frame frame = frame_of(sight->pose + sight->walls->wall_of[contact->primitive]);
    return fillet_plane(contact->closest.n, contact->closest.distance,
        wall_room(
            primitive_of(sight->walls, contact->primitive), wall_to_reference(frame, sight->x)));
}

static bool may_join(
    const struct sight *sight, const struct reference_contact *contact, int s, int t)
{
    const struct walls *walls = sight->walls;
    return s != t && is_triangle(walls, contact[t].primitive) &&
           walls->wall_of[contact[s].primitive] == walls->wall_of[contact[t].primitive] &&
           contact[t].closest.distance < (preal)1.5 * sight->radius;
}

/* The deepest valley of one of n minima. */
static void join(const struct sight *sight, struct reference_contact *contact, int n, int t)
{
    struct reference_contact *own = &contact[t];
    own->partner = -1;
    own->valley = plane_of(sight, own);
    for (int s = 0; s < n; s++) {
        if (!may_join(sight, contact, s, t)) continue;
        struct fillet_plane valley =
            fillet_of(plane_of(sight, own), plane_of(sight, &contact[s]), sight->radius);
        if (!(valley.distance < own->valley.distance)) continue;
        own->valley = valley;
        own->partner = s;
    }
}

/* Its share, when all valleys are known. */
static void share(const struct sight *sight, struct reference_contact *contact, int n, int t)
{
    struct reference_contact *own = &contact[t];
    own->share = 1;
    for (int s = 0; s < n; s++)
        if (may_join(sight, contact, s, t) &&
            fillet_is_first(contact[s].valley.distance, contact[s].closest.distance, s,
                own->valley.distance, own->closest.distance, t))
            own->share *= (preal)1 - fillet_hides(p3_dot(own->closest.n, contact[s].closest.n));
}

int reference_contacts(const struct walls *walls, const struct wall_pose *pose, const double x[3],
    double radius, const int *candidate, int n_candidate, struct reference_contact *out)
{
    struct sight sight = {walls, pose, point_of(x), (preal)radius};
    struct wall_closest *all = fail_alloc(((size_t)n_candidate + 1) * sizeof *all);
    int n = 0;
    for (int t = 0; t < n_candidate; t++) all[t] = closest_of(&sight, candidate[t], sight.x);
    for (int t = 0; t < n_candidate; t++) {
        if (!pose[walls->wall_of[candidate[t]]].active ||
            !is_minimum(&sight, candidate, n_candidate, all, t, out, n))
            continue;
        out[n].primitive = candidate[t];
        out[n++].closest = all[t];
    }
    for (int t = 0; t < n; t++) join(&sight, out, n, t);
    for (int t = 0; t < n; t++) share(&sight, out, n, t);
    for (int t = 0; t < n; t++) {
        if (!(out[t].share < (preal)1)) continue;
        out[t].partner = -1;
        out[t].valley = plane_of(&sight, &out[t]);
    }
    free(all);
    return n;
}

bool reference_acts(const struct reference_contact *contact, int n, int primitive, preal radius)
{
    for (int k = 0; k < n; k++)
        if (contact[k].primitive == primitive)
            return contact[k].share > 0 && contact[k].valley.distance < radius;
    return false;
}
