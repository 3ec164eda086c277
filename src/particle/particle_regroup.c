/* The rare path of the particle method: new owners -> migration -> ghosts -> lists. */
#include "particle.h"

#include <math.h>
#include <stdlib.h>

#include "energy.h"
#include "comm/fail.h"
#include "run/output.h"

/* Skin of slow elements, as a share of the mean radius; fast ones get `horizon` of their own motion
 * on top. Wider skins mean more listed pairs, narrower ones more builds. The skin follows the
 * interval between builds, by rules of steps alone, so that it is the same on any number of
 * ranks. */
enum { INTERVAL_SHORT = 150, INTERVAL_LONG = 1000 };
#define SKIN_SMALLEST 0.005
#define SKIN_LARGEST 0.2

static void adapt_skin(struct sim *s, double radius)
{
    struct particle_run *run = s->particle;
    int64_t interval = s->step - run->built_at;
    if (interval == 0) return;
    if (interval < INTERVAL_SHORT) run->skin *= 1.25;
    if (interval > INTERVAL_LONG) run->skin *= 0.8;
    run->skin = fmin(fmax(run->skin, SKIN_SMALLEST * radius), SKIN_LARGEST * radius);
}

/* What the move of elements out of the domain and around periodic directions changes. */
static void account(struct sim *s)
{
    struct particle_run *run = s->particle;
    int64_t n = run->owners->n_removed;
    for (int64_t i = 0; i < n; i++) particle_note_removed(s, run->owners->removed[i].x);
    comm_sum_i64(s->comm, &n, 1);
    s->n_removed += n;
    run->particles->n_global -= n;
    if (run->features.energy) energy_moved(s, n);
}

/* Where the scene has given the domain's extent and does not say that elements may leave it, one
 * that does ends the run. */
static void check_inside(struct sim *s, const struct cells_bounds *now)
{
    const struct domain *d = &s->scene->domain;
    int32_t is_outside = 0;
    for (int a = 0; a < 3; a++)
        is_outside |= !d->periodic[a] && s->particle->particles->n_owned > 0 &&
                      (now->low[a] < d->min[a] || now->high[a] > d->max[a]);
    if (!d->has_box || d->remove_outside) return;
    comm_or_i32(s->comm, &is_outside, 1);
    if (!is_outside) return;
    struct particles_host *h = particles_download(
        s->particle->particles, &s->particle->features, s->scene, s->particle->first);
    int64_t gid = INT64_MAX, own = -1;
    for (int64_t i = 0; i < h->n; i++)
        for (int a = 0; a < 3; a++) {
            double x = h->x[3 * i + a];
            if (d->periodic[a] || (x >= d->min[a] && x <= d->max[a]) || h->gid[i] >= gid) continue;
            gid = h->gid[i];
            own = i;
        }
    int64_t first = gid;
    comm_min_i64(s->comm, &first, 1);
    double x[3];
    for (int a = 0; a < 3; a++) x[a] = gid == first ? h->x[3 * own + a] : -HUGE_VAL;
    comm_max_f64(s->comm, x, 3);
    particles_host_free(h);
    output_stop_numerics(s,
        "element %lld has left the domain, at (%.6g, %.6g, %.6g) m; "
        "a larger domain.box, or domain.remove_outside: true, lets the run go on",
        (long long)first, x[0], x[1], x[2]);
}

/* Ends the run if any of the owned elements h, of all ranks, is inside wall k. */
static void check_free(struct sim *s, const struct particles_host *h, int k)
{
    struct particle_run *run = s->particle;
    const struct wall_pose *pose = wall_contacts_pose(run->wall_contacts, s->step) + k;
    bool *is_in = fail_alloc((size_t)h->n * sizeof *is_in);
    int64_t gid = INT64_MAX,
            n = generate_in_wall(run->walls, k, pose, h->n, h->x, h->radius, is_in);
    for (int64_t i = 0; i < h->n; i++)
        if (is_in[i] && h->gid[i] < gid) gid = h->gid[i];
    free(is_in);
    comm_sum_i64(s->comm, &n, 1);
    comm_min_i64(s->comm, &gid, 1);
    if (n == 0) return;
    output_stop_numerics(s, "element %lld is inside wall '%s', which appears (%lld in all)",
        (long long)gid, s->scene->wall[k].name, (long long)n);
}

/* Walls that the lists of before do not have, because they appear now, have to find their place
 * free, as at the start. */
static void check_appearing(struct sim *s)
{
    struct particle_run *run = s->particle;
    const struct wall_contacts *w = run->wall_contacts;
    struct particles_host *h = NULL;
    for (int k = 0; w && run->features.timed && k < run->walls->n_wall; k++) {
        if (!wall_contacts_pose(w, s->step)[k].active || w->room_host[k] >= 0) continue;
        if (!h) h = particles_download(run->particles, &run->features, s->scene, run->first);
        check_free(s, h, k);
    }
    particles_host_free(h);
}

/* Room to move until the next build, from the velocities of now. */
static void make_room(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct particles *p = run->particles;
    struct launch *room = run->select_room;
    size_t preal = particles_preal(&run->features);
    buffer_reserve(&p->reference, 4 * preal * (size_t)p->n_owned);
    particles_reserve(p, &run->features, p->n_owned, p->n_owned);
    launch_set_count(room, "n", p->n_owned);
    launch_set_real(room, "skin", run->skin);
    launch_set_real(room, "horizon", run->horizon);
    launch_set_real(room, "bond_range", run->features.bond_range);
    launch_bind_all(room, (const struct launch_binding[]){{"position", &p->field[FIELD_STATE].now},
                              {"motion", &p->field[FIELD_STATE].now}, {"reference", &p->reference},
                              {"reach", &p->reach}, {0}});
    launch_run(room, p->n_owned);
}

void particle_build(struct sim *s)
{
    make_room(s);
    particle_lists(s, s->step);
}

void particle_lists(struct sim *s, int64_t step)
{
    struct particle_run *run = s->particle;
    struct particles *p = run->particles;
    run->bounds = cells_bounds(run->cells, p, p->n_owned);
    for (int a = 0; a < 3; a++) {
        run->box[a] = run->bounds.low[a];
        run->box[3 + a] = run->bounds.high[a];
    }
    comm_min_f64(s->comm, run->box, 3);
    comm_max_f64(s->comm, run->box + 3, 3);
    ghosts_plan(run->ghosts, run->owners, run->scan, p, &run->bounds);
    struct cells_bounds all =
        p->n_ghost > 0 ? cells_bounds(run->cells, p, p->n_owned + p->n_ghost) : run->bounds;
    cells_sort(run->cells, run->scan, p, p->n_owned + p->n_ghost, &all);
    pairs_build(run->pairs, run->cells, run->scan, p);
    if (run->assigned) assigned_build(run->assigned, run->scan, p, run->pairs, run->ghosts);
    if (run->wall_contacts)
        wall_contacts_build(
            run->wall_contacts, run->scan, p, step, (int)ceil(run->horizon / s->dt), run->box);
    watch_reset(&s->watch, s->comm, &p->flags);
    run->built_at = step;
    const struct pair_list *l = &run->pairs->now;
    int64_t n_pair = l->n_interior + l->n_mine,
            n_wall = run->wall_contacts ? run->wall_contacts->now.n : 0;
    const struct halo *halo = run->ghosts->exchange.halo;
    balance_add(s->balance, (struct partition_part){p->n_owned + n_pair + n_wall,
                                l->n_interior + l->n_boundary - l->n_own, halo ? halo->n_send : 0});
}

/* To owners, new ones if they are dealt out. Returns how many have changed hands. */
static int64_t move(struct sim *s, struct cells_bounds bounds, bool is_deal)
{
    struct particle_run *run = s->particle;
    if (is_deal) particle_cut(s);
    owners_move(run->owners, run->cells, run->scan, run->particles, run->pairs, run->wall_contacts,
        &bounds);
    int64_t n = run->owners->n_moved;
    comm_sum_i64(s->comm, &n, 1);
    return n;
}

static void rebuild(struct sim *s)
{
    struct particle_run *run = s->particle;
    particle_build(s);
    pairs_carry(run->pairs, run->particles, &run->owners->old_index);
    if (run->wall_contacts) wall_contacts_carry(run->wall_contacts, &run->owners->old_index);
    particle_bind(s);
}

/* Work is known only from lists, and elements are dealt out by those of before; where the new ones
 * show that it was not enough, by these at once. */
static void deal(struct sim *s, const struct cells_bounds *now)
{
    struct balance *b = s->balance;
    bool is_due = balance_is_due(b);
    balance_begin(b);
    balance_end(b, is_due, move(s, *now, is_due));
    account(s);
    rebuild(s);
    if (!balance_is_uneven(b)) return;
    balance_begin(b);
    int64_t n_moved = move(s, s->particle->bounds, true);
    rebuild(s);
    balance_end(b, true, n_moved);
}

void particle_regroup(struct sim *s)
{
    struct particle_run *run = s->particle;
    exchange_settle(&run->ghosts->exchange);
    balance_look(s->balance, &s->timers, s->step);
    struct cells_bounds now = cells_bounds(run->cells, run->particles, run->particles->n_owned);
    int32_t lost = now.has_nan;
    comm_or_i32(s->comm, &lost, 1);
    if (lost) output_stop_numerics(s, "positions or velocities are not numbers any more");
    check_inside(s, &now);
    if (run->assigned) assigned_complete(run->assigned, run->pairs);
    if (run->features.energy) energy_collect(s);
    adapt_skin(s, generate_smallest_radius(s->particle->first));
    if (run->wall_contacts) wall_contacts_set_step(run->wall_contacts, s->step);
    check_appearing(s);
    overlap_look_behind(s);
    deal(s, &now);
    overlap_look(s);
    s->n_rebuild++;
    balance_write(s->balance, (double)s->step * s->dt);
    balance_go_on(s->balance, &s->timers, s->step);
}
