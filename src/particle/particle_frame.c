#include "particle_contacts.h"

#include <stdlib.h>
#include <string.h>

#include "energy.h"
#include "comm/fail.h"
#include "run/resume.h"
#include "results/snapshot.h"

/* Padded vectors [n][4] on the device to [n][3]. */
static double *read_vectors(struct sim *s, const struct buffer *buffer, size_t n)
{
    double *four = particles_read(s->dev, buffer, s->particle->features.real_is_float, 0, 4 * n),
           *three = fail_alloc(3 * n * sizeof *three);
    for (size_t i = 0; i < n; i++) memcpy(three + 3 * i, four + 4 * i, 3 * sizeof *three);
    free(four);
    return three;
}

/* Contacts per element: overlapping neighbours, and walls that the element touches. Collective. */
static int32_t *coordination(struct sim *s)
{
    struct particle_run *run = s->particle;
    const struct pair_list *l = &run->pairs->now;
    size_t n = (size_t)l->n_owned, all = (size_t)l->n_all,
           stride = run->particles->field[FIELD_STATE].bytes;
    int32_t *count = fail_alloc(n * sizeof *count);
    cl_int *begin = fail_alloc((all + 1) * sizeof *begin),
           *row = fail_alloc((size_t)l->n_row * sizeof *row);
    char *state = fail_alloc(all * stride);
    double *x = fail_alloc(4 * all * sizeof *x);
    if (run->assigned) ghosts_refresh(s->dev, run->ghosts, run->particles);
    buffer_read(s->dev, &l->row_begin, 0, (all + 1) * sizeof *begin, begin);
    buffer_read(s->dev, &l->row, 0, (size_t)l->n_row * sizeof *row, row);
    buffer_read(s->dev, &run->particles->field[FIELD_STATE].now, 0, all * stride, state);
    for (size_t i = 0; i < all; i++)
        for (int a = 0; a < 4; a++)
            x[4 * i + (size_t)a] = run->features.position_is_float
                                       ? (double)((float *)(void *)(state + i * stride))[a]
                                       : ((double *)(void *)(state + i * stride))[a];
    for (size_t i = 0; i < n; i++)
        for (int k = begin[i]; k < begin[i + 1]; k++) {
            const double *a = x + 4 * i, *b = x + 4 * (size_t)row[k];
            double sum = 0, r = a[3] + b[3];
            for (int c = 0; c < 3; c++) {
                double d = b[c] - a[c], period = run->period[c];
                if (period > 0) d -= period * (d > 0.5 * period) - period * (d < -0.5 * period);
                sum += d * d;
            }
            count[i] += sum < r * r;
        }
    if (run->wall_contacts && run->wall_contacts->layout.remembers) {
        size_t m = (size_t)run->wall_contacts->now.n;
        cl_int *element = fail_alloc(m * sizeof *element), *bits = fail_alloc(m * sizeof *bits);
        buffer_read(s->dev, &run->wall_contacts->now.element, 0, m * sizeof *element, element);
        buffer_read(s->dev, &run->wall_contacts->now.state, 0, m * sizeof *bits, bits);
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
    struct particle_run *run = s->particle;
    size_t n = (size_t)h->n;
    bool f = run->features.real_is_float;
    sheet_add_real(
        t, run->features.position_is_float, "position", "m", "centres of the elements", 3, h->x, n);
    for (int i = 0; i < s->scene->output.n_field; i++) {
        const char *name = s->scene->output.field[i];
        if (!strcmp(name, "velocity"))
            sheet_add_real(t, f, "velocity", "m/s", "velocity of the centre", 3, h->v, n);
        else if (!strcmp(name, "angular_velocity"))
            sheet_add_real(t, f, "angular_velocity", "rad/s", "angular velocity", 3, h->w, n);
        else if (!strcmp(name, "orientation"))
            sheet_add_real(t, f, "orientation", "1", "quaternion w, x, y, z", 4, h->q, n);
        else if (!strcmp(name, "radius"))
            sheet_add(t, "radius", "m", "radius of the sphere", COLUMN_F64, 1, h->radius);
        else if (!strcmp(name, "mass")) sheet_add(t, "mass", "kg", "mass", COLUMN_F64, 1, h->mass);
        else if (!strcmp(name, "id")) sheet_add(t, "id", "1", "global id", COLUMN_I64, 1, h->gid);
        else if (!strcmp(name, "material"))
            sheet_add(t, "material", "1", "index of the material in the scene", COLUMN_I32, 1,
                h->material);
        else if (!strcmp(name, "force"))
            sheet_add(t, "force", "N", "sum of contact forces", COLUMN_F64, 3,
                sheet_keep(t, read_vectors(s, &run->particles->force, n)));
        else if (!strcmp(name, "coordination"))
            sheet_add(t, "coordination", "1", "number of contacts", COLUMN_I32, 1,
                sheet_keep(t, coordination(s)));
        else if (!strcmp(name, "owner")) {
            int32_t *owner = sheet_keep(t, fail_alloc(n * sizeof *owner));
            for (size_t k = 0; k < n; k++) owner[k] = s->comm->rank;
            sheet_add(t, "owner", "1", "rank that owns the element", COLUMN_I32, 1, owner);
        }
    }
}

static void state_columns(struct sim *s, struct sheet *t, const struct particles_host *h)
{
    struct particle_run *run = s->particle;
    size_t n = (size_t)h->n;
    bool f = run->features.real_is_float;
    sheet_add(t, "id", "1", "global id", COLUMN_I64, 1, h->gid);
    sheet_add_real(
        t, run->features.position_is_float, "position", "m", "centres of the elements", 3, h->x, n);
    sheet_add_real(t, f, "velocity", "m/s", "velocity of the centre", 3, h->v, n);
    sheet_add_real(t, f, "angular_velocity", "rad/s", "angular velocity", 3, h->w, n);
    if (run->features.orientation)
        sheet_add_real(t, f, "orientation", "1", "quaternion w, x, y, z", 4, h->q, n);
    sheet_add_real(t, f, "force", "N", "sum of contact forces", 3,
        sheet_keep(t, read_vectors(s, &run->particles->force, n)), n);
    if (run->features.spin)
        sheet_add_real(t, f, "torque", "N m", "sum of contact torques", 3,
            sheet_keep(t, read_vectors(s, &run->particles->torque, n)), n);
    const struct particles *p = run->particles;
    f = run->features.position_is_float;
    sheet_add_real(t, f, "reference", "m",
        "centre when the lists were built, and room to move from there", 4,
        sheet_keep(t, particles_read(s->dev, &p->reference, f, 0, 4 * n)), n);
    sheet_add_real(t, f, "reach", "m", "how far neighbours were listed", 1,
        sheet_keep(t, particles_read(s->dev, &p->reach, f, 0, n)), n);
}

/* Totals of the run: small tables, all of their rows on rank 0. Returns how many. */
static int total_tables(struct sim *s, struct sheet *t, struct table *table)
{
    struct particle_run *run = s->particle;
    bool first = s->comm->rank == 0;
    int64_t *left = sheet_keep(t, fail_alloc((size_t)s->scene->n_measure * sizeof *left));
    int64_t(*total)[SUMS_WIDTH] = sheet_keep(t, fail_alloc(ENERGY_TOTALS * sizeof *total));
    for (int i = 0; i < s->scene->n_measure; i++) left[i] = run->left[i];
    comm_sum_i64(s->comm, left, s->scene->n_measure);
    energy_totals(s, total);
    sheet_add(t, "left", "1", "elements that have left where a count holds, by measure", COLUMN_I64,
        1, left);
    sheet_add(t, "sum", "J", "losses and what left, as kernels/common/sums.h has sums", COLUMN_I64,
        SUMS_WIDTH, total);
    sheet_add(
        t, "start", "J", "terms of the account at the start", COLUMN_F64, 1, &run->energy_start);
    const int64_t n_row[] = {
        s->scene->n_measure, ENERGY_TOTALS, sizeof run->energy_start / sizeof(double)};
    static const char *const name[] = {"measures", "energy", "energy_start"};
    for (int k = 0; k < 3; k++)
        table[k] = (struct table){name[k], first ? n_row[k] : 0, &t->column[k], 1};
    return 3;
}

/* Flags that some drift has set and that nobody has acted on yet. Collective. */
static void flags_now(struct sim *s, int32_t flag[2])
{
    buffer_read(s->dev, &s->particle->particles->flags, 0, 2 * sizeof *flag, flag);
    comm_or_i32(s->comm, flag, 2);
}

void particle_frame(struct sim *s, int64_t index)
{
    struct particle_run *run = s->particle;
    enum { SHEETS = 5, OWN_SCALARS = 4 };
    struct particles_host *h =
        particles_download(s->dev, run->particles, &run->features, s->scene, run->first);
    struct sheet *sheet = fail_alloc(SHEETS * sizeof *sheet);
    int32_t flag[2];
    flags_now(s, flag);
    point_columns(s, &sheet[0], h);
    state_columns(s, &sheet[1], h);
    int64_t n_pair = particle_contacts_sheet(s, &sheet[2], false),
            n_wall = particle_contacts_sheet(s, &sheet[3], true);
    struct table state[6] = {{"elements", h->n, sheet[1].column, sheet[1].n},
        {"pairs", n_pair, sheet[2].column, sheet[2].n},
        {"wall_contacts", n_wall, sheet[3].column, sheet[3].n}};
    int n_state = 3 + total_tables(s, &sheet[4], state + 3);
    struct frame_scalar scalar[OWN_SCALARS + RESUME_SCALARS] = {{"skin", COLUMN_F64, run->skin, 0},
        {"built_at", COLUMN_I64, 0, run->built_at}, {"stale", COLUMN_I64, 0, flag[0]},
        {"lost", COLUMN_I64, 0, flag[1]}};
    resume_note(s, scalar + OWN_SCALARS);
    struct frame frame = {.step = s->step,
        .time = (double)s->step * s->dt,
        .index = index,
        .points = {"points", h->n, sheet[0].column, sheet[0].n},
        .state = state,
        .n_state = n_state,
        .resolved = s->scene->resolved,
        .scalar = scalar,
        .n_scalar = OWN_SCALARS + RESUME_SCALARS};
    snapshot_write(s->comm, s->options->dir, &frame);
    for (int i = 0; i < SHEETS; i++) sheet_free(&sheet[i]);
    free(sheet);
    particles_host_free(h);
}
