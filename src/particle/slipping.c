#include "slipping.h"

#include <math.h>
#include <stdlib.h>

#include "comm/fail.h"
#include "contact_table.h"
#include "kernels/contact/contact_state.h"
#include "particle.h"

/* A force this near to the limit is at it: it is known to single precision at worst. */
#define AT_LIMIT (1 - 1e-5)

/* What is read of the pairs on this rank. */
struct read {
    cl_int *i, *j, *state; /* [n] */
    double *result;        /* [n][width] force on i first [N] */
    int64_t *gid;          /* [n_all] */
    char *element;         /* [n_all] records, place first [m] */
    size_t n, width, stride;
};

static struct read read_pairs(struct sim *s)
{
    struct particle_run *run = s->particle;
    struct pair_list *p = &run->pairs->now;
    const struct field *states = &run->particles->field[FIELD_STATE];
    size_t n = (size_t)(p->first_boundary + p->n_mine), all = (size_t)p->n_all;
    struct read r = {.n = n, .width = (size_t)run->pairs->layout.result};
    r.stride = states->bytes / particles_preal(&run->features);
    r.i = fail_alloc(n * sizeof *r.i);
    r.j = fail_alloc(n * sizeof *r.j);
    r.state = fail_alloc(n * sizeof *r.state);
    r.gid = fail_alloc(all * sizeof *r.gid);
    r.element = fail_alloc(all * states->bytes);
    if (n == 0) return r;
    buffer_read(&p->pair_i, 0, n * sizeof *r.i, r.i);
    buffer_read(&p->pair_j, 0, n * sizeof *r.j, r.j);
    buffer_read(&p->state, 0, n * sizeof *r.state, r.state);
    buffer_read(&run->particles->field[FIELD_GID].now, 0, all * sizeof *r.gid, r.gid);
    buffer_read(&states->now, 0, all * states->bytes, r.element);
    r.result = reals_read(&run->pairs->result, run->features.real_is_float, 0, n * r.width);
    return r;
}

static void read_free(struct read *r)
{
    void *own[] = {r->i, r->j, r->state, r->gid, r->element, r->result};
    for (int k = 0; k < 6; k++) free(own[k]);
}

/* Limit [N] of the friction of pair k under the normal force; 0: no friction. */
static double limit_of(const struct sim *s, const struct read *r, size_t k, double normal)
{
    const struct elements_host *first = s->particle->first;
    int64_t a = r->gid[r->i[k]], b = r->gid[r->j[k]];
    double row[MATERIAL_WIDTH],
        r_star = first->radius[a] * first->radius[b] / (first->radius[a] + first->radius[b]);
    contact_table_material(s->scene, first->material[a], first->material[b], row);
    /* what holds them adds to the load: the pull-off force, JKR: 3 pi w R*, twice of it */
    double held = r->state[k] & CONTACT_BONDED ? contact_table_pull(row, r_star) : 0;
    if (row[MATERIAL_jkr] > 0) held *= 2;
    return row[MATERIAL_mu] * fmax(normal + held, 0);
}

/* Whether pair k has friction, and slips. */
static void look(const struct sim *s, const struct read *r, size_t k, int64_t count[2])
{
    const struct particle_run *run = s->particle;
    bool is_float = run->features.position_is_float;
    double d[3], square = 0, normal = 0, tangential = 0;
    const double *f = r->result + k * r->width;
    for (int a = 0; a < 3; a++) {
        size_t at = (size_t)a;
        d[a] = reals_get(r->element, is_float, (size_t)r->j[k] * r->stride + at) -
               reals_get(r->element, is_float, (size_t)r->i[k] * r->stride + at);
        if (run->period[a] > 0) d[a] -= run->period[a] * round(d[a] / run->period[a]);
        square += d[a] * d[a];
        normal -= f[a] * d[a]; /* it pushes i away from j */
    }
    if (!(square > 0)) return;
    normal /= sqrt(square);
    for (int a = 0; a < 3; a++) {
        double part = f[a] + normal * d[a] / sqrt(square);
        tangential += part * part;
    }
    double limit = limit_of(s, r, k, normal);
    if (!(limit > 0)) return;
    count[0]++;
    count[1] += sqrt(tangential) >= AT_LIMIT * limit;
}

double slipping_share(struct sim *s)
{
    struct particle_run *run = s->particle;
    const struct pair_list *p = &run->pairs->now;
    int64_t count[2] = {0, 0};
    if (!run->features.pair.tangential) return (double)NAN;
    struct read r = read_pairs(s);
    for (size_t k = 0; k < r.n; k++) {
        bool gap = k >= (size_t)p->n_interior && k < (size_t)p->first_boundary;
        if (!gap && r.i[k] < p->n_lower && r.state[k] != 0) look(s, &r, k, count);
    }
    read_free(&r);
    comm_sum_i64(s->comm, count, 2);
    return count[0] > 0 ? (double)count[1] / (double)count[0] : (double)NAN;
}
