/* Scene -> flat table. Motion is in walls_pose.c. */
#include "walls.h"

#include "base/vector.h"
#include "comm/fail.h"
#include "kernels/contact/law_wall.h"
#include "stl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void cross(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

void walls_axes(const double normal[3], double u[3], double v[3])
{
    double m[3] = {normal[0], normal[1], normal[2]};
    vector_normalise(m);
    /* left out unless clearly not the nearest: 1e-9 keeps a rounded diagonal in one class */
    int out = 2;
    for (int k = 1; k >= 0; k--)
        if (fabs(m[k]) > fabs(m[out]) + 1e-9) out = k;
    int first = out == 0 ? 1 : 0, second = out == 2 ? 1 : 2;
    for (int k = 0; k < 3; k++) u[k] = (k == first) - m[first] * m[k];
    vector_normalise(u);
    cross(m, u, v);
    if (v[second] < 0)
        for (int k = 0; k < 3; k++) v[k] = -v[k];
}

/* A fresh primitive of wall w: its row of 12, zeroed but for the kind. */
static double *add_primitive(struct walls *walls, int w, int kind)
{
    size_t k = (size_t)walls->n_primitive++;
    if ((k & (k - 1)) == 0) { /* full at every power of two */
        size_t room = k ? 2 * k : 1;
        walls->primitive =
            fail_realloc(walls->primitive, room * WALL_PRIMITIVE_WIDTH * sizeof(double));
        walls->wall_of = fail_realloc(walls->wall_of, room * sizeof(int));
        walls->low = fail_realloc(walls->low, room * 3 * sizeof(double));
        walls->high = fail_realloc(walls->high, room * 3 * sizeof(double));
        walls->features = fail_realloc(walls->features, room * 6 * sizeof(int));
    }
    double *row = walls->primitive + WALL_PRIMITIVE_WIDTH * k;
    memset(row, 0, WALL_PRIMITIVE_WIDTH * sizeof(double));
    row[11] = kind;
    walls->wall_of[k] = w;
    walls->n_of_kind[kind]++;
    for (int a = 0; a < 3; a++) {
        walls->low[3 * k + (size_t)a] = -HUGE_VAL;
        walls->high[3 * k + (size_t)a] = HUGE_VAL;
    }
    for (int f = 0; f < 6; f++) walls->features[6 * k + (size_t)f] = -1;
    return row;
}

/* Grows the bounds of the newest primitive around the point; the first point starts them. */
static void bound_last(struct walls *walls, const double p[3], bool is_first)
{
    double *low = walls->low + 3 * (walls->n_primitive - 1),
           *high = walls->high + 3 * (walls->n_primitive - 1);
    for (int a = 0; a < 3; a++) {
        low[a] = is_first ? p[a] : fmin(low[a], p[a]);
        high[a] = is_first ? p[a] : fmax(high[a], p[a]);
    }
}

static void add_plane(struct walls *walls, int w, const double point[3], const double normal[3])
{
    double *row = add_primitive(walls, w, WALL_PLANE);
    memcpy(row, point, 3 * sizeof(double));
    memcpy(row + 3, normal, 3 * sizeof(double));
    vector_normalise(row + 3);
}

static void add_rectangle(struct walls *walls, int w, const struct wall *wall)
{
    double *row = add_primitive(walls, w, WALL_RECTANGLE);
    memcpy(row, wall->point, 3 * sizeof(double));
    walls_axes(wall->normal, row + 3, row + 6);
    row[9] = 0.5 * wall->size[0];
    row[10] = 0.5 * wall->size[1];
    for (int k = 0; k < 4; k++) {
        double corner[3], su = k & 1 ? row[9] : -row[9], sv = k & 2 ? row[10] : -row[10];
        for (int a = 0; a < 3; a++) corner[a] = row[a] + su * row[3 + a] + sv * row[6 + a];
        bound_last(walls, corner, k == 0);
    }
}

/* Six planes that face inwards: -x, +x, -y, +y, -z, +z side. */
static void add_box(struct walls *walls, int w, const struct wall *wall)
{
    for (int k = 0; k < 6; k++) {
        double normal[3] = {0};
        normal[k / 2] = k % 2 ? -1 : 1;
        add_plane(walls, w, k % 2 ? wall->max : wall->min, normal);
    }
}

static void add_cylinder(struct walls *walls, int w, const struct wall *wall)
{
    double *row = add_primitive(walls, w, wall->inside ? WALL_PIPE : WALL_ROD), unused[3];
    memcpy(row, wall->from, 3 * sizeof(double));
    for (int a = 0; a < 3; a++) row[3 + a] = wall->to[a] - wall->from[a];
    row[10] = vector_normalise(row + 3);
    walls_axes(row + 3, row + 6, unused);
    row[9] = wall->radius;
    for (int k = 0; k < 2; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
            double p[3]; /* a rim reaches radius sqrt(1 - axis_a^2) along coordinate a */
            for (int a = 0; a < 3; a++)
                p[a] = (k ? wall->to[a] : wall->from[a]) +
                       sign * wall->radius * sqrt(fmax(0, 1 - row[3 + a] * row[3 + a]));
            bound_last(walls, p, k == 0 && sign < 0);
        }
}

/* Edges of the mesh keep their numbers, vertices follow; both go behind the features of the meshes
 * before. */
static void add_mesh(struct walls *walls, int w, const struct stl *stl)
{
    for (int t = 0; t < stl->n_triangle; t++) {
        double *row = add_primitive(walls, w, WALL_TRIANGLE);
        int *features = walls->features + 6 * (walls->n_primitive - 1);
        for (int k = 0; k < 3; k++) {
            const double *p = stl->vertex + 3 * stl->triangle[3 * t + k];
            memcpy(row + 3 * k, p, 3 * sizeof(double));
            bound_last(walls, p, k == 0);
            features[k] = walls->n_feature + stl->edge[3 * t + k];
            features[3 + k] = walls->n_feature + stl->n_edge + stl->triangle[3 * t + k];
        }
    }
    walls->n_feature += stl->n_edge + stl->n_vertex;
    walls->n_dropped += stl->n_dropped;
}

static void add_stl(
    struct walls *walls, int w, const struct scene *scene, struct scene_errors *errors)
{
    const struct wall *wall = scene->wall + w;
    char *text = NULL;
    struct stl *stl = stl_read(wall->stl, wall->scale, &text);
    if (!stl) {
        scene_errors_add(errors, "%s:%d: wall '%s': %s", scene->path, wall->line, wall->name, text);
        free(text);
        return;
    }
    if (stl->n_dropped)
        fail_warn("%s: triangles of zero area are left out: %d of %d", wall->stl, stl->n_dropped,
            stl->n_dropped + stl->n_triangle);
    add_mesh(walls, w, stl);
    stl_free(stl);
}

/* CSR of triangles by feature: count, sum, fill in ascending order. */
static void share_features(struct walls *walls)
{
    walls->share_first = fail_alloc(((size_t)walls->n_feature + 2) * sizeof(int));
    int *first = walls->share_first, n_row = 6 * walls->n_primitive;
    for (int k = 0; k < n_row; k++)
        if (walls->features[k] >= 0) first[walls->features[k] + 2]++;
    for (int f = 0; f < walls->n_feature; f++) first[f + 2] += first[f + 1];
    walls->share = fail_alloc((size_t)first[walls->n_feature + 1] * sizeof(int));
    /* while filling, first[f + 1] runs from the start of f to its end */
    for (int k = 0; k < n_row; k++)
        if (walls->features[k] >= 0) walls->share[first[walls->features[k] + 1]++] = k / 6;
}

static bool is_zero(const double a[3])
{
    return !(fabs(a[0]) > 0) && !(fabs(a[1]) > 0) && !(fabs(a[2]) > 0);
}

static void bound_wall(struct walls *walls, int w)
{
    for (int a = 0; a < 3; a++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int k = walls->first[w]; k < walls->first[w + 1]; k++) {
            low = fmin(low, walls->low[3 * k + a]);
            high = fmax(high, walls->high[3 * k + a]);
        }
        walls->wall_low[3 * w + a] = low;
        walls->wall_high[3 * w + a] = high;
    }
}

struct walls *walls_create(const struct scene *scene, struct scene_errors *errors)
{
    int n = scene->n_wall, n_error = errors->n;
    struct walls *walls = fail_alloc(sizeof *walls);
    walls->wall = scene->wall;
    walls->n_wall = n;
    walls->first = fail_alloc(((size_t)n + 1) * sizeof(int));
    walls->moves = fail_alloc((size_t)n * sizeof(int));
    walls->wall_low = fail_alloc(3 * (size_t)n * sizeof(double));
    walls->wall_high = fail_alloc(3 * (size_t)n * sizeof(double));
    for (int w = 0; w < n; w++) {
        const struct wall *wall = scene->wall + w;
        switch (wall->kind) {
        case SURFACE_PLANE: add_plane(walls, w, wall->point, wall->normal); break;
        case SURFACE_RECTANGLE: add_rectangle(walls, w, wall); break;
        case SURFACE_BOX: add_box(walls, w, wall); break;
        case SURFACE_CYLINDER: add_cylinder(walls, w, wall); break;
        case SURFACE_STL: add_stl(walls, w, scene, errors); break;
        }
        walls->first[w + 1] = walls->n_primitive;
        bool swings = !is_zero(wall->amplitude) && (wall->frequency > 0 || wall->frequency < 0);
        walls->moves[w] = !is_zero(wall->velocity) || swings || wall->rotation_rate > 0 ||
                          wall->rotation_rate < 0;
        walls->n_moving += walls->moves[w];
        bound_wall(walls, w);
    }
    share_features(walls);
    for (int w = 0; w < n; w++) walls_room(walls, w);
    if (errors->n == n_error) return walls;
    walls_free(walls);
    return NULL;
}

void walls_free(struct walls *walls)
{
    if (!walls) return;
    free(walls->first);
    free(walls->wall_of);
    free(walls->primitive);
    free(walls->low);
    free(walls->high);
    free(walls->wall_low);
    free(walls->wall_high);
    free(walls->features);
    free(walls->share_first);
    free(walls->share);
    free(walls->moves);
    free(walls);
}
