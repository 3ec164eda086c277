#include "series.h"
#include "fail.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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

struct series *series_create(const struct comm *comm, const char *dir, const char *name, const struct series_column *column, int n_column)
{
    struct series *series = fail_alloc(sizeof *series);
    series->n_column = n_column;
    if (comm->rank > 0) return series;
    series->path = fail_format("%s/%s.csv", dir, name);
    series->file = fopen(series->path, "we");
    if (!series->file) stop(series, "create");
    setvbuf(series->file, NULL, _IOFBF, BUFFER_SIZE);
    put_title(series->file, "time", "s");
    for (int k = 0; k < n_column; k++) {
        fputc(',', series->file);
        put_title(series->file, column[k].name, column[k].unit);
    }
    fputc('\n', series->file);
    series_flush(series);
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
