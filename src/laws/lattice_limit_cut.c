/* The bound of w_max of a body with cells that its surface cuts: as lattice_limit.c, with links of
 * shares that act beside the middles of their faces (kernels/lattice/law_link.h). */
#include "lattice_limit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"

/* What the law asks of a link over a face, as cell i sees it. */
struct side {
    struct link_stiffness k; /* in its share; r_i is this cell's */
    double d[2];             /* offset [m] */
    int beyond;
    int axis, sign; /* sign 1: the cell is the lower one */
};

static const struct lattice_share *share_of(const struct lattice_body *b, int i)
{
    return &b->share[b->share_of[i]];
}

static bool side_of(const struct lattice_body *b, int i, int face, struct side *s)
{
    int j = b->neighbour[i][face];
    if (j < 0 || (b->links && !(b->links[i] >> face & 1))) return false;
    const struct lattice_share *own = share_of(b, i);
    double c = own->face[face];
    s->k = link_constants_between(
        b->set, b->materials[b->material[i]], b->materials[b->material[j]], b->h);
    s->k.kn *= c;
    s->k.ks *= c;
    s->k.kt *= c;
    s->k.kb *= c;
    s->k.r_i *= c;
    s->k.r_j *= c;
    for (int a = 0; a < 2; a++) s->d[a] = own->offset[face][a] * b->h;
    s->beyond = j;
    s->axis = face / 2;
    s->sign = face % 2 ? 1 : -1;
    return true;
}

/* Gap and turn of the link by the six DOF of one of its cells, axis first; sign -1: of the lower
 * one. */
static void rows_of(const struct side *s, int sign, double arm, double row[6][6])
{
    memset(row, 0, 6 * sizeof *row);
    for (int k = 0; k < 6; k++) row[k][k] = sign;
    row[0][4] = sign * s->d[1];
    row[0][5] = -sign * s->d[0];
    row[1][3] = -sign * s->d[1];
    row[1][5] = -arm;
    row[2][3] = sign * s->d[0];
    row[2][4] = arm;
}

static int dof(int axis, int k)
{
    return k < 3 ? (axis + k) % 3 : 3 + (axis + k - 3) % 3;
}

/* Adds the link to the cell's own block, with signs, and the block of the cell beyond to y. */
static void add_link(const struct side *s, double h, double own[6][6], const double *z, double *y)
{
    const double k[6] = {s->k.kn, s->k.ks, s->k.ks, s->k.kt, s->k.kb, s->k.kb};
    double me[6][6], other[6][6];
    rows_of(s, -s->sign, 0.5 * h, me);
    rows_of(s, s->sign, 0.5 * h, other);
    for (int p = 0; p < 6; p++)
        for (int q = 0; q < 6; q++) {
            double sum = 0, cross = 0;
            for (int r = 0; r < 6; r++) {
                sum += k[r] * me[r][p] * me[r][q];
                cross += k[r] * me[r][p] * other[r][q];
            }
            own[dof(s->axis, p)][dof(s->axis, q)] += sum;
            y[dof(s->axis, p)] += fabs(cross) * z[dof(s->axis, q)];
        }
}

/* Sum of stretches by the DOF of one cell at a link, in the share r: with signs into t. */
static void add_stretch(const struct side *s, int sign, double r, double h, double t[6])
{
    double c = sign * r / (2 * h);
    t[dof(s->axis, 0)] += c;
    t[dof(s->axis, 4)] += c * s->d[1];
    t[dof(s->axis, 5)] -= c * s->d[0];
}

static double dot(const double t[6], const double z[6])
{
    double sum = 0;
    for (int c = 0; c < 6; c++) sum += fabs(t[c]) * z[c];
    return sum;
}

static double size_of(const struct lattice_body *b, int i)
{
    struct link_material m = b->materials[b->material[i]];
    const struct lattice_share *own = share_of(b, i);
    double per = link_constants_lambda(b->set, m) / (4 * link_constants_shear(m)),
           missing = 6 * own->volume;
    struct side s;
    for (int f = 0; f < 6; f++) missing -= side_of(b, i, f, &s) ? own->face[f] : 0;
    double size = own->volume + missing * per;
    return b->share_of[i] ? fmax(size, link_constants_least_size(b->set, m)) : size;
}

/* |D| |T| z of all cells. */
static void volumes(const struct lattice_body *b, const double (*z)[6], double *v)
{
    struct side s;
    for (int i = 0; i < b->n; i++) {
        double own[6] = {0}, sum = 0;
        for (int f = 0; f < 6; f++) {
            double beyond[6] = {0};
            if (!side_of(b, i, f, &s)) continue;
            add_stretch(&s, -s.sign, s.k.r_i, b->h, own);
            add_stretch(&s, s.sign, s.k.r_i, b->h, beyond);
            sum += dot(beyond, z[s.beyond]);
        }
        double lambda = link_constants_lambda(b->set, b->materials[b->material[i]]);
        v[i] = fabs(lambda) * b->h * b->h * b->h / size_of(b, i) * (sum + dot(own, z[i]));
    }
}

/* B z of cell i. */
static void row_of(
    const struct lattice_body *b, int i, const double (*z)[6], const double *v, double *y)
{
    double own[6][6] = {{0}}, stretch[6] = {0};
    struct link_material m = b->materials[b->material[i]];
    double mass = link_constants_mass(m, b->h) * share_of(b, i)->mass,
           inertia = link_constants_inertia(m, b->h);
    struct side s;
    for (int c = 0; c < 6; c++) y[c] = 0;
    for (int f = 0; f < 6; f++) {
        double other[6] = {0};
        if (!side_of(b, i, f, &s)) continue;
        add_link(&s, b->h, own, z[s.beyond], y);
        add_stretch(&s, -s.sign, s.k.r_i, b->h, stretch);
        add_stretch(&s, -s.sign, s.k.r_j, b->h, other);
        for (int c = 0; c < 6; c++) y[c] += fabs(other[c]) * v[s.beyond];
    }
    for (int c = 0; c < 6; c++) {
        y[c] += dot(own[c], z[i]) + fabs(stretch[c]) * v[i];
        y[c] /= c < 3 ? mass : inertia;
    }
}

double lattice_limit_cut(const struct lattice_body *b, int rounds)
{
    size_t n = (size_t)b->n;
    double(*z)[6] = fail_alloc(n * sizeof *z), (*y)[6] = fail_alloc(n * sizeof *y),
    *v = fail_alloc(n * sizeof *v), bound = HUGE_VAL;
    for (size_t i = 0; i < n; i++) {
        struct link_material m = b->materials[b->material[i]];
        double mass = link_constants_mass(m, b->h) * share_of(b, (int)i)->mass;
        for (int c = 0; c < 6; c++)
            z[i][c] = 1 / sqrt(c < 3 ? mass : link_constants_inertia(m, b->h));
    }
    for (int round = 0; round < rounds; round++) {
        double largest = 0;
        volumes(b, (const double(*)[6])z, v);
        for (int i = 0; i < b->n; i++) {
            row_of(b, i, (const double(*)[6])z, v, y[i]);
            for (int c = 0; c < 6; c++) largest = fmax(largest, y[i][c] / z[i][c]);
        }
        bound = fmin(bound, largest);
        for (size_t i = 0; i < n; i++)
            for (int c = 0; c < 6; c++)
                z[i][c] = y[i][c] > 1e-250 * largest ? y[i][c] / largest : z[i][c];
    }
    free(z);
    free(y);
    free(v);
    return sqrt(bound);
}
