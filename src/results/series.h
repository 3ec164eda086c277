/* Time series as CSV: one file per measure, first column `time [s]`, units in the header, numbers
 * that read back to the same bits. Rank 0 writes, the others pass through. Knows nothing of what is
 * measured. Lines are kept in memory until series_flush. */
#ifndef DEMOCLES_SERIES_H
#define DEMOCLES_SERIES_H

#include "comm/comm.h"

struct series_column {
    const char *name, *unit; /* header: `name [unit]` */
};

struct series;

/* Whether a file is the series of some run (or empty, as of one that was killed), not a link and
 * not somebody else's CSV. */
bool series_is_ours(const char *path);

/* Creates DIR/NAME.csv with its header. `column` [n_column] without the time; copied. Not
 * collective (rank 0 acts); failure: EXIT_IO. */
struct series *series_create(const struct comm *comm, const char *dir, const char *name,
    const struct series_column *column, int n_column);
/* Before anything is changed: where DIR/NAME.csv is there and has other columns, the run ends with
 * EXIT_SCENE. Rank 0 acts. */
void series_check(const struct comm *comm, const char *dir, const char *name,
    const struct series_column *column, int n_column);
/* Goes on with that file: lines of later times than `time` [s], and one that is not whole, are cut
 * off. One that is empty, or not there, is begun anew, with a warning. */
struct series *series_resume(const struct comm *comm, const char *dir, const char *name,
    const struct series_column *column, int n_column, double time);
/* Appends one line. `value` [n_column], read on rank 0 only. */
void series_add(struct series *series, double time, const double *value);
/* To the file; at frames, so that file and frames tell the same story after a crash. */
void series_flush(struct series *series);
/* Flushes, closes, frees. NULL is fine. */
void series_free(struct series *series);

/* Shortest of %.15g, %.16g, %.17g that reads back to the same double; nan, inf, -inf otherwise.
 * Returns `text`. */
enum { SERIES_NUMBER_SIZE = 32 };
char *series_number(double value, char text[SERIES_NUMBER_SIZE]);

#endif
