/* Warnings that single precision is too coarse where the elements are. */
#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "limit_parts.h"
#include "shape/walls.h"

/* Spacing of numbers, as shares that are still good enough: of the smallest radius; of the smallest
 * overlap of an impact, whose force and restitution it rounds; of the range of a bond. */
#define SHARE_OF_RADIUS 1e-3
#define SHARE_OF_OVERLAP 0.01
#define SHARE_OF_RANGE 0.1

/* Largest coordinate that elements have or can get to [m]. */
static double largest_coordinate(
    const struct scene *scene, const struct walls *walls, const struct elements_host *e)
{
    const struct domain *d = &scene->domain;
    double largest = 0;
    for (int64_t k = 0; k < 3 * e->n; k++) largest = fmax(largest, fabs(e->x[k]));
    for (int k = 0; k < 3 && d->has_box; k++)
        largest = fmax(largest, fmax(fabs(d->min[k]), fabs(d->max[k])));
    for (int k = 0; k < 3 * walls->n_wall && !d->has_box; k++) {
        double low = fabs(walls->wall_low[k]), high = fabs(walls->wall_high[k]);
        if (isfinite(low) && isfinite(high)) largest = fmax(largest, fmax(low, high));
    }
    return largest;
}

/* From a number to the next in single precision. */
static double spacing_at(double x)
{
    int exponent;
    frexp(x, &exponent);
    return ldexp((double)FLT_EPSILON, exponent - 1);
}

/* What positions have to resolve [m]. */
struct lengths {
    double radius, overlap, range;
};

static void look(struct lengths *l, const struct scene *scene, const struct limit_class *c,
    const struct limit_class *p, int material, double speed)
{
    struct contact_material m = limit_material_of(scene, c->material, material);
    struct limit_ends ends = {c->w, p ? p->w : 0, c->r, p ? p->r : 0};
    if (!(m.k_n > 0)) return;
    double depth = limit_depth(scene, m, ends, speed);
    if (depth > 0) l->overlap = fmin(l->overlap, depth);
    if (m.f_b > 0) l->range = fmin(l->range, limit_range(m, ends));
}

static struct lengths lengths_of(
    const struct scene *scene, const struct elements_host *elements, double speed)
{
    struct lengths l = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
    int n_class;
    struct limit_class *all = limit_classes(scene, elements, &n_class);
    for (int c = 0; c < n_class; c++) {
        l.radius = fmin(l.radius, all[c].r);
        for (int p = 0; p <= c; p++)
            if (p != c || all[c].n > 1) look(&l, scene, &all[c], &all[p], all[p].material, speed);
        for (int w = 0; w < scene->n_wall; w++)
            look(&l, scene, &all[c], NULL, scene->wall[w].material, speed);
    }
    free(all);
    return l;
}

void limit_precision_warnings(const struct scene *scene, const struct walls *walls,
    const struct elements_host *elements, double speed, double dt, struct scene_errors *warnings)
{
    if (scene->precision != PRECISION_SINGLE || elements->n == 0) return;
    struct lengths l = lengths_of(scene, elements, speed);
    double at = largest_coordinate(scene, walls, elements), spacing = spacing_at(at);
    struct {
        double length, share;
        const char *what;
    } needed[] = {{l.radius, SHARE_OF_RADIUS, "the smallest radius"},
        {l.overlap, SHARE_OF_OVERLAP, "the overlap of an impact"},
        {l.range, SHARE_OF_RANGE, "the range of bonds"},
        {speed * dt, 1, "the way in one time step, at the largest speed"}};
    for (int k = 0; k < 4; k++) {
        if (!(needed[k].length > 0) || !(spacing > needed[k].share * needed[k].length)) continue;
        scene_errors_add(warnings,
            "precision: single: at %.3g m, the largest coordinate, neighbouring numbers are %.3g m "
            "apart, %.3g of %s, %.3g m; above %g results are wrong: take precision: mixed, or "
            "bring the scene to the origin",
            at, spacing, spacing / needed[k].length, needed[k].what, needed[k].length,
            needed[k].share);
        return;
    }
}
