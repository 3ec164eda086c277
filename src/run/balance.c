#include "balance.h"

#include <math.h>
#include <stdlib.h>

#include "comm/fail.h"
#include "results/log.h"
#include "results/report.h"
#include "results/series.h"

/* Shares of one sum; none is smaller than a 64th of the mean, so that every rank has work to be
 * measured by. */
enum { SHARES = 1 << 20, SMALLEST = 64 };
/* Weight of the newest measurement of speed. */
#define NEWEST 0.5

struct balance *balance_create(const struct comm *comm, const struct scene_partition *scene)
{
    struct balance *b = fail_alloc(sizeof *b);
    size_t n = (size_t)comm->n_rank;
    b->comm = comm;
    b->scene = scene;
    b->share = fail_alloc(n * sizeof *b->share);
    b->work = fail_alloc(n * sizeof *b->work);
    b->speed = fail_alloc(n * sizeof *b->speed);
    for (size_t r = 0; r < n; r++) b->share[r] = SHARES / comm->n_rank;
    return b;
}

void balance_free(struct balance *b)
{
    if (!b) return;
    series_free(b->record);
    free(b->share);
    free(b->work);
    free(b->speed);
    free(b);
}

void balance_add(struct balance *b, struct partition_part part)
{
    b->part = part;
    b->before = b->quality;
    partition_quality_add(&b->quality, b->comm, &part, b->share);
    comm_gather(b->comm, &part.work, b->work, sizeof part.work);
    if (b->is_fresh) b->after = b->quality.imbalance;
    b->is_fresh = false;
}

/* Seconds that a step takes with the work as it is, and as it would be after a deal. Unequal speeds
 * are made up for only where shares follow them. */
static void predict(const struct balance *b, double *now, double *then)
{
    double work = 0, speed = 0, slowest = HUGE_VAL;
    *now = 0;
    for (int r = 0; r < b->comm->n_rank; r++) {
        if (!(b->speed[r] > 0)) continue;
        *now = fmax(*now, (double)b->work[r] / b->speed[r]);
        work += (double)b->work[r];
        speed += b->speed[r];
        slowest = fmin(slowest, b->speed[r]);
    }
    *then = speed > 0 ? b->scene->weights == WEIGHTS_MEASURED ? work / speed
                                                              : work / (b->comm->n_rank * slowest)
                      : *now;
}

static void measure(struct balance *b, int64_t n_step, double busy)
{
    int n = b->comm->n_rank;
    double *all = fail_alloc((size_t)n * sizeof *all), sum = 0;
    comm_gather(b->comm, &busy, all, sizeof busy);
    for (int r = 0; r < n; r++) {
        double speed =
            b->work[r] > 0 && all[r] > 0 ? (double)b->work[r] * (double)n_step / all[r] : 0;
        if (speed > 0)
            b->speed[r] = b->speed[r] > 0 ? (1 - NEWEST) * b->speed[r] + NEWEST * speed : speed;
        sum += b->speed[r];
    }
    for (int r = 0; r < n && b->scene->weights == WEIGHTS_MEASURED; r++) {
        double share = b->speed[r] > 0 ? b->speed[r] / sum : 0;
        b->share[r] = llround(SHARES * fmax(share, 1.0 / (SMALLEST * n)));
    }
    free(all);
}

void balance_look(struct balance *b, const struct timers *timers, int64_t step)
{
    double now, then, looked = b->looked, waited = b->waited, written = b->written;
    int64_t n_step = step - b->step;
    if (timers->begun[TIMER_LOOP] > looked) { /* timers have begun anew since */
        looked = timers->begun[TIMER_LOOP];
        waited = written = 0;
    }
    double busy = timer_now() - looked - (timers->total[TIMER_WAIT] - waited) -
                  (timers->total[TIMER_OUTPUT] - written);
    b->step = step;
    if (n_step > 0 && b->comm->n_rank > 1) {
        measure(b, n_step, busy);
        predict(b, &now, &then);
        b->saving += (double)n_step * fmax(now - then * (1 + b->after), 0);
    }
    b->imbalance = partition_imbalance(b->work, b->share, b->comm->n_rank);
}

bool balance_is_due(const struct balance *b)
{
    if (b->comm->n_rank == 1 || b->scene->every == 0) return false;
    /* To deal anew or not is like to buy or to rent: who buys when the rent so far has come up to
     * the price pays at most twice what a prophet would. What was lost since the last deal is also
     * the forecast for as long a time to come (Nicol and Saltz, IEEE Trans. Comput. 37 (1988)
     * 1073). */
    if (b->scene->every == PARTITION_AUTO) return b->saving > b->cost;
    return b->step - b->dealt_at >= b->scene->every && b->imbalance > b->scene->threshold;
}

bool balance_is_uneven(struct balance *b)
{
    if (b->comm->n_rank == 1 || b->scene->every == 0 || b->scene->every == PARTITION_AUTO)
        return false;
    if (b->dealt_at != b->step && b->step - b->dealt_at < b->scene->every) return false;
    if (b->quality.imbalance <= b->scene->threshold) return false;
    b->quality = b->before;
    return true;
}

void balance_begin(struct balance *b)
{
    b->began = timer_now();
}

void balance_end(struct balance *b, bool is_deal, int64_t n_moved)
{
    double took = timer_now() - b->began;
    b->n_moved += n_moved;
    if (!is_deal) {
        b->plain_sum += took;
        b->n_plain++;
        return;
    }
    b->cost = fmax(took - (b->n_plain > 0 ? b->plain_sum / (double)b->n_plain : 0), 0);
    comm_max_f64(b->comm, &b->cost, 1);
    b->cost_sum += b->cost;
    b->n_cost++;
    b->n_deal++;
    b->dealt_at = b->step;
    b->saving = 0;
    b->is_fresh = true;
}

void balance_record(struct balance *b, const char *dir, double from)
{
    static const struct series_column column[] = {
        {"imbalance", "1"}, {"work", "1"}, {"cut", "1"}, {"repartitions", "1"}, {"moved", "1"}};
    enum { COLUMNS = sizeof column / sizeof *column };
    if (b->comm->n_rank == 1) return;
    b->record = from < 0 ? series_create(b->comm, dir, "run.balance", column, COLUMNS)
                         : series_resume(b->comm, dir, "run.balance", column, COLUMNS, from);
}

void balance_write(struct balance *b, double time)
{
    double work = 0;
    if (!b->record) return;
    for (int r = 0; r < b->comm->n_rank; r++) work += (double)b->work[r];
    series_add(b->record, time,
        (double[]){
            b->quality.imbalance, work, b->quality.cut, (double)b->n_deal, (double)b->n_moved});
    series_flush(b->record); /* lists are built rarely */
}

void balance_go_on(struct balance *b, const struct timers *timers, int64_t step)
{
    b->step = step;
    b->looked = timer_now();
    b->waited = timers->total[TIMER_WAIT];
    b->written = timers->total[TIMER_OUTPUT];
}

void balance_restart(struct balance *b)
{
    b->quality = (struct partition_quality){0};
    b->plain_sum = b->cost = b->cost_sum = 0;
    b->n_plain = b->n_cost = b->n_deal = b->n_moved = 0;
    balance_add(b, b->part);
}

static const char *const method_name[] = {"geometric", "interactions", "graph"};

void balance_print(const struct balance *b, struct log *log)
{
    const struct partition_quality *q = &b->quality;
    double n = q->n > 0 ? (double)q->n : 1;
    if (b->comm->n_rank == 1) return;
    log_print(log,
        "partition %s: load imbalance %.3g on average, %.3g at most; %.3g neighbour ranks; %lld "
        "repartitions, %lld elements migrated",
        method_name[b->scene->method], q->imbalance_sum / n, q->imbalance_max,
        q->neighbours_sum / n, (long long)b->n_deal, (long long)b->n_moved);
}

static void report_ranks(const struct balance *b, struct report *r, double busy, int64_t n_element)
{
    struct {
        int64_t n_element, work;
        double busy;
    } mine = {n_element, b->part.work, busy},
      *all = fail_alloc((size_t)b->comm->n_rank * sizeof *all);
    double shares = 0;
    comm_gather(b->comm, &mine, all, sizeof mine);
    for (int k = 0; k < b->comm->n_rank; k++) shares += (double)b->share[k];
    report_begin_list(r, "ranks");
    for (int k = 0; k < b->comm->n_rank; k++) {
        report_begin(r, NULL);
        report_number(r, "share", (double)b->share[k] / shares);
        report_integer(r, "elements", all[k].n_element);
        report_integer(r, "work", all[k].work);
        report_number(r, "busy_s", all[k].busy);
        report_end(r);
    }
    report_end(r);
    free(all);
}

void balance_report(const struct balance *b, struct report *r, const struct timers *timers,
    int64_t n_step, int64_t n_element)
{
    double steps = timers->total[TIMER_LOOP] - timers->total[TIMER_REGROUP],
           step = n_step > 0 ? steps / (double)n_step : 0;
    static const char *const weights[] = {"interactions", "measured"}, *const boundary[] = {
                                                                           "both", "assigned"};
    const struct partition_quality *q = &b->quality;
    double n = q->n > 0 ? (double)q->n : 1,
           cost = b->n_cost > 0 ? b->cost_sum / (double)b->n_cost : 0;
    report_begin(r, "partition");
    report_text(r, "method", method_name[b->scene->method]);
    report_text(r, "weights", weights[b->scene->weights]);
    report_text(r, "boundary", boundary[b->scene->boundary]);
    report_number(r, "cut", q->cut_sum / n);
    report_begin(r, "neighbours");
    report_number(r, "mean", q->neighbours_sum / n);
    report_integer(r, "max", q->neighbours_max);
    report_end(r);
    report_number(r, "cost_s", cost);
    report_number(r, "cost_steps", step > 0 ? cost / step : 0);
    report_ranks(b, r, fmax(steps - timers->total[TIMER_WAIT], 0), n_element);
    report_end(r);
}
