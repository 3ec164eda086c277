/* Values of keys: one reader per type. Each checks the node, stores the value in the record and
 * writes it, in SI, to the resolved text. */
#include <ctype.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "base/nearest.h"
#include "scene_values.h"
#include "units.h"

/* Bytes of a name, and of one that names NAME.csv. */
enum { MAX_WORDS = 32, LONGEST = 1000, LONGEST_FILE = 250 };

/* Splits "a|b|c" into `buffer`; returns the number of words. An empty word counts. */
static int split_words(const char *words, char *buffer, size_t size, const char **word)
{
    snprintf(buffer, size, "%s", words);
    int n = 0;
    for (char *p = buffer; p && n < MAX_WORDS;) {
        char *bar = strchr(p, '|');
        if (bar) *bar = '\0';
        word[n++] = p;
        p = bar ? bar + 1 : NULL;
    }
    return n;
}

void scene_values_join(char *text, size_t size, const char *const *word, int n)
{
    text[0] = '\0';
    for (int k = 0; k < n; k++) {
        size_t used = strlen(text);
        if (*word[k]) snprintf(text + used, size - used, "%s%s", used ? ", " : "", word[k]);
    }
}

/* Index of `text`, what the node says, among the words; -1, after a message, if it is none of
 * them. */
static int find_word(const struct scene_place *p, const struct scene_node *node, const char *text,
    const char *const *word, int n, const char *what)
{
    for (int k = 0; k < n; k++)
        if (*word[k] && strcmp(word[k], text) == 0) return k;
    const char *near = nearest_name(text, word, n);
    char all[512];
    scene_values_join(all, sizeof all, word, n);
    if (near && *near)
        scene_issue_at(p->reader, node, p->path, "unknown %s '%s'; did you mean '%s'?", what,
            node->text, near);
    else if (*all)
        scene_issue_at(p->reader, node, p->path, "unknown %s '%s'; expected one of: %s", what,
            node->text, all);
    else scene_issue_at(p->reader, node, p->path, "unknown %s '%s'", what, node->text);
    return -1;
}

static void write_number(const struct scene_place *p, double value)
{
    const struct scene_key *key = p->key;
    if (key->special && (value == key->special_value))
        scene_write(&p->reader->out, "%s", key->special);
    else scene_write_number(&p->reader->out, value);
}

static void store_number(const struct scene_place *p, double value, int n)
{
    double *to = scene_key_place(p->key, p->record);
    for (int k = 0; k < n && to; k++) to[k] = value * (p->key->factor != 0 ? p->key->factor : 1);
    scene_write(&p->reader->out, " ");
    write_number(p, value);
    scene_write_end(&p->reader->out);
}

static void read_vector(const struct scene_place *p, const struct scene_node *node)
{
    int n = p->key->width;
    double value[3];
    char expected[32];
    snprintf(expected, sizeof expected, "a list of %d numbers", n);
    if (!scene_is_kind(p, node, NODE_SEQUENCE, expected)) return;
    if (node->n != n) {
        scene_issue_at(p->reader, node, p->path, "expected %s, found %d", expected, node->n);
        return;
    }
    bool good = true;
    for (int k = 0; k < n; k++) {
        char *path = fail_format("%s[%d]", p->path, k);
        if (p->key->special && scene_yaml_is_null(node->item[k])) value[k] = p->key->special_value;
        else good = scene_number(p, node->item[k], path, &value[k]) && good;
        free(path);
    }
    if (!good) return;
    double *to = scene_key_place(p->key, p->record);
    if (to) memcpy(to, value, (size_t)n * sizeof *to);
    for (int k = 0; k < n; k++) {
        scene_write(&p->reader->out, "%s", k ? ", " : " [");
        write_number(p, value[k]);
    }
    scene_write(&p->reader->out, "]\n");
}

static void read_integer(const struct scene_place *p, const struct scene_node *node)
{
    double value;
    if (!scene_number(p, node, p->path, &value)) return;
    /* 2^53: beyond, doubles skip integers */
    if (value != floor(value) || fabs(value) > 9007199254740992.0) {
        scene_issue_at(p->reader, node, p->path, "expected a whole number, found %s", node->text);
        return;
    }
    long *to = scene_key_place(p->key, p->record);
    if (to) *to = (long)value;
    if (p->key->special && value == p->key->special_value)
        scene_write_value(&p->reader->out, p->key->special);
    else scene_write(&p->reader->out, " %ld\n", (long)value);
}

static void read_bool(const struct scene_place *p, const struct scene_node *node)
{
    bool is_true = node->kind == NODE_SCALAR && strcmp(node->text, "true") == 0;
    if (!is_true && !(node->kind == NODE_SCALAR && strcmp(node->text, "false") == 0)) {
        if (scene_is_kind(p, node, NODE_SCALAR, "true or false"))
            scene_issue_at(
                p->reader, node, p->path, "expected true or false, found '%s'", node->text);
        return;
    }
    bool *to = scene_key_place(p->key, p->record);
    if (to) *to = is_true;
    scene_write_value(&p->reader->out, is_true ? "true" : "false");
}

/* The word that is meant: the node's own, or today's name for it, of which a note tells. */
static const char *word_of_today(const struct scene_place *p, const struct scene_node *node)
{
    const char *bar = p->key->renamed ? strchr(p->key->renamed, '|') : NULL;
    if (!bar || strlen(node->text) != (size_t)(bar - p->key->renamed) ||
        strncmp(node->text, p->key->renamed, strlen(node->text)) != 0)
        return node->text;
    scene_errors_add(&p->reader->scene->notes,
        "%s: %s: '%s' is now called '%s'; the old name will go with the next release",
        p->reader->path, p->path, node->text, bar + 1);
    return bar + 1;
}

static void read_choice(const struct scene_place *p, const struct scene_node *node)
{
    char buffer[256];
    const char *word[MAX_WORDS];
    int n = split_words(p->key->words, buffer, sizeof buffer, word);
    if (!scene_is_kind(p, node, NODE_SCALAR, "a word")) return;
    int index = find_word(p, node, word_of_today(p, node), word, n, "word");
    if (index < 0) return;
    int *to = scene_key_place(p->key, p->record);
    if (to) *to = index;
    scene_write_value(&p->reader->out, word[index]);
}

static void read_text(const struct scene_place *p, const struct scene_node *node)
{
    if (node->kind != NODE_SCALAR && !scene_is_kind(p, node, NODE_SCALAR, "text")) return;
    if (p->key->type == KEY_NAME) {
        const char *problem = scene_values_name_problem(node);
        bool names_file = !strcmp(p->key->path, "measure[].name");
        if (!problem && names_file && strlen(node->text) > LONGEST_FILE)
            problem = "the name of a measure, and of its file, is at most 250 bytes long";
        if (problem) {
            scene_issue_at(p->reader, node, p->path, "%s", problem);
            return;
        }
    }
    char **to = scene_key_place(p->key, p->record);
    free(*to);
    *to = fail_strdup(node->text);
    scene_write(&p->reader->out, " ");
    scene_write_string(&p->reader->out, node->text);
    scene_write_end(&p->reader->out);
}

const char *scene_values_name_problem(const struct scene_node *node)
{
    if (node->kind != NODE_SCALAR || !*node->text) return "a name must not be empty";
    for (const char *c = node->text; *c; c++)
        if (!isalnum((unsigned char)*c) && *c != '_' && *c != '-' && (unsigned char)*c < 0x80)
            return "a name may hold letters, digits, '_' and '-' only";
    if (scene_write_has_unsafe(node->text))
        return "a name may hold letters, digits, '_' and '-' only";
    /* YAML looks no further for the colon after a key than 1024 characters. */
    if (strlen(node->text) > LONGEST) return "a name is at most 1000 bytes long";
    return NULL;
}

/* What a key refers to by name. */
static const char *referred_name(const struct scene *scene, enum key_type type, int k)
{
    const char *name = type == KEY_WALL   ? scene->wall[k].name
                       : type == KEY_BODY ? scene->body[k].name
                                          : scene->material[k].name;
    return name ? name : "";
}

/* Index of a material, wall or body by name; -1 and an issue if there is none. Silent where none
 * could be read at all: that has its own issue. */
static int find_reference(
    const struct scene_place *p, const struct scene_node *node, enum key_type type)
{
    const struct scene *scene = p->reader->scene;
    const char *what = type == KEY_WALL ? "wall" : type == KEY_BODY ? "body" : "material";
    const char *list = type == KEY_WALL ? "walls" : type == KEY_BODY ? "bodies" : "materials";
    int n = type == KEY_WALL ? scene->n_wall : type == KEY_BODY ? scene->n_body : scene->n_material;
    char expected[32];
    snprintf(expected, sizeof expected, "the name of a %s", what);
    if (!scene_is_kind(p, node, NODE_SCALAR, expected)) return -1;
    if (n == 0 && scene_issue_is_below(p->reader, list)) return -1;
    const char **name = fail_alloc((size_t)n * sizeof *name);
    for (int k = 0; k < n; k++) name[k] = referred_name(scene, type, k);
    int index = find_word(p, node, node->text, name, n, what);
    free(name);
    return index;
}

static void read_reference(const struct scene_place *p, const struct scene_node *node)
{
    int index = find_reference(p, node, p->key->type);
    if (index < 0) return;
    *(int *)scene_key_place(p->key, p->record) = index;
    scene_write(&p->reader->out, " ");
    scene_write_string(&p->reader->out, node->text);
    scene_write_end(&p->reader->out);
}

static void read_pair(const struct scene_place *p, const struct scene_node *node)
{
    if (!scene_is_kind(p, node, NODE_SEQUENCE, "a list of two materials")) return;
    if (node->n != 2) {
        scene_issue_at(
            p->reader, node, p->path, "expected a list of two materials, found %d", node->n);
        return;
    }
    int *to = scene_key_place(p->key, p->record);
    for (int k = 0; k < 2; k++) {
        struct scene_place own = *p;
        own.path = fail_format("%s[%d]", p->path, k);
        to[k] = find_reference(&own, node->item[k], KEY_MATERIAL);
        free((char *)own.path);
    }
    if (to[0] < 0 || to[1] < 0) return;
    scene_write(&p->reader->out, " [");
    scene_write_string(&p->reader->out, node->item[0]->text);
    scene_write(&p->reader->out, ", ");
    scene_write_string(&p->reader->out, node->item[1]->text);
    scene_write(&p->reader->out, "]\n");
}

/* Lists out of fixed words, each at most once: `index` gets those found. Returns their number. */
static int read_word_list(const struct scene_place *p, const struct scene_node *node,
    const char *words, const char *what, int *index)
{
    char buffer[256], expected[64];
    const char *word[MAX_WORDS];
    int n_word = split_words(words, buffer, sizeof buffer, word), n = 0;
    snprintf(expected, sizeof expected, "a list of %ss", what);
    if (!scene_is_kind(p, node, NODE_SEQUENCE, expected)) return 0;
    for (int k = 0; k < node->n; k++) {
        struct scene_place own = *p;
        own.path = fail_format("%s[%d]", p->path, k);
        int found = scene_is_kind(&own, node->item[k], NODE_SCALAR, "a word")
                        ? find_word(&own, node->item[k], node->item[k]->text, word, n_word, what)
                        : -1;
        bool again = false;
        for (int j = 0; j < n; j++) again = again || index[j] == found;
        if (found >= 0 && again)
            scene_issue_at(p->reader, node->item[k], own.path, "'%s' is listed twice", word[found]);
        else if (found >= 0) index[n++] = found;
        free((char *)own.path);
    }
    scene_write(&p->reader->out, " [");
    for (int k = 0; k < n; k++) scene_write(&p->reader->out, "%s%s", k ? ", " : "", word[index[k]]);
    scene_write(&p->reader->out, "]\n");
    return n;
}

static void read_axes(const struct scene_place *p, const struct scene_node *node)
{
    int index[MAX_WORDS];
    bool *to = scene_key_place(p->key, p->record);
    for (int k = read_word_list(p, node, p->key->words, "direction", index) - 1; k >= 0; k--)
        to[index[k]] = true;
}

static void read_words(const struct scene_place *p, const struct scene_node *node)
{
    char buffer[256];
    const char *word[MAX_WORDS];
    int index[MAX_WORDS], n = read_word_list(p, node, p->key->words, "field", index);
    split_words(p->key->words, buffer, sizeof buffer, word);
    char **list = fail_alloc((size_t)n * sizeof *list);
    for (int k = 0; k < n; k++) list[k] = fail_strdup(word[index[k]]);
    *(char ***)scene_key_place(p->key, p->record) = list;
    *(int *)((char *)p->record + p->key->count_at - 1) = n;
}

void scene_values_read(struct scene_reader *reader, const struct scene_key *key,
    const struct scene_node *node, const char *path, void *record)
{
    struct scene_place p = {reader, key, path, record};
    double value;
    switch (key->type) {
    case KEY_NUMBER:
        if (scene_number(&p, node, path, &value)) store_number(&p, value, 1);
        break;
    case KEY_SPAN: /* as a number: both ends */
        if (scene_number(&p, node, path, &value)) store_number(&p, value, 2);
        break;
    case KEY_VECTOR: read_vector(&p, node); break;
    case KEY_INTEGER: read_integer(&p, node); break;
    case KEY_BOOL: read_bool(&p, node); break;
    case KEY_CHOICE: read_choice(&p, node); break;
    case KEY_TEXT:
    case KEY_NAME: read_text(&p, node); break;
    case KEY_FILE: scene_table_file(&p, node); break;
    case KEY_MATERIAL:
    case KEY_WALL:
    case KEY_BODY: read_reference(&p, node); break;
    case KEY_PAIR: read_pair(&p, node); break;
    case KEY_AXES: read_axes(&p, node); break;
    case KEY_WORDS: read_words(&p, node); break;
    case KEY_TABLE: scene_table_read(&p, node); break;
    case KEY_MAP:
    case KEY_LIST:
    case KEY_NAMED: break; /* scene_read.c reads these itself */
    }
}
