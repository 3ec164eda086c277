#include "measures.h"

#include <stdlib.h>

#include "base/whole.h"
#include "comm/fail.h"
#include "resume.h"

struct measures {
    int n;
    struct series **series;
};

int measures_columns(struct series_column *column, int n, const struct scene_item *items)
{
    for (; items->name; items++) column[n++] = (struct series_column){items->name, items->unit};
    return n;
}

struct measures *measures_create(struct sim *s)
{
    struct measures *m = fail_alloc(sizeof *m);
    m->n = s->scene->n_measure;
    m->series = fail_alloc((size_t)m->n * sizeof *m->series);
    for (int i = 0; i < m->n; i++) {
        struct series_column column[STEP_MEASURE_COLUMNS];
        int n = s->ops->measure_columns(s, &s->scene->measure[i], column);
        const char *name = s->scene->measure[i].name;
        m->series[i] = s->from ? series_resume(s->comm, s->options->dir, name, column, n,
                                     (double)s->from->step * s->dt)
                               : series_create(s->comm, s->options->dir, name, column, n);
    }
    return m;
}

void measures_check(struct sim *s)
{
    for (int i = 0; i < s->scene->n_measure; i++) {
        struct series_column column[STEP_MEASURE_COLUMNS];
        int n = s->ops->measure_columns(s, &s->scene->measure[i], column);
        series_check(s->comm, s->options->dir, s->scene->measure[i].name, column, n);
    }
}

void measures_free(struct measures *m)
{
    if (!m) return;
    for (int i = 0; i < m->n; i++) series_free(m->series[i]);
    free(m->series);
    free(m);
}

int64_t measures_every(const struct sim *s, int i)
{
    return whole_steps(s->scene->measure[i].every, s->dt);
}

void measures_write(struct sim *s, struct measures *m)
{
    bool any = false, *due = fail_alloc((size_t)m->n * sizeof *due);
    double(*value)[STEP_MEASURE_COLUMNS] = fail_alloc((size_t)m->n * sizeof *value);
    for (int i = 0; i < m->n; i++)
        any |= due[i] = s->rest.reached || s->step % measures_every(s, i) == 0;
    if (any) s->ops->measure(s, due, value);
    for (int i = 0; i < m->n; i++)
        if (due[i]) series_add(m->series[i], (double)s->step * s->dt, value[i]);
    free(due);
    free(value);
}

void measures_flush(struct measures *m)
{
    for (int i = 0; i < m->n; i++) series_flush(m->series[i]);
}
