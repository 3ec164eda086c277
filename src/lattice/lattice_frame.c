/* Frames of the lattice: a hexahedron per cell, at its place at the start, with the displacement of
 * its corners to warp by. */
#include "lattice_method.h"

#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "lattice_fields.h"
#include "lattice_restore.h"
#include "run/output.h"
#include "run/resume.h"
#include "results/snapshot.h"

enum { CORNERS = 8 };

static void read_breakage(const struct sim *s, struct lattice_state *t)
{
    size_t n = (size_t)t->n;
    t->broken = fail_alloc(n * sizeof *t->broken);
    if (!s->lattice->lattice->breakage) return;
    t->links = fail_alloc(n * sizeof *t->links);
    t->fate = fail_alloc(n * sizeof *t->fate);
    lattice_break_read(s->lattice->lattice->breakage, t->links, t->fate);
    for (int64_t i = 0; i < t->n; i++)
        t->broken[i] =
            __builtin_popcount(s->lattice->cells->bits[t->gid[i]] & CELL_LINKS & ~t->links[i]);
}

struct lattice_state *lattice_state_create(const struct sim *s)
{
    const struct lattice *l = s->lattice->lattice;
    struct lattice_state *t = fail_alloc(sizeof *t);
    size_t n = (size_t)l->layout->n_owned;
    double(*theta)[3] = fail_alloc(n * sizeof *theta);
    t->n = (int64_t)n;
    t->gid = l->layout->gid;
    t->turn_width = l->features.turn ? 4 : 3;
    t->centre = fail_alloc(n * sizeof *t->centre);
    t->u = fail_alloc(n * sizeof *t->u);
    t->turn = fail_alloc(n * sizeof *t->turn);
    t->v = fail_alloc(n * sizeof *t->v);
    t->w = fail_alloc(n * sizeof *t->w);
    struct lattice_motion m = {.u = t->u, .v = t->v, .w = t->w};
    if (l->features.turn) m.q = t->turn;
    else m.theta = theta;
    lattice_read(l, &m);
    for (size_t i = 0; i < n; i++) {
        lattice_cells_centre(s->lattice->cells, t->gid[i], t->centre[i]);
        if (!l->features.turn) memcpy(t->turn[i], theta[i], sizeof theta[i]);
    }
    free(theta);
    if (s->lattice->stress) {
        t->stress = fail_alloc(n * sizeof *t->stress);
        t->von_mises = fail_alloc(n * sizeof *t->von_mises);
        lattice_stress_run(s->lattice->stress, t->stress, t->von_mises);
    }
    read_breakage(s, t);
    return t;
}

void lattice_state_free(struct lattice_state *t)
{
    if (!t) return;
    void *own[] = {t->centre, t->u, t->turn, t->v, t->w, t->stress, t->von_mises, t->links, t->fate,
        t->broken, t->v_before, t->w_before, t->ledger, t->fresh, t->released, t};
    for (size_t k = 0; k < sizeof own / sizeof *own; k++) free(own[k]);
}

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int k = 0; k < 3; k++)
        out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

void lattice_state_turn(const struct lattice_state *t, int64_t i, const double r[3], double out[3])
{
    if (t->turn_width == 3) {
        cross(t->turn[i], r, out);
        return;
    }
    double once[3], twice[3];
    cross(t->turn[i] + 1, r, once);
    cross(t->turn[i] + 1, once, twice);
    for (int k = 0; k < 3; k++) out[k] = 2 * (t->turn[i][0] * once[k] + twice[k]);
}

/* Corners in VTK's order, and their displacements. */
static void corners(
    const struct sim *s, const struct lattice_state *t, double (*x)[3], double (*u)[3])
{
    static const int corner[CORNERS][3] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
        {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}};
    const struct lattice_cells *c = s->lattice->cells;
    for (int64_t i = 0; i < t->n; i++) {
        double half = 0.5 * c->grid[c->kind[c->kind_of[t->gid[i]]].grid].h, r[3], turned[3];
        for (int k = 0; k < CORNERS; k++) {
            for (int a = 0; a < 3; a++) r[a] = half * corner[k][a];
            lattice_state_turn(t, i, r, turned);
            for (int a = 0; a < 3; a++) {
                x[CORNERS * i + k][a] = t->centre[i][a] + r[a];
                u[CORNERS * i + k][a] = t->u[i][a] + turned[a];
            }
        }
    }
}

void lattice_method_frame(struct sim *s, int64_t index)
{
    struct lattice_state *t = lattice_state_create(s);
    size_t n = (size_t)t->n;
    double(*x)[3] = fail_alloc(CORNERS * n * sizeof *x),
    (*u)[3] = fail_alloc(CORNERS * n * sizeof *u);
    struct sheet shown = {.n = 0}, state = {.n = 0};
    corners(s, t, x, u);
    const struct column point[] = {
        {"position", "m", "corners of the cells at the start", COLUMN_F64, 3, x},
        {"displacement", "m", "displacement of the corners", COLUMN_F64, 3, u}};
    lattice_fields_show(s, &shown, t);
    lattice_restore_take(s, t);
    lattice_fields_state(s, &state, t);
    struct table table[2] = {{"cells", t->n, state.column, state.n}};
    double *total = sheet_keep(&state, lattice_restore_totals(s));
    const struct column column = {"number", "1",
        "totals and what the loop has noted, see lattice_restore.c", COLUMN_F64, 1, total};
    table[1] =
        (struct table){"totals", s->comm->rank == 0 ? LATTICE_RESTORE_TOTALS : 0, &column, 1};
    struct frame_scalar scalar[RESUME_SCALARS];
    resume_note(s, scalar);
    struct frame frame = {.step = s->step,
        .time = (double)s->step * s->dt,
        .index = index,
        .points = {"points", CORNERS * t->n, point, 2},
        .hexahedra = true,
        .cells = {"cells", t->n, shown.column, shown.n},
        .state = table,
        .n_state = 2,
        .resolved = s->scene->resolved,
        .scalar = scalar,
        .n_scalar = RESUME_SCALARS};
    output_frame(s, &frame);
    sheet_free(&shown);
    sheet_free(&state);
    free(x);
    free(u);
    lattice_state_free(t);
}
