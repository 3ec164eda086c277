#include "limit.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contact_table.h"
#include "comm/fail.h"
#include "device/buffers.h"
#include "particle.h"

/* Several elements per work-item: most are then seen at a glance not to be the one. */
enum { GROUP = 64, PER_ITEM = 8 };

struct limit {
    struct program *program;
    struct launch *launch;
    struct buffer table, partial, partial_gid;
};

static const struct buffer_spec buffers[] = {
    {"materials of the limit", offsetof(struct limit, table)},
    {"limit", offsetof(struct limit, partial)},
    {"limit, elements", offsetof(struct limit, partial_gid)}, {0}};

static void write_table(struct sim *s, struct limit *limit)
{
    struct particle_run *run = s->particle;
    int n = s->scene->n_material;
    size_t n_value = (size_t)n * (size_t)n * MATERIAL_WIDTH;
    double *row = fail_alloc(n_value * sizeof *row);
    for (int k = 0; k < n * n; k++)
        limit_material(s->scene, k / n, k % n, row + k * MATERIAL_WIDTH);
    reals_put(&limit->table, run->features.real_is_float, n_value, row);
    free(row);
}

/* Build options of the walls' program, with what pairs need besides. */
static char *options_of(const struct features *features)
{
    struct features f = *features;
    f.energy = false;
#define ADD(member, flag, needed) f.wall.member |= f.pair.member;
    CONTACT_FEATURES(ADD)
#undef ADD
    return features_options(&f, FEATURES_WALL);
}

struct limit *limit_create(struct sim *s)
{
    struct particle_run *run = s->particle;
    static const char *const sources[] = {"step_limit.cl", "overlap.cl", NULL};
    struct limit *limit = fail_alloc(sizeof *limit);
    char *options = options_of(&run->features);
    limit->program = program_build(s->dev, s->comm, "limit", options, sources);
    free(options);
    limit->launch = launch_create(limit->program, "step_limit");
    buffers_init(s->dev, limit, buffers);
    buffer_reserve(&limit->partial, LIMIT_GROUPS * particles_real(&run->features));
    buffer_reserve(&limit->partial_gid, LIMIT_GROUPS * sizeof(int64_t));
    write_table(s, limit);
    launch_set_int(limit->launch, "n_material", s->scene->n_material);
    launch_set_int(limit->launch, "kind", run->first->n > 0 ? run->first->material[0] : 0);
    launch_set_vector_if(limit->launch, "period", run->period);
    return limit;
}

const struct program *limit_program(const struct limit *limit)
{
    return limit->program;
}

void limit_free(struct limit *limit)
{
    if (!limit) return;
    buffers_free(limit, buffers);
    launch_free(limit->launch);
    program_free(limit->program);
    free(limit);
}

void limit_bind(struct sim *s, struct launch *launch)
{
    struct particle_run *run = s->particle;
    const struct particles *p = run->particles;
    const struct wall_contacts *w = run->wall_contacts;
    launch_bind_all(
        launch, (const struct launch_binding[]){{"position", &p->field[FIELD_STATE].now},
                    {"motion", &p->field[FIELD_STATE].now}, {"gid", &p->field[FIELD_GID].now},
                    {"row_begin", &run->pairs->now.row_begin}, {"row", &run->pairs->now.row},
                    {"table", &run->limit->table}, {0}});
    if (!w) return;
    launch_bind_all_if(
        launch, (const struct launch_binding[]){{"wall_begin", &w->now.begin},
                    {"candidate", &w->now.candidate}, {"primitive", &w->primitive},
                    {"wall_of", &w->wall_of}, {"wall_material", &w->material}, {"pose", &w->pose},
                    {"keep", &w->keep}, {"partner", &w->partner}, {"near", &w->near}, {0}});
}

int limit_run_groups(struct sim *s, struct launch *launch)
{
    const struct particles *p = s->particle->particles;
    int64_t wanted = (p->n_owned + GROUP * PER_ITEM - 1) / (GROUP * PER_ITEM);
    int n = wanted < LIMIT_GROUPS ? (int)wanted : LIMIT_GROUPS;
    if (n == 0) return 0;
    launch_set_count(launch, "n_owned", p->n_owned);
    launch_set_int(launch, "n_group", n);
    launch_run(launch, n * GROUP);
    return n;
}

/* Of this rank. */
static struct limit_result smallest(struct sim *s, struct limit *limit)
{
    struct particle_run *run = s->particle;
    struct limit_result best = {HUGE_VAL, -1};
    int64_t gid[LIMIT_GROUPS];
    int n_group = limit_run_groups(s, limit->launch);
    double *dt = reals_read(&limit->partial, run->features.real_is_float, 0, (size_t)n_group);
    buffer_read(&limit->partial_gid, 0, (size_t)n_group * sizeof *gid, gid);
    for (int g = 0; g < n_group; g++) {
        if (gid[g] < 0 || dt[g] > best.dt || (!(dt[g] < best.dt) && gid[g] > best.gid)) continue;
        best.dt = dt[g];
        best.gid = gid[g];
    }
    free(dt);
    return best;
}

struct limit_result limit_run(struct sim *s, double dt, double share)
{
    struct particle_run *run = s->particle;
    struct limit *limit = run->limit;
    struct limit_result best = {HUGE_VAL, -1};
    if (run->wall_contacts) {
        wall_contacts_set_step(run->wall_contacts, s->step);
        if (run->features.joined && run->wall_contacts->now.n > 0)
            wall_contacts_select(run->wall_contacts, run->particles);
    }
    if (run->particles->n_owned > 0) {
        limit_bind(s, limit->launch);
        launch_bind_buffer(limit->launch, "partial", &limit->partial);
        launch_bind_buffer(limit->launch, "partial_gid", &limit->partial_gid);
        launch_set_real(limit->launch, "dt", dt);
        launch_set_real(limit->launch, "share", share);
        best = smallest(s, limit);
    }
    double least = best.dt;
    comm_min_f64(s->comm, &least, 1);
    int64_t gid = best.gid >= 0 && !(best.dt > least) ? best.gid : INT64_MAX;
    comm_min_i64(s->comm, &gid, 1);
    best.dt = least;
    best.gid = gid == INT64_MAX ? -1 : gid;
    return best;
}
