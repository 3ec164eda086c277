/* `democles check`: what a scene would run, as text. Needs no device. */
#ifndef DEMOCLES_CHECK_H
#define DEMOCLES_CHECK_H

#include "comm/comm.h"
#include "scene/scene.h"

/* Makes elements and walls as a run does, and prints them, the contact laws, the time step,
 * features and memory to stdout; `resolved`: prints the scene with all defaults instead.
 * Collective, rank 0 works and prints. What is wrong with files or elements ends the program with
 * EXIT_SCENE. Returns the exit code. */
int check_scene(const struct comm *comm, const struct scene *scene, bool resolved);

#endif
