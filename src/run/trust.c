#include "trust.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include "comm/fail.h"

struct row {
    const char *name;
    size_t at; /* of the double in struct trust */
    double least, most;
    const char *before, *after; /* around the value */
    bool by_step;               /* a smaller time step helps */
    const char *advice;         /* what else does */
};

static const struct row rows[] = {
    {"energy_error", offsetof(struct trust, energy_error), 0, 0.01, "energy balance off by ",
        " of what was supplied", true, ""},
    {"step", offsetof(struct trust, step), 0, 1, "time step ", " of the critical one", true, ""},
    {"contact_steps", offsetof(struct trust, contact_steps), 20, HUGE_VAL, "shortest contact ",
        " steps", true, ", or softer contacts"},
    {"overlap", offsetof(struct trust, overlap), 0, 0.2, "largest overlap ", " of the radius",
        false, "stiffer contacts"},
    {"slipping", offsetof(struct trust, slipping), 0, HUGE_VAL, "slipping ", " of the pairs", false,
        ""},
    {"list_room", offsetof(struct trust, list_room), 0, 1, "neighbour lists used ",
        " of their room", true, ""},
};
enum { N_ROW = sizeof rows / sizeof *rows };

const struct trust trust_unknown = {
    (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN, (double)NAN};

static double value_of(const struct trust *trust, const struct row *row)
{
    return *(const double *)(const void *)((const char *)trust + row->at);
}

static bool is_outside(const struct row *row, double value)
{
    return value < row->least || value > row->most;
}

double trust_energy(double balance, double supplied, double spare)
{
    double all = supplied + spare;
    return all > 0 ? fabs(balance) / all : (double)NAN;
}

/* All that are known, or those outside their range with it and with what to do; empty where there
 * are none. The caller owns it. step_key: what makes the time step smaller. */
static char *list(const struct trust *trust, bool outside, const char *step_key)
{
    char *text = NULL;
    size_t bytes = 0;
    FILE *file = open_memstream(&text, &bytes);
    if (!file) fail_stop(EXIT_IO, "out of memory");
    int n = 0;
    for (const struct row *row = rows; row < rows + N_ROW; row++) {
        double value = value_of(trust, row);
        if (!isfinite(value) || (outside && !is_outside(row, value))) continue;
        fprintf(file, "%s%s%.3g%s", n++ > 0 ? "; " : "", row->before, value, row->after);
        if (!outside) continue;
        if (value > row->most) fprintf(file, ", above %g: ", row->most);
        else fprintf(file, ", below %g: ", row->least);
        fprintf(file, "%s%s%s", row->by_step ? "a smaller " : "", row->by_step ? step_key : "",
            row->advice);
    }
    fclose(file);
    return text;
}

void trust_report(const struct sim *s, struct report *r, struct trust trust)
{
    if (isfinite(s->dt_limit) && s->dt_limit > 0) trust.step = s->dt / s->dt_limit;
    report_begin(r, "trust");
    for (const struct row *row = rows; row < rows + N_ROW; row++)
        report_number(r, row->name, value_of(&trust, row));
    report_begin_list(r, "outside");
    for (const struct row *row = rows; row < rows + N_ROW; row++)
        if (is_outside(row, value_of(&trust, row))) report_text(r, NULL, row->name);
    report_end(r);
    report_end(r);
    const char *step_key = s->scene->time.step > 0 ? "time.step" : "time.safety";
    char *all = list(&trust, false, step_key), *outside = list(&trust, true, step_key);
    if (all[0]) log_print(s->log, "%s", all);
    if (outside[0]) log_warn(s->log, "errors may be above 1 %%: %s", outside);
    free(all);
    free(outside);
}
