#include "account_fixture.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "../mpi_check.h"
#include "comm/fail.h"

static double uniform(uint64_t *key)
{
    return (double)(mpi_check_random((*key)++) >> 11) * 0x1p-52 - 1;
}
static double spread(uint64_t *key, int most)
{
    return uniform(key) * ldexp(1, -(int)(mpi_check_random((*key)++) % (uint64_t)most));
}

void account_random(struct account_state *a, bool is_float)
{
    uint64_t key = 1;
    memset(a, 0, sizeof *a);
    for (int i = 0; i < N_ELEMENT; i++) {
        for (int k = 0; k < 3; k++) {
            a->x[i][k] = 3 + uniform(&key);
            a->v[i][k] = spread(&key, 20);
            a->w[i][k] = 100 * spread(&key, 20);
        }
        a->radius[i] = 0.01 * (1.5 + uniform(&key));
        a->inverse_m[i] = 1 / ldexp(1.5 + uniform(&key), -(int)(mpi_check_random(key++) % 30));
        for (int k = 0; k < LEDGER_WIDTH; k++) a->at_wall[i][k] = spread(&key, 60);
        double *number[] = {a->x[i], a->x[i] + 1, a->x[i] + 2, a->v[i], a->v[i] + 1, a->v[i] + 2,
            a->w[i], a->w[i] + 1, a->w[i] + 2, &a->radius[i], &a->inverse_m[i]};
        for (int k = 0; k < 11 && is_float; k++) *number[k] = (double)(float)*number[k];
    }
    for (int p = 0; p < N_PAIR; p++) {
        a->lower[p] = (int)(mpi_check_random(key++) % (N_ELEMENT - 1));
        a->upper[p] = a->lower[p] + 1 +
                      (int)(mpi_check_random(key++) % (uint64_t)(N_ELEMENT - 1 - a->lower[p]));
        for (int k = 0; k < LEDGER_WIDTH; k++) a->pair[p][k] = spread(&key, 60);
    }
    for (int k = 0; k < 3; k++) {
        a->gravity[k] = k == 2 ? -9.81 : 0.3 * k;
        a->domain[k] = 1.75 + 0.1 * k;
        a->domain[3 + k] = 4.5;
    }
}

int account_owner(int gid, int n_rank)
{
    return gid / 3 % n_rank;
}

/* Number of an element on this rank: owned ones first, then ghosts, both by gid. */
static int *local_numbers(const struct account_state *a, int rank, int n_rank, int *n_owned)
{
    int *local = fail_alloc(N_ELEMENT * sizeof *local), n = 0;
    for (int own = 1; own >= 0; own--) {
        for (int i = 0; i < N_ELEMENT; i++)
            if (own == (account_owner(i, n_rank) == rank) && !a->taken[i]) local[i] = n++;
        if (own) *n_owned = n;
    }
    return local;
}

static void put(char *at, bool is_float, int k, double x)
{
    if (is_float) ((float *)(void *)at)[k] = (float)x;
    else ((double *)(void *)at)[k] = x;
}

void account_write_elements(struct sim *s, const struct account_state *a)
{
    struct particle_run *run = s->particle;
    const struct features *f = &run->features;
    int n_owned, *local = local_numbers(
                     a, s->comm->n_rank > 1 ? s->comm->rank : 0, s->comm->n_rank, &n_owned);
    size_t bytes = particles_record(f);
    char *state = fail_alloc(N_ELEMENT * bytes);
    int64_t *gid = fail_alloc(N_ELEMENT * sizeof *gid);
    for (int i = 0; i < N_ELEMENT; i++) {
        if (a->taken[i]) continue;
        char *head = state + (size_t)local[i] * bytes, *tail = head + 4 * particles_preal(f);
        for (int k = 0; k < 3; k++) {
            put(head, f->position_is_float, k, a->x[i][k]);
            put(tail, f->real_is_float, k, a->v[i][k]);
            if (f->spin) put(tail, f->real_is_float, 4 + k, a->w[i][k]);
        }
        put(head, f->position_is_float, 3, a->radius[i]);
        put(tail, f->real_is_float, 3, a->inverse_m[i]);
        gid[local[i]] = i;
    }
    run->particles->n_owned = n_owned;
    buffer_write(&run->particles->field[FIELD_STATE].now, 0, N_ELEMENT * bytes, state);
    buffer_write(&run->particles->field[FIELD_GID].now, 0, N_ELEMENT * sizeof *gid, gid);
    free(state);
    free(gid);
    free(local);
}

static void write_pairs(struct sim *s, const struct account_state *a, int rank, int n_rank)
{
    struct particle_run *run = s->particle;
    struct pair_list *l = &run->pairs->now;
    int n_owned, *local = local_numbers(a, rank, n_rank, &n_owned), n = 0;
    int *i = fail_alloc((N_PAIR + PAIR_GAP) * sizeof *i),
        *j = fail_alloc((N_PAIR + PAIR_GAP) * sizeof *j);
    double *ledger = fail_alloc((N_PAIR + PAIR_GAP) * LEDGER_WIDTH * sizeof *ledger);
    l->n_owned = l->n_lower = n_owned;
    l->capacity = N_PAIR + PAIR_GAP;
    /* between and behind the pairs */
    for (int k = 0; k < (N_PAIR + PAIR_GAP) * LEDGER_WIDTH; k++) ledger[k] = NAN;
    for (int boundary = 0; boundary < 2; boundary++) {
        l->first_boundary = boundary ? n : 0;
        for (int p = 0; p < N_PAIR; p++) {
            bool own = local[a->lower[p]] < n_owned, other = local[a->upper[p]] < n_owned;
            if (a->taken[a->lower[p]] || a->taken[a->upper[p]] || (!own && !other) ||
                boundary != (own != other || p % 5 == 0))
                continue;
            i[n] = local[a->lower[p]];
            j[n] = local[a->upper[p]];
            for (int k = 0; k < LEDGER_WIDTH; k++) ledger[k * l->capacity + n] = a->pair[p][k];
            n++;
        }
        if (boundary) break;
        l->n_interior = n;
        for (int k = 0; k < PAIR_GAP; k++) i[n++] = 0;
    }
    l->n_boundary = l->n_mine = n - l->first_boundary;
    buffer_reserve(&l->pair_i, (size_t)l->capacity * sizeof *i);
    buffer_reserve(&l->pair_j, (size_t)l->capacity * sizeof *j);
    buffer_reserve(&run->pairs->ledger, (size_t)l->capacity * LEDGER_WIDTH * sizeof *ledger);
    buffer_write(&l->pair_i, 0, (size_t)l->capacity * sizeof *i, i);
    buffer_write(&l->pair_j, 0, (size_t)l->capacity * sizeof *j, j);
    buffer_write(
        &run->pairs->ledger, 0, (size_t)l->capacity * LEDGER_WIDTH * sizeof *ledger, ledger);
    free(i);
    free(j);
    free(ledger);
    free(local);
}

static void write_walls(struct sim *s, const struct account_state *a, int rank, int n_rank)
{
    struct wall_contacts *w = s->particle->wall_contacts;
    int n_owned, *local = local_numbers(a, rank, n_rank, &n_owned), wall_of[N_WALL] = {0, 1};
    size_t capacity = (size_t)n_owned + 16;
    int *candidate = fail_alloc(capacity * sizeof *candidate),
        *element = fail_alloc(capacity * sizeof *element);
    double *ledger = fail_alloc(capacity * LEDGER_WIDTH * sizeof *ledger);
    w->now.n = w->now.n_owned = n_owned;
    w->now.capacity = (int64_t)capacity;
    for (int i = 0; i < N_ELEMENT; i++) {
        if (a->taken[i] || local[i] >= n_owned) continue;
        candidate[local[i]] = i % N_WALL;
        element[local[i]] = local[i];
        for (size_t k = 0; k < LEDGER_WIDTH; k++)
            ledger[k * capacity + (size_t)local[i]] = a->at_wall[i][k];
    }
    buffer_reserve(&w->now.candidate, capacity * sizeof *candidate);
    buffer_reserve(&w->now.element, capacity * sizeof *element);
    buffer_reserve(&w->ledger, capacity * LEDGER_WIDTH * sizeof *ledger);
    buffer_reserve(&w->wall_of, sizeof wall_of);
    buffer_write(&w->now.candidate, 0, capacity * sizeof *candidate, candidate);
    buffer_write(&w->now.element, 0, capacity * sizeof *element, element);
    buffer_write(&w->ledger, 0, capacity * LEDGER_WIDTH * sizeof *ledger, ledger);
    buffer_write(&w->wall_of, 0, sizeof wall_of, wall_of);
    free(candidate);
    free(element);
    free(ledger);
    free(local);
}

static void init_buffers(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct buffer *all[] = {&run->particles->field[FIELD_STATE].now,
        &run->particles->field[FIELD_STATE].spare, &run->particles->field[FIELD_GID].now,
        &run->particles->field[FIELD_GID].spare, &run->pairs->now.pair_i, &run->pairs->now.pair_j,
        &run->pairs->ledger, &run->wall_contacts->now.candidate, &run->wall_contacts->now.element,
        &run->wall_contacts->ledger, &run->wall_contacts->wall_of};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        buffer_init(all[k], s->dev, "made up");
        buffer_reserve(all[k], N_ELEMENT * 96);
    }
}

struct sim *account_sim(struct device *dev, struct comm *comm, const struct account_state *a,
    const struct features *features, int rank, int n_rank)
{
    struct sim *s = fail_alloc(sizeof *s);
    struct particle_run *run = s->particle = fail_alloc(sizeof *run);
    s->dev = dev;
    s->comm = comm;
    run->features = *features;
    s->scene = fail_alloc(sizeof *s->scene);
    memcpy(s->scene->gravity, a->gravity, sizeof a->gravity);
    memcpy(run->domain, a->domain, sizeof a->domain);
    run->particles = fail_alloc(sizeof *run->particles);
    run->pairs = fail_alloc(sizeof *run->pairs);
    run->owners = fail_alloc(sizeof *run->owners);
    struct wall_contacts *w = run->wall_contacts = fail_alloc(sizeof *w);
    struct walls *walls = fail_alloc(sizeof *walls);
    walls->n_wall = N_WALL;
    w->walls = walls;
    w->poses = fail_alloc(WALL_BATCH * N_WALL * sizeof *w->poses);
    w->room_host = fail_alloc(N_WALL * sizeof *w->room_host);
    /* the second goes at step 7 */
    for (int k = 0; k < WALL_BATCH * N_WALL; k++)
        w->poses[k].active = k % N_WALL == 0 || k / N_WALL < 7;
    init_buffers(s);
    account_write_elements(s, a);
    write_pairs(s, a, rank, n_rank);
    write_walls(s, a, rank, n_rank);
    run->energy = energy_create(s);
    return s;
}

void account_leave(struct sim *s, const struct account_state *a)
{
    struct particle_run *run = s->particle;
    struct owners *o = run->owners;
    o->removed = fail_alloc(N_ELEMENT * sizeof *o->removed);
    for (int i = 0; i < N_ELEMENT; i++) {
        if (!a->taken[i] || account_owner(i, s->comm->n_rank) != s->comm->rank) continue;
        struct owners_removed *r = &o->removed[o->n_removed++];
        *r =
            (struct owners_removed){.gid = i, .radius = a->radius[i], .inverse_m = a->inverse_m[i]};
        memcpy(r->x, a->x[i], sizeof r->x);
        memcpy(r->v, a->v[i], sizeof r->v);
        if (run->features.spin) memcpy(r->w, a->w[i], sizeof r->w);
    }
    particles_swap(run->particles);
    account_write_elements(s, a);
}

void account_free(struct sim *s)
{
    struct particle_run *run = s->particle;
    energy_free(run->energy);
    struct wall_contacts *w = run->wall_contacts;
    struct buffer *all[] = {&run->particles->field[FIELD_STATE].now,
        &run->particles->field[FIELD_STATE].spare, &run->particles->field[FIELD_GID].now,
        &run->particles->field[FIELD_GID].spare, &run->pairs->now.pair_i, &run->pairs->now.pair_j,
        &run->pairs->ledger, &w->now.candidate, &w->now.element, &w->ledger, &w->wall_of};
    for (size_t k = 0; k < sizeof all / sizeof *all; k++) buffer_free(all[k]);
    free((void *)(uintptr_t)w->walls);
    free(w->poses);
    free(w->room_host);
    free(run->owners->removed);
    void *own[] = {w, run->owners, run->pairs, run->particles, s->scene, run, s};
    for (size_t k = 0; k < sizeof own / sizeof *own; k++) free(own[k]);
}
