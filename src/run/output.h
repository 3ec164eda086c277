/* What a run writes while it runs: measures and frames; and whether somebody has asked it to stop.
 * All functions are collective unless they say otherwise. */
#ifndef DEMOCLES_OUTPUT_H
#define DEMOCLES_OUTPUT_H

#include <stdbool.h>
#include <stdint.h>

struct frame;
struct sim;
struct outputs;

/* Folder, series, first schedule. */
struct outputs *output_create(struct sim *s);
void output_free(struct outputs *out);

/* Whether anything is due at this step, so that it must be observed. Not collective, the same on
 * all ranks. */
bool output_due(const struct sim *s, int64_t step);
/* Writes what is due at s->step; the state on the device is an observed one. `last`: a frame in any
 * case. */
void output_write(struct sim *s, bool last);

/* A signal, the file `stop`, or --max-time: on this rank, looked at now and then. Not
 * collective. */
bool output_stop_wanted(struct sim *s);
/* snapshot_write; a state that is not finite is no frame and ends the run, for those before to stay
 * the ones to go on from. */
void output_frame(struct sim *s, const struct frame *frame);
/* Ends the run because the numbers are no good: run.json is written, exit code EXIT_NUMERICS on all
 * ranks. Frames that are there stay. */
_Noreturn void output_stop_numerics(struct sim *s, const char *what, ...)
    __attribute__((format(printf, 2, 3)));
/* Digest, run.json and the closing words. */
void output_close(struct sim *s, int exit_code);

#endif
