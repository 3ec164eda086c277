/* Names that a run gives to files in its folder of results, exactly as it writes them: no file of
 * another name is ever removed. */
#ifndef DEMOCLES_OUTPUT_NAMES_H
#define DEMOCLES_OUTPUT_NAMES_H

#include <stdbool.h>
#include <stdint.h>

/* A frame or run.json: a folder with one of these holds results. */
bool output_names_are_results(const char *name);
/* Files that `run --force` removes from a folder of results: those, what was left unfinished by a
 * run that was killed, and log.txt, run.balance.csv, trace.json, stop, the list of frames and the
 * sources of builds that failed. */
bool output_names_are_ours(const char *name);
/* Files that `resume` removes when it goes on from frame `index`: later frames, what was left
 * unfinished, run.json and stop. */
bool output_names_are_over(const char *name, int64_t index);

#endif
