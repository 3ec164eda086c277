/* Warnings that a stable time step may still be too large for accuracy. */
#include <math.h>
#include <stdlib.h>

#include "limit_parts.h"
#include "shape/walls.h"

/* Accuracy: steps per contact, share of the smallest radius and of the range of a bond per step. */
#define CONTACT_STEPS 20
#define SHARE 0.1
/* Overlap over the smaller radius that a scene may allow without a warning. Speeds are bounds: what
 * a run shows is watched with a sharper one (overlap.h). */
#define DEEP 0.75

/* Extent of elements, walls and domain [m]. */
static void extent(const struct scene *scene, const struct walls *walls,
    const struct elements_host *e, double size[3])
{
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (int64_t i = 0; i < e->n; i++)
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], e->x[3 * i + a]);
            high[a] = fmax(high[a], e->x[3 * i + a]);
        }
    for (int w = 0; walls && w < walls->n_wall; w++)
        for (int a = 0; a < 3; a++) {
            bool plane = walls->wall[w].kind == SURFACE_PLANE;
            double b[2] = {plane ? walls->wall[w].point[a] : walls->wall_low[3 * w + a],
                plane ? b[0] : walls->wall_high[3 * w + a]};
            low[a] = fmin(low[a], b[0]);
            high[a] = fmax(high[a], b[1]);
        }
    for (int a = 0; a < 3; a++) {
        size[a] = fmax(high[a] - low[a], 0);
        if (scene->domain.has_box) size[a] = scene->domain.max[a] - scene->domain.min[a];
    }
}

static double length(const double a[3])
{
    return sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

static double wall_speed(const struct wall *w, const double size[3])
{
    return length(w->velocity) + fabs(w->rotation_rate) * length(size) +
           2 * M_PI * w->frequency * length(w->amplitude);
}

double limit_speed(
    const struct scene *scene, const struct walls *walls, const struct elements_host *elements)
{
    double size[3], start = 0, wall = 0, potential = 0;
    extent(scene, walls, elements, size);
    for (int64_t i = 0; i < elements->n; i++) start = fmax(start, length(elements->v + 3 * i));
    for (int w = 0; w < scene->n_wall; w++) wall = fmax(wall, wall_speed(&scene->wall[w], size));
    for (int a = 0; a < 3; a++) potential += fabs(scene->gravity[a]) * size[a];
    return fmin(sqrt(start * start + 2 * potential),
               start + length(scene->gravity) * scene->time.end) +
           wall;
}

/* A contact and how deep it may get. */
struct deepest {
    double share, depth; /* [1] of the smaller radius; [m] */
    double speed;        /* [m/s] at which */
    int a, b;            /* material; of the other element, or the wall */
    bool is_wall;
};

/* The two ends, the shortest contact and the shortest range over its bond's crossing, as the loop
 * finds them. */
struct worst {
    double contact;                 /* [s] shortest contact of a pair or with a wall */
    double bond, range, bond_speed; /* [s] shortest crossing, [m], [m/s] */
    struct deepest deepest;
};

static void look_how_deep(struct deepest *deepest, const struct scene *scene,
    const struct limit_class *c, const struct limit_class *p, int wall, double speed)
{
    int b = p ? p->material : scene->wall[wall].material;
    struct contact_material m = limit_material_of(scene, c->material, b);
    struct limit_ends ends = {c->w, p ? p->w : 0, c->r, p ? p->r : 0};
    if (!(m.k_n > 0)) return;
    double depth = limit_depth(scene, m, ends, speed);
    double share = depth / (p ? fmin(c->r, p->r) : c->r);
    if (share > deepest->share)
        *deepest = (struct deepest){share, depth, speed, c->material, p ? b : wall, !p};
}

/* Relative speed [m/s] of two elements: without walls nothing but collisions turns them around, and
 * gravity pulls both alike. */
static double pair_speed(const struct scene *scene, const struct elements_host *e, double speed)
{
    double spread[3];
    for (int a = 0; a < 3; a++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int64_t i = 0; i < e->n; i++) {
            low = fmin(low, e->v[3 * i + a]);
            high = fmax(high, e->v[3 * i + a]);
        }
        spread[a] = e->n > 0 ? high - low : 0;
    }
    return scene->n_wall > 0 ? speed : fmin(speed, length(spread));
}

static void warn_how_deep(
    const struct deepest *d, const struct scene *scene, struct scene_errors *warnings)
{
    if (!(d->share > DEEP)) return;
    scene_errors_add(warnings,
        "%s of material '%s' and %s '%s' may overlap by %.3g m, %.3g of the smaller radius, under "
        "their weight and at %.3g m/s, the largest relative speed that this scene allows; %s",
        d->is_wall ? "particles" : "two particles,", scene->material[d->a].name,
        d->is_wall ? "wall" : "material",
        d->is_wall ? scene->wall[d->b].name : scene->material[d->b].name, d->depth, d->share,
        d->speed,
        d->share < 1 ? "contact laws are for small overlaps"
        : d->is_wall ? "above 1 they pass the wall"
                     : "above 1 they pass each other");
}

/* Half a period of two bodies of effective mass m on their spring: linear pi (m/k)^(1/2); Hertz
 * 2.943 delta/v with k = 1.5 K delta^(1/2) and (2/5) K delta^(5/2) = m v^2/2 is 4.03 (m/k)^(1/2). A
 * bond reaches F_b/k_n; a relative speed v crosses that in F_b/(k_n v). Pairs faster than F_b/(k_n
 * m)^(1/2) are not held by it anyway. */
static void look(struct worst *worst, const struct scene *scene, const struct limit_class *c,
    const struct limit_class *p, struct contact_material m, double speed)
{
    if (!(m.k_n > 0)) return;
    struct limit_contact k = limit_deepest(scene, c, p, m, speed, 0);
    double m_star = 1 / (c->w + (p ? p->w : 0));
    worst->contact =
        fmin(worst->contact, (material_is_hertz(m) ? 4.03 : M_PI) * sqrt(m_star / k.k_n));
    if (!(m.f_b > 0)) return;
    struct limit_ends ends = {c->w, p ? p->w : 0, c->r, p ? p->r : 0};
    double range = limit_range(m, ends);
    double energy = (material_is_hertz(m) ? 0.4 : 0.5) * m.f_b * range;
    double v = fmin(speed, sqrt(2 * energy / m_star));
    if (!(v > 0) || range / v >= worst->bond) return;
    worst->bond = range / v;
    worst->range = range;
    worst->bond_speed = v;
}

/* r: the smallest radius [m]. */
static struct worst worst_of(
    const struct scene *scene, const struct elements_host *elements, double speed, double *r)
{
    int n_class;
    struct limit_class *all = limit_classes(scene, elements, &n_class);
    struct worst worst = {.contact = HUGE_VAL, .bond = HUGE_VAL};
    double among = pair_speed(scene, elements, speed);
    *r = HUGE_VAL;
    for (int c = 0; c < n_class; c++) {
        *r = fmin(*r, all[c].r);
        for (int p = 0; p <= c; p++)
            if (p != c || all[c].n > 1) {
                look(&worst, scene, &all[c], &all[p],
                    limit_material_of(scene, all[c].material, all[p].material), speed);
                look_how_deep(&worst.deepest, scene, &all[c], &all[p], -1, among);
            }
        for (int w = 0; w < scene->n_wall; w++) {
            look_how_deep(&worst.deepest, scene, &all[c], NULL, w, speed);
            look(&worst, scene, &all[c], NULL,
                limit_material_of(scene, all[c].material, scene->wall[w].material), speed);
        }
    }
    free(all);
    return worst;
}

double limit_shortest_contact(
    const struct scene *scene, const struct elements_host *elements, double speed)
{
    double r;
    return worst_of(scene, elements, speed, &r).contact;
}

void limit_warnings(const struct scene *scene, const struct walls *walls,
    const struct elements_host *elements, double speed, double dt, struct scene_errors *warnings)
{
    double r;
    struct worst worst = worst_of(scene, elements, speed, &r);
    limit_precision_warnings(scene, walls, elements, speed, dt, warnings);
    warn_how_deep(&worst.deepest, scene, warnings);
    if (worst.contact < CONTACT_STEPS * dt)
        scene_errors_add(warnings,
            "the shortest contact lasts %.3g s, %.1f time steps of %.3g s; with fewer than %d "
            "its restitution is inaccurate: a smaller time.step, or softer contacts",
            worst.contact, worst.contact / dt, dt, CONTACT_STEPS);
    if (speed * dt > SHARE * r)
        scene_errors_add(warnings,
            "at %.3g m/s, the largest relative speed that this scene allows, particles move by "
            "%.2g of the smallest radius in one time step; above %.1f contacts begin with too "
            "large an overlap",
            speed, speed * dt / r, SHARE);
    if (SHARE * worst.bond < dt)
        scene_errors_add(warnings,
            "bonds act up to a gap of %.3g m (pull-off force over stiffness); a particle that "
            "they just hold, at %.3g m/s, crosses it in %.1f time steps; with fewer than %.0f "
            "bonds break at the wrong time",
            worst.range, worst.bond_speed, worst.bond / dt, 1 / SHARE);
}
