#include <string.h>

#include "two_body.h"

struct body two_body_sphere(real m, real r, pvec3 x, vec3 v, vec3 w)
{
    struct body b;
    b.x = x;
    b.v = v;
    b.w = w;
    b.force = b.torque = b.kick = b.spun = v3(0, 0, 0);
    b.m = m;
    b.r = r;
    b.mobility = 1;
    return b;
}

void two_body_set(struct two_body *s, struct contact_material c)
{
    const struct body *i = &s->b[0], *j = &s->b[1];
    struct contact_pair sizes =
        s->plane ? contact_pair_wall((real)1 / i->m, i->r)
                 : contact_pair_of(i->mobility / i->m, j->mobility / j->m, i->r, j->r);
    s->p = contact_parameters_of(c, sizes, s->dt);
    memset(&s->h, 0, sizeof s->h);
    memset(s->lost, 0, sizeof s->lost);
}

static void kick_half(struct two_body *s)
{
    for (int n = 0; n < 2; n++) {
        struct body *b = &s->b[n];
        real half = (real)0.5 * s->dt * b->mobility / b->m;
        b->kick = v3_scale(half, b->force);
        b->spun = v3_scale(half / ((real)0.4 * b->r * b->r), b->torque);
        b->v = v3_add(b->v, b->kick);
        b->w = v3_add(b->w, b->spun);
    }
}

static struct contact_kinematics kinematics(const struct two_body *s)
{
    const struct body *i = &s->b[0], *j = &s->b[1];
    vec3 zero = v3(0, 0, 0);
    struct kinematics_motion m =
        kinematics_free(i->v, s->plane ? zero : j->v, i->w, s->plane ? zero : j->w);
    m.kick = s->plane ? i->kick : v3_sub(i->kick, j->kick);
    m.spun_i = i->spun;
    m.spun_j = s->plane ? zero : j->spun;
    m.radius_lever = parameters_radius_lever(s->p);
    if (s->plane) {
        vec3 down = v3(0, 0, -1);
        real delta = (real)((preal)i->r - i->x.z);
        return contact_kinematics_wall(
            down, down, delta, delta + (real)0.5 * s->dt * i->v.z, m, i->r);
    }
    return contact_kinematics_pair(p3_sub(j->x, i->x), m, i->r, j->r, s->dt);
}

void two_body_step(struct two_body *s)
{
    struct body *i = &s->b[0], *j = &s->b[1];

    kick_half(s);
    i->x = p3_fma((preal)(s->dt * i->mobility), p3_of_v3(i->v), i->x);
    j->x = p3_fma((preal)(s->dt * j->mobility), p3_of_v3(j->v), j->x);
    s->k = kinematics(s);
    s->r = contact_law(s->k, s->p, s->dt, &s->h);
    i->force = v3_add(v3_add(s->r.force, s->pull), v3_scale(i->m, s->gravity));
    j->force = v3_add(v3_neg(s->r.force), v3_scale(j->m, s->gravity));
    i->torque = v3_fma(s->k.l_i, s->r.couple, s->r.moment);
    j->torque = v3_sub(v3_scale(s->k.l_j, s->r.couple), s->r.moment);
    kick_half(s);
    s->lost[0] += (double)s->r.loss_n;
    s->lost[1] += (double)s->r.loss_t;
    s->lost[2] += (double)s->r.loss_s;
    s->lost[3] += (double)s->r.loss_r;
    s->lost[4] += (double)s->r.loss_b;
}

double two_body_kinetic(const struct two_body *s)
{
    double sum = 0;
    for (int n = 0; n < (s->plane ? 1 : 2); n++) {
        const struct body *b = &s->b[n];
        double m = (double)b->m, r = (double)b->r;
        sum += (double)b->mobility * 0.5 * m *
               ((double)v3_dot(b->v, b->v) + 0.4 * r * r * (double)v3_dot(b->w, b->w));
    }
    return sum;
}

double two_body_lost(const struct two_body *s)
{
    return s->lost[0] + s->lost[1] + s->lost[2] + s->lost[3] + s->lost[4];
}

double two_body_energy(const struct two_body *s)
{
    double sum = two_body_kinetic(s) + (double)s->r.elastic;
    for (int n = 0; n < (s->plane ? 1 : 2); n++)
        sum -= (double)s->b[n].m * (double)p3_dot(s->b[n].x, p3_of_v3(s->gravity));
    return sum;
}
