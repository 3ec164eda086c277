/* What the python tests of this folder run, alone or under mpirun:
 *   frame DIR [N]      write the frame of frame_fixture.h; files may not grow beyond N bytes
 *   write FILE N       write one column without asking for the room first, files may not grow
 *     beyond N bytes on rank 0 (no limit: 0)
 *   check FILE...      print what is wrong with frames, or nothing
 *   folder DIR SCENE [--force]   make the folder of results
 *   record DIR [NAME]  a run.json, a log and a time series; no byte goes into the file NAME */
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "base/files.h"
#include "comm/fail.h"
#include "frame_fixture.h"
#include "results/h5_write.h"
#include "results/log.h"
#include "results/output_dir.h"
#include "results/report.h"
#include "results/series.h"

static void limit_files(const char *bytes)
{
    struct rlimit limit;
    getrlimit(RLIMIT_FSIZE, &limit);
    limit.rlim_cur = (rlim_t)atoll(bytes);
    setrlimit(RLIMIT_FSIZE, &limit);
    signal(SIGXFSZ, SIG_IGN);
}

static void frame(const struct comm *comm, int n, char **arg)
{
    static struct fixture fixture;
    fixture_fill(&fixture, comm);
    if (n > 1) limit_files(arg[1]);
    snapshot_write(comm, arg[0], &fixture.frame);
}

static void write_column(const struct comm *comm, int n, char **arg)
{
    enum { ROWS = 100000 };
    double *data = fail_alloc(ROWS * sizeof *data);
    struct column column = {"numbers", "1", "nothing but zeros", COLUMN_F64, 1, data};
    if (n > 1 && comm->rank == 0 && atoll(arg[1]) > 0) limit_files(arg[1]);
    struct h5_writer *writer = h5_create(comm, arg[0], 0);
    h5_column(writer, writer->file, &column, h5_rows_of(comm, ROWS));
    h5_finish(writer);
    free(data);
}

static void folder(const struct comm *comm, int n, char **arg)
{
    const char *const measure[] = {"outflow"};
    char error[FILES_ERROR_SIZE];
    size_t n_scene = 0;
    char *scene = files_read(arg[1], &n_scene, error);
    if (!scene) fail_stop_together(EXIT_USAGE, "%s", error);
    struct output_request request = {arg[0], n > 2 && !strcmp(arg[2], "--force"), false, scene,
        n_scene, "title: resolved\nmeasure: [{name: energy}]\n", measure, 1};
    output_dir_create(comm, &request);
    free(scene);
}

/* limited: the file that no byte can be written to; NULL: none. */
static void record(const struct comm *comm, const char *dir, const char *limited)
{
    struct timers timers = {.total = {[TIMER_LOOP] = 1.0 + comm->rank}};
    const double p[3] = {1.0 / 3.0, -0.0, (double)INFINITY};
    struct report *report = report_create();
    report_text(report, "title", "a \"quoted\" \\ path\nµ\t\x01");
    report_integer(report, "large", INT64_C(9007199254740993));
    report_number(report, "third", 1.0 / 3.0);
    report_number(report, "not_a_number", (double)NAN);
    report_text(report, "nothing", NULL);
    report_numbers(report, "p", p, 3);
    report_begin_list(report, "devices");
    report_begin(report, NULL);
    report_flag(report, "gpu", false);
    report_end(report);
    report_end(report);
    report_begin(report, "empty");
    report_end(report);
    report_timers(report, "timers", comm, &timers);
    report_spread(report, "share", comm, comm->rank);
    if (!report_write(report, comm, dir)) fail_stop_together(EXIT_IO, "no run.json");
    report_free(report);

    const struct series_column column[] = {{"below", "1"}, {"a, b", "J"}};
    if (limited && !strcmp(limited, "outflow.csv")) limit_files("0");
    struct series *series = series_create(comm, dir, "outflow", column, 2);
    const double odd[] = {1.0 / 3.0, 5e-324, 1e23, 0.1, -0.0, 1.7976931348623157e308};
    for (int k = 0; k < 6; k++) series_add(series, 1e-3 * k, (const double[]){k, odd[k]});
    series_free(series);

    struct log *log = log_create(comm, false);
    log_print(log, "before the folder");
    if (limited && !strcmp(limited, "log.txt")) limit_files("0");
    log_attach(log, dir, false, "");
    log_print(log, "%d elements", 17);
    struct log_progress progress = {0, 1000, 0, 1e-2, 50000};
    for (; progress.step <= progress.n_step; progress.step++, progress.time += 1e-5)
        log_progress(log, &progress);
    progress.step--;
    log_progress_end(log, &progress);
    log_free(log);
}

int main(int argc, char **argv)
{
    snapshot_serve(argc, argv);
    if (argc > 2 && !strcmp(argv[1], "check")) {
        for (int k = 2; k < argc; k++) {
            char *wrong = snapshot_check(NULL, argv[k]);
            if (wrong) printf("%s\n", wrong);
            free(wrong);
        }
        return 0;
    }
    struct comm *comm = comm_create(&argc, &argv);
    int n = argc - 2;
    char **arg = argv + 2;
    if (argc > 2 && !strcmp(argv[1], "frame")) frame(comm, n, arg);
    else if (argc > 2 && !strcmp(argv[1], "write")) write_column(comm, n, arg);
    else if (argc > 3 && !strcmp(argv[1], "folder")) folder(comm, n, arg);
    else if (argc > 2 && !strcmp(argv[1], "record")) record(comm, argv[2], n > 1 ? argv[3] : NULL);
    else fail_stop_together(EXIT_USAGE, "see the head of results_tool.c");
    comm_free(comm);
    return 0;
}
