/* Prints what is wrong with a scene, once for all ranks. */
#ifndef DEMOCLES_SCENE_REPORT_H
#define DEMOCLES_SCENE_REPORT_H

#include "comm/comm.h"
#include "scene.h"

/* Collective. Returns where no rank has any error. Otherwise the lowest rank that has some prints
 * each on its line to stderr, and all finalise MPI and exit with EXIT_SCENE: also where only one
 * rank could not read its copy of a file. */
void scene_report_errors(const struct comm *comm, struct scene_errors *errors);

/* scene_read on every rank; collective. Errors end the program as above; so does a file that is not
 * the same on every rank. */
struct scene *scene_report_read(
    const struct comm *comm, const char *path, const char *const *set, int n_set);

#endif
