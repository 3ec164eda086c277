/* How link_force.cl keeps the account of its cells (lattice_work.h): what acts on a cell, and
 * planes of struct lattice_ledger that every evaluation adds to. WITH_ENERGY only. */
#ifndef DEMOCLES_LINK_ACCOUNT_H
#define DEMOCLES_LINK_ACCOUNT_H

#include "lattice_view.h"
#include "lattice_work.h"

#if WITH_ENERGY
/* links: what all links of the cell do, as it moves. */
LAW struct lattice_effort lattice_effort_of(int mixed, struct lattice_view s, size_t l, int word,
    struct link_cell me, struct link_share links, __global const real *cell,
    __global const int *row, __global const real *rows, vec3 gravity)
{
    struct lattice_effort e;
    e.links = e.still = links;
    e.loads.force = e.loads.torque = e.added = e.v = e.w = v3(0, 0, 0);
    e.weight = gravity;
    e.face = 0;
    if (WITH_LINK_DAMPING) {
        struct link_cell rest = me;
        rest.v = rest.w = v3(0, 0, 0);
        s.still = 1;
        if (WITH_VOLUME) s.p += s.plane;
        e.still = lattice_links(mixed, s, l, word, rest);
    }
    if (WITH_LOADS && mixed) {
        struct lattice_load load;
        __global const real *at = rows + (size_t)row[s.begin + l] * LOAD_WIDTH;
        load = lattice_load_of(at);
        e.loads = lattice_load_add(e.loads, me, load);
        e.added = load.acceleration;
        e.v = load.now_v;
        e.w = load.now_w;
        if (WITH_VOLUME) e.face = cell[7] * cell[3] * s.p[s.begin + l] * load.rate;
    }
    return e;
}

LAW struct lattice_ledger lattice_ledger_of(__global const double *ledger, size_t plane, size_t i)
{
    struct lattice_ledger k;
    k.work = ledger[i];
    k.links = ledger[plane + i];
    k.mass = ledger[2 * plane + i];
    return k;
}

LAW void lattice_ledger_keep(
    __global double *ledger, size_t plane, size_t i, struct lattice_ledger k)
{
    ledger[i] = k.work;
    ledger[plane + i] = k.links;
    ledger[2 * plane + i] = k.mass;
}

/* word: 0 if no cell of the run has loads or held DOF. */
LAW void link_account_kicks(struct lattice_effort e, struct link_cell c, vec3 a, vec3 b, int word,
    __global const real *cell, real per_mass, __global const real *kick, int count,
    __global double *ledger, size_t plane, size_t i)
{
    struct lattice_kick end, begin;
    struct lattice_ledger sum = lattice_ledger_of(ledger, plane, i);
    double alpha = (double)cell[6], mass = 1.0 / (double)per_mass, inertia = 1.0 / (double)cell[1];
    end = lattice_kick_of(kick);
    begin = lattice_kick_of(kick + KICK_PART);
    lattice_ledger_keep(ledger, plane, i,
        lattice_work_split(sum, e, c, a, b, end, begin, word, alpha, mass, inertia, count));
}

/* c: as the stage finds it. last: planes of the accelerations of the stage before, Nystrom's
 * alone. */
LAW void link_account_stage(struct lattice_effort e, struct link_cell c, vec3 a, vec3 b, int word,
    __global const real *cell, real per_mass, struct lattice_stage stage,
    struct lattice_speed speed, __global real *last, __global double *ledger, size_t plane,
    size_t i)
{
    struct lattice_ledger sum = lattice_ledger_of(ledger, plane, i);
    double alpha = (double)cell[6], mass = 1.0 / (double)per_mass, inertia = 1.0 / (double)cell[1];
    if (stage.is_nystrom) {
        vec3 before_a = v3_load(last, plane, 0, i), before_b = v3_load(last, plane, 3, i);
        c = lattice_speed_of(c, a, b, before_a, before_b, speed, stage.is_first);
        v3_store(last, plane, 0, i, a);
        v3_store(last, plane, 3, i, b);
    }
    lattice_ledger_keep(ledger, plane, i,
        lattice_work_stage(sum, e, c, word, alpha, mass, inertia, (double)stage.sum_k));
}
#endif

#endif
