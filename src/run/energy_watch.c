#include "energy_watch.h"

#include <math.h>

#include "output.h"

void energy_watch(struct sim *s, double balance, double supplied, double spare)
{
    if (isnan(balance))
        output_stop_numerics(
            s, "the energy is not a number, or too large to measure; use a smaller time.step");
    if (fabs(balance) > 10 * supplied + spare && !s->scene->time.allow_unstable)
        output_stop_numerics(s,
            "the energy runs away: its balance error is %.3g J, although only %.3g J were "
            "supplied; use a smaller time.step",
            fabs(balance), supplied);
}
