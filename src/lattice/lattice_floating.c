/* Relaxation of what nothing holds. Joined cells that can still move as one rigid body stay where
 * they are only if their loads balance in that motion.
 *
 * Motions t + w x r about the middle of the part, r in units of its size L, are vectors (t, L w) of
 * six numbers; each fixed DOF of a cell is a row that such a motion must not have, and the rows
 * give an orthonormal basis of the motions that are held (Gram and Schmidt). What the loads, too a
 * vector (force, moment/L), have outside of it would move the part for ever. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "lattice_frequency.h"
#include "lattice_loads.h"
#include "lattice_parts.h"

static const double dependent = 1e-6, balanced = 1e-6; /* [1] of a row; of the sum of all loads */

struct part {
    double middle[3], size; /* [m] */
    int64_t n;
    double basis[6][6];
    int n_held;
    double load[6], all; /* force [N] and moment/size [N]; sum of their parts without signs */
    int body;            /* the first one */
};

static int32_t root_of(int32_t *parent, int32_t i)
{
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

/* The lowest cell that each one is joined with. */
static int32_t *find_parts(const struct lattice_cells *cells)
{
    int32_t *parent = fail_alloc((size_t)cells->n * sizeof *parent);
    int32_t *upper = fail_alloc((size_t)cells->n * sizeof *upper);
    for (int64_t i = 0; i < cells->n; i++) parent[i] = (int32_t)i;
    for (int a = 0; a < 3; a++) {
        lattice_cells_upper(cells, a, upper);
        for (int64_t i = 0; i < cells->n; i++) {
            if (!(cells->bits[i] & CELL_LINK(2 * a + 1))) continue;
            int32_t p = root_of(parent, (int32_t)i), q = root_of(parent, upper[i]);
            if (p < q) parent[q] = p;
            else parent[p] = q;
        }
    }
    for (int64_t i = 0; i < cells->n; i++) parent[i] = root_of(parent, (int32_t)i);
    free(upper);
    return parent;
}

/* A row that a free motion must not have joins the basis unless it adds nothing. */
static void hold(struct part *part, const double row[6])
{
    double rest[6], size = 0, left = 0;
    memcpy(rest, row, sizeof rest);
    for (int k = 0; k < 6; k++) size += row[k] * row[k];
    for (int b = 0; b < part->n_held; b++) {
        double along = 0;
        for (int k = 0; k < 6; k++) along += rest[k] * part->basis[b][k];
        for (int k = 0; k < 6; k++) rest[k] -= along * part->basis[b][k];
    }
    for (int k = 0; k < 6; k++) left += rest[k] * rest[k];
    if (part->n_held == 6 || !(left > dependent * dependent * size)) return;
    for (int k = 0; k < 6; k++) part->basis[part->n_held][k] = rest[k] / sqrt(left);
    part->n_held++;
}

/* Fixed DOF of a cell at r [size]. */
static void hold_cell(struct part *part, uint16_t bits, const double r[3])
{
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        double move[6] = {0}, turn[6] = {0};
        move[a] = 1; /* (w x r)_a = w_b r_c - w_c r_b */
        move[3 + b] = r[c];
        move[3 + c] = -r[b];
        turn[3 + a] = 1;
        if (bits & CELL_FIX(a)) hold(part, move);
        if (bits & CELL_FIX(3 + a)) hold(part, turn);
    }
}

static void load_cell(
    struct part *part, const struct scene *scene, const double *row, double mass, const double r[3])
{
    double force[3], moment[3] = {0};
    for (int a = 0; a < 3; a++)
        force[a] = row[LOAD_FORCE + a] + row[LOAD_BODY + a] +
                   mass * (scene->gravity[a] + row[LOAD_ACCELERATION + a]);
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        const double *lever = row + LOAD_LEVER + 3 * a; /* e_a x L_a */
        moment[b] -= lever[c] / part->size;
        moment[c] += lever[b] / part->size;
        moment[a] += r[b] * force[c] - r[c] * force[b] + row[LOAD_TURN + a] / part->size;
    }
    for (int a = 0; a < 3; a++) {
        part->load[a] += force[a];
        part->load[3 + a] += moment[a];
        part->all += fabs(force[a]) + fabs(moment[a]);
    }
}

/* Size of what the loads have outside of the basis. */
static double unbalanced(const struct part *part)
{
    double rest[6], square = 0;
    memcpy(rest, part->load, sizeof rest);
    for (int b = 0; b < part->n_held; b++) {
        double along = 0;
        for (int k = 0; k < 6; k++) along += rest[k] * part->basis[b][k];
        for (int k = 0; k < 6; k++) rest[k] -= along * part->basis[b][k];
    }
    for (int k = 0; k < 6; k++) square += rest[k] * rest[k];
    return sqrt(square);
}

/* Middle and size of each part, at its lowest cell. */
static void measure_parts(
    const struct lattice_cells *cells, const int32_t *part_of, struct part *part)
{
    double x[3];
    for (int64_t i = 0; i < cells->n; i++) {
        struct part *p = &part[part_of[i]];
        lattice_cells_centre(cells, i, x);
        for (int a = 0; a < 3; a++) p->middle[a] += x[a];
        if (p->n++ == 0) p->body = cells->body[i];
    }
    for (int64_t i = 0; i < cells->n; i++)
        if (part[i].n > 0)
            for (int a = 0; a < 3; a++) part[i].middle[a] /= (double)part[i].n;
    for (int64_t i = 0; i < cells->n; i++) {
        struct part *p = &part[part_of[i]];
        lattice_cells_centre(cells, i, x);
        for (int a = 0; a < 3; a++)
            p->size = fmax(p->size, fmax(fabs(x[a] - p->middle[a]),
                                        cells->grid[cells->kind[cells->kind_of[i]].grid].h));
    }
}

static void load_parts(const struct scene *scene, const struct lattice_cells *cells,
    const int32_t *part_of, struct part *part)
{
    double *rows = fail_alloc((size_t)cells->loads->n_row * LOAD_WIDTH * sizeof *rows), x[3];
    double end = scene->time.end;
    lattice_loads_at(cells->loads, scene, end, end, end, rows);
    for (int64_t i = 0; i < cells->n; i++) {
        struct part *p = &part[part_of[i]];
        const struct lattice_kind *kind = &cells->kind[cells->kind_of[i]];
        double mass =
            link_constants_mass(lattice_frequency_material(&scene->material[kind->material]),
                cells->grid[kind->grid].h) *
            lattice_cells_share(cells, i)->mass;
        lattice_cells_centre(cells, i, x);
        for (int a = 0; a < 3; a++) x[a] = (x[a] - p->middle[a]) / p->size;
        hold_cell(p, cells->bits[i], x);
        load_cell(p, scene, rows + (int64_t)cells->row[i] * LOAD_WIDTH, mass, x);
    }
    free(rows);
}

void lattice_floating_settle(
    const struct scene *scene, struct lattice_cells *cells, struct scene_errors *errors)
{
    int32_t *part_of = find_parts(cells);
    struct part *part = fail_alloc((size_t)cells->n * sizeof *part);
    measure_parts(cells, part_of, part);
    load_parts(scene, cells, part_of, part);
    for (int64_t i = 0; i < cells->n; i++) {
        const struct part *p = &part[i];
        if (p->n == 0 || p->n_held == 6 || unbalanced(p) <= balanced * p->all) continue;
        const struct body *body = &scene->body[p->body];
        double f[6]; /* without what rounding has left of sums */
        for (int k = 0; k < 6; k++)
            f[k] = (k < 3 ? 1 : p->size) * (fabs(p->load[k]) > 1e-12 * p->all ? p->load[k] : 0);
        const double *x = p->middle;
        lattice_fault(scene, errors, body->line, body->column,
            "bodies[%d]: '%s' %s, and its loads do not balance: force (%.4g, %.4g, %.4g) N, moment "
            "(%.4g, %.4g, %.4g) N m about (%.4g, %.4g, %.4g) m; it has no state of rest "
            "(lattice.relax)",
            p->body, body->name,
            p->n_held == 0 ? "is held by nothing" : "is not held against every motion", f[0], f[1],
            f[2], f[3], f[4], f[5], x[0], x[1], x[2]);
    }
    for (int64_t i = 0; i < cells->n && cells->v; i++)
        for (int a = 0; a < 3 && part[part_of[i]].n_held < 6; a++) {
            if (!(cells->bits[i] & CELL_FIX(a))) cells->v[i][a] = 0;
            if (!(cells->bits[i] & CELL_FIX(3 + a))) cells->w[i][a] = 0;
        }
    free(part);
    free(part_of);
}
