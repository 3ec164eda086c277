#include "lattice_limit.h"

#include "comm/fail.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* Largest w dt of undamped steps: |trace| of the step matrix reaches 2, or |R(i z)| = 1 for RK4 (2
 * sqrt(2)). */
static const double undamped[] = {[LATTICE_LEAPFROG] = 2,
    [LATTICE_RK4] = 2.8284271,
    [LATTICE_RKN4] = 2.5865,
    [LATTICE_PEFRL] = 2.9894,
    [LATTICE_VEFRL] = 3.4696};

/* RK4 on the curve z = w dt (-zeta +- i sqrt(1 - zeta^2)): the limit is above 2 sqrt(2) up to zeta
 * = 0.3, has its minimum 2.615 at 0.54 and is 2.785 at 1; beyond, the faster of the two real roots
 * counts. Slower modes of a body with one eta have smaller zeta and w alike and stay inside. */
static double damped_rk4(double zeta)
{
    if (zeta <= 0.3) return undamped[LATTICE_RK4];
    if (zeta <= 1) return 2.61;
    return fmin(2.61, 2.785 / (zeta + sqrt(zeta * zeta - 1)));
}

double lattice_limit_factor(enum lattice_scheme scheme, double zeta)
{
    if (!(zeta > 0)) return undamped[scheme];
    if (scheme == LATTICE_LEAPFROG) return 2 / (sqrt(1 + zeta * zeta) + zeta);
    return scheme == LATTICE_RK4 ? damped_rk4(zeta) : 0;
}

double lattice_limit_uniform(enum link_set set, struct link_material m, double h)
{
    double g = link_constants_shear(m), lambda = link_constants_lambda(set, m),
           c = 1 / (m.density * h * h), p = lambda + 2 * g;
    if (set == LINK_REFERENCE) return sqrt(72 * m.young * c);
    /* the two meet at 4.4305 G */
    return sqrt(c * fmax(28 * g, lambda > 2 * g ? 3 * p * p / lambda : 0));
}

/* What the materials make of links and cells, once for all cells. */
struct constants {
    const struct lattice_body *body;
    /* [n_material][n_material]: of a cell of the first, seen from it */
    struct link_stiffness *between;
    struct link_stiffness *wall; /* [n_material] */
};

static struct constants constants_create(const struct lattice_body *body)
{
    size_t n = (size_t)body->n_material;
    struct constants c = {
        body, fail_alloc(n * n * sizeof *c.between), fail_alloc(n * sizeof *c.wall)};
    for (size_t i = 0; i < n; i++) {
        c.wall[i] = link_constants_wall(body->set, body->materials[i], body->h);
        for (size_t j = 0; j < n; j++)
            c.between[i * n + j] =
                link_constants_between(body->set, body->materials[i], body->materials[j], body->h);
    }
    return c;
}

static void constants_free(struct constants c)
{
    free(c.between);
    free(c.wall);
}

/* A link of cell i over a face as the cell sees it. */
struct side {
    const struct link_stiffness *k; /* zero where there is no link; r_i is this cell's */
    int beyond;                     /* cell, or -1: none, or a wall */
    bool exists;
};

static struct side side_of(const struct constants *c, int i, int face)
{
    static const struct link_stiffness none;
    const struct lattice_body *b = c->body;
    int beyond = b->neighbour[i][face], bit = 1 << face;
    if (beyond >= 0 && (!b->links || b->links[i] & bit))
        return (struct side){
            &c->between[b->material[i] * b->n_material + b->material[beyond]], beyond, true};
    if (beyond < 0 && b->walls && b->walls[i] & bit)
        return (struct side){&c->wall[b->material[i]], -1, true};
    return (struct side){&none, -1, false};
}

void lattice_limit_start(const struct lattice_body *body, double (*z)[6])
{
    for (int i = 0; i < body->n; i++) {
        struct link_material m = body->materials[body->material[i]];
        double shift = 1 / sqrt(link_constants_mass(m, body->h)),
               turn = 1 / sqrt(link_constants_inertia(m, body->h));
        for (int c = 0; c < 6; c++) z[i][c] = c < 3 ? shift : turn;
    }
}

void lattice_limit_volume(const struct lattice_body *body, const double (*z)[6], double *s)
{
    struct constants constants = constants_create(body);
    for (int i = 0; i < body->n; i++) {
        struct link_material m = body->materials[body->material[i]];
        double lambda = link_constants_lambda(body->set, m), sum = 0, h = body->h;
        int missing = 0;
        for (int a = 0; a < 3; a++) {
            struct side low = side_of(&constants, i, 2 * a),
                        high = side_of(&constants, i, 2 * a + 1);
            sum += fabs(high.k->r_i - low.k->r_i) * z[i][a];
            if (low.beyond >= 0) sum += low.k->r_i * z[low.beyond][a];
            if (high.beyond >= 0) sum += high.k->r_i * z[high.beyond][a];
            missing += !low.exists + !high.exists;
        }
        s[i] = fabs(lambda) * h * h * h / (1 + missing * lambda / (4 * link_constants_shear(m))) *
               sum / (2 * h);
    }
    constants_free(constants);
}

/* Adds to y, the row of this cell in |K| z + |T|^T s, a link along (a, b, c): its part of the
 * diagonal, and the block of the cell beyond. */
static void add_link(const struct side *l, const double *z, const double (*all)[6], const double *s,
    int a, double h, double *y)
{
    int b = (a + 1) % 3, c = (a + 2) % 3;
    double arm = 0.5 * h, ks = l->k->ks, turn = ks * arm * arm, kb = l->k->kb;
    const double *o = l->beyond >= 0 ? all[l->beyond] : NULL;

    y[a] += l->k->kn * z[a];
    y[b] += ks * z[b];
    y[c] += ks * z[c];
    y[3 + a] += l->k->kt * z[3 + a];
    y[3 + b] += (turn + kb) * z[3 + b];
    y[3 + c] += (turn + kb) * z[3 + c];
    if (!o) return;
    y[a] += l->k->kn * o[a] + l->k->r_j / (2 * h) * s[l->beyond];
    y[b] += ks * (o[b] + arm * o[3 + c]);
    y[c] += ks * (o[c] + arm * o[3 + b]);
    y[3 + a] += l->k->kt * o[3 + a];
    y[3 + b] += fabs(turn - kb) * o[3 + b] + ks * arm * o[c];
    y[3 + c] += fabs(turn - kb) * o[3 + c] + ks * arm * o[b];
}

double lattice_limit_round(
    const struct lattice_body *body, const double (*z)[6], const double *s, double (*Bz)[6])
{
    struct constants constants = constants_create(body);
    double largest = 0, h = body->h;
    for (int i = 0; i < body->n; i++) {
        struct link_material m = body->materials[body->material[i]];
        double mass = link_constants_mass(m, h), inertia = link_constants_inertia(m, h), *y = Bz[i];
        memset(y, 0, sizeof *Bz);
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            struct side low = side_of(&constants, i, 2 * a),
                        high = side_of(&constants, i, 2 * a + 1);
            /* shift and turn of the cell itself; zero between equal links */
            double own = 0.5 * h * fabs(high.k->ks - low.k->ks);
            add_link(&low, z[i], z, s, a, h, y);
            add_link(&high, z[i], z, s, a, h, y);
            y[b] += own * z[i][3 + c];
            y[c] += own * z[i][3 + b];
            y[3 + b] += own * z[i][c];
            y[3 + c] += own * z[i][b];
            y[a] += fabs(high.k->r_i - low.k->r_i) / (2 * h) * s[i];
        }
        for (int c = 0; c < 6; c++) {
            y[c] /= c < 3 ? mass : inertia;
            largest = fmax(largest, y[c] / z[i][c]);
        }
    }
    constants_free(constants);
    return largest;
}

static bool is_uniform(const struct lattice_body *b)
{
    const struct link_material *first = &b->materials[b->material[0]];
    for (int i = 0; i < b->n; i++) {
        const struct link_material *m = &b->materials[b->material[i]];
        if (m->density < first->density || m->density > first->density || m->young < first->young ||
            m->young > first->young || m->poisson < first->poisson || m->poisson > first->poisson ||
            (b->walls && b->walls[i]))
            return false;
    }
    return true;
}

double lattice_limit_body(const struct lattice_body *body, int rounds)
{
    size_t n = (size_t)body->n;
    double bound = HUGE_VAL;
    if (n == 0) return 0;
    if (body->share) return lattice_limit_cut(body, rounds);
    if (is_uniform(body))
        return lattice_limit_uniform(body->set, body->materials[body->material[0]], body->h);
    double(*z)[6] = fail_alloc(n * sizeof *z), (*Bz)[6] = fail_alloc(n * sizeof *Bz),
    *s = fail_alloc(n * sizeof *s);
    lattice_limit_start(body, z);
    for (int round = 0; round < rounds; round++) {
        lattice_limit_volume(body, z, s);
        double largest = lattice_limit_round(body, z, s, Bz);
        bound = fmin(bound, largest);
        /* any positive vector will do: what shrinks to nothing (a part of its own, a cell without
         * links) stays put */
        for (size_t i = 0; i < n; i++)
            for (int c = 0; c < 6; c++)
                z[i][c] = Bz[i][c] > 1e-250 * largest ? Bz[i][c] / largest : z[i][c];
    }
    free(z);
    free(Bz);
    free(s);
    return sqrt(bound);
}
