/* The particle method behind step.h. */
#include "particle.h"

static bool stale(struct sim *s)
{
    struct particle_run *run = s->particle;
    return run->wall_contacts && wall_contacts_stale(run->wall_contacts, s->step, run->box);
}

const struct step_ops particle_ops = {
    .name = "particles",
    .read = particle_read,
    .plan = particle_plan,
    .setup = particle_setup,
    .warn = particle_warn,
    .free = particle_free,
    .stale = stale,
    .regroup = particle_regroup,
    .advance = particle_advance,
    .begin_step = particle_begin_step,
    .check_limit = particle_check_limit,
    .n_element = particle_number,
    .frame = particle_frame,
    .measure_columns = particle_measure_columns,
    .measure = particle_measure,
    .digest = particle_digest,
    .n_owned = particle_owned,
    .count = particle_count,
    .report_features = particle_report_features,
    .report_state = particle_report_state,
    .launches = particle_launches,
};
