#include "overlap.h"

#include <math.h>
#include <stdlib.h>

#include "comm/fail.h"
#include "device/buffers.h"
#include "kernels/particle/particle_words.h"
#include "particle.h"
#include "results/report.h"

struct overlap {
    struct launch *look, *room_used, *passage; /* passage: NULL without walls */
    double used;                               /* [1] of the room, of this rank */
    struct buffer partial, partial_count, partial_id, pose_built;
    struct {
        double share;  /* [1]; 0: none so far */
        int64_t step;  /* when it was seen */
        int64_t id[2]; /* element, and the other one or -1 - wall */
    } largest;
    struct {
        int64_t n;           /* passages: an element that returns and passes again counts twice */
        int64_t step, id[2]; /* of the first: element, wall */
    } passed;
    bool has_warned_of_largest, has_warned_of_passed;
};

static const struct buffer_spec buffers[] = {{"overlaps", offsetof(struct overlap, partial)},
    {"passages of walls", offsetof(struct overlap, partial_count)},
    {"overlaps, elements", offsetof(struct overlap, partial_id)},
    {"wall poses of the lists", offsetof(struct overlap, pose_built)}, {0}};

struct overlap *overlap_create(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct overlap *o = fail_alloc(sizeof *o);
    const struct program *program = limit_program(run->limit);
    o->passed.step = INT64_MAX;
    o->look = launch_create(program, "overlap");
    o->room_used = launch_create(program, "room_used");
    o->passage = run->wall_contacts ? launch_create(program, "passage") : NULL;
    buffers_create(s->dev, o, buffers);
    buffer_reserve(&o->partial, LIMIT_GROUPS * particles_real(&run->features));
    buffer_reserve(&o->partial_count, LIMIT_GROUPS * sizeof(cl_int));
    buffer_reserve(&o->partial_id, LIMIT_GROUPS * 2 * sizeof(int64_t));
    launch_set_int(o->look, "n_material", s->scene->n_material);
    launch_set_int(o->look, "kind", run->first->n > 0 ? run->first->material[0] : 0);
    launch_set_vector_if(o->look, "period", run->period);
    return o;
}

void overlap_free(struct overlap *overlap)
{
    if (!overlap) return;
    buffers_free(overlap, buffers);
    launch_free(overlap->look);
    launch_free(overlap->room_used);
    launch_free(overlap->passage);
    free(overlap);
}

/* The walls where the lists were built; those that stay are where they are now. */
static const struct buffer *built_poses(struct sim *s, struct overlap *o)
{
    struct particle_run *run = s->particle;
    const struct wall_contacts *w = run->wall_contacts;
    if (!run->features.moving) return &w->pose;
    size_t n = (size_t)w->walls->n_wall;
    double *row = fail_alloc(n * POSE_WIDTH * sizeof *row);
    for (size_t k = 0; k < n; k++) wall_contacts_pose_row(&w->built[k], row + k * POSE_WIDTH);
    reals_put(&o->pose_built, run->features.position_is_float, n * POSE_WIDTH, row);
    free(row);
    return &o->pose_built;
}

static void look_at_walls(struct sim *s, struct overlap *o)
{
    struct particle_run *run = s->particle;
    const struct particles *p = run->particles;
    const struct wall_contacts *w = run->wall_contacts;
    if (!w || w->now.n == 0) return;
    cl_int count[LIMIT_GROUPS];
    int64_t id[LIMIT_GROUPS][2], first[2] = {INT64_MAX, 0}, n = 0;
    launch_bind_all(
        o->passage, (const struct launch_binding[]){{"position", &p->field[FIELD_STATE].now},
                        {"reference", &p->reference}, {"gid", &p->field[FIELD_GID].now},
                        {"wall_begin", &w->now.begin}, {"candidate", &w->now.candidate},
                        {"primitive", &w->primitive}, {"wall_of", &w->wall_of}, {"pose", &w->pose},
                        {"pose_built", built_poses(s, o)}, {"partial_count", &o->partial_count},
                        {"partial_id", &o->partial_id}, {0}});
    int n_group = limit_run_groups(s, o->passage);
    if (n_group == 0) return;
    buffer_read(&o->partial_count, 0, (size_t)n_group * sizeof *count, count);
    buffer_read(&o->partial_id, 0, (size_t)n_group * sizeof *id, id);
    for (int g = 0; g < n_group; g++) {
        n += count[g];
        if (id[g][0] >= first[0]) continue;
        first[0] = id[g][0];
        first[1] = id[g][1];
    }
    o->passed.n += n;
    if (n == 0 || s->step >= o->passed.step) return;
    o->passed.step = s->step;
    o->passed.id[0] = first[0];
    o->passed.id[1] = first[1];
}

static void look_at_room(struct sim *s, struct overlap *o)
{
    struct particle_run *run = s->particle;
    const struct particles *p = run->particles;
    launch_bind_all(
        o->room_used, (const struct launch_binding[]){{"position", &p->field[FIELD_STATE].now},
                          {"reference", &p->reference}, {"partial", &o->partial}, {0}});
    int n_group = limit_run_groups(s, o->room_used);
    if (n_group == 0) return;
    double *used = reals_read(&o->partial, run->features.real_is_float, 0, (size_t)n_group);
    for (int g = 0; g < n_group; g++) o->used = fmax(o->used, used[g]);
    free(used);
}

void overlap_look_behind(struct sim *s)
{
    look_at_walls(s, s->particle->overlap);
    look_at_room(s, s->particle->overlap);
}

void overlap_look(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct overlap *o = run->overlap;
    int64_t id[LIMIT_GROUPS][2];
    limit_bind(s, o->look);
    launch_bind_buffer(o->look, "partial", &o->partial);
    launch_bind_buffer(o->look, "partial_id", &o->partial_id);
    int n_group = limit_run_groups(s, o->look);
    if (n_group == 0) return;
    double *share = reals_read(&o->partial, run->features.real_is_float, 0, (size_t)n_group);
    buffer_read(&o->partial_id, 0, (size_t)n_group * sizeof *id, id);
    for (int g = 0; g < n_group; g++) {
        bool is_first = share[g] >= o->largest.share && s->step == o->largest.step &&
                        id[g][0] < o->largest.id[0];
        if (!(share[g] > o->largest.share) && !is_first) continue;
        o->largest.share = share[g];
        o->largest.step = s->step;
        o->largest.id[0] = id[g][0];
        o->largest.id[1] = id[g][1];
    }
    free(share);
}

/* key[0], of those that still have a part in it: the smallest of all ranks; who has another one
 * has no part any more. */
static void keep_smallest(const struct comm *comm, int64_t key, bool *has_part)
{
    int64_t least = *has_part ? key : INT64_MAX;
    comm_min_i64(comm, &least, 1);
    *has_part = *has_part && key == least;
}

/* From the one rank that has a part: key[n] to all. */
static void spread(const struct comm *comm, bool has_part, int64_t *key, int n)
{
    for (int k = 0; k < n && !has_part; k++) key[k] = INT64_MIN;
    comm_max_i64(comm, key, n);
}

/* The findings of all ranks; passed.n stays that of this rank. */
static void bring_together(struct sim *s, struct overlap *o)
{
    double share = o->largest.share;
    comm_max_f64(s->comm, &share, 1);
    bool has_part = !(o->largest.share < share);
    keep_smallest(s->comm, o->largest.step, &has_part);
    keep_smallest(s->comm, o->largest.id[0], &has_part);
    int64_t found[] = {o->largest.step, o->largest.id[0], o->largest.id[1]};
    spread(s->comm, has_part, found, 3);
    o->largest.share = share;
    o->largest.step = found[0];
    for (int k = 0; k < 2; k++) o->largest.id[k] = found[1 + k];
    has_part = true;
    keep_smallest(s->comm, o->passed.step, &has_part);
    keep_smallest(s->comm, o->passed.id[0], &has_part);
    int64_t first[] = {o->passed.step, o->passed.id[0], o->passed.id[1]};
    spread(s->comm, has_part, first, 3);
    o->passed.step = first[0];
    for (int k = 0; k < 2; k++) o->passed.id[k] = first[1 + k];
}

static void warn_of_largest(struct sim *s, struct overlap *o)
{
    if (o->has_warned_of_largest || !(o->largest.share > OVERLAP_BOUND)) return;
    o->has_warned_of_largest = true;
    int64_t with = o->largest.id[1];
    char *other = with < 0 ? fail_format("wall '%s'", s->scene->wall[-1 - with].name)
                           : fail_format("element %lld", (long long)with);
    log_warn(s->log,
        "t = %.6g s: element %lld and %s overlap by %.3g of the smaller radius; contact laws are "
        "for small overlaps, and above 1 centres pass: stiffer contacts are needed, or lower "
        "speeds",
        (double)o->largest.step * s->dt, (long long)o->largest.id[0], other, o->largest.share);
    free(other);
}

void overlap_warn(struct sim *s)
{
    struct overlap *o = s->particle->overlap;
    bring_together(s, o);
    warn_of_largest(s, o);
    if (o->has_warned_of_passed || o->passed.step == INT64_MAX) return;
    o->has_warned_of_passed = true;
    log_warn(s->log, "t = %.6g s: element %lld has passed wall '%s'",
        (double)o->passed.step * s->dt, (long long)o->passed.id[0],
        s->scene->wall[o->passed.id[1]].name);
}

double overlap_largest(const struct sim *s)
{
    return s->particle->overlap->largest.share;
}

double overlap_room_used(const struct sim *s)
{
    double used = s->particle->overlap->used;
    comm_max_f64(s->comm, &used, 1);
    return used;
}

/* Of the first step that is known: element, and the other one or the wall. */
static void report_who(
    struct report *r, const struct sim *s, int64_t step, int64_t element, int64_t other)
{
    report_number(r, "time", (double)step * s->dt);
    report_integer(r, "element", element);
    if (other < 0) report_text(r, "wall", s->scene->wall[-1 - other].name);
    else report_integer(r, "other", other);
}

void overlap_report(struct sim *s, struct report *r, bool observed)
{
    struct overlap *o = s->particle->overlap;
    if (observed) {
        if (s->particle->assigned) ghosts_refresh(s->particle->ghosts, s->particle->particles);
        overlap_look_behind(s);
        overlap_look(s);
        overlap_warn(s);
    }
    int64_t n_passed = o->passed.n;
    comm_sum_i64(s->comm, &n_passed, 1);
    report_begin(r, "overlap");
    report_number(r, "largest", o->largest.share);
    if (o->largest.share > 0) report_who(r, s, o->largest.step, o->largest.id[0], o->largest.id[1]);
    report_end(r);
    report_begin(r, "passed_walls");
    report_integer(r, "count", n_passed);
    if (o->passed.step != INT64_MAX)
        report_who(r, s, o->passed.step, o->passed.id[0], -1 - o->passed.id[1]);
    report_end(r);
}
