/* democles: arguments, MPI, one command, exit code. */
#include <stdio.h>
#include <stdlib.h>

#include "check.h"
#include "comm/fail.h"
#include "lattice/lattice_method.h"
#include "options.h"
#include "particle/particle.h"
#include "results/snapshot.h"
#include "run/resume.h"
#include "scene/scene_report.h"
#include "base/files.h"
#include "base/signals.h"
#include "version.h"

/* `democles run` and `democles resume`: collective. */
static int run(struct comm *comm, struct options *options)
{
    signals_install(); /* after MPI_Init, which has handlers of its own */
    struct log *log = log_create(comm, options->run.quiet);
    bool goes_on = options->command == OPTIONS_RESUME;
    struct resume *from = goes_on ? resume_open(comm, log, options->operand) : NULL;
    struct scene *scene =
        goes_on ? resume_scene(comm, from, options->set, options->n_set)
                : scene_report_read(comm, options->operand, options->set, options->n_set);
    const char *given = goes_on ? options->operand : options->run.dir;
    char *dir = given ? fail_strdup(given) : fail_format("out/%s", scene->name);
    options->run.dir = dir;
    const struct step_ops *ops = scene->method == METHOD_LATTICE ? &lattice_ops : &particle_ops;
    struct sim *sim = sim_create(scene, comm, log, ops, from, &options->run);
    int code = sim_run(sim);
    sim_free(sim);
    log_free(log);
    resume_free(from);
    scene_free(scene);
    free(dir);
    return code;
}

/* `democles check`: collective. */
static int check(struct comm *comm, const struct options *options)
{
    struct scene *scene = scene_report_read(comm, options->operand, options->set, options->n_set);
    int code = check_scene(comm, scene, options->resolved);
    scene_free(scene);
    return code;
}

/* `democles devices`, on one rank. */
static int list_devices(int n_rank)
{
    char *text = NULL;
    size_t n = 0;
    FILE *file = open_memstream(&text, &n);
    int n_device = file ? device_list(n_rank, file) : 0;
    if (!file || fclose(file)) fail_stop(EXIT_IO, "out of memory");
    if (n_device > 0) fputs(text, stdout);
    else fprintf(stderr, "democles: error: %s", text);
    free(text);
    return n_device > 0 ? EXIT_DONE : EXIT_DEVICE;
}

/* What only prints: rank 0 does it, all ranks get its exit code. */
static int print(const struct comm *comm, const struct options *options)
{
    int code = EXIT_DONE;
    if (comm->rank == 0) {
        if (options->version) printf("democles %s (%s)\n", DEMOCLES_VERSION, DEMOCLES_GIT);
        else if (options->help) options_help(options->command, stdout);
        else if (options->command == OPTIONS_DEVICES)
            code = list_devices(options->n_rank > 0 ? options->n_rank : comm->n_node_rank);
        else if (!scene_explain(options->operand)) code = EXIT_USAGE;
    }
    comm_bcast(comm, &code, sizeof code, 0);
    return code;
}

int main(int argc, char **argv)
{
    files_hold_standard();
    snapshot_serve(argc, argv);
    signals_hold(); /* from the threads of MPI and OpenCL */
    struct comm *comm = comm_create(&argc, &argv);
    struct options options = options_parse(argc, argv);
    if (options.error) fail_stop_together(EXIT_USAGE, "%s", options.error);

    int code;
    bool runs = options.command == OPTIONS_RUN || options.command == OPTIONS_RESUME;
    if (!runs) signals_pass();
    if (options.help || options.version || (!runs && options.command != OPTIONS_CHECK))
        code = print(comm, &options);
    else code = runs ? run(comm, &options) : check(comm, &options);

    /* Whoever asked for no more (`democles explain | head -1`) has got what was wanted; what a run
     * says is in its log.txt. */
    int32_t is_lost = (fflush(stdout) || ferror(stdout)) && !files_reader_is_gone();
    comm_or_i32(comm, &is_lost, 1);
    if (is_lost) fail_stop_together(EXIT_IO, "cannot write to the standard output");
    options_free(&options);
    comm_free(comm);
    return code;
}
