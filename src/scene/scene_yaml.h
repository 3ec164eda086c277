/* A YAML text as a small tree of nodes that know their line and column. It knows no key of the
 * scene language.
 *
 * Aliases are expanded (within limits), tags and comments are dropped, the keys of mappings must be
 * plain text. Duplicate keys are kept: the reader reports them. One document per text. */
#ifndef DEMOCLES_SCENE_YAML_H
#define DEMOCLES_SCENE_YAML_H

#include <stdbool.h>
#include <stddef.h>

enum scene_node_kind { NODE_SCALAR, NODE_SEQUENCE, NODE_MAPPING };

struct scene_node {
    enum scene_node_kind kind;
    int set;                  /* 0: from the file; k: from the k-th --set (from 1) */
    int line, column;         /* in the file, from 1 */
    char *text;               /* scalar: its text, UTF-8; else NULL */
    bool plain;               /* scalar: written without quotes */
    int n;                    /* sequence, mapping: number of items */
    struct scene_node **key;  /* [n] mapping: scalars */
    struct scene_node **item; /* [n] */
};

/* What is wrong with the text, at a line and column from 1. */
struct scene_yaml_error {
    int line, column;
    char text[256];
};

/* Parses `length` bytes of YAML into a new tree, owned by the caller. NULL and `error` where they
 * are not valid UTF-8 or YAML, or hold nothing. `set` goes into every node. */
struct scene_node *scene_yaml_parse(
    const char *text, size_t length, int set, struct scene_yaml_error *error);
void scene_yaml_free(struct scene_node *node);

struct scene_node *scene_yaml_new_mapping(int set, int line, int column);

/* Value of the first key `name` of a mapping (index through *index if not NULL), or NULL; NULL too
 * for other kinds of nodes. */
struct scene_node *scene_yaml_get(const struct scene_node *node, const char *name, int *index);

/* Gives a mapping the pair name: value, in place of the first pair of that name if there is one.
 * Takes `value` over. */
void scene_yaml_put(struct scene_node *node, const char *name, struct scene_node *value);
/* Takes the first pair of that name out of a mapping, if there is one. */
void scene_yaml_remove(struct scene_node *node, const char *name);

/* A plain empty scalar, `~` or `null`. */
bool scene_yaml_is_null(const struct scene_node *node);

/* "a mapping", "a list", "nothing", "text": for messages. */
const char *scene_yaml_kind_name(const struct scene_node *node);

#endif
