/* Binds the kernels of a step to the buffers of now. */
#include "particle.h"

static void bind_all(
    struct launch *launch, const char *const *name, const struct buffer *const *buffer)
{
    for (int i = 0; name[i]; i++) launch_bind_buffer_if(launch, name[i], buffer[i]);
}

void particle_bind(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct particles *p = run->particles;
    struct pair_list *l = &run->pairs->now;
    static const char *const pair_name[] = {
        "position", "motion", "pair_i", "pair_j", "state", "history", "ledger", "result", NULL};
    const struct buffer *state = &p->field[FIELD_STATE].now;
    bind_all(run->pair_force, pair_name,
        (const struct buffer *const[]){state, state, &l->pair_i, &l->pair_j, &l->state, &l->history,
            &run->pairs->ledger, &run->pairs->result});
    launch_set_int(run->pair_force, "capacity", (int)l->capacity);
    static const char *const body_name[] = {"position", "motion", "incidence_begin", "incidence",
        "result", "wall_begin", "wall_result", "orientation", "force", "torque", "reference",
        "flags", NULL};
    struct wall_contacts *w = run->wall_contacts;
    const struct buffer *body[] = {state, state, &l->incidence_begin, &l->incidence,
        &run->pairs->result, w ? &w->now.begin : NULL, w ? &w->result : NULL,
        &p->field[FIELD_ORIENTATION].now, &p->force, &p->torque, &p->reference, &p->flags};
    bind_all(run->gather, body_name, body);
    bind_all(run->kick_drift, body_name, body);
    launch_set_int(run->gather, "n_owned", (int)p->n_owned);
    launch_set_int(run->kick_drift, "n_owned", (int)p->n_owned);
    if (!w) return;
    static const char *const wall_name[] = {"position", "motion", "candidate", "candidate_element",
        "primitive", "wall_of", "pose", "keep", "state", "history", "ledger", "wall_material",
        "result", NULL};
    bind_all(run->wall_force, wall_name,
        (const struct buffer *const[]){state, state, &w->now.candidate, &w->now.element,
            &w->primitive, &w->wall_of, &w->pose, &w->keep, &w->now.state, &w->now.history,
            &w->ledger, &w->material, &w->result});
    launch_set_int(run->wall_force, "capacity", (int)w->now.capacity);
}
