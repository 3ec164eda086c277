/* Parts of `democles check`. Private to check*.c. */
#ifndef DEMOCLES_CHECK_PARTS_H
#define DEMOCLES_CHECK_PARTS_H

#include "comm/comm.h"
#include "particle/features.h"

/* `check` of a scene of method lattice; as check_scene. */
int check_lattice(const struct comm *comm, const struct scene *scene, bool resolved);

/* Title, file, method, precision, gravity; what will be written; features in and out, by their
 * names and values. */
void check_head(const struct scene *scene);
void check_output(const struct scene *scene);
/* A line each; frees them. */
void check_warnings(struct scene_errors *warnings);
void check_features(const struct feature_row *table, const void *features);

/* The contact laws of all pairs of materials that can meet, with what follows from the sizes of the
 * elements. */
void check_contacts(const struct scene *scene, const struct elements_host *elements);

#endif
