#include "lattice_loads.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "lattice_facet.h"
#include "scene/history.h"
#include "lattice_parts.h"

/* What a boundary takes of a cell: bits 0-5 its free faces, as links; bit 6 the cell itself, by its
 * centre; bit 7 the part of a curved surface in it. */
enum { TAKES_FACES = 63, TAKES_CENTRE = 64, TAKES_FACET = 128, TAKES_ALL = 256 };

/* The combination of loads of a cell while it grows: that of `parent`, and one more boundary. Roots
 * stand for grids, without a load. */
struct node {
    int parent, boundary, takes; /* parent -1: root */
    int grid, share;             /* share: row of cells->share, 0: whole */
    double n_share;              /* cells, or areas in whole faces */
};

struct builder {
    const struct scene *scene;
    struct lattice_cells *cells;
    struct scene_errors *errors;
    uint8_t *takes;   /* [n] of the boundary at hand */
    int64_t n_centre; /* cells by their centre ... */
    int64_t n_face;   /* ... and faces, that it takes */
    double area;      /* of these, in whole faces */
    uint8_t *moved;   /* [n] DOF with a prescribed velocity */
    struct node *node;
    int n_node, n_room;
};

static const char *const dof_name[6] = {"x", "y", "z", "rx", "ry", "rz"};

static void fault(const struct builder *b, int k, const char *key, const char *text)
{
    const struct boundary *of = &b->scene->boundary[k];
    lattice_fault(b->scene, b->errors, of->line, of->column, "boundaries[%d].%s: %s", k, key, text);
}

/* Area of the faces and the part of a curved surface that are taken, in whole faces. */
static double area_of(const struct lattice_share *share, int takes)
{
    double area = 0, vector[3];
    for (int f = 0; f < 6; f++) area += takes >> f & 1 ? share->face[f] : 0;
    if (takes & TAKES_FACET) area += lattice_facet_area(share, vector);
    return area;
}

/* Cells and free faces in the region of boundary k. */
static void choose(struct builder *b, int k)
{
    const struct boundary *of = &b->scene->boundary[k];
    const struct lattice_cells *cells = b->cells;
    struct region_shape shape;
    free(region_open(&shape, &of->where)); /* none of these regions can fail */
    b->n_centre = b->n_face = 0;
    b->area = 0;
    for (int64_t i = 0; i < cells->n; i++) {
        const struct lattice_share *share = lattice_cells_share(cells, i);
        double h = cells->grid[cells->kind[cells->kind_of[i]].grid].h, x[3], vector[3];
        bool near = of->body < 0 || of->body == cells->body[i];
        b->takes[i] = 0;
        lattice_cells_centre(cells, i, x);
        for (int a = 0; a < 3; a++)
            near = near && x[a] >= shape.low[a] - h && x[a] <= shape.high[a] + h;
        if (!near) continue;
        int takes = region_holds(&shape, x, -LATTICE_SLACK * h) ? TAKES_CENTRE : 0;
        b->n_centre += takes != 0;
        for (int f = 0; f < 6; f++) {
            double y[3] = {x[0], x[1], x[2]};
            y[f / 2] += (f & 1) ? 0.5 * h : -0.5 * h;
            for (int c = 0; c < 2; c++) y[(f / 2 + 1 + c) % 3] += share->offset[f][c] * h;
            if (cells->bits[i] & (1 << f) || !(share->face[f] > 0) ||
                !region_holds(&shape, y, -LATTICE_SLACK * h))
                continue;
            takes |= 1 << f;
            b->n_face++;
        }
        for (int a = 0; a < 3; a++) x[a] += share->facet[a] * h;
        if (lattice_facet_area(share, vector) > 0 && region_holds(&shape, x, 0)) {
            takes |= TAKES_FACET;
            b->n_face++;
        }
        b->area += area_of(share, takes);
        b->takes[i] = (uint8_t)takes;
    }
    region_close(&shape);
}

/* The DOF that a boundary prescribes, as six bits. */
static int dofs_of(const struct boundary *of)
{
    int dofs = 0;
    for (int c = 0; c < 6; c++) {
        bool is_mine = of->kind == BOUNDARY_FIX
                           ? of->fix[c]
                           : (of->kind == BOUNDARY_VELOCITY && c < 3 && isfinite(of->value[c])) ||
                                 (of->kind == BOUNDARY_ANGULAR_VELOCITY && c >= 3 &&
                                     isfinite(of->value[c - 3]));
        dofs |= is_mine << c;
    }
    return dofs;
}

/* Bits of what is fixed or prescribed. A DOF with a prescribed velocity may be so once only. */
static void hold(struct builder *b, int k)
{
    const struct boundary *of = &b->scene->boundary[k];
    int dofs = dofs_of(of), twice = 0;
    for (int64_t i = 0; i < b->cells->n; i++) {
        if (!(b->takes[i] & TAKES_CENTRE)) continue;
        int held = b->cells->bits[i] >> 6;
        twice |= dofs & (of->kind == BOUNDARY_FIX ? b->moved[i] : held);
        b->cells->bits[i] |= (uint16_t)(dofs << 6);
        if (of->kind != BOUNDARY_FIX) b->moved[i] |= (uint8_t)dofs;
    }
    for (int c = 0; c < 6; c++) {
        if (!(twice >> c & 1)) continue;
        char *text = fail_format(
            "an earlier boundary already prescribes the motion in %s of some of these cells",
            dof_name[c]);
        fault(b, k, "where", text);
        free(text);
    }
}

/* Loads that cannot move anything: on DOF that are held in every cell that they act on. */
static void check_moves(struct builder *b, int k)
{
    const struct boundary *of = &b->scene->boundary[k];
    int all_held = 63;
    for (int64_t i = 0; i < b->cells->n; i++)
        if (b->takes[i]) all_held &= b->cells->bits[i] >> 6;
    if (of->kind == BOUNDARY_PRESSURE) {
        if ((all_held & 7) == 7) fault(b, k, "pressure", "every cell that it acts on is fixed");
        return;
    }
    for (int c = 0; c < 3; c++) {
        bool acts = of->value[c] < 0 || of->value[c] > 0;
        if (!acts || !(all_held >> c & 1)) continue;
        char *text = fail_format("every cell that it acts on is fixed in %c", "xyz"[c]);
        fault(b, k, of->kind == BOUNDARY_FORCE ? "force" : "acceleration", text);
        free(text);
    }
}

static int add_node(struct builder *b, struct node node)
{
    if (b->n_node == b->n_room) {
        b->n_room = b->n_room ? 2 * b->n_room : 64;
        b->node = fail_realloc(b->node, (size_t)b->n_room * sizeof *b->node);
    }
    b->node[b->n_node] = node;
    return b->n_node++;
}

/* Gives every cell that boundary k takes the row of its row and that. */
static void refine(struct builder *b, int k)
{
    size_t n = (size_t)b->n_node * TAKES_ALL;
    /* [node][takes]; 0: none yet, since roots are never children */
    int *child = fail_alloc(n * sizeof *child);
    double n_share = b->n_face > 0 ? b->area : (double)b->n_centre;
    for (int64_t i = 0; i < b->cells->n; i++) {
        int takes = b->takes[i], row = b->cells->row[i];
        if (!takes) continue;
        int share = b->cells->share ? b->cells->share_of[i] : 0, none = 0,
            *to = share ? &none : &child[(size_t)row * TAKES_ALL + (size_t)takes];
        if (!*to)
            *to = add_node(b, (struct node){row, k, takes, b->node[row].grid, share, n_share});
        b->cells->row[i] = *to;
    }
    free(child);
}

/* Boundary k of kind force, pressure, acceleration or velocity: whom it acts on, and its rows. */
static void load(struct builder *b, int k)
{
    const struct boundary *of = &b->scene->boundary[k];
    bool on_faces = of->kind == BOUNDARY_PRESSURE || (of->kind == BOUNDARY_FORCE && b->n_face > 0);
    if (of->kind == BOUNDARY_PRESSURE && b->n_face == 0) {
        fault(b, k, "where", "no free face has its centre in this region");
        return;
    }
    for (int64_t i = 0; i < b->cells->n; i++)
        b->takes[i] &= on_faces ? TAKES_FACES | TAKES_FACET : TAKES_CENTRE;
    if (of->kind != BOUNDARY_VELOCITY && of->kind != BOUNDARY_ANGULAR_VELOCITY) check_moves(b, k);
    refine(b, k);
}

static void fill_term(const struct scene *scene, const struct node *node,
    const struct lattice_share *share, double h, double *value)
{
    const struct boundary *of = &scene->boundary[node->boundary];
    double n = node->n_share, area = h * h;
    if (of->kind == BOUNDARY_FORCE && node->takes == TAKES_CENTRE)
        for (int c = 0; c < 3; c++) value[LOAD_FORCE + c] = of->value[c] / n;
    if (of->kind == BOUNDARY_ACCELERATION)
        for (int c = 0; c < 3; c++) value[LOAD_ACCELERATION + c] = of->value[c];
    if (of->kind == BOUNDARY_VELOCITY || of->kind == BOUNDARY_ANGULAR_VELOCITY)
        for (int c = 0; c < 3; c++)
            if (isfinite(of->value[c]))
                value[LOAD_VELOCITY + (of->kind == BOUNDARY_VELOCITY ? 0 : 3) + c] = of->value[c];
    for (int f = 0; f < 6; f++) {
        if (!(node->takes >> f & 1)) continue;
        double sign = (f & 1) ? 1 : -1, part = share->face[f];
        int a = f / 2;
        if (of->kind == BOUNDARY_FORCE) {
            for (int c = 0; c < 3; c++) {
                value[LOAD_FORCE + c] += of->value[c] / n * part;
                value[LOAD_LEVER + 3 * a + c] += sign * 0.5 * h * (of->value[c] / n * part);
                for (int d = 0; d < 2; d++)
                    value[LOAD_LEVER + 3 * ((a + 1 + d) % 3) + c] +=
                        share->offset[f][d] * h * (of->value[c] / n * part);
            }
            value[LOAD_NORMAL + f] += sign * (of->value[a] / n) / area;
        } else {
            value[LOAD_BODY + a] -= sign * of->pressure * area * part;
            value[LOAD_NORMAL + f] -= of->pressure;
            /* d x F of the offset d */
            value[LOAD_TURN + (a + 1) % 3] -=
                share->offset[f][1] * h * sign * of->pressure * area * part;
            value[LOAD_TURN + (a + 2) % 3] +=
                share->offset[f][0] * h * sign * of->pressure * area * part;
        }
        value[LOAD_TRACTION] += value[LOAD_NORMAL + f] * part;
        value[LOAD_NORMAL + f] *= sqrt(part);
    }
    if (node->takes & TAKES_FACET)
        lattice_facet_load(
            share, h, of->kind == BOUNDARY_FORCE ? of->value : NULL, n, of->pressure, value);
}

/* Rows in the order in which cells name them first; those on the way to others vanish. */
static void number_rows(struct builder *b)
{
    struct lattice_loads *loads = b->cells->loads;
    int *row_of = fail_alloc((size_t)b->n_node * sizeof *row_of),
        *node_of = fail_alloc((size_t)(b->n_node + 1) * sizeof *node_of), n_term = 0;
    loads->n_row = 1;
    for (int64_t i = 0; i < b->cells->n; i++) {
        int node = b->cells->row[i];
        if (b->node[node].parent >= 0 && !row_of[node]) {
            node_of[loads->n_row] = node;
            row_of[node] = loads->n_row++;
        }
        b->cells->row[i] = row_of[node];
    }
    loads->begin = fail_alloc((size_t)(loads->n_row + 1) * sizeof *loads->begin);
    for (int r = 1; r < loads->n_row; r++) {
        loads->begin[r] = n_term;
        for (int node = node_of[r]; b->node[node].parent >= 0; node = b->node[node].parent)
            n_term++;
    }
    loads->begin[loads->n_row] = n_term;
    loads->boundary = fail_alloc((size_t)n_term * sizeof *loads->boundary);
    loads->value = fail_alloc((size_t)n_term * sizeof *loads->value);
    for (int r = 1; r < loads->n_row; r++) {
        int term = loads->begin[r + 1];
        for (int node = node_of[r]; b->node[node].parent >= 0; node = b->node[node].parent) {
            loads->boundary[--term] = b->node[node].boundary;
            const struct node *of = &b->node[node];
            static const struct lattice_share whole = {.face = {1, 1, 1, 1, 1, 1}};
            fill_term(b->scene, of, of->share ? &b->cells->share[of->share] : &whole,
                b->cells->grid[of->grid].h, loads->value[term]);
        }
    }
    free(row_of);
    free(node_of);
}

void lattice_loads_create(
    const struct scene *scene, struct lattice_cells *cells, struct scene_errors *errors)
{
    size_t n = (size_t)cells->n;
    struct builder b = {.scene = scene,
        .cells = cells,
        .errors = errors,
        .takes = fail_alloc(n),
        .moved = fail_alloc(n)};
    cells->row = fail_alloc(n * sizeof *cells->row);
    cells->loads = fail_alloc(sizeof *cells->loads);
    cells->loads->at = fail_alloc((size_t)scene->n_boundary * sizeof(double));
    cells->loads->rate = fail_alloc((size_t)scene->n_boundary * sizeof(double));
    cells->loads->mean = fail_alloc((size_t)scene->n_boundary * sizeof(double));
    for (int g = 0; g < cells->n_grid; g++) add_node(&b, (struct node){.parent = -1, .grid = g});
    for (int64_t i = 0; i < cells->n; i++) cells->row[i] = cells->kind[cells->kind_of[i]].grid;
    for (int pass = 0; pass < 2; pass++) /* what is held first: loads are checked against it */
        for (int k = 0; k < scene->n_boundary; k++) {
            const struct boundary *of = &scene->boundary[k];
            bool holds = dofs_of(of) != 0;
            if (pass == 0 && !holds) continue;
            if (pass == 1 && of->kind == BOUNDARY_FIX) continue;
            choose(&b, k);
            bool by_faces = of->kind == BOUNDARY_FORCE || of->kind == BOUNDARY_PRESSURE;
            if (b.n_centre == 0 && !(by_faces && b.n_face > 0)) {
                if (pass == 0 || !holds)
                    fault(&b, k, "where",
                        by_faces ? "nothing is in this region"
                                 : "no cell has its centre in this region");
            } else if (pass == 0) hold(&b, k);
            else load(&b, k);
        }
    number_rows(&b);
    free(b.takes);
    free(b.moved);
    free(b.node);
}

void lattice_loads_free(struct lattice_loads *loads)
{
    if (!loads) return;
    free(loads->begin);
    free(loads->boundary);
    free(loads->value);
    free(loads->at);
    free(loads->rate);
    free(loads->mean);
    free(loads);
}

void lattice_loads_at(struct lattice_loads *loads, const struct scene *scene, double t, double from,
    double to, double *rows)
{
    memset(rows, 0, (size_t)loads->n_row * LOAD_WIDTH * sizeof *rows);
    for (int k = 0; k < scene->n_boundary; k++) {
        loads->at[k] = history_at(&scene->boundary[k].history, t);
        loads->rate[k] = history_rate(&scene->boundary[k].history, t);
        loads->mean[k] = history_mean(&scene->boundary[k].history, from, to);
    }
    for (int r = 0; r < loads->n_row; r++)
        for (int term = loads->begin[r]; term < loads->begin[r + 1]; term++) {
            const double *value = loads->value[term];
            int k = loads->boundary[term];
            double *row = rows + (size_t)r * LOAD_WIDTH;
            for (int c = 0; c < LOAD_VELOCITY; c++) row[c] += loads->at[k] * value[c];
            for (int c = 0; c < LOAD_NOW - LOAD_VELOCITY; c++) {
                row[LOAD_VELOCITY + c] += loads->mean[k] * value[LOAD_VELOCITY + c];
                row[LOAD_NOW + c] += loads->at[k] * value[LOAD_VELOCITY + c];
            }
            row[LOAD_RATE] += loads->rate[k] * value[LOAD_TRACTION];
        }
}
