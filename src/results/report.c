#include "report.h"
#include "comm/fail.h"
#include "base/files.h"
#include "series.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEPTH_MAX = 32 };

struct report {
    char *text;
    size_t n, room;
    int depth;               /* open objects and lists; the outermost object is opened by create */
    char closing[DEPTH_MAX]; /* } or ] */
    bool is_empty[DEPTH_MAX];
    bool is_ended; /* the outermost brace is closed, by report_json */
};

static void put(struct report *report, const char *text)
{
    size_t more = strlen(text);
    if (report->n + more + 1 > report->room) {
        report->room = 2 * (report->n + more + 1);
        report->text = fail_realloc(report->text, report->room);
    }
    memcpy(report->text + report->n, text, more + 1);
    report->n += more;
}

static void put_string(struct report *report, const char *value)
{
    char code[8];
    put(report, "\"");
    for (const unsigned char *c = (const unsigned char *)value; *c; c++) {
        if (*c == '"') strcpy(code, "\\\"");
        else if (*c == '\\') strcpy(code, "\\\\");
        else if (*c == '\n') strcpy(code, "\\n");
        else if (*c == '\t') strcpy(code, "\\t");
        else if (*c < 0x20 || *c == 0x7f) snprintf(code, sizeof code, "\\u%04x", *c);
        else snprintf(code, sizeof code, "%c", *c); /* UTF-8 passes byte by byte */
        put(report, code);
    }
    put(report, "\"");
}

static void put_number(struct report *report, double value)
{
    char text[SERIES_NUMBER_SIZE];
    /* JSON has neither NaN nor infinity */
    if (!isfinite(value)) put(report, "null");
    else if (value == 0 && signbit(value)) put(report, "-0.0"); /* readers take -0 for an integer */
    else put(report, series_number(value, text));
}

static void put_line(struct report *report)
{
    put(report, "\n");
    for (int d = 0; d < report->depth; d++) put(report, "  ");
}

/* Comma, fresh line and key of the next value. */
static void next(struct report *report, const char *key)
{
    bool *is_empty = &report->is_empty[report->depth - 1];
    if (!*is_empty) put(report, ",");
    *is_empty = false;
    put_line(report);
    if (!key) return;
    put_string(report, key);
    put(report, ": ");
}

static void open_level(struct report *report, const char *opening, char closing)
{
    if (report->depth == DEPTH_MAX)
        fail_stop(EXIT_IO, "run.json: nested deeper than %d", DEPTH_MAX);
    put(report, opening);
    report->closing[report->depth] = closing;
    report->is_empty[report->depth] = true;
    report->depth++;
}

struct report *report_create(void)
{
    struct report *report = fail_alloc(sizeof *report);
    open_level(report, "{", '}');
    return report;
}

void report_free(struct report *report)
{
    if (!report) return;
    free(report->text);
    free(report);
}

void report_text(struct report *report, const char *key, const char *value)
{
    next(report, key);
    if (value) put_string(report, value);
    else put(report, "null");
}

void report_number(struct report *report, const char *key, double value)
{
    next(report, key);
    put_number(report, value);
}

void report_integer(struct report *report, const char *key, int64_t value)
{
    char text[32];
    snprintf(text, sizeof text, "%lld", (long long)value);
    next(report, key);
    put(report, text);
}

void report_flag(struct report *report, const char *key, bool value)
{
    next(report, key);
    put(report, value ? "true" : "false");
}

void report_numbers(struct report *report, const char *key, const double *value, int n)
{
    next(report, key);
    put(report, "[");
    for (int k = 0; k < n; k++) {
        if (k > 0) put(report, ", ");
        put_number(report, value[k]);
    }
    put(report, "]");
}

void report_begin(struct report *report, const char *key)
{
    next(report, key);
    open_level(report, "{", '}');
}

void report_begin_list(struct report *report, const char *key)
{
    next(report, key);
    open_level(report, "[", ']');
}

void report_end(struct report *report)
{
    report->depth--;
    if (!report->is_empty[report->depth]) put_line(report);
    char closing[2] = {report->closing[report->depth], '\0'};
    put(report, closing);
}

/* One line {"min": a, "mean": b, "max": c} of all ranks' values; values [n_rank][stride], the first
 * of each. */
static void put_spread(
    struct report *report, const char *key, const double *value, int n_rank, int stride)
{
    double low = value[0], high = value[0], sum = 0;
    for (int r = 0; r < n_rank; r++) {
        double v = value[(size_t)r * (size_t)stride];
        low = v < low ? v : low;
        high = v > high ? v : high;
        sum += v;
    }
    next(report, key);
    put(report, "{\"min\": ");
    put_number(report, low);
    put(report, ", \"mean\": ");
    put_number(report, sum / n_rank);
    put(report, ", \"max\": ");
    put_number(report, high);
    put(report, "}");
}

void report_timers(
    struct report *report, const char *key, const struct comm *comm, const struct timers *timers)
{
    double *all = fail_alloc((size_t)comm->n_rank * sizeof timers->total);
    comm_gather(comm, timers->total, all, sizeof timers->total);
    report_begin(report, key);
    for (int k = 0; k < TIMER_N; k++)
        put_spread(report, timer_label[k], all + k, comm->n_rank, TIMER_N);
    report_end(report);
    free(all);
}

void report_spread(struct report *report, const char *key, const struct comm *comm, double value)
{
    double *all = fail_alloc((size_t)comm->n_rank * sizeof value);
    comm_gather(comm, &value, all, sizeof value);
    put_spread(report, key, all, comm->n_rank, 1);
    free(all);
}

const char *report_json(struct report *report)
{
    if (report->depth == 1 && !report->is_ended) {
        report_end(report);
        put(report, "\n");
        report->is_ended = true;
    }
    return report->text;
}

bool report_write(struct report *report, const struct comm *comm, const char *dir)
{
    return comm->rank > 0 || report_save(report, dir);
}

bool report_save(struct report *report, const char *dir)
{
    char error[FILES_ERROR_SIZE];
    char *path = fail_format("%s/run.json", dir);
    const char *json = report_json(report);
    bool ok = files_replace(path, json, strlen(json), error);
    if (!ok) fail_warn("%s", error);
    free(path);
    return ok;
}
