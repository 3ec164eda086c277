/* The limit of the densest packing, by the bound of kernels/contact/law_limit.h on the host.
 *
 * Elements are put into classes of like size. How many of class p can touch one of class c at once:
 * spheres of radius r on a sphere of radius R cover caps of half-angle asin(r/(R + r)), and by
 * Fejes Toth (1943) no two of n points on a sphere are further apart than the angle with cos =
 * (cot^2 w - 1)/2, w = n pi/(6 (n - 2)); so n <= 12 w/(6 w - pi), cot^2 w = 1 + 2 cos(2 asin(r/(R +
 * r))). Equal spheres: 12, up to R/r = 1.09 where 13 fit (Schuette and van der Waerden 1951, 1953).
 * Contacts of a full shell point evenly into all directions: sums over n n^T are a third of their
 * trace. Of n < 12 contacts at most 4 count along and 8 across any direction, as in the full shell.
 * Walls: in a corner of three walls there is room for half of the shell at most. */
#include <math.h>
#include <stdlib.h>

#include "contact_table.h"
#include "comm/fail.h"
#include "limit_parts.h"

enum { CLASSES_MOST = 4 /* per material */, ROUNDS = 12 };

/* Smallest overlap at which Hertz contacts are taken, in radii: springs that nothing has loaded
 * would ask for no step at all. */
#define OVERLAP_LEAST 1e-4
#define THIRTEEN_FIT 1.0911

void limit_material(const struct scene *scene, int a, int b, double *row)
{
    contact_table_material(scene, a, b, row);
    if (!(row[MATERIAL_mu] > 0)) row[MATERIAL_k_t] = row[MATERIAL_gamma_t] = 0;
}

struct contact_material limit_material_of(const struct scene *scene, int a, int b)
{
    double row[MATERIAL_WIDTH];
    limit_material(scene, a, b, row);
    return material_load(row);
}

double limit_best_share(const struct scene *scene)
{
    double kappa = 0;
    for (int i = 0; i < scene->n_contact; i++) {
        struct contact_material m =
            limit_material_of(scene, scene->contact[i].between[0], scene->contact[i].between[1]);
        kappa = fmax(kappa, m.k_t / (material_is_hertz(m) ? 1.5 * m.k_n : m.k_n));
    }
    return kappa > 0 ? limit_share(kappa) : 1;
}

/* Smallest and largest of each of up to CLASSES_MOST ranges of size per material. */
struct limit_class *limit_classes(
    const struct scene *scene, const struct elements_host *e, int *n_class)
{
    int n_material = scene->n_material;
    struct limit_class *all = fail_alloc((size_t)n_material * CLASSES_MOST * 2 * sizeof *all);
    double *low = fail_alloc((size_t)n_material * sizeof *low),
           *high = fail_alloc((size_t)n_material * sizeof *high);
    for (int64_t i = 0; i < e->n; i++) {
        int m = e->material[i];
        low[m] = low[m] > 0 ? fmin(low[m], e->radius[i]) : e->radius[i];
        high[m] = fmax(high[m], e->radius[i]);
    }
    for (int64_t i = 0; i < e->n; i++) {
        int m = e->material[i];
        double width = log(high[m] / low[m]);
        int k = width > 1e-6
                    ? (int)fmin(CLASSES_MOST * log(e->radius[i] / low[m]) / width, CLASSES_MOST - 1)
                    : 0;
        struct limit_class *pair = all + 2 * (m * CLASSES_MOST + k);
        if (pair[0].n == 0 || e->radius[i] < pair[0].r) pair[0].r = e->radius[i];
        pair[1].r = fmax(pair[1].r, e->radius[i]);
        pair[0].n++;
        pair[0].material = m;
    }
    int n = 0;
    for (int k = 0; k < n_material * CLASSES_MOST; k++) {
        struct limit_class small = all[2 * k], large = all[2 * k + 1];
        if (small.n == 0) continue;
        bool one = large.r < 1.001 * small.r;
        small.w = 1 / scene_mass(scene, small.material, small.r);
        large.material = small.material;
        large.w = 1 / scene_mass(scene, large.material, large.r);
        large.n = small.n;
        all[n++] = small;
        if (!one) all[n++] = large;
    }
    *n_class = n;
    free(low);
    free(high);
    return all;
}

/* Tangent springs of c against p (NULL: a wall) where an impact at `speed` meets a column as high
 * as that speed takes to fall: its pressure rho g H = rho v^2/2 puts the force rho v^2/2 (2 r)^2 on
 * a contact of spheres of radius r, the smaller of both. */
struct limit_contact limit_deepest(const struct scene *scene, const struct limit_class *c,
    const struct limit_class *p, struct contact_material m, double speed, double dt)
{
    struct limit_ends ends = {c->w, p ? p->w : 0, c->r, p ? p->r : 0};
    double r = p ? fmin(c->r, p->r) : c->r, depth = OVERLAP_LEAST * r;
    if (material_is_hertz(m)) {
        double rho = scene->material[c->material].density, k = m.k_n * sqrt(limit_r_star(ends));
        if (p) rho = fmax(rho, scene->material[p->material].density);
        depth = fmax(depth, pow(0.5 * rho * speed * speed * 4 * r * r / k, 2.0 / 3.0));
    }
    return limit_contact_of(m, ends, depth, speed, dt);
}

/* Overlap at which the spring holds what comes with `speed` and goes on being pulled by gravity g:
 * k d^2/2, for Hertz (2/5) K d^(5/2), is m v^2/2 + m g d. The next d from the one before rises to
 * the root from below. */
double limit_depth(
    const struct scene *scene, struct contact_material m, struct limit_ends ends, double speed)
{
    const double *a = scene->gravity;
    double m_star = 1 / (ends.w_i + ends.w_j), g = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    bool is_hertz = material_is_hertz(m);
    double k = is_hertz ? 0.4 * m.k_n * sqrt(limit_r_star(ends)) : 0.5 * m.k_n, depth = 0, before;
    do {
        before = depth;
        depth = pow(m_star * (0.5 * speed * speed + g * before) / k, is_hertz ? 0.4 : 0.5);
    } while (depth > before * (1 + 1e-6));
    return depth;
}

double limit_range(struct contact_material m, struct limit_ends ends)
{
    return material_is_hertz(m) ? pow(m.f_b / (m.k_n * sqrt(limit_r_star(ends))), 2.0 / 3.0)
                                : m.f_b / m.k_n;
}

static double shell(double centre, double r)
{
    if (centre < THIRTEEN_FIT * r) return 12;
    double sine = r / (centre + r);
    double w = atan(1 / sqrt(1 + 2 * (1 - 2 * sine * sine)));
    return floor(12 * w / (6 * w - M_PI) + 1e-9);
}

/* Sums over contacts before directions: along and across n, of stiffness and damping; rotation
 * across alone. */
struct traces {
    double n; /* contacts */
    double along_k, across_k, along_g, across_g, turn_k, turn_g;
    double most_k, most_g; /* all in one direction */
};

static struct traces traces_of(struct limit_contact k, struct limit_ends e, double share, double n)
{
    struct traces t = {.n = n};
    double p = limit_mobility(e), q = limit_spin_mobility(e), across = p * (1 + 2.5 * share);
    t.along_k = n * p * k.k_n;
    t.along_g = n * p * k.gamma_n;
    t.across_k = n * across * k.k_t;
    t.across_g = n * across * k.gamma_t;
    t.turn_k = n * (across / share * k.k_t + q * k.k_r);
    t.turn_g = n * (across / share * k.gamma_t + q * k.c_r);
    t.most_k = fmax(t.along_k, t.across_k);
    t.most_g = fmax(t.along_g, t.across_g);
    return t;
}

static void traces_add(struct traces *t, struct traces a)
{
    t->n += a.n;
    t->along_k += a.along_k;
    t->along_g += a.along_g;
    t->across_k += a.across_k;
    t->across_g += a.across_g;
    t->turn_k += a.turn_k;
    t->turn_g += a.turn_g;
    t->most_k += a.most_k;
    t->most_g += a.most_g;
}

/* Largest eigenvalues: [0] T stiffness, [1] T damping, [2] R stiffness, [3] R damping. */
static void eigenvalues(struct traces t, double out[4])
{
    double along = fmax(1.0 / 3, fmin(1, 4 / t.n)), across = fmax(2.0 / 3, fmin(1, 8 / t.n));
    for (int k = 0; k < 4; k++) out[k] = 0;
    if (!(t.n > 0)) return;
    out[0] = fmin(along * t.along_k + across * t.across_k, t.most_k);
    out[1] = fmin(along * t.along_g + across * t.across_g, t.most_g);
    out[2] = across * t.turn_k;
    out[3] = across * t.turn_g;
}

/* The shell of class c: filled with the partners that load it most for the room they take, as many
 * as there are of them. */
static struct traces fill_shell(const struct scene *scene, const struct limit_class *all,
    int n_class, int c, double speed, double dt, double share)
{
    struct traces sum = {0}, *one = fail_alloc((size_t)n_class * sizeof *one);
    double room = 1;
    for (int p = 0; p < n_class; p++) {
        struct contact_material m = limit_material_of(scene, all[c].material, all[p].material);
        struct limit_ends ends = {all[c].w, all[p].w, all[c].r, all[p].r};
        one[p] = traces_of(limit_deepest(scene, &all[c], &all[p], m, speed, dt), ends, share, 1);
    }
    for (int round = 0; round < n_class && room > 1e-9; round++) {
        int best = -1;
        double most = 0;
        for (int p = 0; p < n_class; p++) {
            double load = one[p].n > 0
                              ? shell(all[c].r, all[p].r) * (one[p].along_k + one[p].across_k +
                                                                one[p].along_g / fmax(dt, 1e-30))
                              : 0;
            if (load > most) {
                most = load;
                best = p;
            }
        }
        if (best < 0) break;
        double full = shell(all[c].r, all[best].r), there = (double)(all[best].n - (best == c));
        double n = fmin(full * room, there);
        struct traces t = one[best];
        traces_add(
            &sum, (struct traces){n, n * t.along_k, n * t.across_k, n * t.along_g, n * t.across_g,
                      n * t.turn_k, n * t.turn_g, n * t.most_k, n * t.most_g});
        room -= n / full;
        one[best].n = 0; /* used up */
    }
    free(one);
    return sum;
}

/* The bound of one class; dt: of the dashpots' centring. */
static double class_limit(const struct scene *scene, const struct limit_class *all, int n_class,
    int c, double speed, double dt, double share)
{
    double pairs[4], walls[4] = {0, 0, 0, 0}, w[4];
    struct limit_ends ends = {all[c].w, 0, all[c].r, 0};
    eigenvalues(fill_shell(scene, all, n_class, c, speed, dt, share), pairs);
    for (int k = 0; k < scene->n_wall; k++) {
        struct contact_material m =
            limit_material_of(scene, all[c].material, scene->wall[k].material);
        struct traces t =
            traces_of(limit_deepest(scene, &all[c], NULL, m, speed, dt), ends, share, 1);
        /* in a corner: along one wall's normal, across those of two */
        w[0] = t.along_k + 2 * t.across_k;
        w[1] = t.along_g + 2 * t.across_g;
        w[2] = 2 * t.turn_k;
        w[3] = 2 * t.turn_g;
        for (int i = 0; i < 4; i++) walls[i] = fmax(walls[i], w[i]);
    }
    for (int i = 0; i < 4; i++) w[i] = fmax(pairs[i], 0.5 * pairs[i] + walls[i]);
    return fmin(limit_step(w[0], w[1]), limit_step(w[2], w[3]));
}

const char *limit_missing(const struct scene *scene, const struct elements_host *elements)
{
    int n_class, overflow = 0;
    struct limit_class *all = limit_classes(scene, elements, &n_class);
    for (int c = 0; c < n_class; c++) overflow |= !(all[c].w > 0 && isfinite(all[c].w));
    for (int k = 0; k < scene->n_contact && n_class > 0; k++) {
        const struct contact *of = &scene->contact[k];
        struct contact_material m = limit_material_of(scene, of->between[0], of->between[1]);
        overflow |= m.k_n > 0 ? !(m.k_n < LIMIT_NONE) : m.k_n < 0 || isnan(m.k_n);
    }
    free(all);
    return overflow ? "its masses or stiffnesses are beyond what a number can hold, or so large or "
                      "small that nothing follows from them"
                    : "nothing in this scene limits the time step";
}

double limit_dense(const struct scene *scene, const struct elements_host *elements, double speed)
{
    int n_class;
    struct limit_class *all = limit_classes(scene, elements, &n_class);
    double best = 0, share[2] = {limit_best_share(scene), 1};
    for (int k = 0; k < 2; k++) {
        double dt = 0; /* rises to where the dashpots' centring agrees with it */
        for (int round = 0; round < ROUNDS; round++) {
            double least = LIMIT_NONE;
            for (int c = 0; c < n_class; c++)
                least = fmin(least, class_limit(scene, all, n_class, c, speed, dt, share[k]));
            bool done = least < 1.0005 * dt || !(least < LIMIT_NONE);
            dt = least;
            if (done) break;
        }
        best = fmax(best, dt);
    }
    free(all);
    return best < LIMIT_NONE ? LIMIT_ROUNDING * best : HUGE_VAL;
}
