/* Forces of pairs: no neighbour loop, no atomics. Each pair writes its own result record; gather.cl
 * adds them up.
 *
 * Three phases through local memory, over batches of pairs (batch.h). Loads and stores of whole
 * records are vector loads, which keep a compiler from vectorising a loop; the law between them is
 * pure scalar arithmetic on contiguous local arrays and becomes full-width SIMD code on a CPU. On a
 * GPU the phases cost two barriers.
 *
 * lint: WITH_TANGENTIAL_DAMPING requires WITH_TANGENTIAL
 * lint: WITH_WHOLE_SLIP requires WITH_TANGENTIAL
 * lint: WITH_RADIUS_LEVER requires WITH_TANGENTIAL
 * lint: WITH_NO_RESCALE requires WITH_TANGENTIAL
 * lint: WITH_CAP_MAGNITUDE requires WITH_TANGENTIAL
 * lint: WITH_TANGENTIAL requires WITH_SPIN
 * lint: WITH_ROLLING_CDT requires WITH_SPIN
 * lint: WITH_ROLLING_EPSD requires WITH_SPIN
 * lint: WITH_MATERIALS requires WITH_SPIN
 * lint: WITH_SPIN_KICK requires WITH_SPIN
 * lint: WITH_SPIN_KICK requires WITH_KICK
 * lint: WITH_TANGENTIAL_DAMPING requires WITH_SPIN_KICK
 * lint: WITH_ROLLING_CDT requires WITH_SPIN_KICK
 * lint: WITH_ROLLING_EPSD requires WITH_SPIN_KICK
 * lint: some of WITH_LINEAR WITH_HERTZ */
#include "element.h"
#include "contact/contact_memory.h"

/* Rows of local memory: what the law needs of both elements; the results take their place. */
#define BOTH_SPINS (WITH_SIZES || WITH_ROLLING)
#define SPINS (BOTH_SPINS ? 6 : 3)
#define SPIN_KICKS (WITH_TANGENTIAL_DAMPING || WITH_ROLLING)
#define L_U 0
#define L_KICK 3
/* of equal spheres that do not roll: w_i + w_j */
#define L_W (WITH_KICK ? 6 : 3)
#define L_SPUN (L_W + (WITH_ROTATION ? SPINS : 0))
#define L_SIZE (L_SPUN + (SPIN_KICKS ? SPINS : 0)) /* r_i r_j 1/m_i 1/m_j */
#define L_KIND (L_SIZE + (WITH_SIZES ? 4 : 0))
#define L_ROWS (L_KIND + (WITH_MATERIALS ? 1 : 0))
#define RESULT_ROWS (WITH_ROLLING ? 9 : WITH_ROTATION ? (WITH_SIZES ? 8 : 6) : 3)
#define ROWS (L_ROWS > RESULT_ROWS ? L_ROWS : RESULT_ROWS)
#define LOC(row) loc[(row)*BATCH + l]

/* Where the law's numbers come from. */
#define TABLE_ROW (WITH_MATERIALS ? (int)LOC(L_KIND) : 0)
#if WITH_SIZES
#define PAIR_SIZES contact_pair_of(LOC(L_SIZE + 2), LOC(L_SIZE + 3), LOC(L_SIZE), LOC(L_SIZE + 1))
#define PARAMETERS                                                                                 \
    contact_parameters_of(material_load(table + MATERIAL_WIDTH * TABLE_ROW), PAIR_SIZES, dt)
#define RADIUS(k) LOC(L_SIZE + k)
#elif WITH_MATERIALS
#define PARAMETERS parameters_load(table + PARAMETER_WIDTH * TABLE_ROW)
#define RADIUS(k) radius
#else
#define PARAMETERS PARAMETERS_OF_ARGUMENTS
#define RADIUS(k) radius
#endif

#if WITH_SPIN || WITH_SPIN_KICK
/* Two spins, or their sum, to the rows from `row` on. */
LAW void pair_keep_spins(real4 wi, real4 wj, int row, __local real *loc, size_t l)
{
    if (!BOTH_SPINS) wi += wj;
    ROW3_STORE(loc, row, l, wi.s0, wi.s1, wi.s2);
    if (BOTH_SPINS) { ROW3_STORE(loc, row + 3, l, wj.s0, wj.s1, wj.s2); }
}
#endif

/* Differences of positions and velocities, spins, and what sizes and materials there are. */
LAW void pair_load(int i, int j, __global const preal *position, __global const real *motion,
    real n_material, __local preal *distance, __local real *loc, size_t l)
{
    preal4 xi = LOAD_POSITION(i), xj = LOAD_POSITION(j), x = xj - xi;
    real4 vi = LOAD_VELOCITY(i), vj = LOAD_VELOCITY(j), u = vi - vj;
    (void)n_material;
    ROW3_STORE(distance, 0, l, x.s0, x.s1, x.s2);
    ROW3_STORE(loc, L_U, l, u.s0, u.s1, u.s2);
#if WITH_KICK
    real4 kick = LOAD_KICK(i) - LOAD_KICK(j);
    ROW3_STORE(loc, L_KICK, l, kick.s0, kick.s1, kick.s2);
#endif
#if WITH_SPIN
    if (WITH_ROTATION || WITH_MATERIALS) {
        real4 wi = LOAD_SPIN(i), wj = LOAD_SPIN(j);
        if (WITH_MATERIALS) LOC(L_KIND) = wi.s3 * n_material + wj.s3;
        if (WITH_ROTATION) pair_keep_spins(wi, wj, L_W, loc, l);
    }
#endif
#if WITH_SPIN_KICK
    if (SPIN_KICKS) pair_keep_spins(LOAD_SPIN_KICK(i), LOAD_SPIN_KICK(j), L_SPUN, loc, l);
#endif
    if (WITH_SIZES) {
        LOC(L_SIZE) = (real)xi.s3;
        LOC(L_SIZE + 1) = (real)xj.s3;
        LOC(L_SIZE + 2) = vi.s3;
        LOC(L_SIZE + 3) = vj.s3;
    }
}

/* Partners lie anywhere in memory, and a processor that meets them one by one waits for each: this
 * fetches the record of the j of a pair AHEAD rounds later, by lines of 64 bytes. On the settled
 * bed of docs/performance.md the kernel takes a fifth less time with it. */
#define AHEAD 32
LAW void pair_fetch(int j, __global const preal *position)
{
    __global const char *record = (__global const char *)(position + (size_t)j * POSITION_STRIDE);
    for (int k = 0; k < ELEMENT_BYTES; k += 64) PREFETCH(record + k);
    (void)record;
}

LAW struct kinematics_motion pair_motion(__local const real *loc, size_t l)
{
    vec3 zero = v3(0, 0, 0);
    struct kinematics_motion m = kinematics_free(ROW3_LOAD(v3, loc, L_U, l), zero, zero, zero);
    if (WITH_KICK) m.kick = ROW3_LOAD(v3, loc, L_KICK, l);
    if (WITH_ROTATION) m.w_i = ROW3_LOAD(v3, loc, L_W, l);
    if (WITH_ROTATION && BOTH_SPINS) m.w_j = ROW3_LOAD(v3, loc, L_W + 3, l);
    if (SPIN_KICKS) m.spun_i = ROW3_LOAD(v3, loc, L_SPUN, l);
    if (SPIN_KICKS && BOTH_SPINS) m.spun_j = ROW3_LOAD(v3, loc, L_SPUN + 3, l);
    return m;
}

/* Force; torques, or couple and levers: see RESULT_WIDTH. */
LAW void pair_keep(
    struct contact_kinematics k, struct contact_result r, __local real *loc, size_t l)
{
    ROW3_STORE(loc, 0, l, r.force.x, r.force.y, r.force.z);
    if (WITH_ROLLING) {
        vec3 ti = v3_fma(k.l_i, r.couple, r.moment), tj = v3_fma(k.l_j, r.couple, v3_neg(r.moment));
        ROW3_STORE(loc, 3, l, ti.x, ti.y, ti.z);
        ROW3_STORE(loc, 6, l, tj.x, tj.y, tj.z);
    } else if (WITH_ROTATION) {
        vec3 c = WITH_SIZES ? r.couple : v3_scale(k.l_i, r.couple);
        ROW3_STORE(loc, 3, l, c.x, c.y, c.z);
        if (WITH_SIZES) {
            LOC(6) = k.l_i;
            LOC(7) = k.l_j;
        }
    }
}

LAW void pair_store(__local const real *loc, size_t l, __global real *out)
{
    int levers = WITH_SIZES && !WITH_ROLLING;
    vstore4((real4)(LOC(0), LOC(1), LOC(2), levers ? LOC(6) : (real)0), 0, out);
    if (WITH_ROTATION) vstore4((real4)(LOC(3), LOC(4), LOC(5), levers ? LOC(7) : (real)0), 1, out);
    if (WITH_ROLLING) vstore4((real4)(LOC(6), LOC(7), LOC(8), (real)0), 2, out);
}

/* Pairs first <= p < end, first a multiple of BATCH; capacity: between two planes of history and
 * ledger. n_material: edge of the table. */
__kernel __attribute__((reqd_work_group_size(BATCH_LANES, 1, 1))) void pair_force(int first,
    int end, int capacity, __global const preal *position, __global const real *motion,
    __global const int *pair_i, __global const int *pair_j,
#if WITH_HISTORY
    __global int *restrict state, __global real *restrict history,
#endif
#if WITH_ENERGY
    __global double *restrict ledger,
#endif
#if WITH_PERIODIC
    preal period_x, preal period_y, preal period_z,
#endif
#if WITH_SIZES || WITH_MATERIALS
    int n_material, __global const real *restrict table,
#else
    PARAMETER_ARGUMENTS
#endif
#if !WITH_SIZES
    real radius,
#endif
    __global real *restrict result, real dt)
{
    __local real loc[ROWS * BATCH];
    __local preal distance[3 * BATCH];
    size_t base = (size_t)first + get_group_id(0) * BATCH;
    size_t left = (size_t)end > base ? (size_t)end - base : 0, n = left < BATCH ? left : BATCH,
           planes = (size_t)capacity;
#if !(WITH_SIZES || WITH_MATERIALS)
    const int n_material = 0;
#endif
    FOR_BATCH (l, n) {
        size_t later = base + l + AHEAD;
        pair_fetch(pair_j[later < (size_t)end ? later : base + l], position);
        pair_load(pair_i[base + l], pair_j[base + l], position, motion, (real)n_material, distance,
            loc, l);
    }
    BATCH_BARRIER;
    BATCH_VECTOR
    FOR_BATCH (l, n) {
        pvec3 D = ROW3_LOAD(p3, distance, 0, l);
#if WITH_PERIODIC
        D = nearest_images(D, period_x, period_y, period_z);
#endif
        struct contact_parameters p = PARAMETERS;
        struct kinematics_motion m = pair_motion(loc, l);
        m.radius_lever = parameters_radius_lever(p);
        struct contact_kinematics k = contact_kinematics_pair(D, m, RADIUS(0), RADIUS(1), dt);
        struct contact_history h = HISTORY_LOAD(base, planes, l);
        struct contact_result r = contact_law(k, p, dt, &h);
        HISTORY_STORE(h, base, planes, l);
        LEDGER_ADD(r, base, planes, l);
        pair_keep(k, r, loc, l);
    }
    BATCH_BARRIER;
    FOR_BATCH (l, n) pair_store(loc, l, result + (base + l) * RESULT_WIDTH);
}
