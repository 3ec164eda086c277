/* --set KEY=VALUE: changes to the node tree of a scene before it is read, so that everything after
 * treats them like the file's own text. Mappings on the way are created; entries of lists are not.
 * `null` as VALUE takes a key or an entry of a list away. */
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "base/nearest.h"
#include "scene_path.h"
#include "scene_reader.h"

/* Says that the list has no such entry; `path` ends with the step. */
static void report_no_entry(struct scene_reader *reader, const struct scene_node *at,
    const struct scene_node *list, const struct scene_step *step, const char *path)
{
    if (!step->word) {
        if (list->n == 0) scene_issue_at(reader, at, path, "no such entry, the list is empty");
        else scene_issue_at(reader, at, path, "no such entry, there are [0] to [%d]", list->n - 1);
        return;
    }
    char *word = fail_format("%.*s", (int)step->length, step->word);
    const char **name = fail_alloc((size_t)list->n * sizeof *name);
    int n = 0;
    for (int k = 0; k < list->n; k++) {
        const struct scene_node *own = scene_yaml_get(list->item[k], "name", NULL);
        if (own && own->kind == NODE_SCALAR) name[n++] = own->text;
    }
    const char *near = nearest_name(word, name, n);
    if (near) scene_issue_at(reader, at, path, "no entry of that name; did you mean '%s'?", near);
    else scene_issue_at(reader, at, path, "no entry of that name");
    free(name);
    free(word);
}

/* Puts `value` (taken over) at the step below `node`, in place of what is there. */
static void put(struct scene_node *node, const struct scene_step *step, struct scene_node *value)
{
    if (node->kind == NODE_MAPPING) {
        char *name = fail_format("%.*s", (int)step->length, step->word);
        if (scene_yaml_is_null(value)) {
            scene_yaml_remove(node, name);
            scene_yaml_free(value);
        } else scene_yaml_put(node, name, value);
        free(name);
    } else {
        int k = scene_path_follow(node, step);
        scene_yaml_free(node->item[k]);
        if (scene_yaml_is_null(value)) {
            scene_yaml_free(value);
            node->n--;
            for (; k < node->n; k++) node->item[k] = node->item[k + 1];
        } else node->item[k] = value;
    }
}

/* Walks along `key`, makes the mappings that are missing, and puts the value at its end. */
static void apply(struct scene_reader *reader, const char *key, struct scene_node *value)
{
    struct scene_node *node = reader->root;
    const char *next = key;
    struct scene_step step;
    while (scene_path_step(&next, &step)) {
        char *path =
            fail_format("%.*s", (int)(next - key) - (next > key && *next && next[-1] == '.'), key);
        int k = scene_path_follow(node, &step);
        const char *problem = NULL;
        if (node->kind == NODE_SCALAR) problem = "its parent is a single value, not a mapping";
        else if (node->kind == NODE_MAPPING && !step.word)
            problem = "its parent is a mapping, not a list";
        else if (node->kind == NODE_MAPPING && k < 0 && *next == '[')
            problem = "the scene does not give this list; set it as a whole";
        if (problem) scene_issue_at(reader, value, path, "%s", problem);
        else if (node->kind == NODE_SEQUENCE && k < 0)
            report_no_entry(reader, value, node, &step, path);
        bool stop = problem || (node->kind == NODE_SEQUENCE && k < 0);
        free(path);
        if (stop) break;
        if (!*next) {
            put(node, &step, value);
            return;
        }
        if (k < 0 || scene_yaml_is_null(node->item[k])) {
            put(node, &step, scene_yaml_new_mapping(value->set, 0, 0));
            k = scene_path_follow(node, &step);
        }
        node = node->item[k];
    }
    scene_yaml_free(value);
}

void scene_set_apply(struct scene_reader *reader, int k)
{
    const char *text = reader->set[k], *equals = strchr(text, '=');
    struct scene_node here = {.set = k + 1};
    if (!equals || equals == text) {
        scene_issue_at(reader, &here, "", "expected KEY=VALUE");
        return;
    }
    char *key = fail_format("%.*s", (int)(equals - text), text);
    struct scene_step step;
    const char *rest = key;
    while (scene_path_step(&rest, &step)) {}
    if (*rest) {
        scene_issue_at(
            reader, &here, "", "cannot read '%s' as a key like walls[1].motion.remove_at", key);
        free(key);
        return;
    }
    struct scene_yaml_error error;
    const char *value_text = equals[1] ? equals + 1 : "null";
    struct scene_node *value = scene_yaml_parse(value_text, strlen(value_text), k + 1, &error);
    if (value) apply(reader, key, value);
    else scene_issue_at(reader, &here, key, "%s", error.text);
    free(key);
}
