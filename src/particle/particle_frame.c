#include "particle_contacts.h"

#include <stdlib.h>

#include "energy.h"
#include "comm/fail.h"
#include "run/output.h"
#include "run/resume.h"
#include "particle_fields.h"
#include "results/snapshot.h"

/* Totals of the run: small tables, all of their rows on rank 0. Returns how many. */
static int total_tables(struct sim *s, struct sheet *t, struct table *table)
{
    struct particle_run *run = s->particle;
    bool first = s->comm->rank == 0;
    int64_t *left = sheet_keep(t, fail_alloc((size_t)s->scene->n_measure * sizeof *left));
    int64_t(*total)[SUMS_WIDTH] = sheet_keep(t, fail_alloc(ENERGY_TOTALS * sizeof *total));
    for (int i = 0; i < s->scene->n_measure; i++) left[i] = run->n_removed_in[i];
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
static void flags_now(struct sim *s, int32_t flag[FLAG_N])
{
    buffer_read(&s->particle->particles->flags, 0, 2 * sizeof *flag, flag);
    comm_or_i32(s->comm, flag, 2);
}

void particle_frame(struct sim *s, int64_t index)
{
    struct particle_run *run = s->particle;
    enum { SHEETS = 5, OWN_SCALARS = 4 };
    struct particles_host *h =
        particles_download(run->particles, &run->features, s->scene, run->first);
    struct sheet *sheet = fail_alloc(SHEETS * sizeof *sheet);
    int32_t flag[FLAG_N];
    flags_now(s, flag);
    particle_fields_show(s, &sheet[0], h);
    particle_fields_state(s, &sheet[1], h);
    int64_t n_pair = particle_contacts_sheet(s, &sheet[2], false),
            n_wall = particle_contacts_sheet(s, &sheet[3], true);
    struct table state[6] = {{"elements", h->n, sheet[1].column, sheet[1].n},
        {"pairs", n_pair, sheet[2].column, sheet[2].n},
        {"wall_contacts", n_wall, sheet[3].column, sheet[3].n}};
    int n_state = 3 + total_tables(s, &sheet[4], state + 3);
    struct frame_scalar scalar[OWN_SCALARS + RESUME_SCALARS] = {{"skin", COLUMN_F64, run->skin, 0},
        {"built_at", COLUMN_I64, 0, run->built_at}, {"stale", COLUMN_I64, 0, flag[FLAG_STALE]},
        {"lost", COLUMN_I64, 0, flag[FLAG_LOST]}};
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
    output_frame(s, &frame);
    for (int i = 0; i < SHEETS; i++) sheet_free(&sheet[i]);
    free(sheet);
    particles_host_free(h);
}
