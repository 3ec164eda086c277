#include "wall_contacts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "device/buffers.h"
#include "kernels/particle/particle_words.h"

static const struct buffer_spec list_buffers[] = {{"wall begin", offsetof(struct wall_list, begin)},
    {"wall candidates", offsetof(struct wall_list, candidate)},
    {"wall candidate elements", offsetof(struct wall_list, element)},
    {"wall state", offsetof(struct wall_list, state)},
    {"wall history", offsetof(struct wall_list, history)}, {0}};
static const struct buffer_spec own_buffers[] = {
    {"wall primitives", offsetof(struct wall_contacts, primitive)},
    {"wall bounds", offsetof(struct wall_contacts, bounds)},
    {"wall blocks", offsetof(struct wall_contacts, block_begin)},
    {"wall block bounds", offsetof(struct wall_contacts, block_bounds)},
    {"wall features", offsetof(struct wall_contacts, triangle_features)},
    {"wall of primitive", offsetof(struct wall_contacts, wall_of)},
    {"wall material", offsetof(struct wall_contacts, material)},
    {"wall room", offsetof(struct wall_contacts, room)},
    {"wall poses", offsetof(struct wall_contacts, pose)},
    {"wall keep", offsetof(struct wall_contacts, keep)},
    {"wall partners", offsetof(struct wall_contacts, partner)},
    {"wall planes", offsetof(struct wall_contacts, near)},
    {"wall results", offsetof(struct wall_contacts, result)},
    {"wall ledger", offsetof(struct wall_contacts, ledger)},
    {"wall pose batch", offsetof(struct wall_contacts, batch)}, {0}};

/* Blocks of up to WALL_BLOCK primitives of one wall that follow each other, and the boxes around
 * them: an element that is far from a box looks at none of its primitives. */
static void upload_blocks(struct wall_contacts *w, const double *bounds)
{
    const struct walls *walls = w->walls;
    size_t n = (size_t)walls->n_primitive;
    double *box = fail_alloc(6 * n * sizeof *box);
    cl_int *begin = fail_alloc((n + 1) * sizeof *begin);
    int n_block = 0;
    for (int k = 0; k < walls->n_primitive; k++) {
        bool goes_on = n_block > 0 && k - begin[n_block - 1] < WALL_BLOCK &&
                       walls->wall_of[k] == walls->wall_of[k - 1];
        if (!goes_on) {
            memcpy(box + 6 * n_block, bounds + 6 * k, 6 * sizeof *box);
            begin[n_block++] = k;
        }
        double *block = box + 6 * (n_block - 1);
        for (int a = 0; a < 3; a++) {
            block[a] = fmin(block[a], bounds[6 * k + a]);
            block[3 + a] = fmax(block[3 + a], bounds[6 * k + 3 + a]);
        }
    }
    begin[n_block] = walls->n_primitive;
    w->n_block = n_block;
    reals_put(&w->block_bounds, w->features->position_is_float, 6 * (size_t)n_block, box);
    buffer_put(&w->block_begin, ((size_t)n_block + 1) * sizeof *begin, begin);
    free(box);
    free(begin);
}

static void upload_walls(struct wall_contacts *w, const struct scene *scene)
{
    const struct walls *walls = w->walls;
    bool is_float = w->features->position_is_float;
    size_t n = (size_t)walls->n_primitive, preal = particles_preal(w->features),
           n_wall = (size_t)walls->n_wall;
    double *bounds = fail_alloc(6 * n * sizeof *bounds);
    cl_int *material = fail_alloc(n_wall * sizeof *material);
    for (size_t i = 0; i < n; i++)
        for (size_t a = 0; a < 3; a++) {
            bounds[6 * i + a] = fmax(walls->low[3 * i + a], -1e30);
            bounds[6 * i + 3 + a] = fmin(walls->high[3 * i + a], 1e30);
        }
    for (size_t i = 0; i < n_wall; i++) material[i] = scene->wall[i].material;
    buffer_reserve(&w->room, n_wall * preal);
    buffer_reserve(&w->pose, n_wall * POSE_WIDTH * preal);
    buffer_reserve(&w->batch, WALL_BATCH * n_wall * POSE_WIDTH * preal);
    reals_put(&w->primitive, is_float, 12 * n, walls->primitive);
    reals_put(&w->bounds, is_float, 6 * n, bounds);
    upload_blocks(w, bounds);
    buffer_put(&w->triangle_features, 6 * n * sizeof(cl_int), walls->features);
    buffer_put(&w->wall_of, n * sizeof(cl_int), walls->wall_of);
    buffer_put(&w->material, n_wall * sizeof(cl_int), material);
    free(bounds);
    free(material);
}

struct wall_contacts *wall_contacts_create(const struct wall_setup *setup)
{
    struct wall_contacts *w = fail_alloc(sizeof *w);
    struct device *dev = setup->program->dev;
    size_t n_wall = (size_t)setup->walls->n_wall;
    w->features = setup->features;
    w->walls = setup->walls;
    w->comm = setup->comm;
    w->dt = setup->dt;
    w->layout = contact_layout(dev, setup->program);
    buffers_create(dev, w, own_buffers);
    buffers_create(dev, &w->now, list_buffers);
    buffers_create(dev, &w->old, list_buffers);
    contact_arrivals_init(dev, &w->arrivals, "arrived wall contacts");
    upload_walls(w, setup->scene);
    w->poses = fail_alloc(WALL_BATCH * n_wall * sizeof *w->poses);
    w->built = fail_alloc(n_wall * sizeof *w->built);
    w->room_host = fail_alloc(n_wall * sizeof *w->room_host);
    w->batch_first = INT64_MIN / 2;
    w->rows = launch_create(setup->program, "wall_rows");
    w->carry = launch_create(setup->program, "wall_carry");
    w->leave = launch_create(setup->program, "wall_leave");
    w->copy = launch_create(setup->program, "pose_copy");
    w->keep_launch = w->features->joined ? launch_create(setup->program, "wall_keep") : NULL;
    launch_bind_buffer(w->copy, "batch", &w->batch);
    launch_bind_buffer(w->copy, "pose", &w->pose);
    launch_set_int(w->copy, "n", w->walls->n_wall * POSE_WIDTH);
    return w;
}

void wall_contacts_free(struct wall_contacts *w)
{
    if (!w) return;
    buffers_free(w, own_buffers);
    buffers_free(&w->now, list_buffers);
    buffers_free(&w->old, list_buffers);
    contact_arrivals_free(&w->arrivals);
    struct launch *launch[] = {w->rows, w->carry, w->leave, w->copy, w->keep_launch};
    for (int i = 0; i < 5; i++) launch_free(launch[i]);
    free(w->poses);
    free(w->built);
    free(w->room_host);
    free(w);
}

void wall_contacts_pose_row(const struct wall_pose *pose, double *row)
{
    memcpy(row, pose->rotation, sizeof pose->rotation);
    memcpy(row + 9, pose->translation, sizeof pose->translation);
    memcpy(row + 12, pose->velocity, sizeof pose->velocity);
    memcpy(row + 15, pose->spin, sizeof pose->spin);
    memcpy(row + 18, pose->centre, sizeof pose->centre);
    row[21] = pose->active;
    memcpy(row + 22, pose->velocity_end, sizeof pose->velocity_end);
    memcpy(row + 25, pose->spin_end, sizeof pose->spin_end);
    memcpy(row + 28, pose->centre_end, sizeof pose->centre_end);
}

/* The batch that has the step. Batches begin at the same steps whenever the run itself began. */
static void new_batch(struct wall_contacts *w, int64_t step, bool upload)
{
    int64_t first = step / WALL_BATCH * WALL_BATCH;
    size_t n = WALL_BATCH * (size_t)w->walls->n_wall;
    double *row = fail_alloc(n * POSE_WIDTH * sizeof *row);
    if (w->comm->rank == 0) walls_poses(w->walls, w->dt, first, WALL_BATCH, w->poses);
    comm_bcast(w->comm, w->poses, n * sizeof *w->poses, 0);
    w->batch_first = first;
    if (!upload) {
        free(row);
        return;
    }
    for (size_t i = 0; i < n; i++) wall_contacts_pose_row(&w->poses[i], row + i * POSE_WIDTH);
    reals_write(&w->batch, w->features->position_is_float, 0, n * POSE_WIDTH, row);
    free(row);
}

void wall_contacts_set_step(struct wall_contacts *w, int64_t step)
{
    bool first = w->batch_first < 0, varies = w->features->moving || w->features->timed;
    if (!first && !varies) return;
    if (first || step >= w->batch_first + WALL_BATCH)
        new_batch(w, step, first || w->features->moving);
    if (!first && !w->features->moving) return;
    launch_set_count(w->copy, "first", (step - w->batch_first) * w->walls->n_wall * POSE_WIDTH);
    launch_run(w->copy, (int64_t)w->walls->n_wall * POSE_WIDTH);
}

const struct wall_pose *wall_contacts_pose(const struct wall_contacts *w, int64_t step)
{
    int64_t k = step - w->batch_first;
    return w->poses + (k < 0 ? 0 : k >= WALL_BATCH ? WALL_BATCH - 1 : k) * w->walls->n_wall;
}

/* Walls in motion get room for horizon_steps at their present speed; what is not there yet is
 * listed when it appears; what is gone is left out. */
static void set_room(struct wall_contacts *w, int64_t step, int horizon_steps, const double box[6])
{
    const struct wall_pose *now = wall_contacts_pose(w, step);
    int64_t later = step - w->batch_first + 1;
    const struct wall_pose *next =
        w->poses + (later < WALL_BATCH ? later : WALL_BATCH - 1) * w->walls->n_wall;
    memcpy(w->built, now, (size_t)w->walls->n_wall * sizeof *now);
    for (int k = 0; k < w->walls->n_wall; k++) {
        w->room_host[k] = now[k].active ? 0 : -1;
        if (now[k].active && w->walls->moves[k]) {
            double per_step = later < WALL_BATCH
                                  ? walls_displacement(w->walls, k, &now[k], &next[k], box, box + 3)
                                  : 0;
            double speed = walls_displacement(w->walls, k, &now[k],
                &w->poses[(WALL_BATCH - 1) * (size_t)w->walls->n_wall + (size_t)k], box, box + 3);
            double left = (double)(WALL_BATCH - (step - w->batch_first));
            w->room_host[k] = horizon_steps * fmax(per_step, speed / fmax(left, 1));
        }
    }
    reals_write(
        &w->room, w->features->position_is_float, 0, (size_t)w->walls->n_wall, w->room_host);
}

static void reserve_contacts(struct wall_contacts *w)
{
    struct wall_list *l = &w->now;
    size_t real = particles_real(w->features), capacity = (size_t)l->capacity;
    buffer_reserve(&l->candidate, capacity * sizeof(cl_int));
    buffer_reserve(&l->element, capacity * sizeof(cl_int));
    if (w->features->joined) {
        buffer_reserve(&w->keep, capacity * real);
        buffer_reserve(&w->partner, capacity * sizeof(cl_int));
        buffer_reserve(&w->near, capacity * NEAR_WIDTH * particles_preal(w->features));
    }
    buffer_reserve(&w->result, capacity * WALL_RESULT_WIDTH(true) * real);
    if (w->layout.remembers) {
        buffer_reserve(&l->state, capacity * sizeof(cl_int));
        buffer_reserve(&l->history, capacity * (size_t)w->layout.history * real);
        buffer_zero(&l->state);
        buffer_zero(&l->history);
    }
    if (w->features->energy) {
        buffer_reserve(&w->ledger, capacity * CONTACT_LEDGER_WIDTH * sizeof(cl_double));
        buffer_zero(&w->ledger);
    }
}

void wall_contacts_build(struct wall_contacts *w, struct scan *scan, const struct particles *p,
    int64_t step, int horizon_steps, const double box[6])
{
    struct wall_list older = w->old, *l = &w->now;
    w->old = w->now;
    w->now = older;
    l->n_owned = p->n_owned;
    set_room(w, step, horizon_steps, box);
    buffer_reserve(&l->begin, ((size_t)l->n_owned + 1) * sizeof(cl_int));
    launch_set_count(w->rows, "n_owned", l->n_owned);
    launch_set_int(w->rows, "n_block", w->n_block);
    launch_bind_all(w->rows,
        (const struct launch_binding[]){{"position", &p->field[FIELD_STATE].now},
            {"reach", &p->reach}, {"primitive", &w->primitive}, {"bounds", &w->bounds},
            {"block_begin", &w->block_begin}, {"block_bounds", &w->block_bounds},
            {"wall_of", &w->wall_of}, {"pose", &w->pose}, {"room", &w->room}, {"begin", &l->begin},
            {"candidate", &l->candidate}, {"candidate_element", &l->element}, {0}});
    launch_set_int(w->rows, "fill", 0);
    launch_run(w->rows, l->n_owned);
    l->n = scan_total(scan, &l->begin, l->n_owned);
    l->capacity = (l->n + PAIR_ALIGN - 1) / PAIR_ALIGN * PAIR_ALIGN + 16;
    reserve_contacts(w);
    launch_set_int(w->rows, "fill", 1);
    launch_run(w->rows, l->n_owned);
}

void wall_contacts_carry(struct wall_contacts *w, const struct buffer *old_index)
{
    struct wall_list *l = &w->now, *o = &w->old;
    struct launch *k = w->carry;
    if (!w->layout.remembers) return;
    launch_set_count(k, "n_owned", l->n_owned);
    launch_set_count(k, "n_old", o->n_owned);
    launch_set_int(k, "width", w->layout.history);
    launch_set_count(k, "capacity", l->capacity);
    launch_set_count(k, "old_capacity", o->capacity);
    launch_set_count(k, "arrival_capacity", w->arrivals.n_contact);
    launch_bind_all(
        k, (const struct launch_binding[]){{"begin", &l->begin}, {"candidate", &l->candidate},
               {"old_index", old_index}, {"old_begin", &o->begin}, {"old_candidate", &o->candidate},
               {"arrival_begin", &w->arrivals.begin}, {"arrival_candidate", &w->arrivals.key},
               {"arrival_state", &w->arrivals.state}, {"arrival_history", &w->arrivals.history},
               {"old_state", &o->state}, {"old_history", &o->history}, {"state", &l->state},
               {"history", &l->history}, {0}});
    launch_run(k, l->n_owned);
}

bool wall_contacts_stale(const struct wall_contacts *w, int64_t step, const double box[6])
{
    if (!w->features->moving && !w->features->timed) return false;
    const struct wall_pose *now = wall_contacts_pose(w, step);
    for (int k = 0; k < w->walls->n_wall; k++) {
        if (now[k].active != (w->room_host[k] >= 0)) return true;
        if (now[k].active && w->walls->moves[k] &&
            walls_displacement(w->walls, k, &w->built[k], &now[k], box, box + 3) > w->room_host[k])
            return true;
    }
    return false;
}

void wall_contacts_select(struct wall_contacts *w, const struct particles *p)
{
    struct wall_list *l = &w->now;
    struct launch *k = w->keep_launch;
    launch_set_count(k, "n_owned", l->n_owned);
    launch_bind_all(
        k, (const struct launch_binding[]){{"position", &p->field[FIELD_STATE].now},
               {"begin", &l->begin}, {"candidate", &l->candidate}, {"primitive", &w->primitive},
               {"features", &w->triangle_features}, {"wall_of", &w->wall_of}, {"pose", &w->pose},
               {"keep", &w->keep}, {"partner", &w->partner}, {"near", &w->near}, {0}});
    launch_bind_buffer_if(k, "state", &l->state);
    launch_bind_buffer_if(k, "history", &l->history);
    launch_set_count_if(k, "capacity", l->capacity);
    launch_run(k, l->n_owned);
}
