/* Factors of loads over time, with exact means over a step of time.
 *
 * constant  1
 * ramp      t/T from 0 to T, 0 before, 1 after
 * sine      sin(2 pi f t + phase)
 * table     straight lines between points (t, f), level before the first and after the last */
#ifndef DEMOCLES_HISTORY_H
#define DEMOCLES_HISTORY_H

#include "scene.h"

double history_at(const struct history *history, double t);
/* Change with time [1/s]; at a corner the mean of both sides. */
double history_rate(const struct history *history, double t);
/* Mean over [from, to], or [to, from]; the value where both are one. */
double history_mean(const struct history *history, double from, double to);

/* Reads the points of a table from a CSV file: a line per point, time in s and factor; a first line
 * that is no number is a header. Returns NULL, or what is wrong with the file, owned by the caller;
 * table->point is the caller's in both cases. */
char *history_read(struct history *table, const char *file);

#endif
