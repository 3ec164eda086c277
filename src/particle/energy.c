#include "energy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "device/buffers.h"
#include "device/integer_sums.h"
#include "particle.h"
#include "scene/measure_columns.h"

/* What has left and entered the energy of this rank's elements since the run began [J], as exact
 * sums of integers (kernels/common/sums.h). */
struct totals {
    /* taken by contacts, one sum per entry of a ledger (ledger.h); that of the elastic energy stays
     * zero, since it is a function of the state */
    struct sum taken[LEDGER_WIDTH];
    struct sum removed; /* energy that removed elements had when they left */
    /* potential that elements have gained by jumps of a period; it is added to that of their
     * positions */
    struct sum wrapped;
};

struct energy {
    struct program *program; /* NULL: no double precision */
    struct launch *elements, *ledger, *gone, *gone_walls;
    struct buffer partial, gone_id, gone_wall;
    struct totals total;
    struct sum gravity_before; /* of this rank's elements, before they change owners */
    bool wraps;                /* some period has a component of gravity along it */
};

static const struct buffer_spec buffers[] = {{"sums", offsetof(struct energy, partial)},
    {"gone elements", offsetof(struct energy, gone_id)},
    {"gone walls", offsetof(struct energy, gone_wall)}, {0}};

struct energy *energy_create(struct sim *s)
{
    struct particle_run *run = s->particle;
    static const char *const source[] = {"sums.cl", NULL};
    struct energy *e = fail_alloc(sizeof *e);
    buffers_init(s->dev, e, buffers);
    for (int a = 0; a < 3; a++)
        e->wraps |= run->features.periodic[a] && fabs(s->scene->gravity[a]) > 0;
    if (!s->dev->fp64) return e;
    char *lists = features_options(&run->features, FEATURES_LISTS),
         *options = fail_format("%s -DWITH_SUMS=1", lists);
    e->program = program_build(s->dev, s->comm, "sums", options, source);
    free(lists);
    free(options);
    e->elements = launch_create(e->program, "sums_elements");
    e->ledger = launch_create(e->program, "sums_ledger");
    e->gone = launch_create(e->program, "sums_gone");
    e->gone_walls = launch_create(e->program, "sums_gone_walls");
    launch_set_vector(e->elements, "gravity", s->scene->gravity);
    launch_set_vector(e->elements, "origin", run->domain);
    buffer_reserve(&e->partial, (size_t)SUMS_GROUPS * SUMS_ELEMENT * SUMS_WIDTH * sizeof(int64_t));
    buffer_reserve(&e->gone_id, 0);
    buffer_reserve(&e->gone_wall, 0);
    struct launch *all[] = {e->elements, e->ledger, e->gone, e->gone_walls};
    for (int i = 0; i < 4; i++) launch_bind_buffer(all[i], "partial", &e->partial);
    return e;
}

void energy_free(struct energy *e)
{
    if (!e) return;
    struct launch *launch[] = {e->elements, e->ledger, e->gone, e->gone_walls};
    for (int i = 0; i < 4; i++) launch_free(launch[i]);
    program_free(e->program);
    buffers_free(e, buffers);
    free(e);
}

static void sum_elements(struct sim *s, struct sum sum[SUMS_ELEMENT])
{
    struct particle_run *run = s->particle;
    struct launch *k = run->energy->elements;
    const struct particles *p = run->particles;
    launch_set_count(k, "n", p->n_owned);
    launch_bind_buffer(k, "position", &p->field[FIELD_STATE].now);
    launch_bind_buffer(k, "motion", &p->field[FIELD_STATE].now);
    integer_sums_run(k, &run->energy->partial, SUMS_ELEMENT, sum);
}

/* Which contacts a kernel goes over: the pairs that count on this rank, or all candidates at
 * walls. */
static void set_contacts(struct launch *k, const struct sim *s, bool wall)
{
    struct particle_run *run = s->particle;
    const struct pair_list *l = &run->pairs->now;
    const struct wall_list *w = wall ? &run->wall_contacts->now : NULL;
    launch_set_count(k, "n", w ? w->n : l->n_interior + l->n_mine);
    launch_set_count(k, "n_first", w ? w->n : l->n_interior);
    launch_set_count(k, "second", w ? 0 : l->first_boundary);
    launch_set_count(k, "n_lower", w ? w->n_owned : l->n_lower);
    launch_set_count(k, "capacity", w ? w->capacity : l->capacity);
    launch_bind_buffer(k, "element", w ? &w->element : &l->pair_i);
    launch_bind_buffer(k, "ledger", w ? &run->wall_contacts->ledger : &run->pairs->ledger);
}

/* Losses to the totals; returns the elastic energy of this rank's contacts. */
static struct sum collect(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct sum sum[LEDGER_WIDTH] = {{0}}, elastic;
    struct energy *e = run->energy;
    for (int wall = 0; wall < (run->wall_contacts ? 2 : 1); wall++) {
        set_contacts(e->ledger, s, wall);
        integer_sums_run(e->ledger, &e->partial, LEDGER_WIDTH, sum);
    }
    elastic = sum[LEDGER_ELASTIC];
    sum[LEDGER_ELASTIC] = (struct sum){0};
    for (int k = 0; k < LEDGER_WIDTH; k++) {
        integer_sums_add(&e->total.taken[k], sum[k], 1);
        integer_sums_carry(&e->total.taken[k]);
    }
    return elastic;
}

void energy_collect(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct sum sum[SUMS_ELEMENT] = {{0}};
    collect(s);
    if (run->energy->wraps) sum_elements(s, sum);
    run->energy->gravity_before = sum[SUMS_GRAVITY];
}

static int by_number(const void *a, const void *b)
{
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x > y) - (x < y);
}

/* Ids of the elements that have left on any rank, ascending, to the device; returns how many.
 * Collective. */
static int64_t share_gone(struct sim *s)
{
    struct particle_run *run = s->particle;
    const struct owners *o = run->owners;
    int64_t most = o->n_removed, n = 0;
    comm_max_i64(s->comm, &most, 1);
    size_t bytes = (size_t)most * sizeof(int64_t), n_all = (size_t)s->comm->n_rank * (size_t)most;
    int64_t *mine = fail_alloc(bytes), *all = fail_alloc(n_all * sizeof *all);
    for (int64_t i = 0; i < most; i++) mine[i] = i < o->n_removed ? o->removed[i].gid : -1;
    comm_gather(s->comm, mine, all, bytes);
    for (size_t i = 0; i < n_all; i++)
        if (all[i] >= 0) all[n++] = all[i];
    qsort(all, (size_t)n, sizeof *all, by_number);
    buffer_put(&run->energy->gone_id, (size_t)n * sizeof *all, all);
    free(mine);
    free(all);
    return n;
}

/* Springs of contacts of which an element has left on any rank, each where it counts otherwise
 * too. */
static void remove_springs(struct sim *s, int64_t n_gone)
{
    struct particle_run *run = s->particle;
    struct energy *e = run->energy;
    launch_set_count(e->gone, "n_gone", n_gone);
    launch_bind_buffer(e->gone, "gone", &e->gone_id);
    /* numbers of the old lists */
    launch_bind_buffer(e->gone, "gid", &run->particles->field[FIELD_GID].spare);
    for (int wall = 0; wall < (run->wall_contacts ? 2 : 1); wall++) {
        set_contacts(e->gone, s, wall);
        launch_bind_buffer(
            e->gone, "partner", wall ? &run->wall_contacts->now.element : &run->pairs->now.pair_j);
        integer_sums_run(e->gone, &e->partial, 1, &e->total.removed);
    }
}

/* Springs of contacts with walls that were there when the lists were built and are no more. */
static void remove_walls(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct energy *e = run->energy;
    const struct wall_contacts *w = run->wall_contacts;
    const struct wall_pose *pose = wall_contacts_pose(w, s->step);
    size_t bytes = (size_t)w->walls->n_wall * sizeof(cl_int);
    cl_int *gone = fail_alloc(bytes), any = 0;
    for (int k = 0; k < w->walls->n_wall; k++)
        any |= gone[k] = w->room_host[k] >= 0 && !pose[k].active;
    if (any) {
        buffer_put(&e->gone_wall, bytes, gone);
        launch_set_count(e->gone_walls, "n", w->now.n);
        launch_set_count(e->gone_walls, "capacity", w->now.capacity);
        launch_bind_all(
            e->gone_walls, (const struct launch_binding[]){{"candidate", &w->now.candidate},
                               {"wall_of", &w->wall_of}, {"gone_wall", &e->gone_wall},
                               {"ledger", &w->ledger}, {0}});
        integer_sums_run(e->gone_walls, &e->partial, 1, &e->total.removed);
    }
    free(gone);
}

/* Elements leave at x^n with the velocities of the half step before; gravity's half kick is
 * missing, that of contacts is left out. */
static void remove_elements(struct sim *s, struct sum *gravity)
{
    struct particle_run *run = s->particle;
    for (int64_t i = 0; i < run->owners->n_removed; i++) {
        const struct owners_removed *r = &run->owners->removed[i];
        struct sums_element e = {.radius = r->radius, .mass = 1 / r->inverse_m};
        double term[SUMS_ELEMENT];
        for (int a = 0; a < 3; a++) {
            e.x[a] = r->x[a];
            e.v[a] = r->v[a] + 0.5 * s->dt * s->scene->gravity[a];
            e.w[a] = r->w[a];
        }
        sums_element(e, s->scene->gravity, run->domain, term);
        for (int k = SUMS_KINETIC; k <= SUMS_GRAVITY; k++)
            sums_add(&run->energy->total.removed, term[k]);
        sums_add(gravity, term[SUMS_GRAVITY]);
    }
    integer_sums_carry(&run->energy->total.removed);
}

void energy_moved(struct sim *s, int64_t n_removed)
{
    struct particle_run *run = s->particle;
    struct energy *e = run->energy;
    struct sum after[SUMS_ELEMENT] = {{0}};
    if (run->features.timed) remove_walls(s);
    if (n_removed > 0) remove_springs(s, share_gone(s));
    if (e->wraps) sum_elements(s, after);
    remove_elements(s, &after[SUMS_GRAVITY]);
    if (!e->wraps) return;
    integer_sums_add(&e->total.wrapped, e->gravity_before, 1);
    integer_sums_add(&e->total.wrapped, after[SUMS_GRAVITY], -1);
    integer_sums_carry(&e->total.wrapped);
}

static struct sum *total_at(struct totals *t, int k)
{
    return k < LEDGER_WIDTH ? &t->taken[k] : k == LEDGER_WIDTH ? &t->removed : &t->wrapped;
}

static void put_sum(struct sum sum, int64_t out[SUMS_WIDTH])
{
    integer_sums_carry(&sum);
    const int64_t one[SUMS_WIDTH] = {sum.hi, sum.mid, sum.lo, sum.bad};
    memcpy(out, one, sizeof one);
}

void energy_totals(const struct sim *s, int64_t total[ENERGY_TOTALS][SUMS_WIDTH])
{
    for (int k = 0; k < ENERGY_TOTALS; k++)
        put_sum(*total_at(&s->particle->energy->total, k), total[k]);
    comm_sum_i64(s->comm, total[0], ENERGY_TOTALS * SUMS_WIDTH);
    for (int k = 0; k < ENERGY_TOTALS; k++)
        put_sum((struct sum){total[k][0], total[k][1], total[k][2], total[k][3]}, total[k]);
}

void energy_restore(struct sim *s, const int64_t total[ENERGY_TOTALS][SUMS_WIDTH])
{
    for (int k = 0; k < ENERGY_TOTALS; k++)
        *total_at(&s->particle->energy->total, k) =
            s->comm->rank > 0 ? (struct sum){0}
                              : (struct sum){total[k][0], total[k][1], total[k][2], total[k][3]};
}

/* Sums in the order in which energy_now makes them, after those of elements. */
enum { ELASTIC = SUMS_ELEMENT, TOTALS, REMOVED = TOTALS + LEDGER_WIDTH, N_SUM };

#define TERM(name, sign, known, source, text)                                                      \
    ENERGY_TERM(struct energy_sums, name, sign, known, source),
const struct energy_term energy_table[] = {MEASURE_ENERGY_PARTICLES(TERM){NULL, 0, 0, 0, 0}};

void energy_now(struct sim *s, struct energy_sums *out)
{
    struct particle_run *run = s->particle;
    struct energy *e = run->energy;
    struct sum sum[N_SUM] = {{0}};
    double v[N_SUM];
    if (e->program) {
        sum_elements(s, sum);
        if (run->features.energy) sum[ELASTIC] = collect(s);
        for (int k = 0; k < LEDGER_WIDTH; k++) sum[TOTALS + k] = e->total.taken[k];
        sum[REMOVED] = e->total.removed;
        integer_sums_add(&sum[SUMS_GRAVITY], e->total.wrapped, 1);
    }
    for (int k = 0; k < N_SUM; k++)
        sum[k].bad += !e->program || (k >= SUMS_ELEMENT && !run->features.energy);
    integer_sums_all(s->comm, sum, N_SUM, v);
    for (const struct energy_term *term = energy_table; term->name; term++)
        *energy_terms_at(term, out) = v[term->source];
    memcpy(out->momentum, v + SUMS_MOMENTUM, sizeof out->momentum);
    memcpy(out->angular, v + SUMS_ANGULAR, sizeof out->angular);
}

double energy_balance(const struct energy_sums *start, const struct energy_sums *now)
{
    return energy_terms_balance(energy_table, start, now);
}

double energy_supplied(const struct energy_sums *start, const struct energy_sums *now)
{
    return start->kinetic + start->rotational + start->elastic + fabs(now->wall_work) +
           fabs(now->removed) + fabs(now->gravity - start->gravity);
}
