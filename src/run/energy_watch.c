#include "energy_watch.h"

#include <math.h>

#include "output.h"

void energy_watch(struct sim *s, double balance, double supplied, double spare)
{
    if (isnan(balance))
        output_stop_numerics(
            s, "the energy is not a number, or too large to measure; use a smaller time.step");
    double most = s->scene->time.allow_unstable ? 1e6 : 10;
    if (fabs(balance) > most * supplied + spare)
        output_stop_numerics(s,
            "the energy runs away: its balance error is %.3g J, although only %.3g J were "
            "supplied; use a smaller time.step",
            fabs(balance), supplied);
}
