#include "account.h"

#include "sim.h"

void account_begin(struct account *account, const struct sim *s)
{
    account->before = s->dev->counters;
    account->rebuilds_before = s->n_rebuild;
    account->may_be_plain = s->step > 0 && !s->observed;
}

void account_end(struct account *account, const struct sim *s)
{
    const struct device_counters *now = &s->dev->counters, *before = &account->before;
    struct device_counters *plain = &account->plain;
    account->element_steps += (double)s->ops->n_element(s);
    if (!account->may_be_plain || s->observed || s->n_rebuild != account->rebuilds_before) return;
    account->n_plain++;
    plain->n_alloc += now->n_alloc - before->n_alloc;
    plain->n_h2d += now->n_h2d - before->n_h2d;
    plain->h2d_bytes += now->h2d_bytes - before->h2d_bytes;
    plain->n_d2h += now->n_d2h - before->n_d2h;
    plain->d2h_bytes += now->d2h_bytes - before->d2h_bytes;
    plain->n_launch += now->n_launch - before->n_launch;
}
