/* Walks the node tree along the table of keys and fills struct scene.
 *
 * The walk follows the order of the table, not that of the file: what is referred to (materials,
 * walls) is read before what refers to it, and the resolved text, written on the way, does not
 * depend on how the user arranged the file. A key that is missing takes the default of the table,
 * read by the same functions as a value of the file. */
#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "base/nearest.h"
#include "scene_reader.h"

enum { MAX_CHILDREN = 64, FEW = 8 /* names that a message may list */ };

/* A mapping that is being read: keys of the table below `pattern`, at `path` of the scene, into
 * `record`. */
struct spot {
    const char *pattern, *path;
    const struct scene_node *map;
    void *record;
    int depth; /* in the resolved text */
};

static void read_mapping(struct scene_reader *reader, const struct spot *at);

static char *join(const char *path, const char *name)
{
    return *path ? fail_format("%s.%s", path, name) : fail_strdup(name);
}

static bool belongs(const struct scene_reader *reader, const struct scene_key *key)
{
    return scene_key_belongs(key, reader->scene->method);
}

/* Of the keys that the scene's method has. */
static int child_names(const struct scene_reader *reader, const char *pattern, const char **name)
{
    int n = 0;
    for (int k = 0; k < scene_keys_n; k++) {
        if (!scene_key_is_child(&scene_keys[k], pattern) || !belongs(reader, &scene_keys[k]))
            continue;
        assert(n < MAX_CHILDREN);
        name[n++] = scene_key_name(&scene_keys[k]);
    }
    return n;
}

static bool is_known(const char *text, const char *const *name, int n)
{
    for (int k = 0; k < n; k++)
        if (strcmp(text, name[k]) == 0) return true;
    return false;
}

/* The method that alone has this key, or NULL. */
static const char *only_method(const char *pattern, const char *name)
{
    for (int k = 0; k < scene_keys_n; k++)
        if (scene_key_is_child(&scene_keys[k], pattern) &&
            strcmp(scene_key_name(&scene_keys[k]), name) == 0)
            return scene_keys[k].only;
    return NULL;
}

/* Whether an unknown key of the mapping most likely means `name`: then `name` is not reported as
 * missing, too. */
static bool is_misspelt(const struct scene_reader *reader, const struct spot *at, const char *name)
{
    const char *known[MAX_CHILDREN];
    int n = child_names(reader, at->pattern, known);
    for (int k = 0; k < at->map->n; k++) {
        const char *text = at->map->key[k]->text;
        const char *near = is_known(text, known, n) || only_method(at->pattern, text)
                               ? NULL
                               : nearest_name(text, known, n);
        if (near && strcmp(near, name) == 0) return true;
    }
    return false;
}

static void report_duplicates(
    struct scene_reader *reader, const struct scene_node *map, const char *path)
{
    for (int k = 1; k < map->n; k++)
        for (int j = 0; j < k; j++) {
            if (strcmp(map->key[j]->text, map->key[k]->text) != 0) continue;
            char *child = join(path, map->key[k]->text);
            scene_issue_at(reader, map->key[k], child, "duplicate key, given first in line %d",
                map->key[j]->line);
            free(child);
            break;
        }
}

static void report_unknown(struct scene_reader *reader, const struct spot *at)
{
    const char *known[MAX_CHILDREN];
    int n = child_names(reader, at->pattern, known);
    for (int k = 0; k < at->map->n; k++) {
        const char *text = at->map->key[k]->text, *only = only_method(at->pattern, text);
        if (is_known(text, known, n)) continue;
        char *child = join(at->path, text);
        const char *near = nearest_name(text, known, n);
        if (only)
            scene_issue_at(reader, at->map->key[k], child, "only valid with method: %s", only);
        else if (near)
            scene_issue_at(reader, at->map->key[k], child, "unknown key; did you mean '%s'?", near);
        else if (n <= FEW) {
            char all[256];
            scene_values_join(all, sizeof all, known, n);
            scene_issue_at(reader, at->map->key[k], child, "unknown key; expected one of: %s", all);
        } else scene_issue_at(reader, at->map->key[k], child, "unknown key");
        free(child);
    }
}

/* The keys marked ONE_OF and AT_MOST_ONE: how many are there? */
static void report_alternatives(struct scene_reader *reader, const struct spot *at)
{
    char all[256] = "";
    int n_given = 0, n_option = 0;
    bool one_needed = false, misspelt = false;
    const struct scene_node *second = NULL;
    for (int k = 0; k < scene_keys_n; k++) {
        const struct scene_key *key = &scene_keys[k];
        if ((key->need != ONE_OF && key->need != AT_MOST_ONE) ||
            !scene_key_is_child(key, at->pattern))
            continue;
        const char *name = scene_key_name(key);
        if (!belongs(reader, key)) { /* has its own message where it is given */
            misspelt = misspelt || scene_yaml_get(at->map, name, NULL);
            continue;
        }
        size_t used = strlen(all);
        snprintf(all + used, sizeof all - used, "%s'%s'", n_option++ ? ", " : "", name);
        one_needed = key->need == ONE_OF;
        misspelt = misspelt || is_misspelt(reader, at, name);
        int index;
        if (!scene_yaml_get(at->map, name, &index)) continue;
        if (++n_given == 1) continue;
        const struct scene_node *word = at->map->key[index];
        if (!second || word->set > second->set || word->line > second->line ||
            (word->line == second->line && word->column > second->column))
            second = word;
    }
    if (n_given > 1) scene_issue_at(reader, second, at->path, "only one of %s can be given", all);
    if (n_given == 0 && one_needed && !misspelt)
        scene_issue_at(reader, at->map, at->path,
            n_option > 1 ? "missing key: one of %s" : "missing key %s", all);
}

/* Whether `when` of the key holds in this mapping: no, yes, or not to be told because the sibling
 * itself is wrong. */
enum holds { HOLDS_NOT, HOLDS, HOLDS_PERHAPS };

/* The sibling "a", or what is below it in "a.b". */
static const struct scene_node *find_sibling(const struct scene_node *map, const char *path)
{
    char word[32];
    const char *dot = strchr(path, '.');
    snprintf(word, sizeof word, "%.*s", (int)(dot ? dot - path : (long)strlen(path)), path);
    const struct scene_node *node = scene_yaml_get(map, word, NULL);
    if (!dot || !node) return node;
    return node->kind == NODE_MAPPING ? find_sibling(node, dot + 1) : NULL;
}

static enum holds condition(const struct scene_key *key, const struct spot *at)
{
    if (!key->when) return HOLDS;
    const char *colon = strstr(key->when, ": ");
    char sibling[32];
    snprintf(sibling, sizeof sibling, "%.*s",
        (int)(colon ? colon - key->when : (long)strlen(key->when)), key->when);
    const struct scene_node *node = find_sibling(at->map, sibling);
    if (!colon || (!node && strchr(sibling, '.'))) return node ? HOLDS : HOLDS_NOT;
    char pattern[128], buffer[64];
    snprintf(pattern, sizeof pattern, "%s.%s", at->pattern, sibling);
    for (int k = 0; k < scene_keys_n && node && node->kind == NODE_SCALAR; k++) {
        if (strcmp(scene_keys[k].path, pattern) != 0) continue;
        snprintf(buffer, sizeof buffer, "|%s|", node->text);
        char all[128];
        snprintf(all, sizeof all, "|%s|", scene_keys[k].words);
        if (*node->text && strstr(all, buffer))
            return strcmp(node->text, colon + 2) == 0 ? HOLDS : HOLDS_NOT;
    }
    return HOLDS_PERHAPS;
}

static void set_mark(const struct scene_key *key, void *record)
{
    if (!key->mark.at) return;
    char *place = (char *)record + key->mark.at - 1;
    if (key->mark.is_bool) *(bool *)(void *)place = key->mark.value;
    else *(int *)(void *)place = key->mark.value;
}

/* Numbers and references of a fresh record that is zero otherwise. */
static void init_record(const char *pattern, void *record)
{
    for (int k = 0; k < scene_keys_n; k++) {
        const struct scene_key *key = &scene_keys[k];
        void *place = scene_key_is_in_record(key, pattern) ? scene_key_place(key, record) : NULL;
        if (!place) continue;
        if (key->type == KEY_NUMBER) *(double *)place = key->absent;
        if (key->type == KEY_MATERIAL || key->type == KEY_WALL || key->type == KEY_BODY ||
            key->type == KEY_PAIR)
            *(int *)place = -1;
        if (key->type == KEY_PAIR) ((int *)place)[1] = -1;
    }
}

/* Of a list or named entries that stand in `record`. */
static void *new_records(const struct scene_key *key, void *record, int n)
{
    void *records = fail_alloc((size_t)n * key->size);
    *(void **)scene_key_place(key, record) = records;
    *(int *)(void *)((char *)record + key->count_at - 1) = n;
    return records;
}

/* Names in a list are unique: they are referred to, and name files. */
static void report_same_names(
    struct scene_reader *reader, const struct scene_node *list, const char *path)
{
    for (int k = 1; k < list->n; k++) {
        const struct scene_node *name = scene_yaml_get(list->item[k], "name", NULL);
        for (int j = 0; j < k && name && name->kind == NODE_SCALAR; j++) {
            const struct scene_node *other = scene_yaml_get(list->item[j], "name", NULL);
            if (!other || other->kind != NODE_SCALAR || strcmp(name->text, other->text) != 0)
                continue;
            char *child = fail_format("%s[%d].name", path, k);
            scene_issue_at(
                reader, name, child, "'%s' is the name of %s[%d] already", name->text, path, j);
            free(child);
            break;
        }
    }
}

static void read_list(
    struct scene_reader *reader, const struct scene_key *key, const struct spot *at)
{
    const struct scene_node *list = at->map;
    if (list->kind != NODE_SEQUENCE || (list->n == 0 && key->need == NEEDED)) {
        const char *found =
            list->kind == NODE_SEQUENCE ? "an empty one" : scene_yaml_kind_name(list);
        scene_issue_at(reader, list, at->path, "expected a list of mappings, found %s", found);
        return;
    }
    char *records = new_records(key, at->record, list->n);
    char *pattern = fail_format("%s[]", at->pattern);
    size_t opened = scene_write_open(&reader->out);
    for (int k = 0; k < list->n; k++) {
        char *record = records + (size_t)k * key->size, *path = fail_format("%s[%d]", at->path, k);
        init_record(pattern, record);
        if (key->label_at) *(int *)(void *)(record + key->label_at - 1) = list->item[k]->line;
        if (key->column_at) *(int *)(void *)(record + key->column_at - 1) = list->item[k]->column;
        reader->out.dash = true;
        struct spot entry = {pattern, path, list->item[k], record, at->depth + 2};
        if (list->item[k]->kind == NODE_MAPPING) read_mapping(reader, &entry);
        else
            scene_issue_at(reader, list->item[k], path, "expected a mapping, found %s",
                scene_yaml_kind_name(list->item[k]));
        free(path);
    }
    reader->out.dash = false;
    scene_write_close(&reader->out, opened, "[]");
    report_same_names(reader, list, at->path);
    free(pattern);
}

static void read_named(
    struct scene_reader *reader, const struct scene_key *key, const struct spot *at)
{
    const struct scene_node *map = at->map;
    if (map->kind != NODE_MAPPING || map->n == 0) {
        const char *found = map->kind == NODE_MAPPING ? "an empty one" : scene_yaml_kind_name(map);
        scene_issue_at(
            reader, map, at->path, "expected a mapping of names to mappings, found %s", found);
        return;
    }
    char *records = new_records(key, at->record, map->n);
    char *pattern = fail_format("%s.NAME", at->pattern);
    scene_write_end(&reader->out);
    for (int k = 0; k < map->n; k++) {
        char *record = records + (size_t)k * key->size, *path = join(at->path, map->key[k]->text);
        const char *problem = scene_values_name_problem(map->key[k]);
        init_record(pattern, record);
        *(char **)(void *)(record + key->label_at - 1) = fail_strdup(map->key[k]->text);
        scene_write_key(&reader->out, at->depth + 1, map->key[k]->text);
        scene_write_end(&reader->out);
        struct spot entry = {pattern, path, map->item[k], record, at->depth + 2};
        if (problem) scene_issue_at(reader, map->key[k], path, "%s", problem);
        if (map->item[k]->kind == NODE_MAPPING) read_mapping(reader, &entry);
        else
            scene_issue_at(reader, map->item[k], path, "expected a mapping, found %s",
                scene_yaml_kind_name(map->item[k]));
        free(path);
    }
    report_duplicates(reader, map, at->path);
    free(pattern);
}

/* The value of a key that is there, or its default. `at` is the key's own spot, with its value in
 * place of the mapping. */
static void read_value(
    struct scene_reader *reader, const struct scene_key *key, const struct spot *at)
{
    set_mark(key, at->record);
    scene_write_key(&reader->out, at->depth, scene_key_name(key));
    if (key->type == KEY_MAP && key->special && at->map->kind == NODE_SCALAR &&
        strcmp(at->map->text, key->special) == 0) {
        scene_write_value(&reader->out, key->special);
    } else if (key->type == KEY_MAP || (key->type == KEY_SPAN && at->map->kind == NODE_MAPPING)) {
        if (at->map->kind != NODE_MAPPING) {
            const char *before = key->special ? ", or '" : "",
                       *word = key->special ? key->special : "", *end = key->special ? "'" : "";
            scene_issue_at(reader, at->map, at->path, "expected a mapping%s%s%s, found %s", before,
                word, end, scene_yaml_kind_name(at->map));
            return;
        }
        size_t opened = scene_write_open(&reader->out);
        struct spot inner = *at;
        inner.depth++;
        read_mapping(reader, &inner);
        scene_write_close(&reader->out, opened, "{}");
    } else if (key->type == KEY_LIST) read_list(reader, key, at);
    else if (key->type == KEY_NAMED) read_named(reader, key, at);
    else scene_values_read(reader, key, at->map, at->path, at->record);
}

static void read_default(struct scene_reader *reader, const struct scene_key *key, struct spot *at)
{
    struct scene_yaml_error error;
    struct scene_node *node = scene_yaml_parse(key->fallback, strlen(key->fallback), 0, &error);
    int before = reader->n_issue;
    assert(node && "a default of the table is no YAML");
    at->map = node;
    read_value(reader, key, at);
    scene_yaml_free(node);
    assert(reader->n_issue == before && "a default of the table is no good value");
    (void)before;
}

static void read_key(
    struct scene_reader *reader, const struct scene_key *key, const struct spot *at)
{
    const char *name = scene_key_name(key);
    char *path = join(at->path, name);
    int index;
    const struct scene_node *value = scene_yaml_get(at->map, name, &index);
    enum holds holds = condition(key, at);
    struct spot own = {key->path, path, value, at->record, at->depth};
    if (holds == HOLDS_NOT) {
        if (value)
            scene_issue_at(reader, at->map->key[index], path, "only valid with '%s'", key->when);
    } else if (value) {
        read_value(reader, key, &own);
    } else if (key->fallback) {
        read_default(reader, key, &own);
    } else if (key->need == NEEDED && holds == HOLDS && !is_misspelt(reader, at, name)) {
        if (key->when)
            scene_issue_at(reader, at->map, at->path, "missing key '%s' (%s)", name, key->when);
        else scene_issue_at(reader, at->map, at->path, "missing key '%s'", name);
    }
    free(path);
}

static void read_mapping(struct scene_reader *reader, const struct spot *at)
{
    for (int k = 0; k < scene_keys_n; k++)
        if (scene_key_is_child(&scene_keys[k], at->pattern) && belongs(reader, &scene_keys[k]))
            read_key(reader, &scene_keys[k], at);
    report_unknown(reader, at);
    report_duplicates(reader, at->map, at->path);
    report_alternatives(reader, at);
}

void scene_walk(struct scene_reader *reader)
{
    init_record("", reader->scene);
    if (reader->root->kind != NODE_MAPPING) {
        scene_issue_at(reader, reader->root, "", "expected a mapping, found %s",
            scene_yaml_kind_name(reader->root));
        return;
    }
    /* Until `method` has been read, and where it is wrong: what the scene looks like. */
    if (scene_yaml_get(reader->root, "bodies", NULL)) reader->scene->method = METHOD_LATTICE;
    read_mapping(reader,
        &(struct spot){.pattern = "", .path = "", .map = reader->root, .record = reader->scene});
}
