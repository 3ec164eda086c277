#include "particles.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "device/buffers.h"

#define NOW(k) offsetof(struct particles, field[k].now)
#define SPARE(k) offsetof(struct particles, field[k].spare)
static const struct buffer_spec field_buffers[] = {{"state", NOW(FIELD_STATE)},
    {"state, spare", SPARE(FIELD_STATE)}, {"gid", NOW(FIELD_GID)}, {"gid, spare", SPARE(FIELD_GID)},
    {"orientation", NOW(FIELD_ORIENTATION)}, {"orientation, spare", SPARE(FIELD_ORIENTATION)}, {0}};
#undef NOW
#undef SPARE
static const struct buffer_spec other_buffers[] = {
    {"reference", offsetof(struct particles, reference)},
    {"reach", offsetof(struct particles, reach)}, {"force", offsetof(struct particles, force)},
    {"torque", offsetof(struct particles, torque)}, {"flags", offsetof(struct particles, flags)},
    {0}};

struct particles *particles_create(
    struct device *dev, const struct features *features, const struct program *lists)
{
    struct particles *p = fail_alloc(sizeof *p);
    p->field[FIELD_STATE].bytes = particles_record(features);
    p->field[FIELD_GID].bytes = sizeof(int64_t);
    p->field[FIELD_ORIENTATION].bytes = features->orientation ? 4 * particles_real(features) : 0;
    buffers_create(dev, p, field_buffers);
    buffers_init(dev, p, other_buffers);
    buffer_reserve(&p->flags, FLAG_N * sizeof(cl_int));
    p->gather = launch_create(lists, "record_gather");
    p->copy = launch_create(lists, "record_copy");
    return p;
}

void particles_free(struct particles *p)
{
    if (!p) return;
    buffers_free(p, field_buffers);
    buffers_free(p, other_buffers);
    launch_free(p->gather);
    launch_free(p->copy);
    free(p);
}

/* Grows a buffer and keeps its first bytes: the rare case of ghosts that do not fit behind the
 * owned elements. */
static void reserve_keep(struct particles *p, struct buffer *buffer, size_t keep, size_t bytes)
{
    if (bytes <= buffer->capacity) {
        buffer_reserve(buffer, bytes);
        return;
    }
    struct buffer larger;
    buffer_init(&larger, buffer->dev, buffer->name);
    buffer_reserve(&larger, bytes + bytes / 4);
    buffer_reserve(&larger, bytes);
    if (keep > 0) {
        int words = (int)(keep / 4);
        launch_set_int(p->copy, "n", words);
        launch_bind_buffer(p->copy, "from", buffer);
        launch_bind_buffer(p->copy, "to", &larger);
        launch_run(p->copy, words);
    }
    device_finish(buffer->dev);
    buffer_free(buffer);
    *buffer = larger;
}

void particles_reserve(
    struct particles *p, const struct features *features, int64_t n, int64_t keep)
{
    for (int i = 0; i < FIELD_N; i++)
        reserve_keep(
            p, &p->field[i].now, p->field[i].bytes * (size_t)keep, p->field[i].bytes * (size_t)n);
    reserve_keep(p, &p->reach, particles_preal(features) * (size_t)keep,
        particles_preal(features) * (size_t)n);
    buffer_reserve(&p->force, 4 * particles_real(features) * (size_t)n);
    buffer_reserve(&p->torque, features->spin ? 4 * particles_real(features) * (size_t)n : 0);
}

void particles_reserve_spare(struct particles *p, int64_t n)
{
    for (int i = 0; i < FIELD_N; i++)
        buffer_reserve(&p->field[i].spare, p->field[i].bytes * (size_t)n);
}

void particles_permute(struct particles *p, const struct buffer *index, int64_t n)
{
    for (int i = 0; i < FIELD_N; i++) {
        if (p->field[i].bytes == 0) continue;
        launch_set_count(p->gather, "n", n);
        launch_set_count(p->gather, "words", p->field[i].bytes / 4);
        launch_bind_all(
            p->gather, (const struct launch_binding[]){{"index", index}, {"from", &p->field[i].now},
                           {"to", &p->field[i].spare}, {0}});
        launch_run(p->gather, n);
    }
}

void particles_swap(struct particles *p)
{
    for (int i = 0; i < FIELD_N; i++) {
        struct buffer b = p->field[i].now;
        p->field[i].now = p->field[i].spare;
        p->field[i].spare = b;
    }
}

/* One element's record, as kernels/particle/element.h reads it; its kicks are still to come. */
static void write_record(
    char *record, const struct features *f, const struct particles_host *h, int64_t i)
{
    const double *x = h->x + 3 * i, *v = h->v + 3 * i, *w = h->w + 3 * i;
    double head[4] = {x[0], x[1], x[2], h->radius[i]},
           tail[8] = {v[0], v[1], v[2], 1 / h->mass[i], w[0], w[1], w[2], h->material[i]};
    memset(record, 0, particles_record(f));
    for (size_t k = 0; k < 4; k++) reals_set(record, f->position_is_float, k, head[k]);
    record += 4 * particles_preal(f);
    for (size_t k = 0; k < (f->spin ? 8 : 4); k++) reals_set(record, f->real_is_float, k, tail[k]);
}

void particles_write_state(
    struct particles *p, const struct features *f, const struct particles_host *h)
{
    size_t bytes = particles_record(f);
    char *state = fail_alloc((size_t)h->n * bytes);
    for (int64_t i = 0; i < h->n; i++) write_record(state + (size_t)i * bytes, f, h, i);
    buffer_write(&p->field[FIELD_STATE].now, 0, (size_t)h->n * bytes, state);
    free(state);
}

void particles_replace(
    struct particles *p, const struct features *f, const struct particles_host *h)
{
    p->n_owned = h->n;
    p->n_ghost = 0;
    particles_reserve(p, f, h->n, 0);
    particles_write_state(p, f, h);
    buffer_write(&p->field[FIELD_GID].now, 0, (size_t)h->n * sizeof *h->gid, h->gid);
    if (f->orientation)
        reals_write(&p->field[FIELD_ORIENTATION].now, f->real_is_float, 0, 4 * (size_t)h->n, h->q);
}

struct particles_host *particles_host_create(int64_t n_row)
{
    struct particles_host *h = fail_alloc(sizeof *h);
    size_t n = (size_t)n_row;
    h->n = n_row;
    h->gid = fail_alloc(n * sizeof *h->gid);
    h->x = fail_alloc(3 * n * sizeof *h->x);
    h->v = fail_alloc(3 * n * sizeof *h->v);
    h->w = fail_alloc(3 * n * sizeof *h->w);
    h->q = fail_alloc(4 * n * sizeof *h->q);
    h->radius = fail_alloc(n * sizeof *h->radius);
    h->mass = fail_alloc(n * sizeof *h->mass);
    h->material = fail_alloc(n * sizeof *h->material);
    for (size_t i = 0; i < n; i++) h->q[4 * i] = 1;
    return h;
}

void particles_host_kind(struct particles_host *h, int64_t i, const struct scene *scene,
    const struct elements_host *first)
{
    int64_t gid = h->gid[i];
    h->radius[i] = first->radius[gid];
    h->material[i] = first->material[gid];
    h->mass[i] = scene_mass(scene, h->material[i], first->radius[gid]);
}

void particles_take(struct particles *p, const struct features *features,
    const struct elements_host *elements, const struct scene *scene, const unsigned char *take)
{
    int64_t n = 0, k = 0;
    for (int64_t i = 0; i < elements->n; i++) n += take[i];
    struct particles_host *h = particles_host_create(n);
    for (int64_t i = 0; i < elements->n; i++) {
        if (!take[i]) continue;
        h->gid[k] = i;
        memcpy(h->x + 3 * k, elements->x + 3 * i, 3 * sizeof *h->x);
        memcpy(h->v + 3 * k, elements->v + 3 * i, 3 * sizeof *h->v);
        memcpy(h->w + 3 * k, elements->w + 3 * i, 3 * sizeof *h->w);
        particles_host_kind(h, k++, scene, elements);
    }
    p->n_global = elements->n;
    particles_replace(p, features, h);
    particles_host_free(h);
}

struct particles_host *particles_download(const struct particles *p, const struct features *f,
    const struct scene *scene, const struct elements_host *first)
{
    size_t n = (size_t)p->n_owned, bytes = particles_record(f);
    struct particles_host *h = particles_host_create(p->n_owned);
    char *state = fail_alloc(n * bytes);
    buffer_read(&p->field[FIELD_STATE].now, 0, n * bytes, state);
    buffer_read(&p->field[FIELD_GID].now, 0, n * sizeof *h->gid, h->gid);
    for (size_t i = 0; i < n; i++) {
        const char *head = state + i * bytes, *tail = head + 4 * particles_preal(f);
        for (size_t a = 0; a < 3; a++) {
            h->x[3 * i + a] = reals_get(head, f->position_is_float, a);
            h->v[3 * i + a] = reals_get(tail, f->real_is_float, a);
            if (f->spin) h->w[3 * i + a] = reals_get(tail, f->real_is_float, 4 + a);
        }
        particles_host_kind(h, (int64_t)i, scene, first);
        h->radius[i] = reals_get(head, f->position_is_float, 3);
    }
    if (f->orientation) {
        free(h->q);
        h->q = reals_read(&p->field[FIELD_ORIENTATION].now, f->real_is_float, 0, 4 * n);
    }
    free(state);
    return h;
}

void particles_host_free(struct particles_host *h)
{
    if (!h) return;
    void *part[] = {h->gid, h->x, h->v, h->w, h->q, h->radius, h->mass, h->material};
    for (size_t i = 0; i < sizeof part / sizeof *part; i++) free(part[i]);
    free(h);
}
