/* The lattice's state between host and device, and its digest. */
#include "lattice.h"

#include <stdlib.h>

#include "kernels/lattice/lattice_words.h"
#include "results/digest.h"
#include "comm/fail.h"

double *lattice_read_plane(
    const struct lattice *l, const struct buffer *buffer, bool is_float, int64_t number)
{
    size_t n = (size_t)l->layout->plane;
    double *plane = reals_read(buffer, is_float, (size_t)number * n, n);
    double *value = fail_alloc((size_t)l->layout->n_owned * sizeof *value);
    for (int64_t k = 0; k < l->layout->n_owned; k++) value[k] = plane[l->layout->index[k]];
    free(plane);
    return value;
}

void lattice_write_plane(struct lattice *l, struct buffer *buffer, bool is_float, int64_t number,
    const double *value, int width)
{
    size_t n = (size_t)l->layout->plane;
    double *plane = reals_read(buffer, is_float, (size_t)number * n, n);
    for (int64_t k = 0; k < l->layout->n_owned; k++) plane[l->layout->index[k]] = value[k * width];
    reals_write(buffer, is_float, (size_t)number * n, n, plane);
    free(plane);
}

/* A part of the state: where it is, how wide. */
struct part {
    double *value;
    int width, first;
    bool is_x;
};

static int parts(const struct lattice *l, const struct lattice_motion *m, struct part part[4])
{
    part[0] = (struct part){m->u ? m->u[0] : NULL, 3, 0, true};
    part[1] = (struct part){m->v ? m->v[0] : NULL, 3, 0, false};
    part[2] = l->features.turn ? (struct part){m->q ? m->q[0] : NULL, 4, 3, true}
                               : (struct part){m->theta ? m->theta[0] : NULL, 3, 3, true};
    part[3] = (struct part){m->w ? m->w[0] : NULL, 3, 3, false};
    return 4;
}

void lattice_read(const struct lattice *l, const struct lattice_motion *m)
{
    struct part part[4];
    int n = parts(l, m, part);
    for (int p = 0; p < n; p++)
        for (int a = 0; a < part[p].width && part[p].value; a++) {
            int64_t set = part[p].is_x ? l->x_observed * LATTICE_X(l->features.turn)
                                       : l->v_observed * LATTICE_V;
            bool is_float =
                part[p].is_x ? l->features.position_is_float : l->features.real_is_float;
            double *plane = lattice_read_plane(
                l, part[p].is_x ? &l->x : &l->v, is_float, set + part[p].first + a);
            for (int64_t k = 0; k < l->layout->n_owned; k++)
                part[p].value[k * part[p].width + a] = plane[k];
            free(plane);
        }
}

/* Into one set of planes. */
static void write_set(struct lattice *l, const struct lattice_motion *m, int set)
{
    struct part part[4];
    int n = parts(l, m, part);
    for (int p = 0; p < n; p++)
        for (int a = 0; a < part[p].width && part[p].value; a++) {
            int64_t number =
                set * (part[p].is_x ? LATTICE_X(l->features.turn) : LATTICE_V) + part[p].first + a;
            lattice_write_plane(l, part[p].is_x ? &l->x : &l->v,
                part[p].is_x ? l->features.position_is_float : l->features.real_is_float, number,
                part[p].value + a, part[p].width);
        }
}

/* The state begins anew from here: in the first set of planes. */
void lattice_write(struct lattice *l, const struct lattice_motion *m)
{
    l->x_set = l->v_set = l->x_observed = l->v_observed = 0;
    l->started = false;
    write_set(l, m, 0);
}

void lattice_write_observed(struct lattice *l, int64_t step, const struct lattice_motion *m,
    const struct lattice_motion *before)
{
    lattice_write(l, m);
    l->step = step;
    if (!l->scheme->ends_with_kick || step == 0) return;
    write_set(l, before, 0);
    write_set(l, &(struct lattice_motion){.v = m->v, .w = m->w}, 1);
    l->v_observed = 1;
    l->started = l->counted = true;
}

void lattice_read_before(const struct lattice *l, const struct lattice_motion *m)
{
    struct lattice view = *l;
    view.v_observed = l->v_set;
    lattice_read(&view, m);
}

int64_t lattice_digest(const struct lattice *l, uint64_t *digest)
{
    size_t n = (size_t)l->layout->n_owned;
    struct lattice_motion m = {fail_alloc(n * sizeof *m.u), fail_alloc(n * sizeof *m.theta),
        fail_alloc(n * sizeof *m.q), fail_alloc(n * sizeof *m.v), fail_alloc(n * sizeof *m.w)};
    struct digest_part digests[4];
    struct part part[4];
    int n_part = parts(l, &m, part);
    lattice_read(l, &m);
    for (int p = 0; p < n_part; p++)
        digests[p] = (struct digest_part){part[p].value, 0, part[p].width, part[p].width};
    int64_t n_nan =
        digest_of_all(l->comm, l->layout->gid, l->layout->n_owned, digests, n_part, digest);
    free(m.u);
    free(m.theta);
    free(m.q);
    free(m.v);
    free(m.w);
    return n_nan;
}
