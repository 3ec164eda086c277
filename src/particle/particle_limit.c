/* The critical time step of the contacts of now, as the main loop asks for it (step.h). */
#include "particle.h"

#include <math.h>

#include "run/output.h"

/* The dashpots' centring lets larger steps through the larger the step itself: from 0 up to where
 * it agrees with itself, safe all the way. */
static struct limit_result from_below(struct sim *s, double share)
{
    enum { ROUNDS = 8 };
    struct limit_result r = limit_run(s, 0, share);
    for (int k = 0; k < ROUNDS && isfinite(r.dt); k++) {
        double before = r.dt;
        r = limit_run(s, before, share);
        if (r.dt < 1.005 * before) break;
    }
    return r;
}

struct limit_result particle_limit(struct sim *s)
{
    struct particle_run *run = s->particle;
    double share = limit_best_share(s->scene);
    if (run->assigned) ghosts_refresh(run->ghosts, run->particles);
    struct limit_result r = limit_run(s, s->dt, share);
    if (r.dt >= s->dt) return r; /* as a rule: one run of the kernel */
    r = from_below(s, share);
    struct limit_result other = share < 1 ? from_below(s, 1) : r;
    return other.dt > r.dt ? other : r;
}

double particle_limit_dense(const struct sim *s)
{
    struct particle_run *run = s->particle;
    return limit_dense(s->scene, run->first, limit_speed(s->scene, run->walls, run->first));
}

void particle_check_limit(struct sim *s)
{
    struct limit_result limit = particle_limit(s);
    s->limit_at = s->step;
    overlap_look(s);
    overlap_warn(s);
    s->dt_limit = s->dt_limit > 0 ? fmin(s->dt_limit, limit.dt) : limit.dt;
    if (s->dt <= limit.dt || s->scene->time.allow_unstable) return;
    output_stop_numerics(s,
        "the time step %.4g s exceeds the critical time step %.4g s, set by the contacts of "
        "element %lld; use a smaller time.step (or softer contacts), or set time.allow_unstable",
        s->dt, limit.dt, (long long)limit.gid);
}
