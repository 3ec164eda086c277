/* The lattice: forces of the six links of each owned cell, loads, and the cell's next state, in one
 * pass. No atomics, no sums across cells: each link is evaluated at both ends, from exact copies,
 * in the same order.
 *
 * One work-group per run of BATCH cells (lattice_view.h). Positions go from one set of planes to
 * another, since neighbours still read the old ones; velocities stay in place unless links are
 * damped. A run of one material without loads or fixed DOF needs no table per cell and has a loop
 * of its own.
 *
 * lint: WITH_ENERGY needs fp64
 * lint: WITH_SHEAR_APART requires WITH_VOLUME
 * lint: WITH_NYSTROM requires WITH_RK */
#include "link_account.h"

/* Accelerations of a cell, and what holds it. */
struct lattice_pull {
    vec3 a, b; /* [m/s2] [rad/s2] */
    /* of fixed DOF: during the drift, or at the next stage [m/s] [rad/s] */
    vec3 given_v, given_w;
    vec3 now_v, now_w; /* of fixed DOF at this stage; Runge-Kutta's alone */
#if WITH_ENERGY
    struct lattice_effort effort;
#endif
};

LAW struct lattice_pull lattice_pull_of(int mixed, struct lattice_view s, size_t l, int word,
    struct link_cell me, __global const real *cell, __global const int *row,
    __global const real *rows, vec3 gravity)
{
    struct lattice_pull r;
    struct link_share sum = lattice_links(mixed, s, l, word, me);
    vec3 add = gravity;
    r.given_v = r.given_w = r.now_v = r.now_w = v3(0, 0, 0);
#if WITH_ENERGY
    r.effort = lattice_effort_of(mixed, s, l, word, me, sum, cell, row, rows, gravity);
#endif
    if (WITH_LOADS && mixed) {
        struct lattice_load load;
        __global const real *at = rows + (size_t)row[s.begin + l] * LOAD_WIDTH;
        load = lattice_load_of(at);
        sum = lattice_load_add(sum, me, load);
        add = WITH_GRAVITY ? v3_add(gravity, load.acceleration) : load.acceleration;
        r.given_v = load.v;
        r.given_w = load.w;
        r.now_v = load.now_v;
        r.now_w = load.now_w;
    }
    real per_mass = lattice_per_mass(mixed, s, s.begin + l, cell);
    r.a = WITH_GRAVITY || (WITH_LOADS && mixed) ? v3_fma(per_mass, sum.force, add)
                                                : v3_scale(per_mass, sum.force);
    r.b = v3_scale(cell[1], sum.torque);
    return r;
}

LAW void lattice_keep(
    __global preal *x, __global real *v, size_t plane, size_t i, struct link_cell c)
{
    p3_store(x, plane, 0, i, c.u);
    if (WITH_TURN) {
        x[3 * plane + i] = c.q.w;
        x[4 * plane + i] = c.q.v.x;
        x[5 * plane + i] = c.q.v.y;
        x[6 * plane + i] = c.q.v.z;
    } else {
        p3_store(x, plane, 3, i, c.theta);
    }
    v3_store(v, plane, 0, i, c.v);
    v3_store(v, plane, 3, i, c.w);
}

#if !WITH_RK
/* Kick, kick, drift. `kick`: row of the table for the cell's kind. */
LAW struct link_cell lattice_move(int mixed, struct link_cell c, struct lattice_pull pull, int word,
    __global const real *kick, preal drift)
{
    c.v = lattice_kick(c.v, pull.a, kick[0], kick[1]);
    c.v = lattice_kick(c.v, pull.a, kick[KICK_PART], kick[KICK_PART + 1]);
    c.w = lattice_kick(c.w, pull.b, kick[0], kick[1]);
    c.w = lattice_kick(c.w, pull.b, kick[KICK_PART], kick[KICK_PART + 1]);
    if ((WITH_FIX || WITH_LOADS) && mixed) {
        c.v = lattice_hold(c.v, word, WORD_FIX, pull.given_v);
        c.w = lattice_hold(c.w, word, WORD_FIX + 3, pull.given_w);
    }
    return lattice_drift(c, drift);
}
#else
LAW struct lattice_sums lattice_sums_of(
    __global const preal *sum_x, __global const real *sum_v, size_t plane, size_t i, int is_first)
{
    struct lattice_sums s, zero = lattice_sums_zero();
    s.u = p3_load(sum_x, plane, 0, i);
    s.turn = p3_load(sum_x, plane, 3, i);
    s.r = p3(0, 0, 0);
    if (WITH_TURN) s.r = p3_load(sum_x, plane, 6, i);
    s.v = v3_load(sum_v, plane, 0, i);
    s.w = v3_load(sum_v, plane, 3, i);
    s.u = p3_choose(is_first, zero.u, s.u);
    s.turn = p3_choose(is_first, zero.turn, s.turn);
    s.r = p3_choose(is_first, zero.r, s.r);
    s.v = v3_choose(is_first, zero.v, s.v);
    s.w = v3_choose(is_first, zero.w, s.w);
    return s;
}

LAW void lattice_sums_keep(
    __global preal *sum_x, __global real *sum_v, size_t plane, size_t i, struct lattice_sums s)
{
    p3_store(sum_x, plane, 0, i, s.u);
    p3_store(sum_x, plane, 3, i, s.turn);
    if (WITH_TURN) p3_store(sum_x, plane, 6, i, s.r);
    v3_store(sum_v, plane, 0, i, s.v);
    v3_store(sum_v, plane, 3, i, s.w);
}

/* alpha: mass-proportional damping of the cell's kind [1/s]. */
LAW struct link_cell lattice_advance(int mixed, struct link_cell c, struct link_cell start,
    struct lattice_pull pull, int word, real alpha, struct lattice_stage stage,
    struct lattice_sums *sum)
{
    vec3 zero = v3(0, 0, 0), mean_v, mean_w;
    int held = (WITH_FIX || WITH_LOADS) && mixed;
    if (held) {
        c.v = lattice_hold(c.v, word, WORD_FIX, pull.now_v);
        c.w = lattice_hold(c.w, word, WORD_FIX + 3, pull.now_w);
    }
    if (WITH_MASS_DAMPING) {
        pull.a = v3_fma(-alpha, c.v, pull.a);
        pull.b = v3_fma(-alpha, c.w, pull.b);
    }
    if (held) {
        pull.a = lattice_hold(pull.a, word, WORD_FIX, zero);
        pull.b = lattice_hold(pull.b, word, WORD_FIX + 3, zero);
    }
    mean_v = c.v;
    mean_w = c.w;
    if (held) {
        mean_v = lattice_hold(
            mean_v, word, WORD_FIX, v3_scale((real)0.5, v3_add(pull.now_v, pull.given_v)));
        mean_w = lattice_hold(
            mean_w, word, WORD_FIX + 3, v3_scale((real)0.5, v3_add(pull.now_w, pull.given_w)));
    }
    c = lattice_stage_next(c, start, pull.a, pull.b, mean_v, mean_w, stage, sum);
    if (held) {
        c.v = lattice_hold(c.v, word, WORD_FIX, pull.given_v);
        c.w = lattice_hold(c.w, word, WORD_FIX + 3, pull.given_w);
    }
    return c;
}
#endif

/* What each cell of a run needs of the kernel's arguments. Members of features that are off are
 * not set. */
struct link_pass {
    struct lattice_view s;  /* the run, in the state that the forces are of */
    __global preal *x, *x0; /* planes that are written; of the step's start, Runge-Kutta's alone */
    __global real *v, *v0;
    __global const real *cell; /* table of CELL_WIDTH */
    __global const int *row;   /* [cells] of the table of loads; WITH_LOADS */
    __global const real *rows;
    vec3 gravity;
#if WITH_ENERGY
    __global double *ledger;
#endif
#if WITH_RK
    __global preal *sum_x;
    __global real *sum_v;
    struct lattice_stage stage;
#if WITH_ENERGY
    struct lattice_speed speed;
#endif
#else
    __global const real *kick; /* table of KICK_WIDTH */
    preal drift;
    int count;
#endif
};

#if WITH_ENERGY
/* What acted on cell i goes into the ledger. kind: of the cell, row of the tables. */
LAW void link_account(int mixed, struct link_pass p, struct link_cell c, struct lattice_pull pull,
    int word, int kind, size_t i)
{
    __global const real *cell = p.cell + kind * CELL_WIDTH;
#if WITH_RK
    real per_mass = lattice_per_mass(mixed, p.s, i, cell);
    link_account_stage(pull.effort, c, pull.a, pull.b, mixed ? word : 0, cell, per_mass, p.stage,
        p.speed, p.sum_v + LATTICE_V * p.s.plane, p.ledger, p.s.plane, i);
#else
    real per_mass = lattice_per_mass(mixed, p.s, i, cell);
    link_account_kicks(pull.effort, c, pull.a, pull.b, mixed ? word : 0, cell, per_mass,
        p.kick + kind * KICK_WIDTH, p.count, p.ledger, p.s.plane, i);
#endif
}
#endif

/* Cell i after this evaluation. */
LAW struct link_cell link_next(int mixed, struct link_pass p, struct link_cell c,
    struct lattice_pull pull, int word, int kind, size_t i)
{
#if WITH_RK
    struct lattice_view s0 = p.s;
    s0.x = p.x0;
    s0.v = p.v0;
    struct link_cell start = lattice_moving(s0, i, lattice_cell(s0, i));
    struct lattice_sums sum = lattice_sums_of(p.sum_x, p.sum_v, p.s.plane, i, p.stage.is_first);
    real alpha = p.cell[kind * CELL_WIDTH + 6];
    c = lattice_advance(mixed, c, start, pull, word, alpha, p.stage, &sum);
    lattice_sums_keep(p.sum_x, p.sum_v, p.s.plane, i, sum);
#else
    (void)i;
    c = lattice_move(mixed, c, pull, word, p.kick + kind * KICK_WIDTH, p.drift);
#endif
    return c;
}

/* Fetches what a later piece of the run reads and writes. */
LAW void link_fetch(struct link_pass p, size_t piece)
{
    size_t ahead = piece + PIECES_AHEAD * BATCH_WIDTH, at = p.s.begin + ahead, plane = p.s.plane;
    int n_x = LATTICE_X(WITH_TURN);
    lattice_fetch(p.s.x + p.s.base[3] + ahead, sizeof(preal), plane, n_x);
    lattice_fetch(p.s.v + at, sizeof(real), plane, LATTICE_V);
    lattice_fetch(p.x + at, sizeof(preal), plane, n_x);
#if WITH_RK
    lattice_fetch(p.x0 + at, sizeof(preal), plane, n_x);
    lattice_fetch(p.v0 + at, sizeof(real), plane, LATTICE_V);
    lattice_fetch(p.v + at, sizeof(real), plane, LATTICE_V);
    lattice_fetch(p.sum_x + at, sizeof(preal), plane, WITH_TURN ? 9 : 6);
    lattice_fetch(p.sum_v + at, sizeof(real), plane, LATTICE_V);
#endif
}

/* Cell l of the run. mixed: a constant, 1 where kinds, loads or fixed DOF differ within the run;
 * kind: of all its cells where it is 0. */
LAW void link_step(int mixed, struct link_pass p, int kind, size_t l)
{
    size_t i = p.s.begin + l;
    int word = p.s.word[i], own = mixed ? LATTICE_KIND(word) : kind;
    struct link_cell c = lattice_moving(p.s, i, lattice_cell(p.s, i));
    struct lattice_pull pull = lattice_pull_of(
        mixed, p.s, l, word, c, p.cell + own * CELL_WIDTH, p.row, p.rows, p.gravity);
#if WITH_ENERGY
    link_account(mixed, p, c, pull, word, own, i);
#endif
    c = link_next(mixed, p, c, pull, word, own, i);
    lattice_keep(p.x, p.v, p.s.plane, i, c);
}

LAW void link_run(int mixed, struct link_pass p, int kind)
{
    FOR_PIECES (piece) {
        link_fetch(p, piece);
        BATCH_VECTOR
        FOR_PIECE (l, piece) link_step(mixed, p, kind, l);
    }
}

/* Runs list[first] to list[first + n - 1]. info: of runs (RUN_MIXED). x_in, x_out, v_in, v_out:
 * first numbers of sets of planes. */
__kernel __attribute__((reqd_work_group_size(BATCH_LANES, 1, 1))) void link_force(
    int first, int n, __global const int *list, __global const int *info, __global const int *base,
    __global const int *word, int n_run, int n_kind, long plane, __global preal *restrict x,
    long x_in, long x_out, __global real *restrict v, long v_in, long v_out,
    __global const real *link, __global const real *cell,
    SHARE_ARGUMENTS
#if WITH_VOLUME
        __global const real *p,
#endif
#if WITH_GRAVITY
    real gravity_x, real gravity_y, real gravity_z,
#endif
#if WITH_LOADS
    __global const int *row, __global const real *rows, int at_rows,
#endif
#if WITH_ENERGY
    __global double *restrict ledger,
#if WITH_RK
    real c_before, real c_own,
#else
    int count,
#endif
#endif
#if WITH_RK
    long start_x, long start_v, __global preal *restrict sum_x, __global real *restrict sum_v,
    preal c_sum_v, preal c_sum_a, preal c_next_v, preal c_next_a, preal c_next_turn,
    preal c_sum_turn, real c_sum_k, real c_next_k, int is_first, int is_last
#else
        __global const real *kick_table,
    int at_kick, preal drift
#endif
)
{
    if (get_group_id(0) >= (size_t)n) return;
    int run = list[first + get_group_id(0)], what = info[run];
    struct link_pass pass;
    pass.s = lattice_view_of(x + x_in, v + v_in, word, link, base, run, n_run, n_kind,
        what & (RUN_MIXED - 1), (size_t)plane);
    pass.x = x + x_out;
    pass.v = v + v_out;
    pass.cell = cell;
    pass.gravity = v3(0, 0, 0);
    pass.row = 0;
    pass.rows = 0;
    VIEW_SHARES(pass.s)
#if WITH_VOLUME
    pass.s.p = p;
#endif
#if WITH_GRAVITY
    pass.gravity = v3(gravity_x, gravity_y, gravity_z);
#endif
#if WITH_LOADS
    pass.row = row;
    pass.rows = rows + at_rows;
#endif
#if WITH_ENERGY
    pass.ledger = ledger;
#endif
#if WITH_RK
    struct lattice_stage stage = {c_sum_v, c_sum_a, c_next_v, c_next_a, c_next_turn, c_sum_turn,
        c_sum_k, c_next_k, is_first, is_last, WITH_NYSTROM};
    pass.stage = stage;
    pass.x0 = x + start_x;
    pass.v0 = v + start_v;
    pass.sum_x = sum_x;
    pass.sum_v = sum_v;
#if WITH_ENERGY
    pass.speed.before = c_before;
    pass.speed.own = c_own;
#endif
#else
    pass.kick = kick_table + at_kick;
    pass.drift = drift;
#if WITH_ENERGY
    pass.count = count;
#endif
#endif
    if ((WITH_KINDS || WITH_FIX || WITH_LOADS || WITH_SHARES) && what >= RUN_MIXED)
        link_run(1, pass, 0);
    else link_run(0, pass, what & (RUN_MIXED - 1));
}

#if !WITH_RK
/* A drift that no force precedes, in place. */
__kernel __attribute__((reqd_work_group_size(BATCH_LANES, 1, 1))) void lattice_first(int first,
    int n, __global const int *list, __global const int *word, long plane,
    __global preal *restrict x, long x_in, __global real *restrict v, long v_in,
#if WITH_LOADS
    __global const int *row, __global const real *rows, int at_rows,
#endif
    preal drift)
{
    if (get_group_id(0) >= (size_t)n) return;
    struct lattice_view s;
    s.plane = (size_t)plane;
    s.begin = (size_t)list[first + get_group_id(0)] * BATCH;
    s.x = x + x_in;
    s.v = v + v_in;
    BATCH_VECTOR
    FOR_BATCH (l, BATCH) {
        size_t i = s.begin + l;
        struct link_cell c = lattice_moving(s, i, lattice_cell(s, i));
#if WITH_LOADS
        __global const real *at = rows + at_rows + (size_t)row[i] * LOAD_WIDTH + LOAD_VELOCITY;
        c.v = lattice_hold(c.v, word[i], WORD_FIX, lattice_vec(at, 0));
        c.w = lattice_hold(c.w, word[i], WORD_FIX + 3, lattice_vec(at, 3));
#endif
        lattice_keep(x + x_in, v + v_in, s.plane, i, lattice_drift(c, drift));
    }
    (void)word;
}
#endif
