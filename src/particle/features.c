#include "features.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#include "kernels/contact/law_wall.h"
#include "comm/fail.h"

static bool is_wanted(const struct scene *scene, const char *field)
{
    for (int i = 0; i < scene->output.n_field; i++)
        if (!strcmp(scene->output.field[i], field)) return true;
    return false;
}

static void add_contact(struct law_features *law, const struct contact *c)
{
    law->any = true;
    law->linear |= c->normal_law == NORMAL_LINEAR;
    law->hertz |= c->normal_law == NORMAL_HERTZ;
    law->no_attraction |= !c->attraction;
    law->tangential |= c->has_tangential && c->friction > 0;
    law->tangential_damping |= c->has_tangential && c->friction > 0 && c->tangential_damping > 0;
    law->rolling_cdt |= c->rolling == ROLLING_CDT;
    law->rolling_epsd |= c->rolling == ROLLING_EPSD;
    law->binding |= c->binding_force > 0;
}

/* F_b/k_n, or (F_b/K)^(2/3) with K = (4/3) E* R*^(1/2) of the smallest sizes. */
static double bond_range(const struct scene *scene, const struct contact *c, double r_min)
{
    if (c->binding_force <= 0) return 0;
    if (c->normal_law == NORMAL_LINEAR) return c->binding_force / c->stiffness;
    const struct material *a = &scene->material[c->between[0]],
                          *b = &scene->material[c->between[1]];
    double e_star =
        1 / ((1 - a->poisson * a->poisson) / a->young + (1 - b->poisson * b->poisson) / b->young);
    double k = 4.0 / 3.0 * e_star * sqrt(0.5 * r_min);
    return pow(c->binding_force / k, 2.0 / 3.0);
}

static void element_features(
    struct features *f, const struct scene *scene, const struct elements_host *e, double *r_min)
{
    *r_min = INFINITY;
    for (int64_t i = 0; i < e->n; i++) {
        double m = scene->material[e->material[i]].density * pow(e->radius[i], 3);
        double m0 = scene->material[e->material[0]].density * pow(e->radius[0], 3);
        f->sizes |= e->radius[i] < e->radius[0] || e->radius[i] > e->radius[0] || m < m0 || m > m0;
        f->materials |= e->material[i] != e->material[0];
        for (int a = 0; a < 3; a++) f->spin |= fabs(e->w[3 * i + a]) > 0;
        *r_min = fmin(*r_min, e->radius[i]);
    }
}

struct features features_of(
    const struct scene *scene, const struct walls *walls, const struct elements_host *elements)
{
    struct features f = {0};
    double r_min;
    f.real_is_float = scene->precision == PRECISION_SINGLE || scene->precision == PRECISION_MIXED;
    f.position_is_float = scene->precision == PRECISION_SINGLE;
    element_features(&f, scene, elements, &r_min);
    for (int i = 0; i < scene->n_contact; i++) {
        const struct contact *c = &scene->contact[i];
        bool is_element[2] = {false, false}, is_wall[2] = {false, false};
        for (int s = 0; s < 2; s++) {
            for (int g = 0; g < scene->n_group; g++)
                is_element[s] |= scene->group[g].material == c->between[s];
            for (int w = 0; w < scene->n_wall; w++)
                is_wall[s] |= scene->wall[w].material == c->between[s];
        }
        if (is_element[0] && is_element[1]) {
            add_contact(&f.pair, c);
            f.bond_range = fmax(f.bond_range, bond_range(scene, c, r_min));
        }
        if ((is_element[0] && is_wall[1]) || (is_element[1] && is_wall[0])) {
            add_contact(&f.wall, c);
            f.bond_range = fmax(f.bond_range, bond_range(scene, c, 2 * r_min));
        }
    }
    for (int i = 0; i < scene->n_measure; i++) f.energy |= scene->measure[i].kind == MEASURE_ENERGY;
    for (int w = 1; w < scene->n_wall; w++)
        f.wall_table |= scene->wall[w].material != scene->wall[0].material;
    f.wall_table |= f.materials;
    f.walls = walls->n_primitive > 0;
    f.plane = walls->n_of_kind[WALL_PLANE] > 0;
    f.rectangle = walls->n_of_kind[WALL_RECTANGLE] > 0;
    f.cylinder = walls->n_of_kind[WALL_PIPE] + walls->n_of_kind[WALL_ROD] > 0;
    f.triangle = walls->n_of_kind[WALL_TRIANGLE] > 0;
    f.moving = walls->n_moving > 0;
    for (int w = 0; w < scene->n_wall; w++)
        f.timed |= scene->wall[w].appear_at > 0 || isfinite(scene->wall[w].remove_at);
    f.orientation = is_wanted(scene, "orientation");
    f.spin |= f.materials || f.orientation || is_wanted(scene, "angular_velocity");
    const struct law_features *law[2] = {&f.pair, &f.wall};
    for (int k = 0; k < 2; k++)
        f.spin |= law[k]->tangential || law[k]->rolling_cdt || law[k]->rolling_epsd;
    for (int a = 0; a < 3; a++) f.periodic[a] = scene->domain.periodic[a];
    f.remove_outside = scene->domain.remove_outside;
    return f;
}

static bool rotates(const struct law_features *law)
{
    return law->tangential || law->rolling_cdt || law->rolling_epsd;
}

char *features_options(const struct features *f, enum features_program program)
{
    struct law_features none = {0};
    const struct law_features *law = program == FEATURES_PAIR   ? &f->pair
                                     : program == FEATURES_WALL ? &f->wall
                                                                : &none;
    return fail_format(
        "-DREAL_IS_FLOAT=%d -DPOSITION_IS_FLOAT=%d -DWITH_SPIN=%d -DWITH_SIZES=%d "
        "-DWITH_MATERIALS=%d -DWITH_TABLE=%d "
        "-DWITH_PERIODIC_X=%d -DWITH_PERIODIC_Y=%d -DWITH_PERIODIC_Z=%d -DWITH_WALLS=%d "
        "-DWITH_PLANE=%d -DWITH_RECTANGLE=%d "
        "-DWITH_CYLINDER=%d -DWITH_TRIANGLE=%d -DWITH_MOVING=%d -DWITH_ENERGY=%d "
        "-DWITH_ORIENTATION=%d "
        "-DWITH_LINEAR=%d -DWITH_HERTZ=%d -DWITH_NO_ATTRACTION=%d -DWITH_TANGENTIAL=%d "
        "-DWITH_TANGENTIAL_DAMPING=%d "
        "-DWITH_ROLLING_CDT=%d -DWITH_ROLLING_EPSD=%d -DWITH_BINDING=%d "
        "-DWITH_PAIR_ROTATION=%d -DWITH_PAIR_ROLLING=%d -DWITH_WALL_ROTATION=%d",
        f->real_is_float, f->position_is_float, f->spin, f->sizes, f->materials, f->wall_table,
        f->periodic[0], f->periodic[1], f->periodic[2], f->walls, f->plane, f->rectangle,
        f->cylinder, f->triangle, f->moving && program != FEATURES_PAIR,
        f->energy && program != FEATURES_BODY, f->orientation, law->linear || !law->hertz,
        law->hertz, law->no_attraction, law->tangential, law->tangential_damping, law->rolling_cdt,
        law->rolling_epsd, law->binding, rotates(&f->pair),
        f->pair.rolling_cdt || f->pair.rolling_epsd, rotates(&f->wall));
}

#define FEATURE(member)                                                                            \
    {                                                                                              \
#member, offsetof(struct features, member)                                                 \
    }
#define LAW_FEATURE(name, part, member)                                                            \
    {                                                                                              \
        name, offsetof(struct features, part) + offsetof(struct law_features, member)              \
    }
static const struct {
    const char *name;
    size_t at;
} feature_table[] = {FEATURE(spin), FEATURE(sizes), FEATURE(materials), FEATURE(wall_table),
    FEATURE(energy), FEATURE(orientation), {"periodic_x", offsetof(struct features, periodic)},
    {"periodic_y", offsetof(struct features, periodic) + sizeof(bool)},
    {"periodic_z", offsetof(struct features, periodic) + 2 * sizeof(bool)}, FEATURE(walls),
    FEATURE(plane), FEATURE(rectangle), FEATURE(cylinder), FEATURE(triangle), FEATURE(moving),
    FEATURE(timed), FEATURE(remove_outside), LAW_FEATURE("pair_linear", pair, linear),
    LAW_FEATURE("pair_hertz", pair, hertz), LAW_FEATURE("pair_no_attraction", pair, no_attraction),
    LAW_FEATURE("pair_tangential", pair, tangential),
    LAW_FEATURE("pair_tangential_damping", pair, tangential_damping),
    LAW_FEATURE("pair_rolling_cdt", pair, rolling_cdt),
    LAW_FEATURE("pair_rolling_epsd", pair, rolling_epsd),
    LAW_FEATURE("pair_binding", pair, binding), LAW_FEATURE("wall_linear", wall, linear),
    LAW_FEATURE("wall_hertz", wall, hertz), LAW_FEATURE("wall_no_attraction", wall, no_attraction),
    LAW_FEATURE("wall_tangential", wall, tangential),
    LAW_FEATURE("wall_tangential_damping", wall, tangential_damping),
    LAW_FEATURE("wall_rolling_cdt", wall, rolling_cdt),
    LAW_FEATURE("wall_rolling_epsd", wall, rolling_epsd),
    LAW_FEATURE("wall_binding", wall, binding), {NULL, 0}};

const char *features_name(int i)
{
    return feature_table[i].name;
}

bool features_value(const struct features *features, int i)
{
    return *(const bool *)((const char *)features + feature_table[i].at);
}
