/* Binds the kernels of a step to the buffers of now. */
#include "particle.h"

void particle_bind(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct particles *p = run->particles;
    struct pair_list *l = &run->pairs->now;
    struct wall_contacts *w = run->wall_contacts;
    const struct buffer *state = &p->field[FIELD_STATE].now;
    launch_bind_all_if(
        run->pair_force, (const struct launch_binding[]){{"position", state}, {"motion", state},
                             {"pair_i", &l->pair_i}, {"pair_j", &l->pair_j}, {"state", &l->state},
                             {"history", &l->history}, {"ledger", &run->pairs->ledger},
                             {"result", &run->pairs->result}, {0}});
    launch_set_count(run->pair_force, "capacity", l->capacity);
    struct launch *body[] = {run->gather, run->kick_drift};
    for (int i = 0; i < 2; i++) {
        launch_bind_all_if(body[i],
            (const struct launch_binding[]){{"position", state}, {"motion", state},
                {"incidence_begin", &l->incidence_begin}, {"incidence", &l->incidence},
                {"result", &run->pairs->result}, {"wall_begin", w ? &w->now.begin : NULL},
                {"wall_result", w ? &w->result : NULL},
                {"orientation", &p->field[FIELD_ORIENTATION].now}, {"force", &p->force},
                {"torque", &p->torque}, {"reference", &p->reference}, {"flags", &p->flags}, {0}});
        launch_set_count(body[i], "n_owned", p->n_owned);
    }
    if (!w) return;
    launch_bind_all_if(run->wall_force,
        (const struct launch_binding[]){{"position", state}, {"motion", state},
            {"candidate", &w->now.candidate}, {"candidate_element", &w->now.element},
            {"primitive", &w->primitive}, {"wall_of", &w->wall_of}, {"pose", &w->pose},
            {"keep", &w->keep}, {"partner", &w->partner}, {"near", &w->near},
            {"state", &w->now.state}, {"history", &w->now.history}, {"ledger", &w->ledger},
            {"wall_material", &w->material}, {"result", &w->result}, {0}});
    launch_set_count(run->wall_force, "capacity", w->now.capacity);
}
