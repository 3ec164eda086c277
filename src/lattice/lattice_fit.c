/* How well the cells of a body fill its shape. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "comm/fail.h"
#include "lattice_parts.h"

enum { PARTS = 48, MOST_LAYERS = 10000 };
static const double close = 0.01;
static const double coarse = 1e-5; /* strain that a displacement in single precision rounds to */

/* Share of the bounding box that is inside the shape and in none of its holes. */
static double share_inside(const struct lattice_cut *cut)
{
    const double *low = cut->shape.low, *high = cut->shape.high;
    double z[PARTS], step[3];
    uint8_t holds[PARTS], hole[PARTS];
    int64_t n = 0;
    for (int a = 0; a < 3; a++) step[a] = (high[a] - low[a]) / PARTS;
    for (int k = 0; k < PARTS; k++) z[k] = low[2] + (k + 0.5) * step[2];
    for (int j = 0; j < PARTS; j++)
        for (int i = 0; i < PARTS; i++) {
            double x = low[0] + (i + 0.5) * step[0], y = low[1] + (j + 0.5) * step[1];
            region_column(&cut->shape, x, y, z, PARTS, 0, holds);
            for (int m = 0; m < cut->body->n_minus; m++) {
                region_column(&cut->minus[m], x, y, z, PARTS, 0, hole);
                for (int k = 0; k < PARTS; k++) holds[k] &= !hole[k];
            }
            for (int k = 0; k < PARTS; k++) n += holds[k];
        }
    return (double)n / ((double)PARTS * PARTS * PARTS);
}

static double radius_of(const struct region *region)
{
    bool is_round = region->kind == REGION_CYLINDER || region->kind == REGION_SPHERE;
    return is_round ? region->radius : HUGE_VAL;
}

struct lattice_fit lattice_fit_of(const struct lattice_cut *cut)
{
    const struct body *body = cut->body;
    const struct lattice_span *span = &cut->span;
    struct lattice_fit fit = {
        .is_box = body->shape.kind == REGION_BOX, .radius = radius_of(&body->shape)};
    double box = 1, h = body->cell;
    for (int a = 0; a < 3; a++) {
        fit.shape[a] = cut->shape.high[a] - cut->shape.low[a];
        fit.cells[a] = cut->is_curved ? fit.shape[a] : (span->high[a] - span->low[a] + 1) * h;
        box *= fit.shape[a];
    }
    bool is_whole = fit.is_box && body->n_minus == 0;
    fit.volume = (cut->is_curved ? cut->covered : (double)span->n) * h * h * h /
                 (box * (is_whole ? 1 : share_inside(cut)));
    for (int m = 0; m < body->n_minus; m++)
        fit.radius = fmin(fit.radius, radius_of(&body->minus[m]));
    return fit;
}

/* Whether cells of size h fill all three lengths. */
static bool is_fitting(const double length[3], double h)
{
    for (int a = 0; a < 3; a++)
        if (fabs(length[a] - nearbyint(length[a] / h) * h) > close * length[a]) return false;
    return true;
}

/* " (a cell of 0.01 m or 0.02 m fits)": the nearest below and above h; empty if there are none. */
static char *fitting_sizes(const double length[3], double h)
{
    double least = fmin(length[0], fmin(length[1], length[2]));
    int layers = (int)fmax(1, fmin(ceil(least / h), MOST_LAYERS)), below = layers, above = layers;
    while (below <= MOST_LAYERS && !is_fitting(length, least / below)) below++;
    while (above >= 1 && (least / above <= h || !is_fitting(length, least / above))) above--;
    if (below > MOST_LAYERS && above < 1) return fail_strdup("");
    if (above < 1) return fail_format("; a cell of %.4g m fits", least / below);
    if (below > MOST_LAYERS) return fail_format("; a cell of %.4g m fits", least / above);
    return fail_format("; a cell of %.4g m or %.4g m fits", least / below, least / above);
}

/* Largest component of a velocity that a body has or is given [m/s]. */
static double fastest(const struct scene *scene, int b)
{
    double v = 0;
    for (int a = 0; a < 3; a++) {
        v = fmax(v, fabs(scene->body[b].velocity[a]));
        for (int k = 0; k < scene->n_boundary; k++) {
            const struct boundary *of = &scene->boundary[k];
            bool is_given = of->kind == BOUNDARY_VELOCITY && isfinite(of->value[a]) &&
                            (of->body < 0 || of->body == b);
            if (is_given) v = fmax(v, fabs(of->value[a]));
        }
    }
    return v;
}

/* In single precision a displacement u is known to u 1.2e-7, and a strain to that over a cell. */
static void warn_of_precision(const struct scene *scene, struct scene_errors *warnings)
{
    for (int b = 0; b < scene->n_body && scene->precision == PRECISION_SINGLE; b++) {
        double way = fastest(scene, b) * scene->time.end, spacing = way * (double)FLT_EPSILON;
        if (!(spacing > coarse * scene->body[b].cell)) continue;
        scene_errors_add(warnings,
            "precision: single: body '%s' may move by %.3g m, where neighbouring numbers are up to "
            "%.3g m apart, a strain of %.3g in a cell; above %g take precision: mixed",
            scene->body[b].name, way, spacing, spacing / scene->body[b].cell, coarse);
    }
}

static void warn_of_relax(const struct scene *scene, struct scene_errors *warnings)
{
    for (int b = 0; b < scene->n_body && scene->lattice.relax; b++) {
        const struct body *body = &scene->body[b];
        bool moves = false;
        for (int a = 0; a < 3; a++)
            moves |= fabs(body->velocity[a]) > 0 || fabs(body->angular_velocity[a]) > 0;
        if (moves)
            scene_errors_add(warnings,
                "body '%s': its initial velocity has no effect on the state of rest that "
                "lattice.relax looks for, and is not the velocity that it ends with",
                body->name);
    }
}

void lattice_fit_warnings(
    const struct scene *scene, const struct lattice_cells *cells, struct scene_errors *warnings)
{
    warn_of_precision(scene, warnings);
    warn_of_relax(scene, warnings);
    for (int b = 0; b < scene->n_body; b++) {
        struct lattice_fit fit = cells->fit[b];
        double off = fabs(fit.volume - 1);
        for (int a = 0; a < 3 && fit.is_box; a++)
            off = fmax(off, fabs(fit.cells[a] / fit.shape[a] - 1));
        if (!(off > close)) continue;
        const double *c = fit.cells, *s = fit.shape;
        char *sizes = fit.is_box ? fitting_sizes(s, scene->body[b].cell) : fail_strdup("");
        scene_errors_add(warnings,
            "body '%s': its cells measure %.4g x %.4g x %.4g m, its shape %.4g x %.4g x %.4g m; "
            "they hold %.4g of its volume%s",
            scene->body[b].name, c[0], c[1], c[2], s[0], s[1], s[2], fit.volume, sizes);
        free(sizes);
    }
}
