#include "lattice_host.h"

#include <string.h>

/* NULL: the cells are whole. */
static const real *shares_of(const struct host *h, int64_t i)
{
    return WITH_SHARES ? h->share + h->cells->share_of[i] * SHARE_WIDTH : NULL;
}

static real per_mass(const struct host *h, int64_t i)
{
    real whole = h->cell[h->cells->kind_of[i] * CELL_WIDTH];
    return WITH_SHARES ? whole * shares_of(h, i)[SHARE_PER_MASS] : whole;
}

static struct link_constants constants(
    const struct host *h, int64_t lower, int64_t higher, int axis)
{
    struct link_constants k;
    const real *row =
        h->link +
        (h->cells->kind_of[lower] * h->cells->n_kind + h->cells->kind_of[higher]) * LINK_WIDTH;
    k = lattice_constants_of(row);
    if (WITH_SHARES) k = lattice_constants_cut(k, shares_of(h, lower), 2 * axis + 1);
    return k;
}

static void load_rows(struct host *h, double t, double from, double to)
{
    if (!WITH_LOADS) return;
    h->options.rows_at(h->options.context, t, from, to, h->rows_double);
    for (int i = 0; i < h->options.n_row * LOAD_WIDTH; i++) h->rows[i] = (real)h->rows_double[i];
}

static struct lattice_load load_of(const struct host *h, int64_t i)
{
    struct lattice_load load;
    const real *row = h->rows + h->cells->row[i] * LOAD_WIDTH;
    load = lattice_load_of(row);
    return load;
}

/* The cell without its velocities. */
static struct link_cell at_rest(struct link_cell c)
{
    c.v = c.w = v3(0, 0, 0);
    return c;
}

static void pressures_in(const struct host *h, bool still, real *p)
{
    for (int64_t i = 0; i < h->n; i++) {
        const real *cell = h->cell + h->cells->kind_of[i] * CELL_WIDTH;
        struct link_cell me = still ? at_rest(h->now[i]) : h->now[i];
        real sum = 0;
        for (int f = 0; f < 6; f++) {
            int64_t j = h->neighbour[i][f];
            struct link_cell other = j < 0 ? me : still ? at_rest(h->now[j]) : h->now[j];
            if (j >= 0)
                sum += lattice_stretch(f, 1, me, other,
                    f % 2 ? constants(h, i, j, f / 2) : constants(h, j, i, f / 2), cell[5]);
            else sum += 0;
        }
        struct volume_constants c;
        c = lattice_volume_of(cell, shares_of(h, i), h->links[i]);
        p[i] = c.lambda *
               volume_strain(sum, WITH_LOADS ? load_of(h, i).traction : (real)0, h->links[i], c);
    }
}

static void pressures(struct host *h)
{
    if (!WITH_VOLUME) return;
    pressures_in(h, false, h->p);
    pressures_in(h, true, h->p_still);
}

struct pull {
    vec3 a, b, given_v, given_w, now_v, now_w;
    struct lattice_effort effort;
};

static const struct link_share none;
static const struct lattice_effort none_acts;

static struct link_share share_of(const struct host *h, int64_t i, int face, bool still)
{
    int64_t j = h->neighbour[i][face];
    if (j < 0) return none;
    const real *p = still ? h->p_still : h->p;
    struct link_constants k =
        face % 2 ? constants(h, i, j, face / 2) : constants(h, j, i, face / 2);
    return lattice_link(face, 1, still ? at_rest(h->now[i]) : h->now[i],
        still ? at_rest(h->now[j]) : h->now[j], k, p[i], p[j]);
}

static struct link_share links_of(const struct host *h, int64_t i, bool still)
{
    struct link_share sum = none;
    for (int f = 0; f < 6; f++) sum = lattice_add(sum, share_of(h, i, f, still));
    return sum;
}

static struct lattice_effort effort_of(const struct host *h, int64_t i, vec3 gravity)
{
    const real *cell = h->cell + h->cells->kind_of[i] * CELL_WIDTH;
    struct lattice_effort e = {
        .links = links_of(h, i, false), .still = links_of(h, i, true), .weight = gravity};
    if (!WITH_LOADS) return e;
    struct lattice_load load = load_of(h, i);
    e.loads = lattice_load_add(none, h->now[i], load);
    e.added = load.acceleration;
    e.v = load.now_v;
    e.w = load.now_w;
    if (WITH_VOLUME) e.face = cell[7] * cell[3] * h->p_still[i] * load.rate;
    return e;
}

static struct pull pull_of(const struct host *h, int64_t i)
{
    struct link_share sum = links_of(h, i, false);
    struct pull r = {.effort = none_acts};
    const real *cell = h->cell + h->cells->kind_of[i] * CELL_WIDTH;
    vec3 add =
        v3((real)h->options.gravity[0], (real)h->options.gravity[1], (real)h->options.gravity[2]);
    if (WITH_ENERGY) r.effort = effort_of(h, i, add);
    if (WITH_LOADS) {
        struct lattice_load load = load_of(h, i);
        sum = lattice_load_add(sum, h->now[i], load);
        add = v3_add(add, load.acceleration);
        r.given_v = load.v;
        r.given_w = load.w;
        r.now_v = load.now_v;
        r.now_w = load.now_w;
    }
    r.a = WITH_LOADS || WITH_GRAVITY ? v3_fma(per_mass(h, i), sum.force, add)
                                     : v3_scale(per_mass(h, i), sum.force);
    r.b = v3_scale(cell[1], sum.torque);
    return r;
}

static void hold(const struct host *h, int64_t i, struct link_cell *c, vec3 v, vec3 w)
{
    c->v = lattice_hold(c->v, h->cells->bits[i], WORD_FIX, v);
    c->w = lattice_hold(c->w, h->cells->bits[i], WORD_FIX + 3, w);
}

/* The kicks of row k, counted as bits of `count` say, and a drift over `drift` s unless it is 0. */
static void split(struct host *h, int k, double drift, int count, struct link_cell *to)
{
    for (int64_t i = 0; i < h->n; i++) {
        const real *kick = h->kick + (k * h->cells->n_kind + h->cells->kind_of[i]) * KICK_WIDTH;
        struct pull r = pull_of(h, i);
        struct link_cell c = h->now[i];
        const real *cell = h->cell + h->cells->kind_of[i] * CELL_WIDTH;
        struct lattice_kick part[2];
        part[0] = lattice_kick_of(kick);
        part[1] = lattice_kick_of(kick + KICK_PART);
        h->ledger[i] = lattice_work_split(h->ledger[i], r.effort, c, r.a, r.b, part[0], part[1],
            h->cells->bits[i], (double)cell[6], 1 / (double)per_mass(h, i), 1 / (double)cell[1],
            count);
        for (int n = 0; n < 2; n++) {
            c.v = lattice_kick(c.v, r.a, part[n].f, part[n].g);
            c.w = lattice_kick(c.w, r.b, part[n].f, part[n].g);
        }
        hold(h, i, &c, r.given_v, r.given_w);
        to[i] = fabs(drift) > 0 ? lattice_drift(c, (preal)drift) : c;
    }
}

/* Stress of a cell in its own axes, and the forces that make it. */
static struct stress stress_of(
    const struct host *h, int64_t i, bool extrapolate, struct lattice_through *f)
{
    struct lattice_load load = {.traction = 0};
    vec3 *const force[6] = {&f->x[0], &f->x[1], &f->y[0], &f->y[1], &f->z[0], &f->z[1]};
    real edge = h->link[h->cells->kind_of[i] * (h->cells->n_kind + 1) * LINK_WIDTH + 6];
    for (int face = 0; face < 6; face++) *force[face] = share_of(h, i, face, false).force;
    if (WITH_LOADS) load = load_of(h, i);
    if (WITH_SHARES && h->cells->share_of[i])
        return lattice_stress_cut(*f, h->now[i], h->links[i], edge, shares_of(h, i));
    return lattice_stress_of(*f, h->now[i], load, h->links[i], edge, extrapolate);
}

/* What is due goes with this step; then every cell says what is due next. */
static void judge_cells(struct host *h)
{
    for (int64_t i = 0; i < h->n; i++)
        for (int axis = 0; axis < 3; axis++) {
            int64_t j = h->neighbour[i][2 * axis + 1];
            if (j >= 0)
                h->fate[i] |= lattice_due(h->links[i] | h->due[i] << WORD_DUE_AT,
                    h->links[j] | h->due[j] << WORD_DUE_AT, axis);
        }
    for (int64_t i = 0; i < h->n; i++) {
        int fate[3];
        struct lattice_through f;
        struct stress s = stress_of(h, i, false, &f);
        for (int axis = 0; axis < 3; axis++) {
            int64_t j = h->neighbour[i][2 * axis];
            fate[axis] = j < 0 ? 0 : h->fate[j];
        }
        bool waits = lattice_gone(h->fate[i], fate[0], fate[1], fate[2]) & h->links[i];
        const real *inverse = &h->inverse[h->cells->kind_of[i]];
        h->due[i] = !waits && principal_fails(s, *inverse)
                        ? lattice_principal(f, s, h->now[i], h->links[i], *inverse,
                              inverse[h->cells->n_kind],
                              (real)lattice_features_lot(h->cells, &h->options, i))
                        : 0;
    }
}

/* Every link once, in the state that h->now and h->p are of. */
static void judge(struct host *h)
{
    for (int64_t i = 0; i < h->n && h->limit; i++)
        for (int axis = 0; axis < 3; axis++) {
            int64_t j = h->neighbour[i][2 * axis + 1];
            struct break_limits limits;
            if (j < 0) continue;
            const real *row =
                h->limit +
                (h->cells->kind_of[i] * h->cells->n_kind + h->cells->kind_of[j]) * BREAK_WIDTH;
            LATTICE_LIMITS(limits, row);
            if (WITH_SHARES)
                limits = lattice_limits_cut(limits, shares_of(h, i)[SHARE_FACE + 2 * axis + 1]);
            h->fate[i] |= lattice_fate(
                axis, h->now[i], h->now[j], constants(h, i, j, axis), h->p[i], h->p[j], limits);
        }
    if (WITH_PRINCIPAL) judge_cells(h);
}

static void part(struct host *h)
{
    for (int64_t i = 0; i < h->n; i++)
        for (int axis = 0; axis < 3; axis++) {
            int64_t j = h->neighbour[i][2 * axis + 1];
            if (!FATE_MODE(h->fate[i], axis) || j < 0) continue;
            h->links[i] &= ~CELL_LINK(2 * axis + 1);
            h->links[j] &= ~CELL_LINK(2 * axis);
            h->neighbour[i][2 * axis + 1] = h->neighbour[j][2 * axis] = -1;
        }
}

static void split_step(struct host *h)
{
    double dt = h->options.dt, at = h->scheme->first;
    if (at > 0) {
        double t = (double)h->step * dt;
        load_rows(h, t, t, t);
        if (WITH_VOLUME) pressures(h);
        judge(h);
        load_rows(h, t, t, t + at * dt);
        for (int64_t i = 0; i < h->n; i++) {
            if (WITH_LOADS) hold(h, i, &h->now[i], load_of(h, i).v, load_of(h, i).w);
            h->now[i] = lattice_drift(h->now[i], (preal)(at * dt));
        }
    }
    for (int k = 0; k < h->scheme->n; k++) {
        const struct lattice_op *op = &h->scheme->op[k];
        double t = ((double)h->step + at) * dt;
        load_rows(h, t, t, t + op->drift * dt);
        pressures(h);
        if (k == 0 && h->scheme->ends_with_kick) judge(h);
        split(h, k == 0 && h->scheme->ends_with_kick && !h->started ? h->scheme->n + 1 : k,
            op->drift * dt, k == 0 && h->counted ? 2 : 3, h->next);
        h->counted = false;
        memcpy(h->now, h->next, (size_t)h->n * sizeof *h->now);
        at += op->drift;
    }
    part(h);
    h->started = true;
}

static struct lattice_stage stage_of(const struct host *h, int k)
{
    const struct lattice_rk *c = &h->scheme->rk[k];
    double dt = h->options.dt, square = dt * dt;
    return (struct lattice_stage){(preal)(c->sum_v * dt), (preal)(c->sum_a * square),
        (preal)(c->next_v * dt), (preal)(c->next_a * square), (preal)(c->next_turn * dt),
        (preal)(c->sum_turn * dt), (real)(c->sum_k * dt), (real)(c->next_k * dt), k == 0,
        k == h->scheme->n - 1, h->scheme->is_nystrom};
}

/* The stage's part in the ledger. */
static void enter(struct host *h, int64_t i, struct link_cell c, const struct pull *r, int k)
{
    const struct lattice_rk *of = &h->scheme->rk[k];
    const real *cell = h->cell + h->cells->kind_of[i] * CELL_WIDTH;
    struct lattice_speed speed = {
        (real)(of->before * h->options.dt), (real)(of->own * h->options.dt)};
    if (h->scheme->is_nystrom)
        c = lattice_speed_of(c, r->a, r->b, h->last_a[i], h->last_b[i], speed, k == 0);
    h->last_a[i] = r->a;
    h->last_b[i] = r->b;
    h->ledger[i] = lattice_work_stage(h->ledger[i], r->effort, c, h->cells->bits[i],
        (double)cell[6], 1 / (double)per_mass(h, i), 1 / (double)cell[1],
        (double)(real)(of->sum_k * h->options.dt));
}

static void rk_step(struct host *h)
{
    memcpy(h->start, h->now, (size_t)h->n * sizeof *h->now);
    for (int k = 0; k < h->scheme->n; k++) {
        struct lattice_stage stage = stage_of(h, k);
        double t = ((double)h->step + h->scheme->rk[k].at) * h->options.dt;
        double next = ((double)h->step + (k + 1 < h->scheme->n ? h->scheme->rk[k + 1].at : 1)) *
                      h->options.dt;
        load_rows(h, t, next, next);
        pressures(h);
        if (k == 0) judge(h);
        for (int64_t i = 0; i < h->n; i++) {
            const real alpha = h->cell[h->cells->kind_of[i] * CELL_WIDTH + 6];
            struct pull r = pull_of(h, i);
            struct link_cell c = h->now[i];
            if (k == 0) h->sums[i] = lattice_sums_zero();
            enter(h, i, c, &r, k);
            hold(h, i, &c, r.now_v, r.now_w);
            if (WITH_MASS_DAMPING) {
                r.a = v3_fma(-alpha, c.v, r.a);
                r.b = v3_fma(-alpha, c.w, r.b);
            }
            r.a = lattice_hold(r.a, h->cells->bits[i], WORD_FIX, v3(0, 0, 0));
            r.b = lattice_hold(r.b, h->cells->bits[i], WORD_FIX + 3, v3(0, 0, 0));
            struct link_cell mean = c;
            hold(h, i, &mean, v3_scale((real)0.5, v3_add(r.now_v, r.given_v)),
                v3_scale((real)0.5, v3_add(r.now_w, r.given_w)));
            h->next[i] =
                lattice_stage_next(c, h->start[i], r.a, r.b, mean.v, mean.w, stage, &h->sums[i]);
            hold(h, i, &h->next[i], r.given_v, r.given_w);
        }
        memcpy(h->now, h->next, (size_t)h->n * sizeof *h->now);
    }
    part(h);
}

void host_step(struct host *h)
{
    if (h->scheme->is_rk) rk_step(h);
    else split_step(h);
    h->step++;
}

void host_observe(struct host *h, struct link_cell *seen)
{
    memcpy(seen, h->now, (size_t)h->n * sizeof *seen);
    if (!h->scheme->ends_with_kick) return;
    struct host copy = *h;
    double t = (double)h->step * h->options.dt;
    load_rows(&copy, t, t, t);
    pressures(&copy);
    split(&copy, h->scheme->n, 0, 1, seen);
    h->counted = true;
}

void host_stress(const struct host *h, struct link_cell *seen, bool extrapolate,
    struct stress *stress, real *von_mises)
{
    struct host copy = *h;
    double t = (double)h->step * h->options.dt;
    copy.now = seen;
    load_rows(&copy, t, t, t);
    pressures(&copy);
    for (int64_t i = 0; i < h->n; i++) {
        struct lattice_through f;
        struct stress s = stress_of(&copy, i, extrapolate, &f);
        stress[i] = lattice_stress_world(s, seen[i]);
        von_mises[i] = stress_von_mises(s);
    }
}
