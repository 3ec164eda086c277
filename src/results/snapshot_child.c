/* A frame is checked in a process of its own: this program once more, with a command that no user
 * is told of, and without MPI. HDF5 1.10 crashes on some damaged files (a link table that it has
 * only half filled is freed), and may loop on others.
 *
 * Started by posix_spawn, which runs none of the handlers that MPI libraries have for fork. Every
 * rank checks its share of the rows and opens the file by itself: what is damaged may fail on one
 * rank and not on others, and then none must wait inside of HDF5. */
#define _GNU_SOURCE /* pipe2 */
#include "snapshot.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "comm/fail.h"
#include "h5_check.h"
#include "snapshot_walk.h"

extern char **environ;

static const char command[] = "check-frame";

/* No core file, and an end to whatever loops: by time of computing, since a slow file system is no
 * fault of the frame. A byte takes some nanoseconds. */
static void limit_child(const char *path)
{
    enum { SECONDS = 10, BYTES_PER_SECOND = 20000000 };
    struct stat status = {.st_size = 0};
    struct rlimit none = {0, 0}, cpu = {SECONDS, SECONDS};
    if (stat(path, &status) == 0) cpu.rlim_cur += (rlim_t)(status.st_size / BYTES_PER_SECOND);
    cpu.rlim_max = cpu.rlim_cur;
    setrlimit(RLIMIT_CORE, &none);
    setrlimit(RLIMIT_CPU, &cpu);
}

/* One line, whatever names the file has. */
static void put_line(const char *before, const char *text)
{
    fputs(before, stdout);
    for (; *text; text++) putchar((unsigned char)*text < ' ' ? '?' : *text);
    putchar('\n');
}

void snapshot_serve(int argc, char **argv)
{
    if (argc != 5 || strcmp(argv[1], command) != 0) return;
    struct snapshot_walk w = {.part = atoi(argv[3]), .n_part = atoi(argv[4])};
    if (w.n_part < 1 || w.part < 0 || w.part >= w.n_part) _exit(EXIT_USAGE);
    limit_child(argv[2]);
    char *wrong = snapshot_walk(&w, argv[2]);
    if (wrong) put_line("wrong ", wrong);
    for (int64_t k = 0; k < w.n && !wrong; k++) {
        char sums[64];
        snprintf(sums, sizeof sums, "sums %016" PRIx64 " %016" PRIx64 " ", w.sum[k], w.expected[k]);
        put_line(sums, w.path[k]);
    }
    put_line("end", "");
    /* nothing else is left to do, and HDF5 may have lost count of what it has open */
    _exit(fflush(stdout) == 0 ? EXIT_DONE : EXIT_IO);
}

/* Starts the child with its standard output in a pipe. */
static pid_t start_child(const struct snapshot_walk *w, const char *path, int *from)
{
    char part[16], n_part[16], name[] = "democles", verb[sizeof command];
    char *file = fail_strdup(path), *argv[] = {name, verb, file, part, n_part, NULL};
    posix_spawn_file_actions_t actions;
    int ends[2];
    pid_t child;
    memcpy(verb, command, sizeof command);
    snprintf(part, sizeof part, "%d", w->part);
    snprintf(n_part, sizeof n_part, "%d", w->n_part);
    if (pipe2(ends, O_CLOEXEC)) fail_stop(EXIT_IO, "cannot make a pipe: %s", strerror(errno));
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    int code = posix_spawn(&child, "/proc/self/exe", &actions, NULL, argv, environ);
    if (code)
        fail_stop(EXIT_IO, "cannot start a process that checks '%s': %s", path, strerror(code));
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    free(file);
    *from = ends[0];
    return child;
}

/* One line of the child's; returns whether it is the last. */
static bool take_line(struct snapshot_walk *w, char *line, char **wrong)
{
    uint64_t sum, expected;
    int at = 0;
    line[strcspn(line, "\n")] = '\0';
    if (!strncmp(line, "wrong ", 6) && !*wrong) *wrong = fail_strdup(line + 6);
    if (sscanf(line, "sums %" SCNx64 " %" SCNx64 " %n", &sum, &expected, &at) == 2 && at > 0)
        snapshot_walk_add(w, line + at, sum, expected);
    return !strcmp(line, "end");
}

/* Walks in a child. Returns what is wrong, or NULL. */
static char *ask_child(struct snapshot_walk *w, const char *path)
{
    int from, status = 0;
    pid_t child = start_child(w, path, &from);
    FILE *file = fdopen(from, "r");
    if (!file) fail_stop(EXIT_IO, "out of memory");
    char *line = NULL, *wrong = NULL;
    size_t room = 0;
    bool ended = false;
    while (getline(&line, &room, file) > 0) ended = take_line(w, line, &wrong);
    free(line);
    fclose(file);
    /* where the parent ignores SIGCHLD there is no status, and the last line has to do */
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
    if (wrong) return wrong;
    if (WIFSIGNALED(status))
        return fail_format("damaged: HDF5 fails on it (signal %d, %s)", WTERMSIG(status),
            strsignal(WTERMSIG(status)));
    if (status != 0 || !ended)
        return fail_format("damaged: it cannot be checked (exit code %d)", WEXITSTATUS(status));
    return NULL;
}

/* The message of the lowest rank that has one, on every rank. */
static char *agree(const struct comm *comm, char *wrong)
{
    char text[512] = "";
    int64_t first = wrong ? comm->rank : comm->n_rank;
    comm_min_i64(comm, &first, 1);
    if (first == comm->n_rank) return NULL;
    if (wrong) snprintf(text, sizeof text, "%s", wrong);
    free(wrong);
    comm_bcast(comm, text, sizeof text, (int)first);
    return fail_strdup(text);
}

/* Ranks that read the same file have found the same datasets. */
static char *agree_on_number(const struct comm *comm, const struct snapshot_walk *w)
{
    int64_t n[2] = {w->n, -w->n};
    comm_min_i64(comm, n, 2);
    return n[0] == -n[1] ? NULL : fail_strdup("ranks see different files under this name");
}

static char *compare(const struct snapshot_walk *w)
{
    for (int64_t k = 0; k < w->n; k++)
        if (w->sum[k] != w->expected[k]) return fail_format("%s: %s", w->path[k], h5_check_wrong);
    return NULL;
}

char *snapshot_check(const struct comm *comm, const char *path)
{
    struct snapshot_walk w = {.part = comm ? comm->rank : 0, .n_part = comm ? comm->n_rank : 1};
    char *wrong = ask_child(&w, path);
    if (comm) wrong = agree(comm, wrong);
    if (!wrong && comm) wrong = agree_on_number(comm, &w);
    if (!wrong && comm) comm_sum_i64(comm, (int64_t *)w.sum, (int)w.n); /* wraps modulo 2^64 */
    if (!wrong) wrong = compare(&w);
    snapshot_walk_free(&w);
    return wrong;
}
