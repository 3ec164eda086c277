/* run.json, the record of a run: a small JSON writer that keeps the order of keys, and what turns
 * timers of all ranks into it.
 *
 * Every rank may fill a report (rank 0's is the one that is written). Numbers read back to the same
 * bits; NaN and infinity become null. `key` is NULL inside a list. Knows nothing of what the keys
 * mean. */
#ifndef DEMOCLES_REPORT_H
#define DEMOCLES_REPORT_H

#include "comm/comm.h"
#include "base/timer.h"

struct report;

struct report *report_create(void);
void report_free(struct report *report); /* NULL is fine */

void report_text(struct report *report, const char *key, const char *value); /* NULL: null */
void report_number(struct report *report, const char *key, double value);
void report_integer(struct report *report, const char *key, int64_t value);
void report_flag(struct report *report, const char *key, bool value);
/* Vector as a list on one line, value [n]. */
void report_numbers(struct report *report, const char *key, const double *value, int n);
/* Objects and lists nest; each begin has its end. */
void report_begin(struct report *report, const char *key);
void report_begin_list(struct report *report, const char *key);
void report_end(struct report *report);

/* Key `timers`: an object of {min, mean, max} over ranks [s] for each timer. Collective. */
void report_timers(
    struct report *report, const char *key, const struct comm *comm, const struct timers *timers);
/* {min, mean, max} of one number per rank. Collective. */
void report_spread(struct report *report, const char *key, const struct comm *comm, double value);

/* The text so far, complete where every begin has its end; owned by the report. */
const char *report_json(struct report *report);
/* Replaces DIR/run.json by rename. Rank 0 acts; not collective. Returns false, after a warning, if
 * it could not: the caller decides (EXIT_IO). */
bool report_write(struct report *report, const struct comm *comm, const char *dir);
/* The same by whichever rank calls it. */
bool report_save(struct report *report, const char *dir);

#endif
