#include "particle_fields.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "run/resume.h"
#include "scene/output_fields.h"

enum number { NUMBER_I32, NUMBER_I64, NUMBER_F64, NUMBER_REAL, NUMBER_PLACE, NUMBER_SHOWN_F64 };

struct field_row {
    const char *name, *unit, *text;
    int width;
    enum number number;
    enum output_fields_use use;
    bool (*is_there)(const struct features *features);
    /* Exactly one of: 1 + offset of the array in struct particles_host, 1 + offset of the buffer in
     * struct particles, a function that returns [n_owned][width] in fresh memory. */
    size_t host, device;
    void *(*make)(struct sim *s);
    bool of_lists; /* the buffer is that of the last list build */
};

static bool is_there_any(const struct features *f)
{
    (void)f;
    return true;
}

static bool is_there_orientation(const struct features *f)
{
    return f->orientation;
}

static bool is_there_spin(const struct features *f)
{
    return f->spin;
}

/* The owned elements and their ghosts, and who is near whom, on the host. */
struct near {
    size_t n;       /* owned */
    cl_int *begin;  /* [n_owned + n_ghost + 1] into row */
    cl_int *row;    /* numbers of the elements that are near */
    double (*x)[4]; /* [n_owned + n_ghost] centre and radius [m] */
    const double *period;
};

static struct near near_read(struct sim *s)
{
    struct particle_run *run = s->particle;
    const struct pair_list *l = &run->pairs->now;
    size_t all = (size_t)l->n_all, stride = run->particles->field[FIELD_STATE].bytes;
    struct near near = {.n = (size_t)l->n_owned, .period = run->period};
    char *state = fail_alloc(all * stride);
    near.begin = fail_alloc((all + 1) * sizeof *near.begin);
    near.row = fail_alloc((size_t)l->n_row * sizeof *near.row);
    near.x = fail_alloc(all * sizeof *near.x);
    if (run->assigned) ghosts_refresh(run->ghosts, run->particles);
    buffer_read(&l->row_begin, 0, (all + 1) * sizeof *near.begin, near.begin);
    buffer_read(&l->row, 0, (size_t)l->n_row * sizeof *near.row, near.row);
    buffer_read(&run->particles->field[FIELD_STATE].now, 0, all * stride, state);
    for (size_t i = 0; i < all; i++)
        for (int a = 0; a < 4; a++)
            near.x[i][a] = run->features.position_is_float
                               ? (double)((float *)(void *)(state + i * stride))[a]
                               : ((double *)(void *)(state + i * stride))[a];
    free(state);
    return near;
}

static void near_free(struct near *near)
{
    free(near->begin);
    free(near->row);
    free(near->x);
}

/* Square of the distance of the centres, of the nearest images [m2]. */
static double near_distance2(const struct near *near, const double a[4], const double b[4])
{
    double sum = 0;
    for (int c = 0; c < 3; c++) {
        double d = b[c] - a[c], period = near->period[c];
        if (period > 0) d -= period * (d > 0.5 * period) - period * (d < -0.5 * period);
        sum += d * d;
    }
    return sum;
}

/* Contacts per element: overlapping neighbours, and walls that the element touches. Collective. */
static void *make_coordination(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct near near = near_read(s);
    int32_t *count = fail_alloc(near.n * sizeof *count);
    for (size_t i = 0; i < near.n; i++)
        for (int k = near.begin[i]; k < near.begin[i + 1]; k++) {
            const double *a = near.x[i], *b = near.x[near.row[k]], r = a[3] + b[3];
            count[i] += near_distance2(&near, a, b) < r * r;
        }
    near_free(&near);
    if (run->wall_contacts && run->wall_contacts->layout.remembers) {
        size_t m = (size_t)run->wall_contacts->now.n;
        cl_int *element = fail_alloc(m * sizeof *element), *bits = fail_alloc(m * sizeof *bits);
        buffer_read(&run->wall_contacts->now.element, 0, m * sizeof *element, element);
        buffer_read(&run->wall_contacts->now.state, 0, m * sizeof *bits, bits);
        for (size_t k = 0; k < m; k++) count[element[k]] += (bits[k] & CONTACT_TOUCHING) != 0;
        free(element);
        free(bits);
    }
    return count;
}

/* Largest overlap with a neighbour over the own radius: (r_i + r_j - d)/r_i, 0 where none touches.
 * The largest number does not depend on the order, so not on the ranks. Collective. */
static void *make_overlap(struct sim *s)
{
    struct near near = near_read(s);
    double *overlap = fail_alloc(near.n * sizeof *overlap);
    for (size_t i = 0; i < near.n; i++)
        for (int k = near.begin[i]; k < near.begin[i + 1]; k++) {
            const double *a = near.x[i], *b = near.x[near.row[k]],
                         depth = a[3] + b[3] - sqrt(near_distance2(&near, a, b));
            overlap[i] = fmax(overlap[i], depth / a[3]);
        }
    near_free(&near);
    return overlap;
}

static void *make_owner(struct sim *s)
{
    size_t n = (size_t)s->particle->particles->n_owned;
    int32_t *owner = fail_alloc(n * sizeof *owner);
    for (size_t k = 0; k < n; k++) owner[k] = s->comm->rank;
    return owner;
}

#define HOST(member) .host = 1 + offsetof(struct particles_host, member)
#define DEVICE(member) .device = 1 + offsetof(struct particles, member)
#define LISTS(member) .device = 1 + offsetof(struct particles, member), .of_lists = true
#define MADE(function) .make = make_##function
#define FIELD_ROW(name_, unit_, width_, number_, use_, when_, source_, text_)                      \
    {.name = #name_,                                                                               \
        .unit = unit_,                                                                             \
        .text = text_,                                                                             \
        .width = width_,                                                                           \
        .number = NUMBER_##number_,                                                                \
        .use = OUTPUT_FIELDS_##use_,                                                               \
        .is_there = is_there_##when_,                                                              \
        source_},

static const struct field_row field_row[] = {OUTPUT_FIELDS_PARTICLES(FIELD_ROW)};
enum { N_ROW = sizeof field_row / sizeof *field_row };

static bool is_real(const struct field_row *row)
{
    return row->number >= NUMBER_REAL;
}

/* Whether the numbers are floats on this device. */
static bool is_float(const struct sim *s, const struct field_row *row)
{
    const struct features *f = &s->particle->features;
    return row->number == NUMBER_PLACE ? f->position_is_float : is_real(row) && f->real_is_float;
}

/* In memory; integers and doubles as they are in files. */
static enum column_type type_of(const struct field_row *row)
{
    return row->number == NUMBER_I32   ? COLUMN_I32
           : row->number == NUMBER_I64 ? COLUMN_I64
                                       : COLUMN_F64;
}

/* Whether the run has the field, for a use. */
static bool is_for(const struct sim *s, const struct field_row *row, int use)
{
    return row->use & use && row->is_there(&s->particle->features);
}

static bool is_state(const struct sim *s, const struct field_row *row)
{
    return is_for(s, row, OUTPUT_FIELDS_STATE);
}

/* Numbers from one element to the next in the device's buffer. */
static int stride_of(const struct field_row *row)
{
    return row->width == 1 ? 1 : 4;
}

static struct buffer *buffer_of(struct sim *s, const struct field_row *row)
{
    return (struct buffer *)(void *)((char *)s->particle->particles + row->device - 1);
}

static void **host_of(const struct particles_host *host, const struct field_row *row)
{
    return (void **)(void *)((char *)host + row->host - 1);
}

/* Rows of `stride` numbers to rows of `width`, or the other way, in fresh memory. */
static double *repack(const double *from, size_t n, int stride, int width)
{
    double *to = fail_alloc(n * (size_t)width * sizeof *to);
    size_t both = (size_t)(stride < width ? stride : width) * sizeof *to;
    for (size_t i = 0; i < n; i++) memcpy(to + i * (size_t)width, from + i * (size_t)stride, both);
    return to;
}

static double *read_buffer(struct sim *s, const struct field_row *row, size_t n)
{
    int stride = stride_of(row);
    double *all = reals_read(buffer_of(s, row), is_float(s, row), 0, (size_t)stride * n);
    if (stride == row->width) return all;
    double *packed = repack(all, n, stride, row->width);
    free(all);
    return packed;
}

static void add(struct sim *s, struct sheet *sheet, const struct particles_host *host,
    const struct field_row *row, bool shown)
{
    size_t n = (size_t)host->n;
    const void *data = row->host
                           ? *host_of(host, row)
                           : sheet_keep(sheet, row->device ? read_buffer(s, row, n) : row->make(s));
    if (is_real(row))
        sheet_add_real(sheet, is_float(s, row) && !(shown && row->number == NUMBER_SHOWN_F64),
            row->name, row->unit, row->text, row->width, data, n);
    else sheet_add(sheet, row->name, row->unit, row->text, type_of(row), row->width, data);
}

void particle_fields_show(struct sim *s, struct sheet *sheet, const struct particles_host *host)
{
    for (int k = 0; k < N_ROW; k++)
        if (is_for(s, &field_row[k], OUTPUT_FIELDS_UNASKED))
            add(s, sheet, host, &field_row[k], true);
    for (int i = 0; i < s->scene->output.n_field; i++)
        for (int k = 0; k < N_ROW; k++)
            if (is_for(s, &field_row[k], OUTPUT_FIELDS_SHOWN) &&
                !strcmp(field_row[k].name, s->scene->output.field[i]))
                add(s, sheet, host, &field_row[k], true);
}

void particle_fields_state(struct sim *s, struct sheet *sheet, const struct particles_host *host)
{
    for (int k = 0; k < N_ROW; k++)
        if (is_state(s, &field_row[k])) add(s, sheet, host, &field_row[k], false);
}

void particle_fields_read(struct sim *s, struct frame_table *table)
{
    for (int k = 0; k < N_ROW; k++)
        if (is_state(s, &field_row[k]))
            frame_table_add(table, s->from->reader, field_row[k].name, type_of(&field_row[k]),
                field_row[k].width);
}

struct particles_host *particle_fields_host(struct sim *s, const struct frame_table *table)
{
    struct particles_host *host = particles_host_create(table->n);
    for (int k = 0; k < N_ROW; k++) {
        const struct field_row *row = &field_row[k];
        size_t bytes = (size_t)row->width * column_type_size(type_of(row));
        if (is_state(s, row) && row->host)
            memcpy(
                *host_of(host, row), frame_table_get(table, row->name), (size_t)table->n * bytes);
    }
    for (int64_t i = 0; i < table->n; i++)
        particles_host_kind(host, i, s->scene, s->particle->first);
    return host;
}

void particle_fields_restore(struct sim *s, const struct frame_table *table, bool of_lists)
{
    size_t n = (size_t)table->n;
    for (int k = 0; k < N_ROW; k++) {
        const struct field_row *row = &field_row[k];
        int stride = stride_of(row);
        if (!is_state(s, row) || !row->device || row->of_lists != of_lists) continue;
        double *padded = repack(frame_table_get(table, row->name), n, row->width, stride);
        reals_write(buffer_of(s, row), is_float(s, row), 0, (size_t)stride * n, padded);
        free(padded);
    }
}
