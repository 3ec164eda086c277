/* What the readers of values share. Internal to src/scene_*.c. */
#ifndef DEMOCLES_SCENE_VALUES_H
#define DEMOCLES_SCENE_VALUES_H

#include "scene_reader.h"

/* What a key's value is read with. */
struct scene_place {
    struct scene_reader *reader;
    const struct scene_key *key;
    const char *path;
    void *record;
};

/* scene_number.c. Whether the node is something of that kind; else an issue: "expected ..., found
 * ...". */
bool scene_is_kind(const struct scene_place *p, const struct scene_node *node,
    enum scene_node_kind kind, const char *expected);
/* The number at the node, with the unit and range of the place's key; `path` is where it stands.
 * False and an issue where it is none. */
bool scene_number(
    const struct scene_place *p, const struct scene_node *node, const char *path, double *value);

/* KEY_FILE, KEY_TABLE (scene_table.c) */
void scene_table_file(const struct scene_place *p, const struct scene_node *node);
void scene_table_read(const struct scene_place *p, const struct scene_node *node);

#endif
