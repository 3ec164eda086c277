/* trace.json: https://docs.google.com/document/d/1CvAClvFfyA5R-PhYUmn5OOQtYMH4h6I0nSsKchNAySU
 * (Trace Event Format). One event per line. */
#include "trace_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "comm/migrate.h"
#include "comm/fail.h"
#include "base/files.h"

static const char *const lane_name[TRACE_LANES] = {"host", "device: compute", "device: copy"};

/* Text without what JSON would have to escape. */
static const char *plain(char text[DEVICE_TEXT], const char *given)
{
    snprintf(text, DEVICE_TEXT, "%s", given);
    for (char *c = text; *c; c++)
        if (*c == '"' || *c == '\\' || (unsigned char)*c < ' ') *c = ' ';
    return text;
}

static void put_names(const struct trace *t, FILE *file)
{
    int rank = t->comm->rank;
    char host[256] = "", a[DEVICE_TEXT], b[DEVICE_TEXT];
    gethostname(host, sizeof host - 1);
    fprintf(file,
        "{\"name\": \"process_name\", \"ph\": \"M\", \"pid\": %d, \"args\": {\"name\": \"rank %d "
        "on %s: %s\"}},\n",
        rank, rank, plain(a, host), plain(b, t->dev->name));
    fprintf(file,
        "{\"name\": \"process_sort_index\", \"ph\": \"M\", \"pid\": %d, \"args\": "
        "{\"sort_index\": %d}},\n",
        rank, rank);
    for (int lane = 0; lane < TRACE_LANES; lane++)
        fprintf(file,
            "{\"name\": \"thread_name\", \"ph\": \"M\", \"pid\": %d, \"tid\": %d, \"args\": "
            "{\"name\": \"%s\"}},\n",
            rank, lane, lane_name[lane]);
}

/* A message as an arrow, from the begin of the span in which it was sent to the end of that in
 * which it was found to have arrived. */
static void put_message(const struct trace *t, const struct trace_span *s, double at, FILE *file)
{
    bool is_sent = s->lane == TRACE_SENT;
    int from = is_sent ? t->comm->rank : s->rank, to = is_sent ? s->rank : t->comm->rank;
    fprintf(file,
        "{\"name\": \"message\", \"cat\": \"message\", \"ph\": \"%s\"%s, \"id\": \"%d-%d-%lld\", "
        "\"pid\": %d, \"tid\": %d, \"ts\": %.3f},\n",
        is_sent ? "s" : "f", is_sent ? "" : ", \"bp\": \"e\"", from, to, (long long)s->size,
        t->comm->rank, TRACE_HOST, at);
}

/* Times in us from `zero` [ns] on. */
static void put_span(const struct trace *t, const struct trace_span *s, int64_t zero, FILE *file)
{
    double at = 1e-3 * (double)(s->begin - zero);
    if (s->lane >= TRACE_LANES) {
        put_message(t, s, at, file);
        return;
    }
    fprintf(file,
        "{\"name\": \"%s\", \"cat\": \"%s\", \"ph\": \"X\", \"pid\": %d, \"tid\": %d, \"ts\": "
        "%.3f, \"dur\": %.3f, \"args\": {\"step\": %lld",
        s->name, s->lane == TRACE_HOST ? "host" : "device", t->comm->rank, (int)s->lane, at,
        1e-3 * (double)(s->end - s->begin), (long long)s->step);
    if (s->lane != TRACE_HOST) fprintf(file, ", \"size\": %lld", (long long)s->size);
    if (s->part) fprintf(file, ", \"part\": \"%s\"", s->part);
    fprintf(file, "}},\n");
}

/* The own events, as text that the caller frees. */
static char *own_events(const struct trace *t, int64_t zero, size_t *bytes)
{
    char *text = NULL;
    FILE *file = open_memstream(&text, bytes);
    if (!file) fail_stop(EXIT_IO, "out of memory");
    put_names(t, file);
    for (int64_t i = 0; i < t->n_span; i++) put_span(t, &t->span[i], zero, file);
    if (fclose(file)) fail_stop(EXIT_IO, "out of memory");
    return text;
}

/* What is known of the clocks [us]. */
static void put_other(
    const struct trace *t, const struct trace_bounds (*all)[3], int64_t n_lost, FILE *file)
{
    static const char *const name[] = {
        "host_minus_device_before", "host_minus_device_after", "first_host_minus_host"};
    fprintf(file,
        "\"displayTimeUnit\": \"ms\",\n\"otherData\": {\"first_step\": %lld, \"steps\": %lld, "
        "\"spans_lost\": %lld, \"clocks\": [",
        (long long)t->first, (long long)t->n, (long long)n_lost);
    for (int r = 0; r < t->comm->n_rank; r++) {
        fprintf(file, "%s\n{\"rank\": %d", r > 0 ? "," : "", r);
        for (int k = 0; k < 3; k++)
            fprintf(file, ", \"%s\": {\"low\": %.3f, \"high\": %.3f, \"taken\": %.3f}", name[k],
                1e-3 * (double)all[r][k].low, 1e-3 * (double)all[r][k].high,
                1e-3 * (double)trace_offset(&all[r][k]));
        fprintf(file, "}");
    }
    fprintf(file, "]}\n}\n");
}

static void put_file(const struct trace *t, const char *events, size_t bytes,
    const struct trace_bounds (*all)[3], int64_t n_lost)
{
    char *text = NULL, error[FILES_ERROR_SIZE], *path = fail_format("%s/trace.json", t->dir);
    size_t n = 0;
    FILE *file = open_memstream(&text, &n);
    if (!file) fail_stop(EXIT_IO, "out of memory");
    fprintf(file, "{\"traceEvents\": [\n");
    fwrite(events, 1, bytes - strlen(",\n"), file);
    fprintf(file, "\n],\n");
    put_other(t, all, n_lost, file);
    if (fclose(file)) fail_stop(EXIT_IO, "out of memory");
    if (!files_replace(path, text, n, error)) fail_warn("%s", error);
    if (n_lost > 0)
        fail_warn("%s: %lld spans are left out, over %d on a rank: take fewer steps", path,
            (long long)n_lost, TRACE_SPANS);
    free(text);
    free(path);
}

void trace_write(const struct trace *t)
{
    size_t n_rank = (size_t)t->comm->n_rank, bytes;
    int64_t zero = INT64_MAX, n_lost = t->n_lost, shift = trace_offset(&t->first_rank);
    for (int64_t i = 0; i < t->n_span; i++)
        if (t->span[i].begin + shift < zero) zero = t->span[i].begin + shift;
    comm_min_i64(t->comm, &zero, 1);
    if (zero == INT64_MAX) zero = 0; /* nothing was done */
    comm_sum_i64(t->comm, &n_lost, 1);
    char *text = own_events(t, zero - shift, &bytes);

    int64_t *to = fail_alloc(n_rank * sizeof *to), *from = fail_alloc(n_rank * sizeof *from),
            sum = 0;
    struct trace_bounds own[3] = {t->device[0], t->device[1], t->first_rank},
                        (*all)[3] = fail_alloc(n_rank * sizeof *all);
    to[0] = (int64_t)bytes;
    char *events = migrate_bytes(t->comm, text, to, from);
    comm_gather(t->comm, own, all, sizeof own);
    for (size_t r = 0; r < n_rank; r++) sum += from[r];
    if (t->comm->rank == 0)
        put_file(t, events, (size_t)sum, (const struct trace_bounds(*)[3])all, n_lost);
    free(events);
    free(text);
    free(to);
    free(from);
    free(all);
}
