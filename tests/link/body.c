#include "body.h"

#include <string.h>

double body_size(vec3 a)
{
    return sqrt((double)v3_dot(a, a));
}

void body_build(
    struct body *b, const int size[3], int (*solid)(int x, int y, int z), int periodic, double h)
{
    static int cell[64][16][16];
    memset(b, 0, sizeof *b);
    b->h = h;
    b->materials[0] = (struct link_material){.density = 1, .young = 1};
    for (int x = 0; x < size[0]; x++)
        for (int y = 0; y < size[1]; y++)
            for (int z = 0; z < size[2]; z++) {
                cell[x][y][z] = -1;
                if (solid && !solid(x, y, z)) continue;
                if (b->n == BODY_MOST) fail_msg("more than %d cells", BODY_MOST);
                cell[x][y][z] = b->n;
                b->at[b->n][0] = x;
                b->at[b->n][1] = y;
                b->at[b->n][2] = z;
                b->q[b->n++] = quat_of(1, 0, 0, 0);
            }
    for (int i = 0; i < b->n; i++)
        for (int face = 0; face < 6; face++) {
            int a = face / 2, to[3] = {b->at[i][0], b->at[i][1], b->at[i][2]};
            to[a] += face & 1 ? 1 : -1;
            if (periodic & 1 << a) to[a] = (to[a] + size[a]) % size[a];
            b->neighbour[i][face] = to[a] < 0 || to[a] >= size[a] ? -1 : cell[to[0]][to[1]][to[2]];
        }
}

static vec3 any3(double size)
{
    double x = uniform(-size, size), y = uniform(-size, size), z = uniform(-size, size);
    return v3((real)x, (real)y, (real)z);
}

void body_shake(struct body *b, double shift, double turn)
{
    for (int i = 0; i < b->n; i++) {
        b->u[i] = p3_of_v3(any3(shift));
        b->theta[i] = p3_of_v3(any3(turn));
        b->q[i] = quat_turn(quat_of(1, 0, 0, 0), b->theta[i]);
        b->v[i] = any3(shift);
        b->w[i] = any3(turn);
    }
}

pvec3 body_place(const struct body *b, int i)
{
    return p3(
        (preal)(b->h * b->at[i][0]), (preal)(b->h * b->at[i][1]), (preal)(b->h * b->at[i][2]));
}

pvec3 body_now(const struct body *b, int i)
{
    return p3_add(body_place(b, i), b->u[i]);
}

static vec3 turned(struct quat Q, vec3 a)
{
    return v3_of_p3(quat_rotate(Q, p3_of_v3(a)));
}

void body_turn(struct body *b, struct quat Q)
{
    for (int i = 0; i < b->n; i++) {
        b->u[i] = p3_sub(quat_rotate(Q, body_now(b, i)), body_place(b, i));
        b->q[i] = quat_times(Q, b->q[i]);
        b->v[i] = turned(Q, b->v[i]);
        b->w[i] = turned(Q, b->w[i]);
        for (int face = 0; face < 6; face++) b->traction[i][face] = turned(Q, b->traction[i][face]);
    }
}

void body_load(struct body *b, const double S[3][3])
{
    for (int i = 0; i < b->n; i++)
        for (int face = 0; face < 6; face++) {
            double sign = face & 1 ? 1 : -1;
            const double *row = S[face / 2];
            if (b->neighbour[i][face] < 0)
                b->traction[i][face] =
                    v3((real)(sign * row[0]), (real)(sign * row[1]), (real)(sign * row[2]));
        }
}

static struct link_cell cell_of(const struct body *b, int i)
{
    struct link_cell c = {p3(0, 0, 0), p3(0, 0, 0), quat_of(1, 0, 0, 0), v3(0, 0, 0), v3(0, 0, 0)};
    return i < 0 ? c : (struct link_cell){b->u[i], b->theta[i], b->q[i], b->v[i], b->w[i]};
}

static struct link_material material_of(const struct body *b, int i)
{
    return b->materials[b->material[i]];
}

/* A share of the face, and where its middle is. */
static void cut(struct body_link *l)
{
    struct link_constants *k = &l->k;
    real share = (real)(0.3 + 0.1 * ((7 * l->i + 3 * l->j + l->axis) % 8)), h = k->h;
    k->kn *= share;
    k->ks *= share;
    k->kt *= share;
    k->kb *= share;
    k->r_i *= share;
    k->r_j *= share;
    k->is_cut = 1;
    k->offset = v3(0, (real)(0.1 * (l->j % 5 - 2)) * h, (real)(0.15 * (l->i % 4 - 2)) * h);
}

struct body_link body_link_of(const struct body *b, int i, int face)
{
    int other = b->neighbour[i][face];
    struct body_link l = {.axis = face / 2, .i = face & 1 ? i : other, .j = face & 1 ? other : i};
    struct link_stiffness k =
        l.i >= 0 && l.j >= 0
            ? link_constants_between(b->set, material_of(b, l.i), material_of(b, l.j), b->h)
            : link_constants_wall(b->set, material_of(b, i), b->h);
    int swap = l.i < 0; /* the wall is the lower one */
    l.k = (struct link_constants){.kn = (real)k.kn,
        .ks = (real)k.ks,
        .kt = (real)k.kt,
        .kb = (real)k.kb,
        .r_i = (real)(swap ? k.r_j : k.r_i),
        .r_j = (real)(swap ? k.r_i : k.r_j),
        .h = (real)b->h,
        .eta = (real)k.eta};
    if (WITH_SHARES && l.i >= 0 && l.j >= 0) cut(&l);
    l.lower = cell_of(b, l.i);
    l.upper = cell_of(b, l.j);
    return l;
}

static int has_link(const struct body *b, int i, int face)
{
    return b->neighbour[i][face] >= 0 || b->walls[i] >> face & 1;
}

/* Each axis by its own constant, as in a kernel. */
static struct link_state state_of(const struct body_link *l)
{
    if (l->axis == 0) return link_state_of(0, l->lower, l->upper, l->k);
    if (l->axis == 1) return link_state_of(1, l->lower, l->upper, l->k);
    return link_state_of(2, l->lower, l->upper, l->k);
}

static struct volume_constants volume_of(const struct body *b, int i)
{
    struct link_material m = material_of(b, i);
    struct volume_constants c = {.lambda = (real)link_constants_lambda(b->set, m),
        .per_4g = (real)(0.25 / link_constants_shear(m)),
        .per_2h = (real)(0.5 / b->h),
        .volume = (real)(b->h * b->h * b->h)};
    c.share = (real)(0.6 + 0.1 * (i % 4));
    c.missing = 2 * c.share;
    c.least = (real)(i % 3 ? 0 : 2); /* of some cells it counts */
    return c;
}

/* Outward normal of a face, as far as the kinematics turn it. */
static vec3 normal_of(const struct body *b, int i, int face)
{
    real sign = face & 1 ? (real)1 : (real)-1;
    pvec3 e = p3_uncycle(p3(1, 0, 0), face / 2);
    return v3_scale(sign, v3_of_p3(WITH_TURN ? p3_add(e, quat_column(b->q[i], face / 2)) : e));
}

/* Sum of the normal tractions on faces without link [Pa], and of their squares. */
static real tractions_of(const struct body *b, int i, real *squares)
{
    real sum = 0;
    *squares = 0;
    for (int face = 0; face < 6; face++) {
        if (has_link(b, i, face)) continue;
        real t = v3_dot(b->traction[i][face], normal_of(b, i, face));
        sum += t;
        *squares += t * t;
    }
    return sum;
}

/* Th; of strains, or (rate) of their rates. */
static real strain_of(const struct body *b, int i, int rate)
{
    real sum = 0, squares;
    int links = 0;
    for (int face = 0; face < 6; face++) {
        if (has_link(b, i, face)) {
            struct body_link l = body_link_of(b, i, face);
            struct link_state s = state_of(&l);
            real stretch =
                rate ? link_normal_rate(s) : link_stretch(s, (real)material_of(b, i).damping);
            sum += volume_part(1, face & 1 ? l.k.r_i : l.k.r_j, stretch);
            links |= 1 << face;
        }
    }
    return volume_strain(sum, rate ? 0 : tractions_of(b, i, &squares), links, volume_of(b, i));
}

/* Share of cell i over `face`: of the link, or of the load. */
static struct link_share share_of(const struct body *b, int i, int face)
{
    struct link_share r;
    if (has_link(b, i, face)) {
        struct body_link l = body_link_of(b, i, face);
        struct link_state s = state_of(&l);
        real p_i = l.i < 0 ? 0 : volume_of(b, l.i).lambda * b->strain[l.i],
             p_j = l.j < 0 ? 0 : volume_of(b, l.j).lambda * b->strain[l.j];
        struct link_force f = link_force_of(s, l.k, p_i, p_j);
        return face & 1 ? link_on_lower(l.axis, s, f) : link_on_upper(l.axis, s, f);
    }
    r.force = v3_scale((real)(b->h * b->h), b->traction[i][face]);
    r.torque = v3_scale((real)(0.5 * b->h), v3_cross(normal_of(b, i, face), r.force));
    return r;
}

void body_forces(struct body *b)
{
    real per_area = (real)(1 / (b->h * b->h));
    for (int i = 0; i < b->n; i++) b->strain[i] = WITH_VOLUME ? strain_of(b, i, 0) : 0;
    for (int i = 0; i < b->n; i++) {
        struct link_share s[6];
        b->force[i] = b->torque[i] = v3(0, 0, 0);
        b->links[i] = b->faces[i] = 0;
        for (int face = 0; face < 6; face++) {
            s[face] = share_of(b, i, face);
            b->force[i] = v3_add(b->force[i], s[face].force);
            b->torque[i] = v3_add(b->torque[i], s[face].torque);
            if (has_link(b, i, face)) b->links[i] |= 1 << face;
            if (has_link(b, i, face) || body_size(b->traction[i][face]) > 0)
                b->faces[i] |= 1 << face;
        }
        for (int form = 0; form < 2; form++) {
            b->rows[form][i].x = stress_row(s[1].force, s[0].force, 0, b->faces[i], form, per_area);
            b->rows[form][i].y = stress_row(s[3].force, s[2].force, 1, b->faces[i], form, per_area);
            b->rows[form][i].z = stress_row(s[5].force, s[4].force, 2, b->faces[i], form, per_area);
        }
    }
}

/* Sum over links, each once, and cells. */
static double total(const struct body *b, int rate)
{
    double sum = 0;
    for (int i = 0; i < b->n; i++) {
        int links = 0;
        for (int face = 0; face < 6; face++) {
            if (!has_link(b, i, face)) continue;
            links |= 1 << face;
            if (!(face & 1) && b->neighbour[i][face] >= 0) continue;
            struct body_link l = body_link_of(b, i, face);
            struct link_state s = state_of(&l);
            sum += (double)(rate ? link_dissipation(s, l.k) : link_energy(s, l.k));
        }
        if (!WITH_VOLUME) continue;
        real squares, traction = tractions_of(b, i, &squares), strain = strain_of(b, i, rate);
        double energy = (double)volume_energy(
            strain, rate ? 0 : traction, rate ? 0 : squares, links, volume_of(b, i));
        sum += rate ? 2 * material_of(b, i).damping * energy : energy;
    }
    return sum;
}

double body_energy(const struct body *b)
{
    return total(b, 0);
}

double body_dissipation(const struct body *b)
{
    return total(b, 1);
}

struct lattice_body body_lattice(const struct body *b)
{
    return (struct lattice_body){.set = b->set,
        .h = b->h,
        .n = b->n,
        .neighbour = b->neighbour,
        .walls = b->walls,
        .material = b->material,
        .materials = b->materials,
        .n_material = 4};
}
