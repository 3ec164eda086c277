/* What the parts of the scene reader share while one scene is read (scene_read.c owns it; the other
 * parts borrow it): the node tree, the scene under construction, the issues found so far and the
 * resolved text as it grows. Internal to src/scene_*.c. */
#ifndef DEMOCLES_SCENE_READER_H
#define DEMOCLES_SCENE_READER_H

#include <stdbool.h>
#include <stddef.h>

#include "scene.h"
#include "scene_keys.h"
#include "scene_write.h"
#include "scene_yaml.h"

struct scene_issue {
    int set, line, column, order; /* order: of arrival, to sort stably */
    char *path;                   /* of the key it belongs to, "" for the whole scene */
    char *text;
};

struct scene_reader {
    const char *path;       /* of the scene file, as given */
    char *folder;           /* of it, with a slash at the end; "" for the working directory */
    const char *const *set; /* --set strings */
    struct scene_node *root;
    struct scene *scene;
    struct scene_issue *issue;
    int n_issue;
    struct scene_text out;
};

/* Notes that the key `path` is wrong, at the place of `node`. */
void scene_issue_at(struct scene_reader *reader, const struct scene_node *node, const char *path,
    const char *format, ...) __attribute__((format(printf, 4, 5)));
/* The same at the place of the deepest node on `path`. */
void scene_issue_on(struct scene_reader *reader, const char *path, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Whether an issue was noted for `path` or below it: a reason not to check further there. */
bool scene_issue_is_below(const struct scene_reader *reader, const char *path);
/* Sorts the issues by position (those of --set last, in their order) and appends their messages to
 * `errors`. */
void scene_issue_report(struct scene_reader *reader, struct scene_errors *errors);
void scene_issue_free(struct scene_reader *reader);

/* Reads the whole node tree into the scene and the resolved text (scene_walk.c). */
void scene_walk(struct scene_reader *reader);
/* Reads the value of one key without keys of its own into its record, and writes it to the resolved
 * text (scene_values.c). */
void scene_values_read(struct scene_reader *reader, const struct scene_key *key,
    const struct scene_node *node, const char *path, void *record);

/* "linear, hertz": the words that are not empty. */
void scene_values_join(char *text, size_t size, const char *const *word, int n);
/* Why a node cannot be a name (of a material, wall, measure: part of paths and file names), or
 * NULL. */
const char *scene_values_name_problem(const struct scene_node *node);

/* Changes the node tree as the k-th --set string says (scene_set.c). */
void scene_set_apply(struct scene_reader *reader, int k);

/* Rules that tie several keys together, and what is derived from them (scene_check.c). Called when
 * every key has been read, also after issues. */
void scene_check(struct scene_reader *reader);
/* Of a scene of method lattice (scene_check_lattice.c). */
void scene_check_lattice(struct scene_reader *reader);
/* scene_check_shapes.c. Whether the scene gives the key; then the rules of shapes, which free
 * `path`. */
bool scene_check_is_given(const struct scene_reader *reader, const char *path);
/* min < max in every direction, or at least min <= max of a box that may be flat. */
void scene_check_box(struct scene_reader *reader, char *path, const double min[3],
    const double max[3], bool may_be_flat);
void scene_check_cylinder(struct scene_reader *reader, char *path, const double from[3],
    const double to[3], double radius);
/* Rules of a region at `path`, which is freed; a flat box is one that selects, not one that is
 * filled. */
void scene_check_region(
    struct scene_reader *reader, char *path, const struct region *region, bool may_be_flat);
/* alpha or eta of materials with a ratio. */
void scene_check_derive_damping(struct scene *scene);
/* Derived values; called only when there are no issues. */
void scene_check_derive(struct scene *scene);

#endif
