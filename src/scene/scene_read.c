/* Reads a scene: the file into a node tree, --set into the tree, the tree along the table of keys
 * into struct scene, then the rules. */
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "comm/fail.h"
#include "scene_reader.h"

/* The whole file, owned by the caller; NULL and an error where it cannot be read. */
static char *read_file(const char *path, size_t *n, struct scene_errors *errors)
{
    FILE *file = files_input(path);
    char *bytes = NULL;
    *n = 0;
    if (file) {
        for (size_t capacity = 4096, got = 1; got > 0; capacity *= 2) {
            bytes = fail_realloc(bytes, capacity);
            got = fread(bytes + *n, 1, capacity - *n, file);
            *n += got;
        }
        int why = ferror(file) ? errno : 0; /* of a folder, for one */
        fclose(file);
        if (!why) return bytes;
        errno = why;
    }
    scene_errors_add(errors, "%s: cannot be read: %s", path, strerror(errno));
    free(bytes);
    return NULL;
}

static char *folder_of(const char *path)
{
    const char *slash = strrchr(path, '/');
    char *folder = fail_strdup(path);
    folder[slash ? slash - path + 1 : 0] = '\0';
    return folder;
}

/* Stem of the file; of its folder where the file is called scene.yaml, or resolved.yaml as in a
 * folder of results. */
static char *name_of(const char *path)
{
    char *absolute = realpath(path, NULL);
    char *rest = absolute ? absolute : fail_strdup(path);
    char *slash = strrchr(rest, '/');
    if (slash &&
        (strcmp(slash + 1, "scene.yaml") == 0 || strcmp(slash + 1, "resolved.yaml") == 0) &&
        slash > rest) {
        *slash = '\0';
        slash = strrchr(rest, '/');
        char *name = fail_strdup(slash ? slash + 1 : rest);
        free(rest);
        return name;
    }
    /* The name as given, not what a link points to. */
    const char *last = strrchr(path, '/');
    char *name = fail_strdup(last ? last + 1 : path);
    char *dot = strrchr(name, '.');
    if (dot && dot > name) *dot = '\0';
    free(rest);
    return name;
}

/* FNV-1a, 64 bits. */
static unsigned long hash_of(const char *text)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (; *text; text++) hash = (hash ^ (unsigned char)*text) * 0x100000001b3u;
    return (unsigned long)hash;
}

/* Whether the scene with all defaults, which frames hold, reads back to the same scene: what a run
 * begins with, `resume` can read. */
static void check_read_back(const struct scene *scene, struct scene_errors *errors)
{
    struct scene_errors again = {0};
    const char *text = scene->resolved;
    struct scene *copy = scene_read_text(scene->path, text, strlen(text), NULL, 0, &again);
    if (!copy || copy->hash != scene->hash)
        scene_errors_add(errors, "%s: no run of this scene could be resumed: %s", scene->path,
            again.n > 0 ? again.text[0] : "with all defaults it is another scene");
    scene_free(copy);
    scene_errors_free(&again);
}

struct scene *scene_read(
    const char *path, const char *const *set, int n_set, struct scene_errors *errors)
{
    size_t n;
    char *text = read_file(path, &n, errors);
    struct scene *scene = text ? scene_read_text(path, text, n, set, n_set, errors) : NULL;
    if (!scene) {
        free(text);
        return NULL;
    }
    scene->given = text;
    scene->n_given = n;
    int before = errors->n;
    check_read_back(scene, errors);
    if (errors->n == before) return scene;
    scene_free(scene);
    return NULL;
}

struct scene *scene_read_text(const char *path, const char *text, size_t n, const char *const *set,
    int n_set, struct scene_errors *errors)
{
    struct scene_yaml_error error;
    struct scene_reader reader = {.path = path, .set = set};
    reader.root = scene_yaml_parse(text, n, 0, &error);
    if (!reader.root) {
        scene_errors_add(errors, "%s:%d:%d: %s", path, error.line, error.column, error.text);
        return NULL;
    }
    reader.folder = folder_of(path);
    reader.scene = fail_alloc(sizeof *reader.scene);
    reader.scene->path = fail_strdup(path);
    reader.scene->name = name_of(path);
    for (int k = 0; k < n_set; k++) scene_set_apply(&reader, k);
    scene_walk(&reader);
    scene_check(&reader);
    struct scene *scene = reader.scene;
    if (reader.n_issue > 0) {
        scene_issue_report(&reader, errors);
        scene_free(scene);
        free(reader.out.bytes);
        scene = NULL;
    } else {
        scene_check_derive(scene);
        scene->resolved = reader.out.bytes;
        scene->hash = hash_of(scene->resolved);
    }
    scene_issue_free(&reader);
    scene_yaml_free(reader.root);
    free(reader.folder);
    return scene;
}
