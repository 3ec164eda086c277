#include "scene_yaml.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <yaml.h>

#include "base/nesting.h"
#include "comm/fail.h"

/* Aliases could blow a few lines up to any size, or contain themselves. */
enum { MAX_DEPTH = NESTING_MOST, MAX_NODES = 1000000, MAX_BYTES = 1 << 26 };

struct conversion {
    yaml_document_t *document;
    struct scene_yaml_error *error;
    int set, n_node;
    size_t n_byte; /* of text, as often as it is said */
};

static struct scene_node *new_node(enum scene_node_kind kind, int set, int line, int column)
{
    struct scene_node *node = fail_alloc(sizeof *node);
    node->kind = kind;
    node->set = set;
    node->line = line;
    node->column = column;
    return node;
}

struct scene_node *scene_yaml_new_mapping(int set, int line, int column)
{
    return new_node(NODE_MAPPING, set, line, column);
}

void scene_yaml_free(struct scene_node *node)
{
    if (!node) return;
    for (int k = 0; k < node->n; k++) {
        if (node->key) scene_yaml_free(node->key[k]);
        scene_yaml_free(node->item[k]);
    }
    free(node->key);
    free(node->item);
    free(node->text);
    free(node);
}

static struct scene_node *refuse(
    struct conversion *c, const yaml_node_t *from, struct scene_node *half, const char *why)
{
    c->error->line = (int)from->start_mark.line + 1;
    c->error->column = (int)from->start_mark.column + 1;
    snprintf(c->error->text, sizeof c->error->text, "%s", why);
    scene_yaml_free(half);
    return NULL;
}

static struct scene_node *convert(struct conversion *c, int id, int depth)
{
    const yaml_node_t *from = yaml_document_get_node(c->document, id);
    if (depth > MAX_DEPTH)
        return refuse(c, from, NULL, "nested too deeply (an alias that contains itself?)");
    if (++c->n_node > MAX_NODES)
        return refuse(c, from, NULL, "too large: bulk data belong into files of their own");
    struct scene_node *node = new_node(
        NODE_SCALAR, c->set, (int)from->start_mark.line + 1, (int)from->start_mark.column + 1);
    if (from->type == YAML_SCALAR_NODE) {
        const char *bytes = (const char *)from->data.scalar.value;
        if (strlen(bytes) != from->data.scalar.length)
            return refuse(c, from, node, "text with a null character");
        c->n_byte += from->data.scalar.length;
        if (c->n_byte > MAX_BYTES)
            return refuse(c, from, node, "too large: bulk data belong into files of their own");
        node->text = fail_strdup(bytes);
        node->plain = from->data.scalar.style == YAML_PLAIN_SCALAR_STYLE;
    } else if (from->type == YAML_SEQUENCE_NODE) {
        node->kind = NODE_SEQUENCE;
        size_t n = (size_t)(from->data.sequence.items.top - from->data.sequence.items.start);
        node->item = fail_alloc(n * sizeof *node->item);
        for (size_t k = 0; k < n; k++, node->n++)
            if (!(node->item[k] = convert(c, from->data.sequence.items.start[k], depth + 1)))
                return scene_yaml_free(node), NULL;
    } else {
        node->kind = NODE_MAPPING;
        size_t n = (size_t)(from->data.mapping.pairs.top - from->data.mapping.pairs.start);
        node->key = fail_alloc(n * sizeof *node->key);
        node->item = fail_alloc(n * sizeof *node->item);
        for (size_t k = 0; k < n; k++) {
            const yaml_node_pair_t *pair = &from->data.mapping.pairs.start[k];
            const yaml_node_t *name = yaml_document_get_node(c->document, pair->key);
            if (name->type != YAML_SCALAR_NODE)
                return refuse(c, name, node, "a key must be a word, not a list or mapping");
            node->key[k] = convert(c, pair->key, depth + 1);
            node->item[k] = node->key[k] ? convert(c, pair->value, depth + 1) : NULL;
            node->n++; /* before the way out, so that the key is freed */
            if (!node->item[k]) return scene_yaml_free(node), NULL;
        }
    }
    return node;
}

/* Length of the UTF-8 character at p (n bytes left), 0 if it is none. Overlong forms and surrogates
 * are none. */
static size_t utf8_length(const unsigned char *p, size_t n)
{
    if (p[0] < 0x80) return 1;
    size_t length = p[0] >= 0xc2 && p[0] <= 0xdf   ? 2
                    : p[0] >= 0xe0 && p[0] <= 0xef ? 3
                    : p[0] >= 0xf0 && p[0] <= 0xf4 ? 4
                                                   : 0;
    if (length == 0 || length > n) return 0;
    for (size_t k = 1; k < length; k++)
        if ((p[k] & 0xc0) != 0x80) return 0;
    if ((p[0] == 0xe0 && p[1] < 0xa0) || (p[0] == 0xed && p[1] > 0x9f) ||
        (p[0] == 0xf0 && p[1] < 0x90) || (p[0] == 0xf4 && p[1] > 0x8f))
        return 0;
    return length;
}

/* Line and column of the first character that no YAML text may hold; false if there is none. */
static bool find_bad_character(const char *text, size_t length, struct scene_yaml_error *error)
{
    int line = 1, column = 1;
    for (size_t k = 0; k < length;) {
        const unsigned char *p = (const unsigned char *)text + k;
        size_t step = utf8_length(p, length - k);
        bool control =
            step == 1 && (*p < 0x20 || *p == 0x7f) && *p != '\t' && *p != '\n' && *p != '\r';
        if (step == 0 || control) {
            error->line = line;
            error->column = column;
            if (step == 0)
                snprintf(error->text, sizeof error->text, "not UTF-8 text (byte 0x%02x)", *p);
            else snprintf(error->text, sizeof error->text, "control character 0x%02x", *p);
            return true;
        }
        column++;
        if (*p == '\n') line++, column = 1;
        k += step;
    }
    return false;
}

/* The parser's own complaint: where the problem is, else where its context began. */
static void take_problem(const yaml_parser_t *parser, struct scene_yaml_error *error)
{
    error->line = (int)parser->problem_mark.line + 1;
    error->column = (int)parser->problem_mark.column + 1;
    const char *problem = parser->problem ? parser->problem : "cannot be parsed";
    if (parser->context)
        snprintf(error->text, sizeof error->text, "not valid YAML: %s, %s (from line %d)", problem,
            parser->context, (int)parser->context_mark.line + 1);
    else snprintf(error->text, sizeof error->text, "not valid YAML: %s", problem);
}

/* A second document: one more load that finds a root. */
static bool has_more(yaml_parser_t *parser, struct scene_yaml_error *error)
{
    yaml_document_t next;
    if (!yaml_parser_load(parser, &next)) {
        take_problem(parser, error);
        return true;
    }
    const yaml_node_t *root = yaml_document_get_root_node(&next);
    if (root) {
        error->line = (int)next.start_mark.line + 1;
        error->column = (int)next.start_mark.column + 1;
        snprintf(error->text, sizeof error->text, "a second document; a scene is one document");
    }
    yaml_document_delete(&next);
    return root;
}

struct scene_node *scene_yaml_parse(
    const char *text, size_t length, int set, struct scene_yaml_error *error)
{
    /* a byte order mark, as some editors write */
    if (length >= 3 && memcmp(text, "\xef\xbb\xbf", 3) == 0) {
        text += 3;
        length -= 3;
    }
    if (find_bad_character(text, length, error)) return NULL;
    if (nesting_is_too_deep(text, length, &error->line, &error->column)) {
        snprintf(error->text, sizeof error->text, "nested too deeply, more than %d levels",
            NESTING_MOST);
        return NULL;
    }
    yaml_parser_t parser;
    yaml_document_t document;
    if (!yaml_parser_initialize(&parser)) fail_stop(EXIT_IO, "out of memory in the YAML parser");
    yaml_parser_set_encoding(&parser, YAML_UTF8_ENCODING);
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, length);
    struct scene_node *node = NULL;
    if (!yaml_parser_load(&parser, &document)) {
        take_problem(&parser, error);
    } else {
        if (!yaml_document_get_root_node(&document)) {
            *error = (struct scene_yaml_error){.line = 1, .column = 1, .text = "the file is empty"};
        } else {
            struct conversion c = {.document = &document, .error = error, .set = set};
            node = convert(&c, 1, 0);
            if (node && has_more(&parser, error)) {
                scene_yaml_free(node);
                node = NULL;
            }
        }
        yaml_document_delete(&document);
    }
    yaml_parser_delete(&parser);
    return node;
}

struct scene_node *scene_yaml_get(const struct scene_node *node, const char *name, int *index)
{
    if (node->kind != NODE_MAPPING) return NULL;
    for (int k = 0; k < node->n; k++) {
        if (strcmp(node->key[k]->text, name) != 0) continue;
        if (index) *index = k;
        return node->item[k];
    }
    return NULL;
}

void scene_yaml_put(struct scene_node *node, const char *name, struct scene_node *value)
{
    assert(node->kind == NODE_MAPPING);
    int k = node->n;
    if (scene_yaml_get(node, name, &k)) {
        scene_yaml_free(node->item[k]);
        scene_yaml_free(node->key[k]);
    } else {
        size_t n = (size_t)++node->n;
        node->key = fail_realloc(node->key, n * sizeof *node->key);
        node->item = fail_realloc(node->item, n * sizeof *node->item);
    }
    node->key[k] = new_node(NODE_SCALAR, value->set, value->line, value->column);
    node->key[k]->text = fail_strdup(name);
    node->item[k] = value;
}

void scene_yaml_remove(struct scene_node *node, const char *name)
{
    int k;
    if (!scene_yaml_get(node, name, &k)) return;
    scene_yaml_free(node->key[k]);
    scene_yaml_free(node->item[k]);
    node->n--;
    for (; k < node->n; k++) {
        node->key[k] = node->key[k + 1];
        node->item[k] = node->item[k + 1];
    }
}

bool scene_yaml_is_null(const struct scene_node *node)
{
    if (node->kind != NODE_SCALAR || !node->plain) return false;
    return strcmp(node->text, "") == 0 || strcmp(node->text, "~") == 0 ||
           strcmp(node->text, "null") == 0;
}

const char *scene_yaml_kind_name(const struct scene_node *node)
{
    if (node->kind == NODE_MAPPING) return "a mapping";
    if (node->kind == NODE_SEQUENCE) return "a list";
    return scene_yaml_is_null(node) ? "nothing" : "text";
}
