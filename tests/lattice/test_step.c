/* Steps of each scheme on the device against the same laws on the host, bit for bit, with one
 * work-item per run and with one per cell; observed steps change nothing. Compiled once for each
 * set of features and each precision, see meson.build. */
#include "tests/limit/limit_test.h"

#include <string.h>

#include "comm/fail.h"
#include "lattice/lattice_break.h"
#include "lattice_host.h"
#include "lattice/lattice_stress.h"

static struct comm *comm;
static bool some; /* of the ways to lay the cells out */
static const double dt = 1e-4, gravity[3] = {0.5, -1, -9.81};

static void rows_at(void *context, double t, double from, double to, double *rows)
{
    (void)context;
    for (int r = 1; r < 5; r++)
        for (int k = 0; k < LOAD_WIDTH; k++) {
            double size = k < LOAD_BODY           ? 100
                          : k < LOAD_ACCELERATION ? 1000
                          : k < LOAD_VELOCITY + 3 ? 10
                                                  : 30;
            rows[r * LOAD_WIDTH + k] =
                size * (k < LOAD_VELOCITY ? sin(r + k + 3e3 * t) : cos(r * k + 2e3 * (from + to)));
        }
}

/* Cells and options that need just the features this test was compiled with. */
static struct lattice_cells *make(struct lattice_options *o, struct link_material material[2],
    double alpha[2], struct link_strength strength[4])
{
    const int size[3] = {37, 7, 5};
    int n_material = WITH_KINDS ? 2 : 1;
    material[0] =
        (struct link_material){1000, 2e7, WITH_VOLUME ? 0.3 : 0, WITH_LINK_DAMPING ? 2e-5 : 0};
    material[1] = (struct link_material){700, 1e7,
        WITH_SHEAR_APART ? 0.1
        : WITH_VOLUME    ? 0.3
                         : 0,
        0};
    alpha[0] = 20;
    alpha[1] = 50;
    o->dt = dt;
    o->turn = WITH_TURN;
    o->energy = WITH_ENERGY;
    o->real_is_float = REAL_IS_FLOAT;
    o->position_is_float = POSITION_IS_FLOAT;
    o->material = material;
    o->n_material = n_material;
    o->alpha = WITH_MASS_DAMPING ? alpha : NULL;
    o->n_row = WITH_LOADS ? 5 : 1;
    o->rows_at = rows_at;
    for (int k = 0; k < 4; k++)
        strength[k] = (struct link_strength){(4 + 2 * k) * 1e5, (10 - 2 * k) * 1e5, k % 3, 0, 0, 0};
    for (int k = 0; k < 2 && WITH_PRINCIPAL; k++)
        strength[k] = (struct link_strength){HUGE_VAL, HUGE_VAL, 0, (2 + k) * 5e4, 0.2 * k, k == 1};
    o->strength = WITH_BREAK ? strength : NULL;
    for (int a = 0; a < 3; a++) o->gravity[a] = WITH_GRAVITY ? gravity[a] : 0;
    struct lattice_cells *c =
        bodies_create(WITH_KINDS ? 2 : 1, size, 0.1, n_material, bodies_mixed);
    for (int64_t i = 0; i < c->n; i++) {
        if (!WITH_FIX) c->bits[i] &= 63;
        if (!WITH_LOADS) c->row[i] = 0;
    }
    if (WITH_SHARES) bodies_cut(c);
    bodies_shake(c, 5, 100);
    return c;
}

static void check_features(const struct lattice_features *f, enum lattice_scheme scheme)
{
    assert_int_equal(f->nystrom, scheme == LATTICE_RKN4);
    assert_true(f->turn == WITH_TURN && f->volume == WITH_VOLUME &&
                f->shear_apart == WITH_SHEAR_APART && f->twist_apart == WITH_TWIST_APART);
    assert_true(f->link_damping == WITH_LINK_DAMPING && f->mass_damping == WITH_MASS_DAMPING &&
                f->fix == WITH_FIX && f->loads == WITH_LOADS);
    assert_true(f->gravity == WITH_GRAVITY && f->kinds == WITH_KINDS && f->rk == WITH_RK &&
                f->energy == WITH_ENERGY && f->breakage == WITH_BREAK &&
                f->principal == WITH_PRINCIPAL && f->shares == WITH_SHARES);
}

static void same(const char *what, int64_t i, const double *device, double x, double y, double z)
{
    const double host[3] = {x, y, z};
    for (int a = 0; a < 3; a++)
        if (memcmp(&device[a], &host[a], sizeof(double)))
            fail_msg("%s[%d] of cell %lld: device %a, host %a", what, a, (long long)i, device[a],
                host[a]);
}

static void compare(const struct lattice *l, const struct link_cell *host)
{
    size_t n = (size_t)l->n_global;
    struct lattice_motion m = {fail_alloc(n * sizeof *m.u), fail_alloc(n * sizeof *m.theta),
        fail_alloc(n * sizeof *m.q), fail_alloc(n * sizeof *m.v), fail_alloc(n * sizeof *m.w)};
    lattice_read(l, &m);
    assert_int_equal(l->layout->n_owned, l->n_global);
    for (int64_t i = 0; i < l->n_global; i++) {
        const struct link_cell *c = &host[i];
        double qw = (double)c->q.w;
        same("u", i, m.u[i], (double)c->u.x, (double)c->u.y, (double)c->u.z);
        same("v", i, m.v[i], (double)c->v.x, (double)c->v.y, (double)c->v.z);
        same("w", i, m.w[i], (double)c->w.x, (double)c->w.y, (double)c->w.z);
        if (WITH_TURN)
            same("q", i, m.q[i] + 1, (double)c->q.v.x, (double)c->q.v.y, (double)c->q.v.z);
        if (WITH_TURN) assert_memory_equal(&m.q[i][0], &qw, sizeof qw);
        if (!WITH_TURN)
            same(
                "theta", i, m.theta[i], (double)c->theta.x, (double)c->theta.y, (double)c->theta.z);
    }
    free(m.u);
    free(m.theta);
    free(m.q);
    free(m.v);
    free(m.w);
}

static void compare_stress(struct lattice *l, const struct host *h, struct link_cell *seen)
{
    size_t n = (size_t)l->n_global;
    struct stress *host = fail_alloc(n * sizeof *host);
    real *von_mises = fail_alloc(n * sizeof *von_mises);
    double(*device)[9] = fail_alloc(n * sizeof *device),
    *equivalent = fail_alloc(n * sizeof *equivalent);
    for (int form = 0; form < 2; form++) {
        struct lattice_stress *s = lattice_stress_create(l, form == 1);
        lattice_stress_run(s, device, equivalent);
        lattice_stress_free(s);
        host_stress(h, seen, form, host, von_mises);
        for (int64_t i = 0; i < l->n_global; i++) {
            const struct stress *c = &host[i];
            double mises = (double)von_mises[i];
            same("stress x", i, device[i], (double)c->xx, (double)c->xy, (double)c->zx);
            same("stress y", i, device[i] + 3, (double)c->xy, (double)c->yy, (double)c->yz);
            same("stress z", i, device[i] + 6, (double)c->zx, (double)c->yz, (double)c->zz);
            if (memcmp(&equivalent[i], &mises, sizeof mises))
                fail_msg("von Mises of cell %lld: %a, %a", (long long)i, equivalent[i], mises);
        }
    }
    free(host);
    free(von_mises);
    free(device);
    free(equivalent);
}

/* Links left, and modes. Returns how many are broken: more than the `before` of the observation
 * before; some stay. */
static int64_t compare_links(
    const struct lattice *l, const struct host *h, int step, int64_t before)
{
    int32_t *links = fail_alloc((size_t)h->n * sizeof *links),
            *fate = fail_alloc((size_t)h->n * sizeof *fate);
    int64_t count[LATTICE_BREAK_MODES], counted[LATTICE_BREAK_MODES] = {0}, all = 0, left = 0;
    lattice_break_read(l->breakage, links, fate);
    lattice_break_count(l->breakage, count);
    for (int64_t i = 0; i < h->n; i++) {
        assert_int_equal(links[i], h->links[i]);
        assert_int_equal(fate[i], h->fate[i] | h->due[i] << FATE_DUE_AT);
        left += __builtin_popcount((unsigned)links[i]);
        for (int axis = 0; axis < 3; axis++)
            if (FATE_MODE(fate[i], axis)) counted[FATE_MODE(fate[i], axis) - 1]++;
    }
    for (int mode = 0; mode < LATTICE_BREAK_MODES; mode++) {
        assert_int_equal(count[mode], counted[mode]);
        all += count[mode];
    }
    printf("step %d: broken by tension %lld, shear %lld, bending %lld, twist %lld, left %lld\n",
        step, (long long)count[0], (long long)count[1], (long long)count[2], (long long)count[3],
        (long long)left / 2);
    assert_true(all > before && left > 0);
    free(links);
    free(fate);
    return all;
}

static void compare_ledger(const struct lattice *l, const struct host *h)
{
    if (!WITH_ENERGY) return;
    double *plane[LATTICE_LEDGER];
    for (int k = 0; k < LATTICE_LEDGER; k++) plane[k] = lattice_read_plane(l, &l->ledger, false, k);
    for (int64_t i = 0; i < l->n_global; i++) {
        const struct lattice_ledger *k = &h->ledger[i];
        const double device[3] = {plane[0][i], plane[1][i], plane[2][i]};
        same("ledger", i, device, k->work, k->links, k->mass);
    }
    for (int k = 0; k < LATTICE_LEDGER; k++) free(plane[k]);
}

/* Observed at steps 0, 3 and 7; between them no stress is asked for, after step 3 it must not
 * matter that it was. */
static void run(enum lattice_scheme scheme, bool one_lane, int axis, int length)
{
    struct link_material material[2];
    double alpha[2];
    struct lattice_options o = {.scheme = scheme, .run = {axis, length}};
    struct link_strength strength[4];
    struct lattice_cells *cells = make(&o, material, alpha, strength);
    struct device *dev = device_open(comm, NULL, false, false);
    if ((!POSITION_IS_FLOAT && !dev->fp64) || (REAL_IS_FLOAT && !dev->fp32_correct_divide))
        exit(77);
    dev->one_lane = one_lane;
    struct lattice *l = lattice_create(dev, comm, cells, &o);
    struct host *h = host_create(cells, &o);
    struct link_cell *seen = fail_alloc((size_t)cells->n * sizeof *seen);
    check_features(&l->features, scheme);
    bool observed = true;
    int64_t broken = 0;
    compare(l, h->now);
    for (int step = 1; step <= 7; step++) {
        if (observed) lattice_begin_step(l);
        observed = step == 3 || step == 7;
        lattice_advance(l, observed);
        host_step(h);
        if (!observed) continue;
        host_observe(h, seen);
        compare(l, seen);
        compare_stress(l, h, seen);
        if (WITH_BREAK) broken = compare_links(l, h, step, broken);
        compare_ledger(l, h);
    }
    free(seen);
    host_free(h);
    lattice_free(l);
    device_free(dev);
    bodies_free(cells);
}

/* The layout of `some`: by groups, as GPUs have it, or all cells of a batch by one work-item. */
enum { GROUPS = WITH_SHARES };

static void leapfrog(void **state)
{
    (void)state;
    run(LATTICE_LEAPFROG, !GROUPS, 0, 64);
    if (some) return;
    run(LATTICE_LEAPFROG, true, 1, 24);
    run(LATTICE_LEAPFROG, false, 2, 32);
}
static void pefrl(void **state)
{
    (void)state;
    run(LATTICE_PEFRL, some && !GROUPS, 0, some ? 64 : 32);
    if (!some) run(LATTICE_PEFRL, true, 2, 16);
}
static void vefrl(void **state)
{
    (void)state;
    run(LATTICE_VEFRL, !some || !GROUPS, 0, some ? 64 : 16);
}
static void rk4(void **state)
{
    (void)state;
    run(LATTICE_RK4, false, 1, 16);
    if (!some) run(LATTICE_RK4, true, 0, 32);
}
static void rkn4(void **state)
{
    (void)state;
    run(LATTICE_RKN4, true, 2, 16);
}

/* Argument: some, all schemes in one layout, which is one compilation; or all. */
int main(int argc, char **argv)
{
    const struct CMUnitTest split[] = {
        cmocka_unit_test(leapfrog), cmocka_unit_test(pefrl), cmocka_unit_test(vefrl)};
    const struct CMUnitTest rk[] = {cmocka_unit_test(rk4), cmocka_unit_test(rkn4)};
    (void)split;
    (void)rk;
    (void)leapfrog;
    comm = comm_create(&argc, &argv);
    some = argc > 1 && strcmp(argv[1], "some") == 0;
    int failed = WITH_RK ? cmocka_run_group_tests(rk, NULL, NULL)
                         : cmocka_run_group_tests(split, NULL, NULL);
    comm_free(comm);
    return failed;
}
