/* `democles check` of many scenes: reads a path per line and answers each with the exit code, or
 * with 128 + the number of the signal that ended it. A child by fork does what the program does
 * after MPI has begun, which is most of the time of a start. What is printed goes to the file that
 * the only argument names. A child that takes longer than LIMIT is ended by SIGALRM. */
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/check.h"
#include "comm/fail.h"
#include "scene/scene_report.h"

enum { LIMIT = 60 }; /* [s] */

static bool is_child;

/* The parent alone ends what it has begun: these replace the functions of the library by MPI's
 * profiling interface. */
int MPI_Finalize(void)
{
    return is_child ? MPI_SUCCESS : PMPI_Finalize();
}

int MPI_Abort(MPI_Comm comm, int code)
{
    if (is_child) _exit(code);
    return PMPI_Abort(comm, code);
}

static _Noreturn void check(const struct comm *comm, const char *path, const char *out)
{
    is_child = true;
    alarm(LIMIT);
    if (!freopen(out, "w", stdout) || dup2(fileno(stdout), STDERR_FILENO) < 0) _exit(EXIT_USAGE);
    struct scene *scene = scene_report_read(comm, path, NULL, 0);
    int code = check_scene(comm, scene, false);
    scene_free(scene);
    fflush(stdout);
    _exit(code);
}

int main(int argc, char **argv)
{
    struct comm *comm = comm_create(&argc, &argv);
    char path[4096];
    while (argc == 2 && fgets(path, sizeof path, stdin)) {
        path[strcspn(path, "\n")] = '\0';
        int status = 0;
        pid_t child = fork();
        if (child == 0) check(comm, path, argv[1]);
        if (child < 0 || waitpid(child, &status, 0) != child) return EXIT_IO;
        printf("%d\n", WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status));
        fflush(stdout);
    }
    comm_free(comm);
    return 0;
}
