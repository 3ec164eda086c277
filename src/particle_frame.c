#include "particle.h"

#include <stdlib.h>
#include <string.h>

#include "fail.h"
#include "snapshot.h"

enum { COLUMNS = 16 };

/* Columns under construction, and the memory that they own. */
struct sheet {
    struct column column[COLUMNS];
    int n;
    void *own[2 * COLUMNS];
    int n_own;
};

static void *keep(struct sheet *t, void *memory)
{
    return t->own[t->n_own++] = memory;
}

static void add(struct sheet *t, const char *name, const char *unit, const char *text, enum column_type type, int width, const void *data)
{
    t->column[t->n++] = (struct column){name, unit, text, type, width, data};
}

static void sheet_free(struct sheet *t)
{
    for (int i = 0; i < t->n_own; i++) free(t->own[i]);
}

/* Doubles that came from floats go back to floats: the state's own bits. */
static void add_real(struct sheet *t, bool is_float, const char *name, const char *unit, const char *text, int width, const double *data, size_t n)
{
    if (!is_float) {
        add(t, name, unit, text, COLUMN_F64, width, data);
        return;
    }
    float *small = keep(t, fail_alloc(n * (size_t)width * sizeof *small));
    for (size_t i = 0; i < n * (size_t)width; i++) small[i] = (float)data[i];
    add(t, name, unit, text, COLUMN_F32, width, small);
}

/* Padded vectors [n][4] on the device to [n][3]. */
static double *read_vectors(struct sim *s, const struct buffer *buffer, size_t n)
{
    double *four = particles_read(s->dev, buffer, s->features.real_is_float, 0, 4 * n), *three = fail_alloc(3 * n * sizeof *three);
    for (size_t i = 0; i < n; i++) memcpy(three + 3 * i, four + 4 * i, 3 * sizeof *three);
    free(four);
    return three;
}

/* Contacts per element: overlapping neighbours, and walls that the element touches. */
static int32_t *coordination(struct sim *s)
{
    const struct pair_list *l = &s->pairs->now;
    size_t n = (size_t)l->n_owned, all = (size_t)l->n_all, stride = s->particles->field[FIELD_STATE].bytes;
    int32_t *count = fail_alloc(n * sizeof *count);
    cl_int *begin = fail_alloc((all + 1) * sizeof *begin), *row = fail_alloc((size_t)l->n_row * sizeof *row);
    char *state = fail_alloc(all * stride);
    double *x = fail_alloc(4 * all * sizeof *x);
    buffer_read(s->dev, &l->row_begin, 0, (all + 1) * sizeof *begin, begin);
    buffer_read(s->dev, &l->row, 0, (size_t)l->n_row * sizeof *row, row);
    buffer_read(s->dev, &s->particles->field[FIELD_STATE].now, 0, all * stride, state);
    for (size_t i = 0; i < all; i++)
        for (int a = 0; a < 4; a++)
            x[4 * i + (size_t)a] =
                s->features.position_is_float ? (double)((float *)(void *)(state + i * stride))[a] : ((double *)(void *)(state + i * stride))[a];
    for (size_t i = 0; i < n; i++)
        for (int k = begin[i]; k < begin[i + 1]; k++) {
            const double *a = x + 4 * i, *b = x + 4 * (size_t)row[k];
            double sum = 0, r = a[3] + b[3];
            for (int c = 0; c < 3; c++) {
                double d = b[c] - a[c], period = s->period[c];
                if (period > 0) d -= period * (d > 0.5 * period) - period * (d < -0.5 * period);
                sum += d * d;
            }
            count[i] += sum < r * r;
        }
    if (s->wall_contacts && s->wall_contacts->layout.remembers) {
        size_t m = (size_t)s->wall_contacts->now.n;
        cl_int *element = fail_alloc(m * sizeof *element), *bits = fail_alloc(m * sizeof *bits);
        buffer_read(s->dev, &s->wall_contacts->now.element, 0, m * sizeof *element, element);
        buffer_read(s->dev, &s->wall_contacts->now.state, 0, m * sizeof *bits, bits);
        for (size_t k = 0; k < m; k++) count[element[k]] += bits[k] & 1;
        free(element);
        free(bits);
    }
    free(begin);
    free(row);
    free(state);
    free(x);
    return count;
}

static void point_columns(struct sim *s, struct sheet *t, const struct particles_host *h)
{
    size_t n = (size_t)h->n;
    bool f = s->features.real_is_float;
    add_real(t, s->features.position_is_float, "position", "m", "centres of the elements", 3, h->x, n);
    for (int i = 0; i < s->scene->output.n_field; i++) {
        const char *name = s->scene->output.field[i];
        if (!strcmp(name, "velocity")) add_real(t, f, "velocity", "m/s", "velocity of the centre", 3, h->v, n);
        else if (!strcmp(name, "angular_velocity")) add_real(t, f, "angular_velocity", "rad/s", "angular velocity", 3, h->w, n);
        else if (!strcmp(name, "orientation")) add_real(t, f, "orientation", "1", "quaternion w, x, y, z", 4, h->q, n);
        else if (!strcmp(name, "radius")) add(t, "radius", "m", "radius of the sphere", COLUMN_F64, 1, h->radius);
        else if (!strcmp(name, "mass")) add(t, "mass", "kg", "mass", COLUMN_F64, 1, h->mass);
        else if (!strcmp(name, "id")) add(t, "id", "1", "global id", COLUMN_I64, 1, h->gid);
        else if (!strcmp(name, "material")) add(t, "material", "1", "index of the material in the scene", COLUMN_I32, 1, h->material);
        else if (!strcmp(name, "force"))
            add(t, "force", "N", "sum of contact forces", COLUMN_F64, 3, keep(t, read_vectors(s, &s->particles->force, n)));
        else if (!strcmp(name, "coordination")) add(t, "coordination", "1", "number of contacts", COLUMN_I32, 1, keep(t, coordination(s)));
        else if (!strcmp(name, "owner")) {
            int32_t *owner = keep(t, fail_alloc(n * sizeof *owner));
            for (size_t k = 0; k < n; k++) owner[k] = s->comm->rank;
            add(t, "owner", "1", "rank that owns the element", COLUMN_I32, 1, owner);
        }
    }
}

static void state_columns(struct sim *s, struct sheet *t, const struct particles_host *h)
{
    size_t n = (size_t)h->n;
    bool f = s->features.real_is_float;
    add(t, "id", "1", "global id", COLUMN_I64, 1, h->gid);
    add_real(t, s->features.position_is_float, "position", "m", "centres of the elements", 3, h->x, n);
    add_real(t, f, "velocity", "m/s", "velocity of the centre", 3, h->v, n);
    add_real(t, f, "angular_velocity", "rad/s", "angular velocity", 3, h->w, n);
    if (s->features.orientation) add_real(t, f, "orientation", "1", "quaternion w, x, y, z", 4, h->q, n);
    add_real(t, f, "force", "N", "sum of contact forces", 3, keep(t, read_vectors(s, &s->particles->force, n)), n);
    if (s->features.spin) add_real(t, f, "torque", "N m", "sum of contact torques", 3, keep(t, read_vectors(s, &s->particles->torque, n)), n);
}

/* Contacts that remember something: keys, state bits, history rows; chosen by `is_mine`. Returns how many. */
static int64_t contact_columns(struct sim *s, struct sheet *t, const struct contact_layout *layout, int64_t n, int64_t capacity,
    const struct buffer *state, const struct buffer *history, const unsigned char *is_mine, const int64_t *key_a, const int64_t *key_b,
    const char *name_b)
{
    size_t width = (size_t)layout->history, m = 0;
    int64_t *a = keep(t, fail_alloc((size_t)n * sizeof *a)), *b = keep(t, fail_alloc((size_t)n * sizeof *b));
    int32_t *bits = keep(t, fail_alloc((size_t)n * sizeof *bits));
    double *rows = keep(t, fail_alloc((size_t)n * width * sizeof *rows)), *plane = NULL;
    if (layout->remembers && n > 0) {
        cl_int *all = fail_alloc((size_t)n * sizeof *all);
        buffer_read(s->dev, state, 0, (size_t)n * sizeof *all, all);
        plane = particles_read(s->dev, history, s->features.real_is_float, 0, width * (size_t)capacity);
        for (int64_t k = 0; k < n; k++) {
            if (!is_mine[k] || all[k] == 0) continue;
            a[m] = key_a[k];
            b[m] = key_b[k];
            bits[m] = all[k];
            for (size_t c = 0; c < width; c++) rows[m * width + c] = plane[c * (size_t)capacity + (size_t)k];
            m++;
        }
        free(all);
        free(plane);
    }
    add(t, "id", "1", "global id of the element; of the lower one in a pair", COLUMN_I64, 1, a);
    add(t, name_b, "1", "the other element, or the primitive of the wall", COLUMN_I64, 1, b);
    add(t, "state", "1", "bit 1: touching, bit 2: bonded", COLUMN_I32, 1, bits);
    if (width > 0)
        add_real(t, s->features.real_is_float, "history", "m", "springs and dashpot forces, see kernels/contact_memory.h", (int)width, rows, m);
    return (int64_t)m;
}

static int64_t pair_columns(struct sim *s, struct sheet *t)
{
    const struct pair_list *l = &s->pairs->now;
    size_t n = (size_t)(l->first_boundary + l->n_boundary), all = (size_t)l->n_all;
    cl_int *i = fail_alloc(n * sizeof *i), *j = fail_alloc(n * sizeof *j);
    int64_t *gid = fail_alloc(all * sizeof *gid), *a = fail_alloc(n * sizeof *a), *b = fail_alloc(n * sizeof *b);
    unsigned char *mine = fail_alloc(n);
    buffer_read(s->dev, &l->pair_i, 0, n * sizeof *i, i);
    buffer_read(s->dev, &l->pair_j, 0, n * sizeof *j, j);
    buffer_read(s->dev, &s->particles->field[FIELD_GID].now, 0, all * sizeof *gid, gid);
    for (size_t k = 0; k < n; k++) {
        bool gap = k >= (size_t)l->n_interior && k < (size_t)l->first_boundary;
        mine[k] = !gap && i[k] < l->n_owned;
        a[k] = gap ? -1 : gid[i[k]];
        b[k] = gap ? -1 : gid[j[k]];
    }
    int64_t m = contact_columns(s, t, &s->pairs->layout, (int64_t)n, l->capacity, &l->state, &l->history, mine, a, b, "partner");
    void *part[] = {i, j, gid, a, b, mine};
    for (size_t k = 0; k < 6; k++) free(part[k]);
    return m;
}

static int64_t wall_columns(struct sim *s, struct sheet *t, const struct particles_host *h)
{
    const struct wall_contacts *w = s->wall_contacts;
    size_t n = w ? (size_t)w->now.n : 0;
    static const struct contact_layout none = {0, 0, false};
    cl_int *e = fail_alloc(n * sizeof *e), *k = fail_alloc(n * sizeof *k);
    int64_t *a = fail_alloc(n * sizeof *a), *b = fail_alloc(n * sizeof *b);
    unsigned char *mine = fail_alloc(n);
    if (n > 0) buffer_read(s->dev, &w->now.element, 0, n * sizeof *e, e);
    if (n > 0) buffer_read(s->dev, &w->now.candidate, 0, n * sizeof *k, k);
    for (size_t c = 0; c < n; c++) {
        a[c] = h->gid[e[c]];
        b[c] = k[c];
        mine[c] = 1;
    }
    int64_t m = contact_columns(s, t, w ? &w->layout : &none, (int64_t)n, w ? w->now.capacity : 0, w ? &w->now.state : NULL,
        w ? &w->now.history : NULL, mine, a, b, "primitive");
    void *part[] = {e, k, a, b, mine};
    for (size_t c = 0; c < 5; c++) free(part[c]);
    return m;
}

void particle_frame(struct sim *s, int64_t index)
{
    struct particles_host *h = particles_download(s->dev, s->particles, &s->features, s->scene, s->first);
    struct sheet *sheet = fail_alloc(4 * sizeof *sheet);
    point_columns(s, &sheet[0], h);
    state_columns(s, &sheet[1], h);
    int64_t n_pair = pair_columns(s, &sheet[2]), n_wall = wall_columns(s, &sheet[3], h);
    struct table state[] = {{"elements", h->n, sheet[1].column, sheet[1].n}, {"pairs", n_pair, sheet[2].column, sheet[2].n},
        {"wall_contacts", n_wall, sheet[3].column, sheet[3].n}};
    struct frame_scalar scalar[] = {{"dt", COLUMN_F64, s->dt, 0}, {"skin", COLUMN_F64, s->skin, 0}, {"built_at", COLUMN_I64, 0, s->built_at},
        {"n_removed", COLUMN_I64, 0, s->n_removed}};
    struct frame frame = {.step = s->step,
        .time = (double)s->step * s->dt,
        .index = index,
        .points = {"points", h->n, sheet[0].column, sheet[0].n},
        .state = state,
        .n_state = 3,
        .resolved = s->scene->resolved,
        .scalar = scalar,
        .n_scalar = 4};
    snapshot_write(s->comm, s->options->dir, &frame);
    for (int i = 0; i < 4; i++) sheet_free(&sheet[i]);
    free(sheet);
    particles_host_free(h);
}
