#include "series.h"
#include "comm/fail.h"
#include "base/files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct series {
    FILE *file; /* NULL on all ranks but 0 */
    char *path;
    int n_column;
};

enum { BUFFER_SIZE = 1 << 16 };

char *series_number(double value, char text[SERIES_NUMBER_SIZE])
{
    if (value != value) return strcpy(text, "nan");
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, SERIES_NUMBER_SIZE, "%.*g", digits, value);
        if (strtod(text, NULL) == value) break; /* also true of infinities at once */
    }
    return text;
}

/* A comma or quote in a name must not shift the columns (RFC 4180). */
static void put_title(FILE *file, const char *name, const char *unit)
{
    bool plain = !strpbrk(name, ",\"\r\n") && !strpbrk(unit, ",\"\r\n");
    if (plain) {
        fprintf(file, "%s [%s]", name, unit);
        return;
    }
    fputc('"', file);
    for (const char *part[] = {name, " [", unit, "]", NULL}, **p = part; *p; p++) {
        for (const char *c = *p; *c; c++) {
            if (*c == '"') fputc('"', file);
            fputc(*c == '\n' || *c == '\r' ? ' ' : *c, file);
        }
    }
    fputc('"', file);
}

static _Noreturn void stop(const struct series *series, const char *what)
{
    fail_stop(EXIT_IO, "cannot %s '%s': %s", what, series->path, strerror(errno));
}

bool series_is_ours(const char *path)
{
    struct stat status;
    return files_begins(path, "time [s]") ||
           (lstat(path, &status) == 0 && S_ISREG(status.st_mode) && status.st_size == 0);
}

/* The first line, in fresh memory owned by the caller. */
static char *header(const struct series_column *column, int n_column)
{
    char *text = NULL;
    size_t n = 0;
    FILE *file = open_memstream(&text, &n);
    if (!file) fail_stop(EXIT_IO, "out of memory");
    put_title(file, "time", "s");
    for (int k = 0; k < n_column; k++) {
        fputc(',', file);
        put_title(file, column[k].name, column[k].unit);
    }
    fputc('\n', file);
    if (fclose(file)) fail_stop(EXIT_IO, "out of memory");
    return text;
}

static void open_file(struct series *series, bool append)
{
    char error[FILES_ERROR_SIZE];
    int fd = append ? files_append(series->path, error) : files_create(series->path, error);
    if (fd < 0) fail_stop(EXIT_IO, "%s", error);
    series->file = fdopen(fd, "a");
    if (!series->file) stop(series, "open");
    setvbuf(series->file, NULL, _IOFBF, BUFFER_SIZE);
}

static struct series *series_of(
    const struct comm *comm, const char *dir, const char *name, int n_column)
{
    struct series *series = fail_alloc(sizeof *series);
    series->n_column = n_column;
    if (comm->rank == 0) series->path = fail_format("%s/%s.csv", dir, name);
    return series;
}

static void begin(struct series *series, const struct series_column *column)
{
    char *first = header(column, series->n_column);
    fputs(first, series->file);
    free(first);
    series_flush(series);
}

struct series *series_create(const struct comm *comm, const char *dir, const char *name,
    const struct series_column *column, int n_column)
{
    struct series *series = series_of(comm, dir, name, n_column);
    if (series->path) {
        open_file(series, false);
        begin(series, column);
    }
    return series;
}

/* Bytes of the header and of the whole lines up to `time`. */
static size_t length_until(const char *text, size_t header_length, double time)
{
    size_t length = header_length;
    for (const char *end; (end = strchr(text + length, '\n')); length = (size_t)(end + 1 - text)) {
        char *number_end;
        double t = strtod(text + length, &number_end);
        if (number_end == text + length || number_end > end || !(t <= time)) break;
    }
    return length;
}

/* What the file holds, in fresh memory; empty if it is not there. */
static char *contents(const char *path)
{
    char error[FILES_ERROR_SIZE];
    size_t n;
    if (access(path, F_OK)) return fail_strdup("");
    char *text = files_read(path, &n, error);
    if (!text) fail_stop(EXIT_IO, "%s", error);
    return text;
}

void series_check(const struct comm *comm, const char *dir, const char *name,
    const struct series_column *column, int n_column)
{
    if (comm->rank > 0) return;
    char *path = fail_format("%s/%s.csv", dir, name), *first = header(column, n_column),
         *text = contents(path);
    struct stat status;
    if (lstat(path, &status) == 0 && !S_ISREG(status.st_mode))
        fail_stop(EXIT_IO, "'%s' is a link, or no ordinary file; it is not written to", path);
    if (text[0] && strncmp(text, first, strlen(first)))
        fail_stop(EXIT_SCENE, "'%s' has other columns than the measure '%s'", path, name);
    free(text);
    free(first);
    free(path);
}

struct series *series_resume(const struct comm *comm, const char *dir, const char *name,
    const struct series_column *column, int n_column, double time)
{
    struct series *series = series_of(comm, dir, name, n_column);
    if (!series->path) return series;
    char *first = header(column, n_column), *text = contents(series->path);
    open_file(series, true);
    if (text[0]) {
        if (ftruncate(fileno(series->file), (off_t)length_until(text, strlen(first), time)))
            stop(series, "shorten");
    } else {
        fail_warn("'%s' is empty; it is started over", series->path);
        begin(series, column);
    }
    free(text);
    free(first);
    return series;
}

void series_add(struct series *series, double time, const double *value)
{
    if (!series->file) return;
    char text[SERIES_NUMBER_SIZE];
    fputs(series_number(time, text), series->file);
    for (int k = 0; k < series->n_column; k++) {
        fputc(',', series->file);
        fputs(series_number(value[k], text), series->file);
    }
    if (fputc('\n', series->file) == EOF || ferror(series->file)) stop(series, "write");
}

void series_flush(struct series *series)
{
    if (series->file && (fflush(series->file) || ferror(series->file))) stop(series, "write");
}

void series_free(struct series *series)
{
    if (!series) return;
    if (series->file && fclose(series->file)) stop(series, "write");
    free(series->path);
    free(series);
}
