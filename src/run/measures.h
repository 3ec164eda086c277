/* Measures: the time series that a scene asks for, one row of a CSV file per step that is due. Sums
 * over ranks are sums of integers, so they do not depend on the number of ranks. */
#ifndef DEMOCLES_MEASURES_H
#define DEMOCLES_MEASURES_H

#include "results/series.h"
#include "scene/scene_item.h"
#include "sim.h"

struct measures;

/* Adds columns to the n that are there; returns how many there are then. */
int measures_columns(struct series_column *column, int n, const struct scene_item *items);

/* Whether the files that are there are those of the measures; of a run that goes on, before it
 * changes anything. Ends the run where they are not. */
void measures_check(struct sim *s);
struct measures *measures_create(struct sim *s);
void measures_free(struct measures *m);
/* Steps between lines of measure i. */
int64_t measures_every(const struct sim *s, int i);
/* Adds a line to every measure that is due at s->step, to all at rest (lattice.relax). Collective;
 * the state on the device is an observed one. */
void measures_write(struct sim *s, struct measures *m);
void measures_flush(struct measures *m);
#endif
