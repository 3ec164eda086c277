/* The folder of results: made, refused where it holds results already, emptied of our own files on
 * request, and given the two scenes. */
#ifndef DEMOCLES_OUTPUT_DIR_H
#define DEMOCLES_OUTPUT_DIR_H

#include "comm/comm.h"

struct output_request {
    const char *dir;
    bool force;        /* replace what a run before, or somebody else, has left */
    bool trace;        /* trace.json will be written */
    const char *scene; /* [n_scene] text of scene.yaml; NULL for a run that goes on */
    size_t n_scene;
    const char *resolved;       /* text of resolved.yaml */
    const char *const *measure; /* [n_measure] names: the CSV files of this run */
    int n_measure;
};

/* Makes the folder with its parents, and writes scene.yaml and resolved.yaml into it. Collective:
 * rank 0 acts, all agree; failure: EXIT_IO. Where it holds frames or run.json, or a file that no
 * run has written and this run would replace (another scene.yaml, a log.txt, the CSV of a measure):
 * without `force` all stop with EXIT_USAGE; with it those go. From a folder of a run, which is one
 * with results or with the log of a run, go the files of output_names_are_ours and the series of
 * the measures that the old resolved.yaml names, and nothing else. The folder is locked for the
 * life of the process: where another run still writes into it, all stop with EXIT_USAGE. From here
 * on SIGXFSZ is ignored, so that a file-size limit is an error like a full disk. */
void output_dir_create(const struct comm *comm, const struct output_request *request);

/* The same for a run that goes on from frame number `index` there: what output_names_are_over says
 * goes, and resolved.yaml is written anew. */
void output_dir_resume(
    const struct comm *comm, const struct output_request *request, int64_t index);

/* True if a file `stop` lies in dir. Not collective: ask on one rank. */
bool output_dir_stop_asked(const char *dir);

#endif
