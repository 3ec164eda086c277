/* The particle method's set-up: kernels for this scene's features, elements on their ranks, first lists, forces at step 0. */
#include "particle.h"

#include <math.h>
#include <stdlib.h>

#include "../kernels/batch.h"
#include "contact_table.h"
#include "energy.h"
#include "fail.h"
#include "limit.h"
#include "output.h"

/* Room to move between list builds, to begin with: share of the smallest radius, and steps of own motion. */
#define SKIN_START 0.01
enum { HORIZON_STEPS = 60 };

static const char *const source_lists[] = {"scan.cl", "cells.cl", "rows.cl", "pairs.cl", "records.cl", "select.cl", "wall_lists.cl", NULL};
static const char *const source_pair[] = {"pair_force.cl", "layout.cl", NULL};
static const char *const source_wall[] = {"wall_keep.cl", "wall_force.cl", "layout.cl", NULL};
static const char *const source_body[] = {"gather.cl", NULL};
static const char *const source_assign[] = {"assign.cl", NULL};

static struct program *build(struct sim *s, const char *name, enum features_program kind, const char *const *sources)
{
    char *options = features_options(&s->features, kind);
    struct program *program = program_build(s->dev, s->comm, name, options, sources);
    free(options);
    return program;
}

/* Number arguments of a force kernel, or the table of all pairs of materials. */
static void set_parameters(struct sim *s, struct launch *launch, struct buffer *buffer, bool wall, bool by_table)
{
    int n = s->scene->n_material, n_row = by_table ? n * n : 1;
    int first_b = wall ? (s->scene->n_wall ? s->scene->wall[0].material : 0) : s->first->material[0];
    int width = s->features.sizes ? CONTACT_TABLE_MATERIAL : CONTACT_TABLE_PARAMETER;
    double *row = fail_alloc((size_t)n_row * (size_t)width * sizeof *row);
    double r = s->first->radius[0], m = 4.0 / 3.0 * M_PI * r * r * r * s->scene->material[s->first->material[0]].density;
    for (int k = 0; k < n_row; k++) {
        int a = by_table ? k / n : s->first->material[0], b = by_table ? k % n : first_b;
        if (s->features.sizes) contact_table_material(s->scene, a, b, row + k * width);
        else contact_table_parameters(s->scene, a, b, wall, r, m, s->dt, row + k * width);
    }
    if (launch_has(launch, "table")) {
        buffer_reserve(s->dev, buffer, (size_t)n_row * (size_t)width * particles_real(&s->features));
        particles_write(s->dev, buffer, s->features.real_is_float, 0, (size_t)n_row * (size_t)width, row);
        launch_bind_buffer(launch, "table", buffer);
    } else {
        contact_table_set(launch, row);
    }
    launch_set_int_if(launch, "n_material", n);
    launch_set_real_if(launch, "radius", r);
    free(row);
}

static void set_motion(struct sim *s, struct launch *launch)
{
    double r = s->first->radius[0], m = 4.0 / 3.0 * M_PI * r * r * r * s->scene->material[s->first->material[0]].density;
    launch_set_real_if(launch, "radius", r);
    launch_set_real_if(launch, "inverse_m", 1 / m);
    launch_set_real(launch, "gravity_x", s->scene->gravity[0]);
    launch_set_real(launch, "gravity_y", s->scene->gravity[1]);
    launch_set_real(launch, "gravity_z", s->scene->gravity[2]);
    launch_set_real(launch, "dt", s->dt);
    launch_set_real(launch, "half_dt", 0.5 * s->dt);
    launch_set_real(launch, "margin_dt", WATCH_MARGIN * s->dt);
}

static void create_kernels(struct sim *s)
{
    s->program_lists = build(s, "lists", FEATURES_BODY, source_lists);
    s->program_pair = build(s, "pairs", FEATURES_PAIR, source_pair);
    s->program_body = build(s, "motion", FEATURES_BODY, source_body);
    s->program_wall = s->features.walls ? build(s, "walls", FEATURES_WALL, source_wall) : NULL;
    if (s->scene->partition.boundary == CUT_PAIRS_ASSIGNED && s->comm->n_rank > 1)
        s->program_assign = build(s, "assign", FEATURES_BODY, source_assign);
    s->select_room = launch_create(s->program_lists, "select_room");
    s->pair_force = launch_create(s->program_pair, "pair_force");
    s->wall_force = s->program_wall ? launch_create(s->program_wall, "wall_force") : NULL;
    launch_set_batch(s->pair_force, BATCH);
    if (s->wall_force) launch_set_batch(s->wall_force, BATCH);
    s->gather = launch_create(s->program_body, "gather");
    s->kick_drift = launch_create(s->program_body, "kick_drift");
    buffer_init(&s->table_pair, "pair table");
    buffer_init(&s->table_wall, "wall table");
    set_parameters(s, s->pair_force, &s->table_pair, false, s->features.materials);
    if (s->wall_force) set_parameters(s, s->wall_force, &s->table_wall, true, s->features.wall_table);
    static const char *const axis[] = {"period_x", "period_y", "period_z"};
    for (int a = 0; a < 3; a++) launch_set_real_if(s->pair_force, axis[a], s->period[a]);
    launch_set_real(s->pair_force, "dt", s->dt);
    if (s->wall_force) launch_set_real(s->wall_force, "dt", s->dt);
    set_motion(s, s->gather);
    set_motion(s, s->kick_drift);
}

static void bind_all(struct launch *launch, const char *const *name, const struct buffer *const *buffer)
{
    for (int i = 0; name[i]; i++) launch_bind_buffer_if(launch, name[i], buffer[i]);
}

void particle_bind(struct sim *s)
{
    struct particles *p = s->particles;
    struct pair_list *l = &s->pairs->now;
    static const char *const pair_name[] = {"position", "motion", "pair_i", "pair_j", "state", "history", "ledger", "result", NULL};
    const struct buffer *state = &p->field[FIELD_STATE].now;
    bind_all(s->pair_force, pair_name,
        (const struct buffer *const[]){state, state, &l->pair_i, &l->pair_j, &l->state, &l->history, &s->pairs->ledger, &s->pairs->result});
    launch_set_int(s->pair_force, "capacity", (int)l->capacity);
    static const char *const body_name[] = {"position", "motion", "incidence_begin", "incidence", "result", "wall_begin", "wall_result",
        "orientation", "force", "torque", "reference", "flags", NULL};
    struct wall_contacts *w = s->wall_contacts;
    const struct buffer *body[] = {state, state, &l->incidence_begin, &l->incidence, &s->pairs->result, w ? &w->now.begin : NULL,
        w ? &w->result : NULL, &p->field[FIELD_ORIENTATION].now, &p->force, &p->torque, &p->reference, &p->flags};
    bind_all(s->gather, body_name, body);
    bind_all(s->kick_drift, body_name, body);
    launch_set_int(s->gather, "n_owned", (int)p->n_owned);
    launch_set_int(s->kick_drift, "n_owned", (int)p->n_owned);
    if (!w) return;
    static const char *const wall_name[] = {"position", "motion", "candidate", "candidate_element", "primitive", "wall_of", "pose", "keep", "state",
        "history", "ledger", "wall_material", "result", NULL};
    bind_all(s->wall_force, wall_name,
        (const struct buffer *const[]){state, state, &w->now.candidate, &w->now.element, &w->primitive, &w->wall_of, &w->pose, &w->keep,
            &w->now.state, &w->now.history, &w->ledger, &w->material, &w->result});
    launch_set_int(s->wall_force, "capacity", (int)w->now.capacity);
}

void particle_spread(struct sim *s, const double *x, int64_t n)
{
    int64_t *weight = fail_alloc((size_t)n * sizeof *weight);
    for (int64_t i = 0; i < n; i++) weight[i] = 1;
    s->rcb = rcb_create(s->comm, s->comm->n_rank, NULL, x, weight, n);
    owners_set_tree(s->dev, s->owners, s->rcb);
    free(weight);
}

/* Every rank has all elements and takes its own. */
static void distribute(struct sim *s)
{
    const struct elements_host *e = s->first;
    int64_t share = (e->n + s->comm->n_rank - 1) / s->comm->n_rank, begin = share * s->comm->rank;
    int64_t n = e->n - begin < share ? e->n - begin : share;
    if (n < 0) n = 0;
    particle_spread(s, n > 0 ? e->x + 3 * begin : e->x, n);
    unsigned char *take = fail_alloc((size_t)e->n);
    for (int64_t i = 0; i < e->n; i++) take[i] = rcb_owner(s->rcb, e->x + 3 * i) == s->comm->rank;
    particles_upload(s->dev, s->particles, &s->features, e, s->scene, take);
    free(take);
}

static double smallest_radius(const struct elements_host *e)
{
    double r = INFINITY;
    for (int64_t i = 0; i < e->n; i++) r = fmin(r, e->radius[i]);
    return r;
}

/* Forces of step 0: velocities are of the same time as positions, nothing has moved yet. A time step of almost nothing says so to the laws. */
static void first_forces(struct sim *s)
{
    launch_set_real(s->pair_force, "dt", 1e-9 * s->dt);
    if (s->wall_force) launch_set_real(s->wall_force, "dt", 1e-9 * s->dt);
    launch_set_real(s->gather, "half_dt", 0);
    particle_ops.advance(s, true);
    launch_set_real(s->pair_force, "dt", s->dt);
    if (s->wall_force) launch_set_real(s->wall_force, "dt", s->dt);
    launch_set_real(s->gather, "half_dt", 0.5 * s->dt);
}

/* Elements as generated, forces at step 0. */
static void start(struct sim *s)
{
    s->skin = SKIN_START * smallest_radius(s->first);
    distribute(s);
    if (s->wall_contacts) wall_contacts_set_step(s->dev, s->wall_contacts, 0);
    particle_build(s);
    particle_bind(s);
    s->limit = limit_create(s);
    if (s->comm->n_rank > 1) particle_cut(s); /* now that interactions are known */
    particle_regroup(s);                      /* its kernels are compiled before the clock runs, and what starts outside leaves at once */
    s->n_rebuild = 0;
    balance_restart(s->balance);
    first_forces(s);
    energy_now(s, &s->energy_start);
}

void particle_setup(struct sim *s)
{
    s->n_first = s->first->n;
    s->left = fail_alloc((size_t)s->scene->n_measure * sizeof *s->left);
    log_print(
        s->log, "%lld element%s, %d wall%s", (long long)s->n_first, s->n_first == 1 ? "" : "s", s->scene->n_wall, s->scene->n_wall == 1 ? "" : "s");
    if (s->features.energy) energy_require_double(s);
    create_kernels(s);
    s->particles = particles_create(s->dev, &s->features, s->program_lists);
    s->scan = scan_create(s->dev, s->program_lists);
    s->cells = cells_create(s->dev, &s->features, s->program_lists, s->period, s->domain);
    s->pairs = pairs_create(s->dev, &s->features, s->program_lists, s->program_pair);
    s->owners = owners_create(s->dev, s->comm, &s->features, s->program_lists, s->period, s->domain);
    s->ghosts = ghosts_create(s->dev, s->comm, &s->features, s->program_lists, s->period);
    if (s->program_assign) s->assigned = assigned_create(s->dev, s->comm, s->program_assign, s->program_lists, particles_real(&s->features));
    if (s->features.walls)
        s->wall_contacts = wall_contacts_create(s->dev, s->comm, &s->features, s->scene, s->walls, s->dt, s->program_lists, s->program_wall);
    s->energy = energy_create(s);
    s->horizon = HORIZON_STEPS * s->dt;
    if (s->from) particle_resume(s);
    else start(s);
    if (s->options->profile) balance_record(s->balance, s->options->dir, s->from ? (double)s->step * s->dt : -1);
}

void particle_free(struct sim *s)
{
    struct launch *launch[] = {s->select_room, s->pair_force, s->wall_force, s->gather, s->kick_drift};
    struct program *program[] = {s->program_lists, s->program_pair, s->program_wall, s->program_body, s->program_assign};
    if (s->ghosts) exchange_settle(s->dev, &s->ghosts->exchange);
    limit_free(s->dev, s->limit);
    energy_free(s->dev, s->energy);
    assigned_free(s->dev, s->assigned);
    ghosts_free(s->dev, s->ghosts);
    owners_free(s->dev, s->owners);
    wall_contacts_free(s->dev, s->wall_contacts);
    pairs_free(s->dev, s->pairs);
    cells_free(s->dev, s->cells);
    scan_free(s->dev, s->scan);
    particles_free(s->dev, s->particles);
    rcb_free(s->rcb);
    walls_free(s->walls);
    generate_free(s->first);
    free(s->left);
    buffer_free(s->dev, &s->table_pair);
    buffer_free(s->dev, &s->table_wall);
    for (int i = 0; i < 5; i++) launch_free(launch[i]);
    for (int i = 0; i < 5; i++) program_free(program[i]);
}
