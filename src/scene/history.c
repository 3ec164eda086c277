#include "history.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "comm/fail.h"

static const double two_pi = 6.283185307179586;

/* First point of the table after t; n_point if there is none. */
static int point_after(const struct history *h, double t)
{
    int low = 0, high = h->n_point;
    while (low < high) {
        int middle = low + (high - low) / 2;
        if (h->point[middle][0] > t) high = middle;
        else low = middle + 1;
    }
    return low;
}

static double table_at(const struct history *h, double t)
{
    int k = point_after(h, t);
    if (k == 0) return h->point[0][1];
    if (k == h->n_point) return h->point[k - 1][1];
    const double *a = h->point[k - 1], *b = h->point[k];
    return a[1] + (b[1] - a[1]) * ((t - a[0]) / (b[0] - a[0]));
}

double history_at(const struct history *h, double t)
{
    switch (h->kind) {
    case HISTORY_RAMP: return t <= 0 ? 0 : fmin(t / h->ramp, 1);
    case HISTORY_SINE: return sin(two_pi * h->frequency * t + h->phase);
    case HISTORY_TABLE: return table_at(h, t);
    case HISTORY_CONSTANT: break;
    }
    return 1;
}

static double table_slope(const struct history *h, int k)
{
    return k <= 0 || k >= h->n_point
               ? 0
               : (h->point[k][1] - h->point[k - 1][1]) / (h->point[k][0] - h->point[k - 1][0]);
}

double history_rate(const struct history *h, double t)
{
    if (h->kind == HISTORY_RAMP)
        return (t >= 0 && t < h->ramp ? 0.5 / h->ramp : 0) +
               (t > 0 && t <= h->ramp ? 0.5 / h->ramp : 0);
    if (h->kind == HISTORY_SINE)
        return two_pi * h->frequency * cos(two_pi * h->frequency * t + h->phase);
    if (h->kind != HISTORY_TABLE) return 0;
    int k = point_after(h, t);
    bool is_corner = k > 0 && !(h->point[k - 1][0] < t);
    return is_corner ? 0.5 * (table_slope(h, k - 1) + table_slope(h, k)) : table_slope(h, k);
}

/* Straight from one corner to the next: on each piece the mean is the value at its middle. */
static double mean_of_pieces(const struct history *h, double from, double to)
{
    double sum = 0, start = from;
    double corner[2] = {0, h->ramp}; /* of a ramp */
    int n = h->kind == HISTORY_RAMP ? 2 : h->n_point, k = 0;
    if (h->kind == HISTORY_TABLE) k = point_after(h, from);
    for (; k <= n && start < to; k++) {
        double end = k == n ? to : h->kind == HISTORY_RAMP ? corner[k] : h->point[k][0];
        end = fmin(end, to);
        if (!(end > start)) continue;
        sum += history_at(h, start + 0.5 * (end - start)) * ((end - start) / (to - from));
        start = end;
    }
    return sum;
}

double history_mean(const struct history *h, double from, double to)
{
    double low = fmin(from, to), high = fmax(from, to);
    if (!(low < high)) return history_at(h, from);
    if (h->kind == HISTORY_RAMP || h->kind == HISTORY_TABLE) return mean_of_pieces(h, low, high);
    double half = 0.5 * two_pi * h->frequency * (high - low);
    if (h->kind == HISTORY_CONSTANT || !(half > 0)) return history_at(h, low);
    /* no difference of cosines: nothing cancels */
    return sin(two_pi * h->frequency * (low + 0.5 * (high - low)) + h->phase) * (sin(half) / half);
}

/* One line "t, f" into point; NULL, or what is wrong. */
static const char *parse(const char *line, double point[2])
{
    const char *at = line;
    for (int k = 0; k < 2; k++) {
        char *end;
        point[k] = strtod(at, &end);
        if (end == at || !isfinite(point[k]))
            return k == 0 ? "the time is not a number" : "the factor is not a number";
        at = end + strspn(end, " \t");
        if (k == 0 && *at != ',') return "expected time, factor";
        at += k == 0;
    }
    return at[strspn(at, " \t\r\n")] ? "more than a time and a factor" : NULL;
}

static char *read_lines(struct history *table, const char *name, FILE *file)
{
    char *line = NULL, *problem = NULL;
    size_t room = 0, n_room = 0;
    bool has_line = false;
    ssize_t n;
    for (int number = 1; !problem && (n = getline(&line, &room, file)) >= 0; number++) {
        const char *nul = memchr(line, 0, (size_t)n);
        if (nul) {
            problem = fail_format("%s:%d:%d: NUL byte: this is no text, or damaged", name, number,
                (int)(nul - line) + 1);
            break;
        }
        if (line[strspn(line, " \t\r\n")] == 0) continue;
        double point[2];
        const char *wrong = parse(line, point);
        bool is_header = !has_line && wrong && !strpbrk(line, "0123456789");
        has_line = true;
        if (is_header) continue;
        if (!wrong && table->n_point > 0 && !(point[0] > table->point[table->n_point - 1][0]))
            wrong = "times must increase";
        if (wrong) {
            problem = fail_format("%s:%d: %s", name, number, wrong);
            break;
        }
        if ((size_t)table->n_point == n_room) {
            n_room = n_room ? 2 * n_room : 64;
            table->point = fail_realloc(table->point, n_room * sizeof *table->point);
        }
        memcpy(table->point[table->n_point++], point, sizeof point);
    }
    if (!problem && table->n_point == 0) problem = fail_format("%s: no point", name);
    free(line);
    return problem;
}

char *history_read(struct history *table, const char *name)
{
    FILE *file = files_input(name);
    table->n_point = 0;
    if (!file) return fail_format("%s: %s", name, strerror(errno));
    char *problem = read_lines(table, name, file);
    fclose(file);
    return problem;
}
