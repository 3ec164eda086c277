/* Issues of one reading: collected with their place, sorted at the end. */
#include <limits.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "scene_path.h"
#include "scene_reader.h"

static void add(struct scene_reader *reader, const struct scene_node *node, const char *path,
    const char *format, va_list args)
{
    char *text = fail_vformat(format, args);
    struct scene_issue issue = {
        .set = node->set, .line = node->line, .column = node->column, .order = reader->n_issue};
    issue.path = fail_strdup(path);
    const char *colon = *path ? ": " : "";
    if (node->set > 0)
        issue.text = fail_format("--set %s: %s%s%s", reader->set[node->set - 1], path, colon, text);
    else
        issue.text = fail_format(
            "%s:%d:%d: %s%s%s", reader->path, node->line, node->column, path, colon, text);
    free(text);
    reader->issue =
        fail_realloc(reader->issue, (size_t)(reader->n_issue + 1) * sizeof *reader->issue);
    reader->issue[reader->n_issue++] = issue;
}

void scene_issue_at(struct scene_reader *reader, const struct scene_node *node, const char *path,
    const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add(reader, node, path, format, args);
    va_end(args);
}

void scene_issue_on(struct scene_reader *reader, const char *path, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    add(reader, scene_path_deepest(reader->root, path), path, format, args);
    va_end(args);
}

bool scene_issue_is_below(const struct scene_reader *reader, const char *path)
{
    size_t n = strlen(path);
    for (int k = 0; k < reader->n_issue; k++) {
        const char *other = reader->issue[k].path;
        if (strncmp(other, path, n) == 0 &&
            (other[n] == '\0' || other[n] == '.' || other[n] == '['))
            return true;
    }
    return false;
}

static int by_place(const void *a, const void *b)
{
    const struct scene_issue *x = a, *y = b;
    if (x->set != y->set) return x->set < y->set ? -1 : 1;
    if (x->line != y->line) return x->line < y->line ? -1 : 1;
    if (x->column != y->column) return x->column < y->column ? -1 : 1;
    return x->order < y->order ? -1 : x->order > y->order;
}

void scene_issue_report(struct scene_reader *reader, struct scene_errors *errors)
{
    if (reader->n_issue > 0)
        qsort(reader->issue, (size_t)reader->n_issue, sizeof *reader->issue, by_place);
    for (int k = 0; k < reader->n_issue; k++) scene_errors_add(errors, "%s", reader->issue[k].text);
}

void scene_issue_free(struct scene_reader *reader)
{
    for (int k = 0; k < reader->n_issue; k++) {
        free(reader->issue[k].path);
        free(reader->issue[k].text);
    }
    free(reader->issue);
}
