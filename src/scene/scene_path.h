/* Dotted paths into the node tree of a scene: "walls[1].motion.remove_at"; "walls.gate.motion"
 * names an entry of a list by its key `name`. */
#ifndef DEMOCLES_SCENE_PATH_H
#define DEMOCLES_SCENE_PATH_H

#include <stdbool.h>
#include <stddef.h>

#include "scene_yaml.h"

/* One step of a path: a word, or an index. */
struct scene_step {
    const char *word; /* [length], not terminated; NULL: an index */
    size_t length;
    long index;
};

/* Takes the first step off *path. False at its end and where it is malformed: then **path is not
 * '\0'. */
bool scene_path_step(const char **path, struct scene_step *step);

/* The index in `node` of the item that the step leads to, or -1. */
int scene_path_follow(const struct scene_node *node, const struct scene_step *step);

/* The deepest node on the path that exists, at least `root`. */
const struct scene_node *scene_path_deepest(const struct scene_node *root, const char *path);
/* The node at the path's end, or NULL. */
const struct scene_node *scene_path_find(const struct scene_node *root, const char *path);

#endif
