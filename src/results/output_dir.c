#include "output_dir.h"
#include "comm/fail.h"
#include "base/files.h"
#include "base/nesting.h"
#include "frame_list.h"
#include "log.h"
#include "output_names.h"
#include "series.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <yaml.h>

/* What rank 0 found, for all: an exit code (0: fine) and its message. */
struct outcome {
    int code;
    char text[FILES_ERROR_SIZE];
};

static bool fail_with(struct outcome *outcome, int code, const char *what, const char *path)
{
    outcome->code = code;
    snprintf(
        outcome->text, sizeof outcome->text, "cannot %s '%s': %s", what, path, strerror(errno));
    return false;
}

static bool make_folders(const char *dir, struct outcome *outcome)
{
    char *path = fail_strdup(dir);
    bool ok = true;
    for (char *c = path + 1; ok; c++) {
        if (*c != '/' && *c != '\0') continue;
        char kept = *c;
        *c = '\0';
        if (mkdir(path, 0777) && errno != EEXIST)
            ok = fail_with(outcome, EXIT_IO, "create the folder", path);
        *c = kept;
        if (kept == '\0') break;
    }
    free(path);
    struct stat status;
    if (ok && stat(dir, &status)) ok = fail_with(outcome, EXIT_IO, "open", dir);
    if (ok && !S_ISDIR(status.st_mode)) {
        errno = ENOTDIR;
        ok = fail_with(outcome, EXIT_IO, "write results into", dir);
    }
    if (ok && access(dir, W_OK | X_OK)) ok = fail_with(outcome, EXIT_IO, "write into", dir);
    return ok;
}

/* Held until the process ends, however it ends. A file system that knows no locks does without. */
static bool lock(const char *dir, struct outcome *outcome)
{
    int fd = open(dir, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (fd < 0) return fail_with(outcome, EXIT_IO, "open the folder", dir);
    if (flock(fd, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return true;
    close(fd);
    outcome->code = EXIT_USAGE;
    snprintf(outcome->text, sizeof outcome->text, "another run is still writing into '%s'%s", dir,
        output_dir_stop_asked(dir) ? "; it has been asked to stop" : "");
    return false;
}

static bool exists(const char *dir, const char *name)
{
    char *path = fail_format("%s/%s", dir, name);
    struct stat status;
    bool found = lstat(path, &status) == 0;
    free(path);
    return found;
}

static bool remove_file(const char *dir, const char *name, struct outcome *outcome)
{
    char *path = fail_format("%s/%s", dir, name);
    bool ok = unlink(path) == 0 || errno == ENOENT || fail_with(outcome, EXIT_IO, "remove", path);
    free(path);
    return ok;
}

/* Somebody else's file with the name of a measure stays. */
static void remove_old(const char *dir, const char *measure)
{
    char *path = fail_format("%s/%s.csv", dir, measure);
    if (!strchr(measure, '/') && series_is_ours(path)) unlink(path); /* never outside of dir */
    free(path);
}

static bool holds_results(const char *dir)
{
    DIR *folder = opendir(dir);
    bool found = false;
    for (struct dirent *entry; folder && (entry = readdir(folder));)
        found |= output_names_are_results(entry->d_name);
    if (folder) closedir(folder);
    return found;
}

static yaml_node_t *value_of(yaml_document_t *document, yaml_node_t *map, const char *key)
{
    if (!map || map->type != YAML_MAPPING_NODE) return NULL;
    for (yaml_node_pair_t *pair = map->data.mapping.pairs.start; pair < map->data.mapping.pairs.top;
         pair++) {
        yaml_node_t *name = yaml_document_get_node(document, pair->key);
        if (name && name->type == YAML_SCALAR_NODE &&
            !strcmp((const char *)name->data.scalar.value, key)) {
            return yaml_document_get_node(document, pair->value);
        }
    }
    return NULL;
}

/* The run before may have had other measures: their names stand in the scene that it left. What
 * cannot be read names none. */
static void remove_old_series(const char *dir)
{
    char error[FILES_ERROR_SIZE], *path = fail_format("%s/resolved.yaml", dir);
    size_t n;
    char *text = files_read(path, &n, error);
    free(path);
    int line, column;
    if (!text) return;
    if (nesting_is_too_deep(text, n, &line, &column)) {
        free(text);
        return;
    }
    yaml_parser_t parser;
    yaml_document_t document;
    if (!yaml_parser_initialize(&parser)) fail_stop(EXIT_IO, "out of memory");
    yaml_parser_set_input_string(&parser, (const unsigned char *)text, n);
    if (yaml_parser_load(&parser, &document)) {
        yaml_node_t *list = value_of(&document, yaml_document_get_root_node(&document), "measure");
        bool is_list = list && list->type == YAML_SEQUENCE_NODE;
        for (yaml_node_item_t *item = is_list ? list->data.sequence.items.start : NULL;
             item && item < list->data.sequence.items.top; item++) {
            yaml_node_t *name =
                value_of(&document, yaml_document_get_node(&document, *item), "name");
            if (name && name->type == YAML_SCALAR_NODE)
                remove_old(dir, (const char *)name->data.scalar.value);
        }
        yaml_document_delete(&document);
    }
    yaml_parser_delete(&parser);
    free(text);
}

/* A folder in the place of a file of this run, or of one that goes: nothing can be replaced then,
 * and nothing is to be lost. */
static bool is_blocked(const char *dir, const char *name, struct outcome *outcome)
{
    char *path = fail_format("%s/%s", dir, name);
    struct stat status;
    bool blocked = lstat(path, &status) == 0 && S_ISDIR(status.st_mode);
    if (blocked) {
        errno = EISDIR;
        fail_with(outcome, EXIT_IO, "replace", path);
    }
    free(path);
    return blocked;
}

static bool are_blocked(
    const struct output_request *request, bool is_ours_already, struct outcome *outcome)
{
    static const char *const fixed[] = {"scene.yaml", "resolved.yaml", "log.txt", "run.json",
        "stop", "run.balance.csv", FRAME_LIST_NAME, "trace.json"};
    bool blocked = false;
    for (size_t k = 0; k < sizeof fixed / sizeof *fixed - !request->trace && !blocked; k++)
        blocked = is_blocked(request->dir, fixed[k], outcome);
    for (int k = 0; k < request->n_measure && !blocked; k++) {
        char *name = fail_format("%s.csv", request->measure[k]);
        blocked = is_blocked(request->dir, name, outcome);
        free(name);
    }
    DIR *folder = is_ours_already ? opendir(request->dir) : NULL;
    for (struct dirent *entry; folder && !blocked && (entry = readdir(folder));)
        blocked = output_names_are_ours(entry->d_name) &&
                  is_blocked(request->dir, entry->d_name, outcome);
    if (folder) closedir(folder);
    return blocked;
}

static bool remove_ours(const char *dir, struct outcome *outcome)
{
    DIR *folder = opendir(dir);
    if (!folder) return fail_with(outcome, EXIT_IO, "read the folder", dir);
    bool ok = true;
    for (struct dirent *entry; (entry = readdir(folder));) {
        if (output_names_are_ours(entry->d_name))
            ok = remove_file(dir, entry->d_name, outcome) && ok;
    }
    closedir(folder);
    return ok;
}

/* A text of the user's own that a file of ours would replace. */
static bool differs(const char *dir, const char *name, const char *text, size_t n)
{
    char error[FILES_ERROR_SIZE], *path = fail_format("%s/%s", dir, name);
    size_t n_there = 0;
    char *there = files_read(path, &n_there, error);
    bool other = there ? n_there != n || memcmp(there, text, n) : exists(dir, name);
    free(there);
    free(path);
    return other;
}

/* What is there already stays: it may be the very scene that is run, or a link to it. */
static bool put_file(
    const char *dir, const char *name, const char *text, size_t n, struct outcome *outcome)
{
    char *path = fail_format("%s/%s", dir, name);
    bool is_there = exists(dir, name) && !differs(dir, name, text, n),
         ok = is_there || files_replace(path, text, n, outcome->text);
    if (!ok) outcome->code = EXIT_IO;
    free(path);
    return ok;
}

/* A CSV of the user's own, perhaps what the scene reads, that a series would replace. */
static bool is_other_series(const char *dir, const char *name)
{
    char *file = fail_format("%s.csv", name), *path = fail_format("%s/%s", dir, file);
    bool other = exists(dir, file) && !series_is_ours(path);
    free(file);
    free(path);
    return other;
}

static bool is_other_list(const char *dir)
{
    char *path = fail_format("%s/" FRAME_LIST_NAME, dir);
    bool other = exists(dir, FRAME_LIST_NAME) && !frame_list_is_ours(path);
    free(path);
    return other;
}

/* Whoever touches a file `stop` asks a run to stop; what is longer is a file of its own. */
static bool is_other_stop(const char *dir)
{
    char *path = fail_format("%s/stop", dir);
    struct stat status;
    bool other = lstat(path, &status) == 0 && (!S_ISREG(status.st_mode) || status.st_size > 1);
    free(path);
    return other;
}

/* Each run writes these anew. */
static bool is_other(const struct output_request *request, const char *scene, size_t n_scene,
    char *what, size_t room)
{
    const char *dir = request->dir, *resolved = request->resolved, *found = NULL;
    if (differs(dir, "scene.yaml", scene, n_scene)) found = "another scene.yaml";
    else if (differs(dir, "resolved.yaml", resolved, strlen(resolved)))
        found = "another resolved.yaml";
    else if (exists(dir, "log.txt")) found = "a file log.txt that no run has written";
    else if (request->trace && exists(dir, "trace.json"))
        found = "a file trace.json that no run has written";
    else if (is_other_list(dir)) found = "a file " FRAME_LIST_NAME " that no run has written";
    else if (is_other_stop(dir)) found = "a file stop that is not empty and would end the run";
    snprintf(what, room, "%s", found ? found : "");
    return found;
}

/* What DIR holds that this run would destroy, or "". */
static void find_others(const struct output_request *request, const char *scene, size_t n_scene,
    bool is_ours_already, char *what, size_t room)
{
    what[0] = '\0';
    if (holds_results(request->dir)) {
        snprintf(what, room, "results already");
        return;
    }
    if (!is_ours_already && is_other(request, scene, n_scene, what, room)) return;
    for (int k = 0; k < request->n_measure; k++)
        if (is_other_series(request->dir, request->measure[k])) {
            snprintf(what, room, "a file %s.csv, the name of a measure", request->measure[k]);
            return;
        }
    if (is_other_series(request->dir, "run.balance"))
        snprintf(what, room, "a file run.balance.csv that no run has written");
}

/* Before this run makes them anew: with --force, or known to be those of a run. */
static bool remove_replaced(const struct output_request *request, struct outcome *outcome)
{
    const char *dir = request->dir;
    bool ok = remove_file(dir, "log.txt", outcome) && remove_file(dir, "stop", outcome) &&
              remove_file(dir, "run.balance.csv", outcome);
    for (int k = 0; k < request->n_measure && ok; k++) {
        char *name = fail_format("%s.csv", request->measure[k]);
        ok = remove_file(dir, name, outcome);
        free(name);
    }
    return ok;
}

static void create(const struct output_request *request, struct outcome *outcome)
{
    const char *dir = request->dir, *scene = request->scene;
    size_t n_scene = request->n_scene;
    if (!make_folders(dir, outcome) || !lock(dir, outcome)) return;
    /* the latter: a run that was killed before its first frame */
    bool is_ours_already = holds_results(dir) || log_is_ours(dir);
    char why[300];
    find_others(request, scene, n_scene, is_ours_already, why, sizeof why);
    if (why[0] && !request->force) {
        outcome->code = EXIT_USAGE;
        snprintf(outcome->text, sizeof outcome->text,
            "'%s' holds %s; --force replaces, -o DIR writes elsewhere", dir, why);
        return;
    }
    if (are_blocked(request, is_ours_already, outcome)) return;
    if (is_ours_already) {
        remove_old_series(dir);
        if (!remove_ours(dir, outcome)) return;
    }
    if (!remove_replaced(request, outcome)) return;
    if (put_file(dir, "scene.yaml", scene, n_scene, outcome))
        put_file(dir, "resolved.yaml", request->resolved, strlen(request->resolved), outcome);
}

void output_dir_create(const struct comm *comm, const struct output_request *request)
{
    /* a limit on file sizes shall come back as an error of write, with a message, not kill the
     * run */
    signal(SIGXFSZ, SIG_IGN);
    struct outcome outcome = {0, ""};
    if (comm->rank == 0) create(request, &outcome);
    comm_bcast(comm, &outcome, sizeof outcome, 0);
    if (outcome.code) fail_stop_together(outcome.code, "%s", outcome.text);
}

static void take_up(const struct output_request *request, int64_t index, struct outcome *outcome)
{
    const char *dir = request->dir;
    if (access(dir, W_OK | X_OK)) {
        fail_with(outcome, EXIT_IO, "write into", dir);
        return;
    }
    if (!lock(dir, outcome)) return;
    DIR *folder = opendir(dir);
    bool ok = folder || fail_with(outcome, EXIT_IO, "read the folder", dir);
    for (struct dirent *entry; folder && (entry = readdir(folder));)
        if (output_names_are_over(entry->d_name, index))
            ok = remove_file(dir, entry->d_name, outcome) && ok;
    if (folder) closedir(folder);
    if (ok) put_file(dir, "resolved.yaml", request->resolved, strlen(request->resolved), outcome);
}

void output_dir_resume(const struct comm *comm, const struct output_request *request, int64_t index)
{
    signal(SIGXFSZ, SIG_IGN);
    struct outcome outcome = {0, ""};
    if (comm->rank == 0) take_up(request, index, &outcome);
    comm_bcast(comm, &outcome, sizeof outcome, 0);
    if (outcome.code) fail_stop_together(outcome.code, "%s", outcome.text);
}

bool output_dir_stop_asked(const char *dir)
{
    return exists(dir, "stop");
}
