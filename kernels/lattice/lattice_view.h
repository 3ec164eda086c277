/* Lattice cells in device memory: runs of BATCH cells along RUN_AXIS, one work-group each
 * (src/lattice/lattice_layout.h). Bases of the neighbouring runs are uniform over the group, so all
 * loads are contiguous. Planes: number k of cell i is at k * plane + i; x and v point to the first
 * plane of the state. */
#ifndef DEMOCLES_LATTICE_VIEW_H
#define DEMOCLES_LATTICE_VIEW_H

#include "common/batch.h"
#include "common/planes.h"
#include "lattice_state.h"

#ifndef RUN_AXIS
#define RUN_AXIS 0
#endif
/* of base: the runs beside along this axis */
#define RUN_SIDE(axis) (2 * ((axis) - ((axis) > RUN_AXIS)))

struct lattice_view {
    __global const preal *x;
    __global const real *v;
    __global const real *p; /* WITH_VOLUME: lambda Th [Pa] */
    __global const int *word;
    __global const real *link; /* table of LINK_WIDTH */
    size_t plane, begin;       /* begin: of this run */
    /* of the runs beside, - and + along the lower of the two other axes, then along the higher */
    size_t base[4];
    const __global int *share;   /* WITH_SHARES: row of each cell in `shares`, 0: whole */
    __global const real *shares; /* WITH_SHARES: table of SHARE_WIDTH */
    int n_kind;
    int still;               /* 1: links without their dashpots */
    struct link_constants k; /* of a run whose cells and neighbours are of one kind */
};

LAW struct link_cell lattice_cell(struct lattice_view s, size_t i)
{
    struct link_cell c;
    c.u = p3_load(s.x, s.plane, 0, i);
    c.theta = c.u;
    c.q = quat_of(1, 0, 0, 0);
    c.v = c.w = v3(0, 0, 0);
    if (WITH_TURN)
        c.q = quat_of(
            s.x[3 * s.plane + i], s.x[4 * s.plane + i], s.x[5 * s.plane + i], s.x[6 * s.plane + i]);
    else c.theta = p3_load(s.x, s.plane, 3, i);
    return c;
}
LAW struct link_cell lattice_moving(struct lattice_view s, size_t i, struct link_cell c)
{
    c.v = v3_load(s.v, s.plane, 0, i);
    c.w = v3_load(s.v, s.plane, 3, i);
    return c;
}

/* Where the neighbour over a face of lane l is; anything may be there if there is no link. */
LAW size_t lattice_beside(struct lattice_view s, int face, size_t l)
{
    int axis = face >> 1, is_upper = face & 1;
    return axis != RUN_AXIS ? s.base[RUN_SIDE(axis) + is_upper] + l
           : is_upper       ? s.begin + l + 1
                            : s.begin + l - 1;
}

/* The shares of cell i of a run that is mixed. */
LAW __global const real *lattice_share(struct lattice_view s, size_t i)
{
    return s.shares + (size_t)s.share[i] * SHARE_WIDTH;
}

/* Constants of the link of cell i over a face: of the run, or (`mixed`) of the two cells' kinds and
 * of what is covered of the face. */
LAW struct link_constants lattice_constants(
    struct lattice_view s, int face, int mixed, int word, size_t i, size_t j)
{
    struct link_constants k = s.k;
    if (WITH_KINDS && mixed) {
        int me = LATTICE_KIND(word), other = LATTICE_KIND(s.word[j]);
        __global const real *row =
            s.link +
            (size_t)(face & 1 ? me * s.n_kind + other : other * s.n_kind + me) * LINK_WIDTH;
        k = lattice_constants_of(row);
    }
    if (WITH_SHARES && mixed) k = lattice_constants_cut(k, lattice_share(s, i), face);
    return k;
}

/* 1/m of cell i [1/kg]; cell: row of the table of its kind. */
LAW real lattice_per_mass(int mixed, struct lattice_view s, size_t i, __global const real *cell)
{
    return WITH_SHARES && mixed ? cell[0] * lattice_share(s, i)[SHARE_PER_MASS] : cell[0];
}

LAW void lattice_view_runs(struct lattice_view *s, __global const int *base, int run, int n_run)
{
    s->begin = (size_t)run * BATCH;
    s->base[0] = (size_t)base[run];
    s->base[1] = (size_t)base[n_run + run];
    s->base[2] = (size_t)base[2 * n_run + run];
    s->base[3] = (size_t)base[3 * n_run + run];
}

LAW struct lattice_view lattice_view_of(__global const preal *x, __global const real *v,
    __global const int *word, __global const real *link, __global const int *base, int run,
    int n_run, int n_kind, int kind, size_t plane)
{
    struct lattice_view s;
    __global const real *row = link + (size_t)(kind * n_kind + kind) * LINK_WIDTH;
    s.x = x;
    s.v = v;
    s.p = 0;
    s.word = word;
    s.link = link;
    s.plane = plane;
    lattice_view_runs(&s, base, run, n_run);
    s.share = 0;
    s.shares = 0;
    s.n_kind = n_kind;
    s.still = 0;
    s.k = lattice_constants_of(row);
    return s;
}

/* For kernels whose arguments have these names: s, the view of a run, and RUN(mixed) over its
 * cells, which are of one kind or (mixed) of several. what: of `info`. */
#if WITH_VOLUME
#define VIEW_PRESSURE s.p = p;
#else
#define VIEW_PRESSURE
#endif
#if WITH_SHARES
#define VIEW_SHARES(view)                                                                          \
    (view).share = share;                                                                          \
    (view).shares = shares;
#define SHARE_ARGUMENTS __global const int *share, __global const real *shares,
#else
#define VIEW_SHARES(view)
#define SHARE_ARGUMENTS
#endif
#define RUN_CELLS(run, what)                                                                       \
    struct lattice_view s = lattice_view_of(x + x_in, v + v_in, word, link, base, run, n_run,      \
        n_kind, (what) & (RUN_MIXED - 1), (size_t)plane);                                          \
    VIEW_PRESSURE                                                                                  \
    VIEW_SHARES(s)                                                                                 \
    if ((WITH_KINDS || WITH_SHARES) && (what) >= RUN_MIXED) {                                      \
        RUN(1)                                                                                     \
    } else {                                                                                       \
        RUN(0)                                                                                     \
    }

#ifdef __OPENCL_VERSION__
/* Pieces that are fetched ahead: of what lies at the front of the tile, x of the run beside that
 * comes last, and of what belongs to the cells alone. On 100^3 cells in double precision, pocl 3.1,
 * AMD Zen 5 (leapfrog): 88 million cells/s with none ahead, 98 with 2, 104 with 3, 110 with 4, 117
 * with 5, 115 with 6. */
enum { PIECES_AHEAD = 5 };

LAW void lattice_fetch(__global const void *first, size_t bytes, size_t plane, int n_plane)
{
    for (int k = 0; k < n_plane; k++)
        PREFETCH((__global const char *)first + (size_t)k * plane * bytes);
    (void)first, (void)bytes, (void)plane;
}
#endif

/* Force and torque of the link over a face. */
LAW struct link_share lattice_face(
    int face, int mixed, struct lattice_view s, size_t l, int word, struct link_cell me)
{
    size_t i = s.begin + l, j = lattice_beside(s, face, l);
    struct link_cell other = lattice_cell(s, j);
    real p_me = 0, p_other = 0;
    if (WITH_LINK_DAMPING && !s.still) other = lattice_moving(s, j, other);
    if (WITH_VOLUME) {
        p_me = s.p[i];
        p_other = s.p[j];
    }
    return lattice_link(face, LATTICE_LINKS(word) >> face & 1, me, other,
        lattice_constants(s, face, mixed, word, i, j), p_me, p_other);
}

/* The six links in the order of the mask. */
LAW struct link_share lattice_links(
    int mixed, struct lattice_view s, size_t l, int word, struct link_cell me)
{
    struct link_share sum = lattice_face(0, mixed, s, l, word, me);
    sum = lattice_add(sum, lattice_face(1, mixed, s, l, word, me));
    sum = lattice_add(sum, lattice_face(2, mixed, s, l, word, me));
    sum = lattice_add(sum, lattice_face(3, mixed, s, l, word, me));
    sum = lattice_add(sum, lattice_face(4, mixed, s, l, word, me));
    return lattice_add(sum, lattice_face(5, mixed, s, l, word, me));
}

/* What the link over a face adds to the sum of stretches of the cell [m]. eta of that cell; 0:
 * without damping. */
LAW real lattice_part(
    int face, int mixed, struct lattice_view s, size_t l, int word, struct link_cell me, real eta)
{
    size_t j = lattice_beside(s, face, l);
    struct link_cell other = lattice_cell(s, j);
    if (WITH_LINK_DAMPING && !s.still) other = lattice_moving(s, j, other);
    return lattice_stretch(face, word >> face & 1, me, other,
        lattice_constants(s, face, mixed, word, s.begin + l, j), eta);
}

#endif
