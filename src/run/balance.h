/* Load balance: how much work each rank has and how long it takes for it, whether a repartition
 * pays, and the statistics of both.
 *
 * Measured times decide only when elements are repartitioned and in which shares, and no bit of the
 * result depends on that. Knows no method. */
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
    struct partition_quality quality; /* of all list rebuilds whose lists were used */
    struct partition_quality before;  /* the same without the last rebuild */
    int64_t *share;             /* [n_rank] target share of each rank, in parts of their sum */
    int64_t *work;              /* [n_rank] interactions at the last measurement */
    double *speed;              /* [n_rank] interactions per second, smoothed; 0: unknown */
    double imbalance;           /* U at the last measurement, against share */
    double after;               /* U right after the last repartition */
    bool is_fresh;              /* the parts of that repartition are still to be added */
    struct partition_part part; /* this rank's part, as added last */
    /* [s] that a perfectly balanced partition would have saved since the last repartition */
    double saving;
    int64_t step;                   /* of the last measurement, or of a restart of the clocks */
    int64_t dealt_at;               /* step of the last repartition */
    double looked, waited, written; /* [s] timers at the end of the last regroup */
    double began, plain_sum; /* [s] start of the regroup under way; of regroups without one */
    int64_t n_plain;         /* regroups in plain_sum */
    double cost, cost_sum;   /* [s] of the last repartition; of all */
    int64_t n_cost;          /* repartitions in cost_sum */
    /* repartitions, and elements that changed their rank, of the whole run with its restarts */
    int64_t n_deal, n_moved;
    struct series *record; /* run.balance.csv; NULL: not asked for */
};

struct balance *balance_create(const struct comm *comm, const struct scene_partition *scene);
void balance_free(struct balance *b); /* NULL is fine */

/* Takes the part that this rank has after a list rebuild. Collective. */
void balance_add(struct balance *b, struct partition_part part);

/* Measures the speed of each rank since the last call. To be called before `step`, when this rank's
 * device is idle and no message has been waited for yet. Collective. */
void balance_look(struct balance *b, const struct timers *timers, int64_t step);
/* After balance_look: whether a repartition is due. The same on all ranks. */
bool balance_is_due(const struct balance *b);
/* After balance_add: whether a repartition is needed before the next step, because the new lists
 * exceed the threshold of imbalance. It may follow another repartition at the same step, and the
 * lists that it replaces do not enter the statistics. The same on all ranks. */
bool balance_is_uneven(struct balance *b);
/* To be called around a repartition, if there is one, and the migration. n_moved: elements of all
 * ranks that have changed their owner. Collective. */
void balance_begin(struct balance *b);
void balance_end(struct balance *b, bool is_deal, int64_t n_moved);
/* Lets each balance_write from now on add a row to DIR/run.balance.csv; with several ranks only.
 * from: time [s] up to which an existing file is kept; negative: the file is new. */
void balance_record(struct balance *b, const char *dir, double from);
void balance_write(struct balance *b, double time);
/* Restarts the clocks after `step`: the time from now on counts as time of steps. */
void balance_go_on(struct balance *b, const struct timers *timers, int64_t step);
/* Forgets the statistics of the set-up, except the parts as they are now. */
void balance_restart(struct balance *b);

/* The line of the log, and the key `partition` of run.json. timers: of a run of n_step steps that
 * is over; n_element: of this rank. Collective. */
void balance_print(const struct balance *b, struct log *log);
void balance_report(const struct balance *b, struct report *r, const struct timers *timers,
    int64_t n_step, int64_t n_element);

#endif
