/* Values that are files or come from them: paths, and tables of a factor over time. */
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "comm/fail.h"
#include "history.h"
#include "scene_values.h"

/* The file that the node names, if it can be read: as usable from the working directory, and
 * without links. Both are the caller's. */
static bool find_file(
    const struct scene_place *p, const struct scene_node *node, char **as_given, char **absolute)
{
    const char *folder = node->text[0] == '/' ? "" : p->reader->folder;
    char *file = fail_format("%s%s", folder, node->text);
    struct stat info;
    const char *problem = NULL;
    if (stat(file, &info) != 0) problem = strerror(errno);
    else if (!S_ISREG(info.st_mode)) problem = "not a file";
    else if (access(file, R_OK) != 0) problem = strerror(errno);
    *absolute = problem ? NULL : realpath(file, NULL);
    if (!problem && !*absolute) problem = strerror(errno);
    if (!problem) {
        *as_given = file;
        return true;
    }
    scene_issue_at(p->reader, node, p->path, "cannot read '%s': %s", file, problem);
    free(file);
    return false;
}

void scene_table_file(const struct scene_place *p, const struct scene_node *node)
{
    char *file, *absolute;
    if (!scene_is_kind(p, node, NODE_SCALAR, "the path of a file") ||
        !find_file(p, node, &file, &absolute))
        return;
    char **to = scene_key_place(p->key, p->record);
    free(*to);
    *to = file;
    scene_write(&p->reader->out, " ");
    scene_write_string(&p->reader->out, absolute);
    scene_write_end(&p->reader->out);
    free(absolute);
}

/* A list of pairs of time and factor into *point; false with an issue where it is none. */
static bool read_pairs(
    const struct scene_place *p, const struct scene_node *node, double (**point)[2])
{
    bool good = node->n > 0;
    if (!good)
        scene_issue_at(
            p->reader, node, p->path, "expected a list of pairs, or a file, found an empty list");
    *point = fail_alloc((size_t)node->n * sizeof **point);
    struct scene_key factor = *p->key;
    factor.unit = UNIT_NONE;
    for (int k = 0; k < node->n; k++) {
        const struct scene_node *pair = node->item[k];
        struct scene_place own = *p, second = *p;
        second.key = &factor;
        own.path = fail_format("%s[%d]", p->path, k);
        bool is_pair = pair->kind == NODE_SEQUENCE && pair->n == 2;
        if (!is_pair) scene_issue_at(p->reader, pair, own.path, "expected [time, factor]");
        bool read = is_pair && scene_number(&own, pair->item[0], own.path, &(*point)[k][0]);
        good = read && scene_number(&second, pair->item[1], own.path, &(*point)[k][1]) && good;
        if (read && good && k > 0 && !((*point)[k][0] > (*point)[k - 1][0])) {
            scene_issue_at(p->reader, pair, own.path, "times must increase");
            good = false;
        }
        free((char *)own.path);
    }
    return good;
}

void scene_table_read(const struct scene_place *p, const struct scene_node *node)
{
    struct history table = {.n_point = node->n};
    char *file = NULL, *absolute = NULL, *problem = NULL;
    bool good = false;
    if (node->kind == NODE_SEQUENCE) good = read_pairs(p, node, &table.point);
    else if (scene_is_kind(p, node, NODE_SCALAR, "a list of pairs, or a file,") &&
             find_file(p, node, &file, &absolute)) {
        problem = history_read(&table, file);
        good = !problem;
        if (problem) scene_issue_at(p->reader, node, p->path, "%s", problem);
    }
    if (good && absolute) {
        scene_write(&p->reader->out, " ");
        scene_write_string(&p->reader->out, absolute);
    } else if (good) {
        for (int k = 0; k < table.n_point; k++) {
            scene_write(&p->reader->out, k ? ", [" : " [[");
            scene_write_number(&p->reader->out, table.point[k][0]);
            scene_write(&p->reader->out, ", ");
            scene_write_number(&p->reader->out, table.point[k][1]);
            scene_write(&p->reader->out, "]");
        }
        scene_write(&p->reader->out, "]");
    }
    scene_write_end(&p->reader->out);
    *(double(**)[2])scene_key_place(p->key, p->record) = table.point;
    *(int *)(void *)((char *)p->record + p->key->count_at - 1) = good ? table.n_point : 0;
    free(problem);
    free(file);
    free(absolute);
}
