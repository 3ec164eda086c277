/* run.json, the record of a run: what it was, did and cost. It is written at the end, also of a run
 * that failed. */
#ifndef DEMOCLES_RECORD_H
#define DEMOCLES_RECORD_H

#include "device/feature_table.h"
#include "results/report.h"
#include "sim.h"

/* Writes each feature that has a name as 0 or 1. */
void record_features(struct report *report, const struct feature_row *row, const void *features);
/* Collective. `observed`: the state on the device is one of full steps, so that energies and the
 * digest can be taken; if it then holds NaN, false is returned and the exit code in the record is
 * EXIT_NUMERICS. */
bool record_write(struct sim *s, int exit_code, bool observed);

/* The short record of a run that an error ends, unless it has one already: for fail_tell. Not
 * collective: written by the rank that has the error. */
void record_error(void *sim, int exit_code, const char *text);

/* Logs each distinct device with the number of ranks that use it. Collective. */
void record_print_devices(const struct sim *s);

#endif
