#include "lattice_features.h"

#include <math.h>
#include <stdlib.h>

#include "kernels/lattice/lattice_words.h"
#include "comm/fail.h"

struct lattice_features lattice_features_of(
    const struct lattice_cells *cells, const struct lattice_options *o)
{
    struct lattice_features f = {.real_is_float = o->real_is_float,
        .position_is_float = o->position_is_float,
        .turn = o->turn};
    for (int i = 0; i < cells->n_kind; i++) {
        int m = cells->kind[i].material;
        f.volume |= fabs(link_constants_lambda(o->set, o->material[m])) > 0;
        f.link_damping |= o->material[m].damping > 0;
        f.mass_damping |= o->alpha && o->alpha[m] > 0;
        for (int j = 0; j < cells->n_kind; j++) {
            struct link_stiffness k = link_constants_between(o->set, o->material[m],
                o->material[cells->kind[j].material], cells->grid[cells->kind[i].grid].h);
            f.shear_apart |= link_constants_shear_apart(k);
            f.twist_apart |= link_constants_twist_apart(k);
        }
    }
    for (int64_t i = 0; i < cells->n; i++) f.fix |= cells->bits[i] >> WORD_FIX;
    f.loads = o->n_row > 1;
    for (int a = 0; a < 3; a++) f.gravity |= fabs(o->gravity[a]) > 0;
    f.kinds = cells->n_kind > 1;
    f.rk = lattice_schemes_table(o->scheme)->is_rk;
    f.nystrom = lattice_schemes_table(o->scheme)->is_nystrom;
    f.breakage = o->strength != NULL;
    for (int k = 0; k < cells->n_kind && o->strength; k++)
        f.principal |= o->strength[k].principal > 0;
    f.energy = o->energy;
    f.shares = cells->share != NULL;
    return f;
}

#define ROW(member, option) FEATURE_ROW(struct lattice_features, member, option)
/* clang-format off */
const struct feature_row lattice_features_table[] = {
    {NULL, "REAL_IS_FLOAT", offsetof(struct lattice_features, real_is_float), ~0},
    {NULL, "POSITION_IS_FLOAT", offsetof(struct lattice_features, position_is_float), ~0},
    ROW(turn, "WITH_TURN"),
    ROW(volume, "WITH_VOLUME"),
    ROW(shear_apart, "WITH_SHEAR_APART"),
    ROW(twist_apart, "WITH_TWIST_APART"),
    ROW(link_damping, "WITH_LINK_DAMPING"),
    ROW(mass_damping, "WITH_MASS_DAMPING"),
    ROW(fix, "WITH_FIX"),
    ROW(loads, "WITH_LOADS"),
    ROW(gravity, "WITH_GRAVITY"),
    ROW(kinds, "WITH_KINDS"),
    ROW(rk, "WITH_RK"),
    ROW(nystrom, "WITH_NYSTROM"),
    ROW(energy, "WITH_ENERGY"),
    ROW(breakage, "WITH_BREAK"),
    ROW(principal, "WITH_PRINCIPAL"),
    ROW(shares, "WITH_SHARES"),
    {NULL, NULL, 0, 0}};
/* clang-format on */

char *lattice_features_options(
    const struct lattice_features *f, const struct lattice_layout *layout)
{
    char *rows = feature_table_options(lattice_features_table, f, 1);
    char *text = fail_format("%s -DRUN_AXIS=%d -DBATCH=%d -DBATCH_WIDTH=%d", rows, layout->axis,
        layout->run, f->real_is_float && f->position_is_float && layout->run % 16 == 0 ? 16 : 8);
    free(rows);
    return text;
}

double *lattice_features_links(const struct lattice_cells *cells, const struct lattice_options *o)
{
    int n = cells->n_kind;
    double *table = fail_alloc((size_t)(n * n) * LINK_WIDTH * sizeof *table), *row = table;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++, row += LINK_WIDTH) {
            double h = cells->grid[cells->kind[i].grid].h;
            struct link_stiffness k = link_constants_between(o->set,
                o->material[cells->kind[i].material], o->material[cells->kind[j].material], h);
            const double value[LINK_WIDTH] = {k.kn, k.ks, k.kt, k.kb, k.r_i, k.r_j, h, k.eta};
            for (int a = 0; a < LINK_WIDTH; a++) row[a] = value[a];
        }
    return table;
}

double *lattice_features_limits(const struct lattice_cells *cells, const struct lattice_options *o)
{
    int n = cells->n_kind;
    double *table = fail_alloc((size_t)(n * n) * BREAK_WIDTH * sizeof *table), *row = table;
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++, row += BREAK_WIDTH) {
            struct link_strength s = link_constants_weaker(o->strength[i], o->strength[j]);
            struct link_limits k = link_constants_limits(s, cells->grid[cells->kind[i].grid].h);
            const double value[BREAK_WIDTH] = {k.normal, k.shear, k.bend, k.twist, s.criterion};
            for (int a = 0; a < BREAK_WIDTH; a++) row[a] = value[a];
        }
    return table;
}

double *lattice_features_principal(
    const struct lattice_cells *cells, const struct lattice_options *o)
{
    int n = cells->n_kind;
    double *inverse = fail_alloc(2 * (size_t)n * sizeof *inverse);
    for (int k = 0; k < n; k++) {
        inverse[k] = o->strength[k].principal > 0 ? 1 / o->strength[k].principal : 0;
        inverse[n + k] = o->strength[k].rise;
    }
    return inverse;
}

/* Additive sequence in three dimensions: with 1/g, 1/g^2, 1/g^3, g^4 = g + 1, the lots of cells
 * that follow each other in any direction fill [0, 1) evenly (Weyl; this g: M. Roberts 2018). So a
 * staircase keeps closer to its plane than by random numbers. */
double lattice_features_lot(
    const struct lattice_cells *cells, const struct lattice_options *o, int64_t i)
{
    static const double step[3] = {0.81917251339616443, 0.67104360670378920, 0.54970047790197019};
    double sum = 0.5;
    if (!o->strength[cells->kind_of[i]].drawn) return -1;
    for (int axis = 0; axis < 3; axis++) sum += step[axis] * cells->at[i][axis];
    return sum - floor(sum);
}

double *lattice_features_shares(const struct lattice_cells *cells, const struct lattice_options *o)
{
    double *table = fail_alloc((size_t)cells->n_share * SHARE_WIDTH * sizeof *table);
    for (int f = 0; f < 6; f++) table[SHARE_FACE + f] = 1;
    table[SHARE_VOLUME] = table[SHARE_PER_MASS] = 1;
    for (int64_t i = 0; i < cells->n; i++) {
        if (!cells->share_of[i]) continue;
        const struct lattice_share *s = &cells->share[cells->share_of[i]];
        const struct link_material *m = &o->material[cells->kind[cells->kind_of[i]].material];
        double h = cells->grid[cells->kind[cells->kind_of[i]].grid].h,
               *row = table + (int64_t)cells->share_of[i] * SHARE_WIDTH;
        for (int f = 0; f < 6; f++) {
            row[SHARE_FACE + f] = s->face[f];
            for (int c = 0; c < 2; c++) row[SHARE_OFFSET + 2 * f + c] = s->offset[f][c] * h;
        }
        row[SHARE_VOLUME] = s->volume;
        row[SHARE_PER_MASS] = 1 / s->mass;
        row[SHARE_LEAST] = link_constants_least_size(o->set, *m);
    }
    return table;
}

double *lattice_features_cells(const struct lattice_cells *cells, const struct lattice_options *o)
{
    double *table = fail_alloc((size_t)cells->n_kind * CELL_WIDTH * sizeof *table);
    for (int i = 0; i < cells->n_kind; i++) {
        const struct link_material *m = &o->material[cells->kind[i].material];
        double h = cells->grid[cells->kind[i].grid].h;
        const double value[CELL_WIDTH] = {1 / link_constants_mass(*m, h),
            1 / link_constants_inertia(*m, h), link_constants_lambda(o->set, *m),
            1 / (4 * link_constants_shear(*m)), 1 / (2 * h), m->damping,
            o->alpha ? o->alpha[cells->kind[i].material] : 0, h * h * h};
        for (int a = 0; a < CELL_WIDTH; a++) table[i * CELL_WIDTH + a] = value[a];
    }
    return table;
}

/* A kick over s [s], as kernels/lattice/lattice_work.h: with z = alpha s
 *     f = e^-z, g = (1 - f)/alpha, G = (s - g)/alpha, A = (1 - f^2)/2, C = alpha times the integral
 *       of g^2 = (s - 2 g + A/alpha)/alpha
 * G and C by their series for small z, where the differences cancel: what is left out is below
 * 1e-16. */
static void kick(double alpha, double s, double *row)
{
    double z = alpha * s, g = alpha > 0 ? -expm1(-z) / alpha : s,
           a = alpha > 0 ? -0.5 * expm1(-2 * z) : 0, whole = 0, lost = 0;
    if (fabs(z) > 0.25) {
        whole = (s - g) / alpha;
        lost = (s - 2 * g + a / alpha) / alpha;
    } else { /* G = s^2 sum of (-z)^k/(k + 2)!, C = z s^2 sum of (-z)^k (2^(k+2) - 2)/(k + 3)! */
        double term = 0.5, two = 4;
        for (int k = 0; k < 20; k++) {
            whole += s * s * term;
            lost += z * s * s * term * (two - 2) / (k + 3);
            term *= -z / (k + 3);
            two *= 2;
        }
    }
    const double value[KICK_PART] = {alpha > 0 ? exp(-z) : 1, g, s, whole, a, lost};
    for (int k = 0; k < KICK_PART; k++) row[k] = value[k];
}

double *lattice_features_kicks(const struct lattice_cells *cells, const struct lattice_options *o)
{
    const struct lattice_table *t = lattice_schemes_table(o->scheme);
    double *table = fail_alloc((size_t)((t->n + 2) * cells->n_kind) * KICK_WIDTH * sizeof *table);
    for (int k = 0; k < t->n + 2; k++)
        for (int i = 0; i < cells->n_kind; i++) {
            const struct lattice_op *op = &t->op[k < t->n ? k : 0];
            double alpha = o->alpha ? o->alpha[cells->kind[i].material] : 0,
                   *row = table + (k * cells->n_kind + i) * KICK_WIDTH;
            kick(alpha, k == t->n + 1 ? 0 : op->end * o->dt, row);
            kick(alpha, k == t->n ? 0 : op->begin * o->dt, row + KICK_PART);
        }
    return table;
}
