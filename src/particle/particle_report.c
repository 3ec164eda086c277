/* The part of run.json that belongs to the particle method. */
#include "particle.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "results/digest.h"
#include "energy.h"
#include "comm/fail.h"
#include "results/report.h"
#include "run/energy_watch.h"
#include "run/record.h"
#include "run/trust.h"
#include "slipping.h"

/* Digest of the state as it lies on the device, in its own bits. Returns false if there are
 * NaNs. */
bool particle_digest(struct sim *s, uint64_t *digest)
{
    struct particle_run *run = s->particle;
    const struct particles *p = run->particles;
    const struct features *f = &run->features;
    size_t n = (size_t)p->n_owned, bytes = p->field[FIELD_STATE].bytes, real = particles_real(f),
           preal = particles_preal(f);
    int stride = (int)(bytes / real);
    char *state = fail_alloc(n * bytes), *q = fail_alloc(n * 4 * real),
         *none = fail_alloc(n * 4 * real);
    int64_t *gid = fail_alloc(n * sizeof *gid);
    buffer_read(&p->field[FIELD_STATE].now, 0, n * bytes, state);
    buffer_read(&p->field[FIELD_GID].now, 0, n * sizeof *gid, gid);
    if (f->orientation) buffer_read(&p->field[FIELD_ORIENTATION].now, 0, n * 4 * real, q);
    for (size_t i = 0; i < n && !f->orientation; i++) reals_set(q, f->real_is_float, 4 * i, 1);
    const char *motion = state + 4 * preal;
    struct digest_part part[4] = {{state, f->position_is_float, 3, (int)(bytes / preal)},
        {motion, f->real_is_float, 3, stride}, {q, f->real_is_float, 4, 4},
        {f->spin ? motion + 4 * real : none, f->real_is_float, 3, f->spin ? stride : 4}};
    int64_t n_nan = digest_of_all(s->comm, gid, p->n_owned, part, 4, digest);
    void *own[] = {state, q, none, gid};
    for (int i = 0; i < 4; i++) free(own[i]);
    return n_nan == 0;
}

int64_t particle_number(const struct sim *s)
{
    return s->particle->particles->n_global;
}

int64_t particle_owned(const struct sim *s)
{
    return s->particle->particles->n_owned;
}

void particle_count(const struct sim *s, struct step_counts *counts)
{
    struct particle_run *run = s->particle;
    const struct exchange *ghosts = &run->ghosts->exchange,
                          *x = run->assigned ? assigned_exchange(run->assigned, ASSIGNED_STATES)
                                             : ghosts;
    struct halo_traffic sent = exchange_sent(x), back = {0};
    if (run->assigned) back = exchange_sent(assigned_exchange(run->assigned, ASSIGNED_RESULTS));
    sent.bytes += back.bytes;
    sent.messages += back.messages;
    *counts = (struct step_counts){
        run->pairs->now.n_own, sent, ghosts->halo ? ghosts->halo->n_send : 0, x->n_send};
}

void particle_report_features(const struct sim *s, struct report *r)
{
    record_features(r, features_table, &s->particle->features);
}

/* What the features of the scene need; what a run has allocated is device_bytes_per_element. */
static void report_memory(const struct features *features, struct report *r)
{
    report_begin(r, "memory");
    report_number(r, "element_bytes", features_element_bytes(features));
    report_number(r, "pair_bytes", features_pair_bytes(features));
    report_end(r);
}

static void report_trust(struct sim *s, struct report *r, const struct energy_sums *now)
{
    struct particle_run *run = s->particle;
    const struct energy_sums *start = &run->energy_start;
    struct trust trust = trust_unknown;
    double speed = limit_speed(s->scene, run->walls, run->first);
    if (run->features.energy)
        trust.energy_error = trust_energy(energy_balance(start, now), energy_supplied(start, now),
            ENERGY_WATCH_SPARE(now->gravity));
    trust.contact_steps = limit_shortest_contact(s->scene, run->first, speed) / s->dt;
    trust.overlap = overlap_largest(s);
    trust.slipping = slipping_share(s);
    trust.list_room = overlap_room_used(s);
    trust_report(s, r, trust);
}

void particle_report_state(struct sim *s, struct report *r, bool observed)
{
    struct particle_run *run = s->particle;
    struct energy_sums now = run->energy_start;
    bool measured = run->features.energy;
    if (observed) energy_now(s, &now);
    energy_terms_report(energy_table, r, &run->energy_start, &now, measured, measured && observed);
    report_numbers(r, "momentum", now.momentum, 3);
    report_memory(&run->features, r);
    overlap_report(s, r, observed);
    if (observed) report_trust(s, r, &now);
}

int particle_launches(const struct sim *s, struct step_launch launch[STEP_LAUNCHES])
{
    struct particle_run *run = s->particle;
    const struct wall_contacts *w = run->wall_contacts;
    struct launch *all[] = {run->pair_force, run->wall_force, w ? w->keep_launch : NULL,
        run->gather, run->kick_drift, run->ghosts->gather, run->pairs->rows, run->pairs->carry,
        w ? w->rows : NULL};
    int n = sizeof all / sizeof *all;
    for (int i = 0; i < n; i++)
        launch[i] = (struct step_launch){all[i] ? all[i]->name : NULL, all[i]};
    launch[5].name = "pack_ghosts"; /* a kernel that moves records of any kind */
    return n;
}
