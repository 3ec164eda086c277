/* Random networks of spheres and walls: the bound against all eigenvalues, any sizes, stiffnesses
 * and damping. */
#include "limit_test.h"

#include "jacobi.h"
#include "kernels/contact/law_limit.h"

enum { N_MOST = 12, LINKS_MOST = 400, SMALL = 200 };

struct link {
    int i, j; /* j = -1: a wall */
    vec3 n;
    double l_i, l_j; /* levers */
    struct limit_ends ends;
    struct contact_material material;
    double delta;
};

struct network {
    int n, n_link;
    double x[3 * (SMALL + 1)], r[SMALL + 1], w[SMALL + 1];
    struct link link[LINKS_MOST];
};

static struct contact_material random_material(double spread, double z, bool friction, bool rolling)
{
    struct contact_material m = contact_material_linear(pow(10, uniform(0, spread)), uniform(0, z),
        friction ? uniform(0.1, 1) : 0, friction ? uniform(0, z) : 0);
    if (rolling) m = contact_material_rolling(m, uniform(0.1, 1), 2.25, uniform(0, z));
    return m;
}

static void add_link(
    struct network *net, int i, int j, double delta, vec3 n, struct contact_material m)
{
    assert_true(net->n_link < LINKS_MOST);
    struct link *k = &net->link[net->n_link++];
    k->i = i;
    k->j = j;
    k->n = n;
    k->delta = delta;
    k->material = m;
    k->l_i = net->r[i] - (j < 0 ? delta : 0.5 * delta);
    k->l_j = j < 0 ? 0 : net->r[j] - 0.5 * delta;
    k->ends =
        (struct limit_ends){net->w[i], j < 0 ? 0 : net->w[j], net->r[i], j < 0 ? 0 : net->r[j]};
}

/* Spheres at random places of a unit box, with its walls; every overlap is a contact, some bonded
 * from a little apart. */
static void random_network(
    struct network *net, double ratio, double spread, double z, bool friction, bool rolling)
{
    net->n = N_MOST;
    net->n_link = 0;
    for (int i = 0; i < net->n; i++) {
        for (int a = 0; a < 3; a++) net->x[3 * i + a] = uniform(0, 1);
        net->r[i] = 0.45 * pow(ratio, -uniform(0, 1));
        net->w[i] = 1 / pow(net->r[i], 3);
    }
    for (int i = 0; i < net->n; i++) {
        for (int j = i + 1; j < net->n; j++) {
            vec3 d = v3_sub(v3(net->x[3 * j], net->x[3 * j + 1], net->x[3 * j + 2]),
                v3(net->x[3 * i], net->x[3 * i + 1], net->x[3 * i + 2]));
            double distance = sqrt(v3_dot(d, d)), delta = net->r[i] + net->r[j] - distance;
            if (delta > -0.02 * fmin(net->r[i], net->r[j]))
                add_link(net, i, j, delta, v3_scale(1 / distance, d),
                    random_material(spread, z, friction, rolling));
        }
        for (int a = 0; a < 3; a++)
            if (net->x[3 * i + a] < net->r[i])
                add_link(net, i, -1, net->r[i] - net->x[3 * i + a],
                    v3(a == 0 ? -1 : 0, a == 1 ? -1 : 0, a == 2 ? -1 : 0),
                    random_material(spread, z, friction, rolling));
    }
}

static struct limit_contact contact_of(const struct link *k, double dt)
{
    return limit_contact_of(k->material, k->ends, k->delta, 0, dt);
}

static double bound(const struct network *net, double dt, double share)
{
    double least = LIMIT_NONE;
    for (int e = 0; e < net->n; e++) {
        struct limit_sums s = limit_sums_zero();
        for (int k = 0; k < net->n_link; k++) {
            const struct link *l = &net->link[k];
            struct limit_ends b = {l->ends.w_j, l->ends.w_i, l->ends.r_j, l->ends.r_i};
            if (l->i == e) s = limit_sums_add(s, contact_of(l, dt), l->ends, l->n, share);
            if (l->j == e) s = limit_sums_add(s, contact_of(l, dt), b, v3_neg(l->n), share);
        }
        least = fmin(least, limit_of_sums(s, LIMIT_NONE));
    }
    return least;
}

/* a += f g g^T in coordinates x m^(1/2), theta I^(1/2) of all spheres; g: the gradient of one
 * relative displacement at link k: translation t of i against -t of j, rotation turn_i, turn_j. */
static void add_square(double *a, const struct network *net, const struct link *k, double f, vec3 t,
    vec3 turn_i, vec3 turn_j)
{
    int size = 6 * net->n, end[2] = {k->i, k->j};
    double g[12];
    for (int b = 0; b < 2; b++) {
        double root = end[b] < 0 ? 0 : sqrt(net->w[end[b]]),
               spin = end[b] < 0 ? 0 : root * sqrt(2.5) / net->r[end[b]], sign = b ? -1 : 1;
        vec3 turn = b ? turn_j : turn_i;
        const double value[6] = {sign * root * t.x, sign * root * t.y, sign * root * t.z,
            spin * turn.x, spin * turn.y, spin * turn.z};
        for (int c = 0; c < 6; c++) g[6 * b + c] = value[c];
    }
    for (int p = 0; p < (k->j < 0 ? 6 : 12); p++)
        for (int q = 0; q < (k->j < 0 ? 6 : 12); q++)
            a[(6 * end[p / 6] + p % 6) * size + 6 * end[q / 6] + q % 6] += f * g[p] * g[q];
}

/* dt^2 K + 2 dt C, [6 n][6 n]; with dt_centre in the dashpots. */
static void assemble(
    const struct network *net, double dt, double damping, double dt_centre, double *a)
{
    int size = 6 * net->n;
    for (int i = 0; i < size * size; i++) a[i] = 0;
    for (int k = 0; k < net->n_link; k++) {
        const struct link *l = &net->link[k];
        struct limit_contact c = contact_of(l, dt_centre);
        vec3 n = l->n, zero = v3(0, 0, 0),
             t1 = v3_cross(n, fabs(n.x) < 0.6 ? v3(1, 0, 0) : v3(0, 1, 0));
        t1 = v3_scale(1 / sqrt(v3_dot(t1, t1)), t1);
        vec3 t[2] = {t1, v3_cross(n, t1)};
        add_square(a, net, l, dt * dt * c.k_n + damping * 2 * dt * c.gamma_n, n, zero, zero);
        for (int b = 0; b < 2; b++) {
            vec3 turn = v3_cross(n, t[b]);
            add_square(a, net, l, dt * dt * c.k_t + damping * 2 * dt * c.gamma_t, t[b],
                v3_scale(l->l_i, turn), v3_scale(l->l_j, turn));
            add_square(
                a, net, l, dt * dt * c.k_r + damping * 2 * dt * c.c_r, zero, t[b], v3_neg(t[b]));
        }
    }
}

static const double ratios[] = {1, 3, 10, 100};

/* Undamped: dt_bound/dt_true of many networks is never above 1, and near it on average. */
static void never_above(void **state)
{
    (void)state;
    static struct network net;
    static double a[36 * N_MOST * N_MOST];
    double sum = 0, least = 1, smallest, largest;
    int count = 0;
    for (int k = 0; k < 64; k++) {
        random_network(&net, ratios[k % 4], k / 4 % 3 * 2, 0, k / 12 % 3 > 0, k % 5 == 0);
        if (net.n_link == 0) continue;
        assemble(&net, 1, 0, 0, a);
        jacobi(a, 6 * net.n, &smallest, &largest);
        double ratio = fmax(bound(&net, 0, 1), bound(&net, 0, 0.7)) / (2 / sqrt(largest));
        assert_between(ratio, 0.4, 1);
        sum += ratio;
        least = fmin(least, ratio);
        count++;
    }
    print_message(
        "bound over true limit: mean %.3f, least %.3f of %d networks\n", sum / count, least, count);
    assert_between(sum / count, 0.75, 0.99);
}

/* Damped: 4 - dt^2 K - 2 dt C is positive at the bound, with the dashpots of a step of almost
 * nothing and with those of that very step. */
static void damped(void **state)
{
    (void)state;
    static struct network net;
    static double a[36 * N_MOST * N_MOST];
    static const double z[] = {0.02, 0.3, 1, 5};
    double smallest, largest;
    for (int k = 0; k < 48; k++) {
        random_network(&net, ratios[k % 4], k / 16 * 2, z[k / 4 % 4], k % 3 > 0, k % 2);
        if (net.n_link == 0) continue;
        double first = bound(&net, 0, 0.8), centred = first;
        assemble(&net, first, 1, 0, a);
        jacobi(a, 6 * net.n, &smallest, &largest);
        assert_between(largest, 0.4, 4);
        for (int round = 0; round < 8; round++) centred = bound(&net, centred, 0.8);
        assert_true(centred >= first);
        assemble(&net, centred, 1, centred, a);
        jacobi(a, 6 * net.n, &smallest, &largest);
        assert_between(largest, 0.4, 4);
    }
}

/* Matrices of the scheme's linear step: x'' from x, from V and from V - V_, each [6 n][6 n]. */
struct scheme {
    double x[36 * N_MOST * N_MOST], v[36 * N_MOST * N_MOST], change[36 * N_MOST * N_MOST];
};

/* Linear normal contacts: V' - V = -dt^2 K x - dt sum gamma [p V + (q/2) (V - V_)]. */
static void scheme_of(struct scheme *s, const struct network *net, double dt)
{
    int size = 6 * net->n;
    vec3 zero = v3(0, 0, 0);
    for (int i = 0; i < size * size; i++) s->x[i] = s->v[i] = s->change[i] = 0;
    for (int k = 0; k < net->n_link; k++) {
        const struct link *l = &net->link[k];
        double m = 1 / (l->ends.w_i + l->ends.w_j), gamma = l->material.gamma_n * sqrt(m);
        struct contact_parameters p = contact_parameters_of(
            l->material, (struct contact_pair){m, limit_r_star(l->ends), 0.4 * m}, dt);
        double c = p.centring_n, damp = p.damp_n;
        add_square(s->x, net, l, dt * dt * p.k_n, l->n, zero, zero);
        add_square(s->v, net, l, dt * gamma * normal_keep(c, p.turning_n, damp), l->n, zero, zero);
        add_square(s->change, net, l, 0.5 * dt * gamma * normal_gain(c, damp), l->n, zero, zero);
    }
}

/* The bound holds in the scheme itself: light and heavy, stiff and soft, damped little and much,
 * any motion stays as large as it was, by the factor that leapfrog's energy allows. */
static void stable_at_the_bound(void **state)
{
    (void)state;
    enum { STEPS = 2000 };
    static struct network net;
    static struct scheme s;
    static const double z[] = {0.02, 0.3, 1, 5};
    double x[6 * N_MOST], v[6 * N_MOST], before[6 * N_MOST], next[6 * N_MOST];
    for (int k = 0; k < 16; k++) {
        random_network(&net, ratios[k % 4], 3, z[k / 4], false, false);
        int size = 6 * net.n;
        double dt = bound(&net, 0, 1), early = 0, late = 0;
        for (int round = 0; round < 8; round++) dt = bound(&net, dt, 1);
        scheme_of(&s, &net, 0.999 * dt);
        for (int i = 0; i < size; i++) {
            x[i] = 0;
            v[i] = before[i] = uniform(-1, 1);
        }
        for (int n = 0; n < STEPS; n++) {
            for (int i = 0; i < size; i++) {
                x[i] += v[i];
                next[i] = v[i];
            }
            for (int i = 0; i < size; i++)
                for (int j = 0; j < size; j++)
                    next[i] -= s.x[i * size + j] * x[j] + s.v[i * size + j] * v[j] +
                               s.change[i * size + j] * (v[j] - before[j]);
            double square = 0;
            for (int i = 0; i < size; i++) {
                before[i] = v[i];
                v[i] = next[i];
                square += v[i] * v[i];
            }
            if (n < STEPS / 10) early = fmax(early, square);
            if (n >= STEPS * 9 / 10) late = fmax(late, square);
        }
        assert_true(late <= early * (1 + 1e-9));
    }
}

/* Largest eigenvalue of K over M by repeated multiplication, from below; no friction. */
static double power(const struct network *net)
{
    static double x[3 * (SMALL + 1)], y[3 * (SMALL + 1)];
    double norm = 0;
    for (int i = 0; i < 3 * net->n; i++) x[i] = uniform(-1, 1);
    for (int round = 0; round < 2000; round++) {
        norm = 0;
        for (int i = 0; i < 3 * net->n; i++) y[i] = 0;
        for (int k = 0; k < net->n_link; k++) {
            const struct link *l = &net->link[k];
            const double n[3] = {l->n.x, l->n.y, l->n.z};
            double u = 0, wi = sqrt(net->w[l->i]), wj = l->j < 0 ? 0 : sqrt(net->w[l->j]);
            for (int c = 0; c < 3; c++)
                u += n[c] * (wi * x[3 * l->i + c] - (l->j < 0 ? 0 : wj * x[3 * l->j + c]));
            for (int c = 0; c < 3; c++) {
                y[3 * l->i + c] += l->material.k_n * u * n[c] * wi;
                if (l->j >= 0) y[3 * l->j + c] -= l->material.k_n * u * n[c] * wj;
            }
        }
        for (int i = 0; i < 3 * net->n; i++) norm += y[i] * y[i];
        norm = sqrt(norm);
        for (int i = 0; i < 3 * net->n; i++) x[i] = y[i] / norm;
    }
    return norm;
}

/* Many small spheres on a large one of ten times their size: the case that weights 1/m would get
 * wrong by a factor of 8. */
static void small_on_large(void **state)
{
    (void)state;
    static struct network net;
    struct contact_material m = contact_material_linear(1, 0, 0, 0);
    net.n = SMALL + 1;
    net.n_link = 0;
    net.r[SMALL] = 1;
    net.w[SMALL] = 1;
    for (int i = 0; i < SMALL; i++) { /* evenly on a spiral */
        double z = 1 - (2 * i + 1.0) / SMALL, rho = sqrt(1 - z * z), phi = i * M_PI * (3 - sqrt(5));
        vec3 n = v3(rho * cos(phi), rho * sin(phi), z);
        net.r[i] = 0.1;
        net.w[i] = 1000;
        add_link(&net, i, SMALL, 0.001, v3_neg(n), m);
    }
    double truth = 2 / sqrt(power(&net));
    assert_between(bound(&net, 0, 1) / truth, 0.6, 1 + 1e-3);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(never_above), cmocka_unit_test(damped),
        cmocka_unit_test(stable_at_the_bound), cmocka_unit_test(small_on_large)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
