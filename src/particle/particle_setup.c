/* The particle method's set-up: kernels for this scene's features, elements on their ranks, first
 * lists, forces at step 0. */
#include "particle.h"

#include <math.h>
#include <stdlib.h>

#include "kernels/common/batch.h"
#include "contact_table.h"
#include "energy.h"
#include "comm/fail.h"
#include "limit.h"
#include "run/output.h"

/* Room to move between list builds, to begin with: share of the smallest radius, and steps of own
 * motion. */
#define SKIN_START 0.01
enum { HORIZON_STEPS = 60 };

static const char *const source_lists[] = {
    "scan.cl", "cells.cl", "rows.cl", "pairs.cl", "records.cl", "select.cl", NULL};
static const char *const source_pair[] = {"pair_force.cl", "layout.cl", NULL};
static const char *const source_wall[] = {
    "wall_lists.cl", "wall_keep.cl", "wall_force.cl", "layout.cl", NULL};
static const char *const source_body[] = {"gather.cl", NULL};
static const char *const source_assign[] = {"assign.cl", NULL};

static struct program *build(
    struct sim *s, const char *name, enum features_program kind, const char *const *sources)
{
    char *options = features_options(&s->particle->features, kind);
    struct program *program = program_build(s->dev, s->comm, name, options, sources);
    free(options);
    return program;
}

/* Number arguments of a force kernel for steps of dt [s], or the table of all pairs of
 * materials. */
static void set_parameters(struct sim *s, struct launch *launch, struct buffer *buffer, bool wall,
    bool by_table, double dt)
{
    struct particle_run *run = s->particle;
    int n = s->scene->n_material, n_row = by_table ? n * n : 1;
    int first_b =
        wall ? (s->scene->n_wall ? s->scene->wall[0].material : 0) : run->first->material[0];
    int width = run->features.sizes ? MATERIAL_WIDTH : PARAMETER_WIDTH;
    double *row = fail_alloc((size_t)n_row * (size_t)width * sizeof *row);
    double r = run->first->radius[0], m = scene_mass(s->scene, run->first->material[0], r);
    for (int k = 0; k < n_row; k++) {
        int a = by_table ? k / n : run->first->material[0], b = by_table ? k % n : first_b;
        if (run->features.sizes) contact_table_material(s->scene, a, b, row + k * width);
        else contact_table_parameters(s->scene, a, b, wall, r, m, dt, row + k * width);
    }
    if (launch_has(launch, "table")) {
        reals_put(buffer, run->features.real_is_float, (size_t)n_row * (size_t)width, row);
        launch_bind_buffer(launch, "table", buffer);
    } else {
        contact_table_set(launch, row);
    }
    launch_set_int_if(launch, "n_material", n);
    launch_set_real_if(launch, "radius", r);
    launch_set_real(launch, "dt", dt);
    free(row);
}

/* Steps of dt [s] for the laws. */
static void set_step(struct sim *s, double dt)
{
    struct particle_run *run = s->particle;
    set_parameters(s, run->pair_force, &run->table_pair, false, run->features.materials, dt);
    if (run->wall_force)
        set_parameters(s, run->wall_force, &run->table_wall, true, run->features.wall_table, dt);
}

static void set_motion(struct sim *s, struct launch *launch)
{
    struct particle_run *run = s->particle;
    double r = run->first->radius[0], m = scene_mass(s->scene, run->first->material[0], r);
    launch_set_real_if(launch, "radius", r);
    launch_set_real_if(launch, "inverse_m", 1 / m);
    launch_set_vector(launch, "gravity", s->scene->gravity);
    launch_set_real(launch, "dt", s->dt);
    launch_set_real(launch, "half_dt", 0.5 * s->dt);
    launch_set_real(launch, "margin_dt", WATCH_MARGIN * s->dt);
}

static void create_kernels(struct sim *s)
{
    struct particle_run *run = s->particle;
    run->program_lists = build(s, "lists", FEATURES_LISTS, source_lists);
    run->program_pair = build(s, "pairs", FEATURES_PAIR, source_pair);
    run->program_body = build(s, "motion", FEATURES_BODY, source_body);
    run->program_wall = run->features.walls ? build(s, "walls", FEATURES_WALL, source_wall) : NULL;
    if (s->scene->partition.boundary == CUT_PAIRS_ASSIGNED && s->comm->n_rank > 1)
        run->program_assign = build(s, "assign", FEATURES_LISTS, source_assign);
    run->select_room = launch_create(run->program_lists, "select_room");
    run->pair_force = launch_create(run->program_pair, "pair_force");
    run->wall_force = run->program_wall ? launch_create(run->program_wall, "wall_force") : NULL;
    launch_set_batch(run->pair_force, BATCH);
    if (run->wall_force) launch_set_batch(run->wall_force, BATCH);
    run->gather = launch_create(run->program_body, "gather");
    run->kick_drift = launch_create(run->program_body, "kick_drift");
    buffer_init(&run->table_pair, s->dev, "pair table");
    buffer_init(&run->table_wall, s->dev, "wall table");
    set_step(s, s->dt);
    launch_set_vector_if(run->pair_force, "period", run->period);
    set_motion(s, run->gather);
    set_motion(s, run->kick_drift);
}

/* Every rank has all elements and takes its own. */
static void distribute(struct sim *s)
{
    struct particle_run *run = s->particle;
    const struct elements_host *e = run->first;
    int64_t share = (e->n + s->comm->n_rank - 1) / s->comm->n_rank, begin = share * s->comm->rank;
    int64_t n = e->n - begin < share ? e->n - begin : share;
    if (n < 0) n = 0;
    particle_spread(s, n > 0 ? e->x + 3 * begin : e->x, n);
    unsigned char *take = fail_alloc((size_t)e->n);
    for (int64_t i = 0; i < e->n; i++) take[i] = rcb_owner(run->rcb, e->x + 3 * i) == s->comm->rank;
    particles_take(run->particles, &run->features, e, s->scene, take);
    free(take);
}

/* Forces of step 0: velocities are of the same time as positions, nothing has moved yet. A time
 * step of almost nothing says so to the laws. */
static void first_forces(struct sim *s)
{
    struct particle_run *run = s->particle;
    set_step(s, 1e-9 * s->dt);
    launch_set_real(run->gather, "half_dt", 0);
    particle_advance(s, true);
    set_step(s, s->dt);
    launch_set_real(run->gather, "half_dt", 0.5 * s->dt);
}

/* Elements as generated, forces at step 0. */
static void start(struct sim *s)
{
    struct particle_run *run = s->particle;
    run->skin = SKIN_START * generate_smallest_radius(run->first);
    distribute(s);
    if (run->wall_contacts) wall_contacts_set_step(run->wall_contacts, 0);
    particle_build(s);
    particle_bind(s);
    run->limit = limit_create(s);
    run->overlap = overlap_create(s);
    if (s->comm->n_rank > 1) particle_cut(s); /* now that interactions are known */
    /* its kernels are compiled before the clock runs, and what starts outside leaves at once */
    particle_regroup(s);
    s->n_rebuild = 0;
    balance_restart(s->balance);
    first_forces(s);
    energy_now(s, &run->energy_start);
}

void particle_setup(struct sim *s)
{
    struct particle_run *run = s->particle;
    s->n_first = run->first->n;
    run->n_removed_in = fail_alloc((size_t)s->scene->n_measure * sizeof *run->n_removed_in);
    log_element(s->log, "particle");
    log_print(s->log, "%lld particle%s, %d wall%s", (long long)s->n_first,
        s->n_first == 1 ? "" : "s", s->scene->n_wall, s->scene->n_wall == 1 ? "" : "s");
    if (run->features.energy) sim_require_double(s);
    create_kernels(s);
    run->particles = particles_create(s->dev, &run->features, run->program_lists);
    run->scan = scan_create(s->dev, run->program_lists);
    run->cells = cells_create(s->dev, &run->features, run->program_lists, run->period, run->domain);
    run->pairs = pairs_create(s->dev, &run->features, run->program_lists, run->program_pair);
    run->owners = owners_create(
        s->dev, s->comm, &run->features, run->program_lists, run->period, run->domain);
    run->ghosts = ghosts_create(s->dev, s->comm, &run->features, run->program_lists, run->period);
    if (run->program_assign)
        run->assigned = assigned_create(s->dev, s->comm, run->program_assign, run->program_lists,
            particles_real(&run->features));
    if (run->features.walls)
        run->wall_contacts = wall_contacts_create(&(struct wall_setup){.comm = s->comm,
            .features = &run->features,
            .scene = s->scene,
            .walls = run->walls,
            .dt = s->dt,
            .program = run->program_wall});
    run->energy = energy_create(s);
    run->horizon = HORIZON_STEPS * s->dt;
    if (s->from) particle_resume(s);
    else start(s);
    if (s->options->profile)
        balance_record(s->balance, s->options->dir, s->from ? (double)s->step * s->dt : -1);
}

void particle_free(struct sim *s)
{
    struct particle_run *run = s->particle;
    if (!run) return;
    struct launch *launch[] = {
        run->select_room, run->pair_force, run->wall_force, run->gather, run->kick_drift};
    struct program *program[] = {run->program_lists, run->program_pair, run->program_wall,
        run->program_body, run->program_assign};
    if (run->ghosts) exchange_settle(&run->ghosts->exchange);
    overlap_free(run->overlap);
    limit_free(run->limit);
    energy_free(run->energy);
    assigned_free(run->assigned);
    ghosts_free(run->ghosts);
    owners_free(run->owners);
    wall_contacts_free(run->wall_contacts);
    pairs_free(run->pairs);
    cells_free(run->cells);
    scan_free(run->scan);
    particles_free(run->particles);
    rcb_free(run->rcb);
    walls_free(run->walls);
    generate_free(run->first);
    free(run->n_removed_in);
    buffer_free(&run->table_pair);
    buffer_free(&run->table_wall);
    for (int i = 0; i < 5; i++) launch_free(launch[i]);
    for (int i = 0; i < 5; i++) program_free(program[i]);
    free(run);
}
