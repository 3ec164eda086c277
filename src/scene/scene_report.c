#include "scene_report.h"

#include <stdio.h>
#include <unistd.h>

#include "base/files.h"
#include "comm/fail.h"

void scene_report_errors(const struct comm *comm, struct scene_errors *errors)
{
    int64_t first = errors->n > 0 ? comm->rank : comm->n_rank;
    comm_min_i64(comm, &first, 1);
    if (first == comm->n_rank) return;
    fflush(stdout);
    if (comm->rank == first)
        for (int k = 0; k < errors->n; k++) fprintf(stderr, "%s\n", errors->text[k]);
    scene_errors_free(errors);
    fail_leave(EXIT_SCENE);
}

/* What is in a pipe can be read once, and mpirun gives its input to rank 0 alone. */
static void refuse_pipe(const struct comm *comm, const char *path)
{
    struct scene_errors errors = {0};
    int32_t is_pipe = comm->n_rank > 1 && comm->rank == 0 && !files_is_ordinary(path);
    comm_or_i32(comm, &is_pipe, 1);
    if (is_pipe)
        scene_errors_add(&errors,
            "%s: no ordinary file, so one rank alone can read it; each of %d ranks reads the scene",
            path, comm->n_rank);
    scene_report_errors(comm, &errors);
}

struct scene *scene_report_read(
    const struct comm *comm, const char *path, const char *const *set, int n_set)
{
    struct scene_errors errors = {0};
    refuse_pipe(comm, path);
    struct scene *scene = scene_read(path, set, n_set, &errors);
    scene_report_errors(comm, &errors);
    uint64_t hash = scene->hash;
    comm_bcast(comm, &hash, sizeof hash, 0);
    if (hash != scene->hash)
        scene_errors_add(&errors, "%s: rank %d reads a different scene from this path than rank 0",
            path, comm->rank);
    scene_report_errors(comm, &errors);
    for (int k = 0; k < scene->notes.n; k++) fail_warn("%s", scene->notes.text[k]);
    return scene;
}
