/* Who does how much: the work of each rank and the time it takes for it, whether it pays to deal
 * the elements out anew, and the account of that.
 *
 * Only when and how elements are dealt out depends on these times, and no bit of the result depends
 * on that. Knows no method. */
#ifndef DEMOCLES_BALANCE_H
#define DEMOCLES_BALANCE_H

#include "partition/partition.h"
#include "scene/scene.h"
#include "base/timer.h"

struct log;
struct report;
struct series;

struct balance {
    const struct comm *comm;
    const struct scene_partition *scene;
    struct partition_quality quality; /* of all list builds that steps went on with */
    struct partition_quality before;  /* without the last one */
    int64_t *share;                   /* [n_rank] of the work that each rank is to have */
    int64_t *work;                    /* [n_rank] at the last look: per step */
    double *speed;                    /* [n_rank] work per second, smoothed; 0: not known */
    double imbalance;                 /* U of the last look, against share */
    double after;                     /* U right after the last deal */
    bool is_fresh;                    /* that deal's parts are yet to be added */
    struct partition_part part;       /* this rank's, added last */
    /* [s] that an even deal would have saved since the last one */
    double saving;
    /* of the last look, or where steps went on; of the last deal */
    int64_t step, dealt_at;
    double looked, waited, written; /* [s] timers at the end of the last regroup */
    double began, plain_sum;        /* [s] of the move under way; of moves without a new deal */
    int64_t n_plain;
    double cost, cost_sum;   /* [s] of the last deal; of all */
    int64_t n_cost;          /* deals in cost_sum */
    int64_t n_deal, n_moved; /* of the whole run, also before it was taken up again */
    struct series *record;   /* NULL: none */
};

struct balance *balance_create(const struct comm *comm, const struct scene_partition *scene);
void balance_free(struct balance *b); /* NULL is fine */

/* The part that this rank has now: after each build of lists. Collective. */
void balance_add(struct balance *b, struct partition_part part);

/* Before `step`, when this rank's device is idle and nothing has been waited for yet.
 * Collective. */
void balance_look(struct balance *b, const struct timers *timers, int64_t step);
/* After a look: whether elements shall be dealt out anew. The same on all ranks. */
bool balance_is_due(const struct balance *b);
/* After balance_add: whether they shall be, once more perhaps, before any step, since the new lists
 * share the work out too unevenly. Those lists do not count then. The same on all ranks. */
bool balance_is_uneven(struct balance *b);
/* Around the deal, if there is one, and the moves of elements. n_moved: those that have changed
 * hands, of all ranks. Collective. */
void balance_begin(struct balance *b);
void balance_end(struct balance *b, bool is_deal, int64_t n_moved);
/* From now on each balance_write adds a line to DIR/run.balance.csv; with several ranks only. from:
 * time [s] up to which the file that is there is kept, negative: a new one. */
void balance_record(struct balance *b, const char *dir, double from);
void balance_write(struct balance *b, double time);
/* Where steps go on, after `step`: what follows counts as their time. */
void balance_go_on(struct balance *b, const struct timers *timers, int64_t step);
/* What the set-up did does not count, but for the parts as they are now. */
void balance_restart(struct balance *b);

/* A line for the log and key `partition`. timers of a run of n_step steps that is over; n_element:
 * of this rank. Collective. */
void balance_print(const struct balance *b, struct log *log);
void balance_report(const struct balance *b, struct report *r, const struct timers *timers,
    int64_t n_step, int64_t n_element);

#endif
