/* Particles from a frame.
 *
 * The lists are built as the run that wrote the frame has built them: around the places that
 * elements had then, with the reach that they had then. So they hold the same contacts, are used up
 * at the same step, and what depends on when they are built (who leaves, periodic places) stays the
 * same. Then everything goes to where it is now. */
#include <stdlib.h>
#include <string.h>

#include "energy.h"
#include "comm/fail.h"
#include "particle_contacts.h"
#include "particle_fields.h"
#include "run/resume.h"

/* This rank's share of the elements, in the frame's order. */
static struct frame_table read_elements(struct sim *s)
{
    struct frame_table t = frame_table_begin(s->comm, s->from->reader, "elements", "id");
    particle_fields_read(s, &t);
    frame_table_check_range(&t, s->comm, "id", 0, s->n_first - 1);
    frame_table_check_unique(&t, s->comm, "id", s->n_first);
    frame_table_check_finite(&t, s->comm);
    return t;
}

/* Cuts through the places of the last list build. */
static void spread(struct sim *s, const struct frame_table *t)
{
    const double *reference = frame_table_get(t, "reference");
    double *x = fail_alloc(3 * (size_t)t->n * sizeof *x);
    for (int64_t i = 0; i < t->n; i++) memcpy(x + 3 * i, reference + 4 * i, 3 * sizeof *x);
    particle_spread(s, x, t->n);
    free(x);
}

/* Elements to where their places of the last list build are in the tree. */
static void send(struct sim *s, struct frame_table *t)
{
    const double *reference = frame_table_get(t, "reference");
    int32_t *to = fail_alloc((size_t)t->n * sizeof *to);
    for (int64_t i = 0; i < t->n; i++) to[i] = rcb_owner(s->particle->rcb, reference + 4 * i);
    frame_table_send(t, s->comm, to, 1);
    free(to);
}

/* Elements at their places of the last build, lists around them, then all as it is at the frame's
 * step. */
static void place(struct sim *s, const struct frame_table *t)
{
    struct particle_run *run = s->particle;
    struct particles *p = run->particles;
    struct particles_host *h = particle_fields_host(s, t);
    size_t n = (size_t)t->n;
    double *now = h->x;
    const double *reference = frame_table_get(t, "reference");
    h->x = fail_alloc(3 * n * sizeof *h->x);
    for (size_t i = 0; i < n; i++) memcpy(h->x + 3 * i, reference + 4 * i, 3 * sizeof *h->x);
    particles_replace(p, &run->features, h);
    buffer_reserve(&p->reference, 4 * particles_preal(&run->features) * n);
    particle_fields_restore(s, t, true);
    int64_t built_at = resume_integer(s, "built_at", s->from->step);
    s->step = s->from->step;
    if (run->wall_contacts) wall_contacts_set_step(run->wall_contacts, built_at);
    particle_lists(s, built_at);
    if (run->wall_contacts) wall_contacts_set_step(run->wall_contacts, s->step);
    free(h->x);
    h->x = now;
    particles_write_state(p, &run->features, h);
    particle_fields_restore(s, t, false);
    particles_host_free(h);
}

static bool is_same_count(const struct measure *a, const struct measure *b)
{
    return !strcmp(a->name, b->name) && a->kind == b->kind &&
           !memcmp(a->below, b->below, sizeof a->below) &&
           !memcmp(a->above, b->above, sizeof a->above);
}

/* Elements that left, by measures of the frame's scene that this scene has too. */
static void restore_left(struct sim *s)
{
    const struct scene *before = s->from->before;
    int n = before->n_measure;
    int64_t *left = fail_alloc((size_t)n * sizeof *left);
    h5_read_rows(s->from->reader, "measures", "left", COLUMN_I64, 1, 0, n, left);
    for (int i = 0; i < s->scene->n_measure && s->comm->rank == 0; i++)
        for (int k = 0; k < n; k++)
            if (is_same_count(&s->scene->measure[i], &before->measure[k]))
                s->particle->n_removed_in[i] = left[k];
    free(left);
}

static void restore_energy(struct sim *s)
{
    struct particle_run *run = s->particle;
    int64_t total[ENERGY_TOTALS][SUMS_WIDTH];
    h5_read_rows(s->from->reader, "energy", "sum", COLUMN_I64, SUMS_WIDTH, 0, ENERGY_TOTALS, total);
    energy_restore(s, total);
    h5_read_rows(s->from->reader, "energy_start", "start", COLUMN_F64, 1, 0,
        sizeof run->energy_start / sizeof(double), &run->energy_start);
}

/* What drifts have said since the last look, and the look itself where it was under way. */
static void restore_flags(struct sim *s)
{
    struct particle_run *run = s->particle;
    cl_int flag[FLAG_N] = {[FLAG_STALE] = (cl_int)resume_integer(s, "stale", INT32_MAX),
        [FLAG_LOST] = (cl_int)resume_integer(s, "lost", INT32_MAX)};
    buffer_write(&run->particles->flags, 0, sizeof flag, flag);
    if (!watch_due(s->step)) return;
    watch_read(&s->watch, &run->particles->flags);
    watch_vote(&s->watch, s->comm, 0);
}

void particle_resume(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct frame_table elements = read_elements(s);
    run->skin = resume_real(s, "skin");
    run->particles->n_global = elements.n;
    comm_sum_i64(s->comm, &run->particles->n_global, 1);
    spread(s, &elements);
    send(s, &elements);
    place(s, &elements);
    if (s->comm->n_rank > 1) { /* now that interactions are known */
        particle_cut(s);
        send(s, &elements);
        place(s, &elements);
    }
    int32_t *owner =
        frame_table_owners(s->comm, frame_table_get(&elements, "id"), elements.n, s->n_first);
    particle_contacts_restore(s, owner, false);
    if (run->wall_contacts) particle_contacts_restore(s, owner, true);
    free(owner);
    frame_table_free(&elements);
    particle_bind(s);
    run->limit = limit_create(s);
    run->overlap = overlap_create(s);
    restore_left(s);
    restore_energy(s);
    balance_restart(s->balance);
    s->balance->dealt_at = s->step;
    balance_go_on(s->balance, &s->timers, s->step);
    resume_recall(s);
    restore_flags(s);
}
