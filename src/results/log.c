#include "log.h"
#include "comm/fail.h"
#include "base/files.h"
#include "base/timer.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Seconds between progress lines: on a terminal for the eye, in a file for whoever looks in now and
 * then. */
static const double every_terminal = 0.2, every_file = 30.0;

struct log {
    bool speaks, quiet; /* speaks: rank 0 */
    bool is_terminal;
    bool is_alone;      /* nobody reads the standard output any more */
    FILE *file;         /* log.txt, NULL before log_attach */
    char *path, *early; /* early: text before log_attach */
    int line_width;     /* of the progress line now on the terminal; 0: none */
    bool is_begun;      /* progress */
    /* [s] clock at the first call, and when a line was last shown */
    double begun, last;
    int64_t step_last, tenth; /* tenth: of the run, already announced */
    double rate;              /* [steps/s], smoothed; 0: not known yet */
    const char *element;      /* what is counted: "particle" */
};

/* Open MPI gives each rank a pseudo-terminal, wherever its own output goes: under mpirun that of
 * mpirun (our parent, on its node) decides. */
static bool is_terminal(void)
{
    if (!isatty(STDOUT_FILENO)) return false;
    if (!getenv("OMPI_COMM_WORLD_RANK")) return true;
    char path[64];
    snprintf(path, sizeof path, "/proc/%ld/fd/1", (long)getppid());
    int fd = open(path, O_WRONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    bool yes = fd >= 0 && isatty(fd);
    if (fd >= 0) close(fd);
    return yes;
}

struct log *log_create(const struct comm *comm, bool quiet)
{
    struct log *log = fail_alloc(sizeof *log);
    log->speaks = comm->rank == 0;
    log->quiet = quiet;
    log->is_terminal = log->speaks && is_terminal();
    log->element = "element";
    return log;
}

void log_element(struct log *log, const char *name)
{
    log->element = name;
}

static void to_file(struct log *log, const char *text)
{
    if (log->file) {
        if (fputs(text, log->file) == EOF || fflush(log->file))
            fail_stop(EXIT_IO, "cannot write '%s': %s", log->path, strerror(errno));
        return;
    }
    char *longer = fail_format("%s%s", log->early ? log->early : "", text);
    free(log->early);
    log->early = longer;
}

bool log_is_ours(const char *dir)
{
    char *path = fail_format("%s/log.txt", dir);
    bool same = files_begins(path, LOG_FIRST_LINE);
    free(path);
    return same;
}

/* In one write, where there is room left (an error may be that there is none). Ranks other than 0
 * add to the file that rank 0 has made; nobody waits for anybody. */
static void take_error(void *context, int exit_code, const char *text)
{
    struct log *log = context;
    char error[FILES_ERROR_SIZE];
    int fd = log->file ? fileno(log->file) : -1;
    if (!log->speaks && files_begins(log->path, LOG_FIRST_LINE))
        fd = files_append(log->path, error);
    if (fd >= 0) dprintf(fd, "error: %s\nexit code %d\n", text, exit_code);
}

void log_attach(struct log *log, const char *dir, bool append, const char *head)
{
    log->path = fail_format("%s/log.txt", dir);
    fail_tell(take_error, log);
    if (!log->speaks) return;
    char error[FILES_ERROR_SIZE];
    int fd = append ? files_append(log->path, error) : files_create(log->path, error);
    if (fd < 0) fail_stop(EXIT_IO, "%s", error);
    log->file = fdopen(fd, "a");
    if (!log->file) fail_stop(EXIT_IO, "cannot open '%s': %s", log->path, strerror(errno));
    to_file(log, head);
    if (log->early) to_file(log, log->early);
    free(log->early);
    log->early = NULL;
}

void log_free(struct log *log)
{
    if (!log) return;
    fail_tell(NULL, log);
    if (log->file && fclose(log->file))
        fail_stop(EXIT_IO, "cannot write '%s': %s", log->path, strerror(errno));
    free(log->path);
    free(log->early);
    free(log);
}

/* Ordinary output never runs into the progress line: that one is wiped first. */
static void wipe(struct log *log)
{
    if (log->line_width == 0) return;
    printf("\r%*s\r", log->line_width, "");
    log->line_width = 0;
}

static char *text_of(const char *format, va_list args)
{
    va_list again;
    va_copy(again, args);
    size_t n = (size_t)vsnprintf(NULL, 0, format, again) + 1;
    va_end(again);
    char *text = fail_alloc(n);
    vsnprintf(text, n, format, args);
    return text;
}

/* A run does not end because `tee` or an ssh session did. */
static void look_for_reader(struct log *log)
{
    if (!ferror(stdout) || log->is_alone || !files_reader_is_gone()) return;
    log->is_alone = true;
    log_warn(log, "the standard output is closed; the run goes on, and log.txt has all it says");
}

void log_print(struct log *log, const char *format, ...)
{
    if (!log->speaks) return;
    va_list args;
    va_start(args, format);
    char *text = text_of(format, args), *line = fail_format("%s\n", text);
    va_end(args);
    if (!log->quiet) {
        wipe(log);
        fputs(line, stdout);
        fflush(stdout);
    }
    to_file(log, line);
    free(line);
    free(text);
    if (!log->quiet) look_for_reader(log);
}

void log_warn(struct log *log, const char *format, ...)
{
    if (!log->speaks) return;
    va_list args;
    va_start(args, format);
    char *text = text_of(format, args), *line = fail_format("warning: %s\n", text);
    va_end(args);
    wipe(log);
    fflush(stdout);
    fail_warn("%s", text);
    to_file(log, line);
    free(line);
    free(text);
}

char *log_duration(double seconds, char text[LOG_DURATION_SIZE])
{
    if (!(seconds >= 0 && seconds < 1e10)) return strcpy(text, "?");
    long s = lround(seconds);
    if (seconds < 9.95) snprintf(text, LOG_DURATION_SIZE, "%.1f s", seconds);
    else if (s < 60) snprintf(text, LOG_DURATION_SIZE, "%ld s", s);
    else if (s < 3600) snprintf(text, LOG_DURATION_SIZE, "%ld min %02ld s", s / 60, s % 60);
    else snprintf(text, LOG_DURATION_SIZE, "%ld h %02ld min", s / 3600, s % 3600 / 60);
    return text;
}

static void begin(struct log *log, const struct log_progress *p, double now)
{
    log->is_begun = true;
    log->begun = log->last = now;
    log->step_last = p->step;
    log->tenth = p->n_step > 0 ? 10 * p->step / p->n_step : 0;
}

char *log_rate(const struct log *log, double per_second)
{
    bool is_fast = per_second >= 1e6;
    return fail_format("%.3g %s%s updates/s", is_fast ? 1e-6 * per_second : per_second,
        is_fast ? "million " : "", log->element);
}

/* Rate since the last line, smoothed, so that the time left does not jump at every rebuild of the
 * lists. */
static void take_rate(struct log *log, const struct log_progress *p, double now)
{
    if (now <= log->last || p->step == log->step_last) return;
    double rate = (double)(p->step - log->step_last) / (now - log->last);
    /* the younger the run, the more the last piece counts */
    double weight = fmax(0.2, (now - log->last) / (now - log->begun));
    log->rate = log->rate > 0 ? (1 - weight) * log->rate + weight * rate : rate;
}

static char *place_text(const struct log_progress *p)
{
    double share = p->n_step > 0 ? 100.0 * (double)p->step / (double)p->n_step : 100.0;
    return fail_format("step %lld of %lld (%.0f %%)  t = %.5g of %.5g s", (long long)p->step,
        (long long)p->n_step, floor(share), p->time, p->end);
}

/* The last line has no rate: that of the whole run is log_rate's, which leaves output out. */
static char *progress_text(const struct log *log, const struct log_progress *p)
{
    char duration[LOG_DURATION_SIZE], *place = place_text(p),
                                      *rate = log_rate(log, log->rate * (double)p->n_element);
    log_duration((double)(p->n_step - p->step) / log->rate, duration);
    char *text = fail_format("%s  %s  %s left", place, rate, duration);
    free(place);
    free(rate);
    return text;
}

void log_progress(struct log *log, const struct log_progress *p)
{
    if (!log->speaks) return;
    double now = timer_now();
    if (!log->is_begun) begin(log, p, now);
    int64_t tenth = p->n_step > 0 ? 10 * p->step / p->n_step : 0;
    bool show_terminal = log->is_terminal && !log->quiet && now - log->last >= every_terminal;
    bool is_mark = tenth > log->tenth && p->step < p->n_step; /* the end is log_progress_end's */
    bool show_line = is_mark || (!log->is_terminal && now - log->last >= every_file);
    if (!show_terminal && !show_line) return;
    take_rate(log, p, now);
    char *text = progress_text(log, p);
    if (log->is_terminal && !log->quiet) {
        int width = printf("\r%s", text) - 1;
        /* the rest of a longer line before */
        if (width < log->line_width) printf("%*s", log->line_width - width, "");
        log->line_width = width;
        fflush(stdout);
        if (show_line) {
            char *line = fail_format("%s\n", text);
            to_file(log, line);
            free(line);
        }
    } else {
        log_print(log, "%s", text);
    }
    free(text);
    log->last = now;
    log->step_last = p->step;
    log->tenth = tenth;
}

void log_progress_end(struct log *log, const struct log_progress *p)
{
    if (!log->speaks) return;
    char *text = place_text(p);
    log_print(log, "%s", text);
    free(text);
}
