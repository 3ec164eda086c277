#include "features.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "kernels/contact/law_wall.h"
#include "comm/fail.h"
#include "contact_table.h"

static bool is_wanted(const struct scene *scene, const char *field)
{
    for (int i = 0; i < scene->output.n_field; i++)
        if (!strcmp(scene->output.field[i], field)) return true;
    return false;
}

static void add_contact(
    struct law_features *law, const struct scene *scene, const struct contact *contact)
{
    double row[MATERIAL_WIDTH];
    contact_table_material(scene, contact->between[0], contact->between[1], row);
    struct contact_material c = material_load(row);
    law->any = true;
    law->damped |= c.gamma_n > 0;
#define ADD(member, flag, needed) law->member |= (needed) != 0;
    CONTACT_FEATURES(ADD)
#undef ADD
}

/* Larger for the smallest or for the largest sizes: it is monotonic in R*. */
static double bond_range(
    const struct scene *scene, const struct contact *c, const double r[2], bool wall)
{
    double row[MATERIAL_WIDTH], part = wall ? 1 : 0.5;
    contact_table_material(scene, c->between[0], c->between[1], row);
    return fmax(contact_table_reach(row, part * r[0]), contact_table_reach(row, part * r[1]));
}

static void element_features(
    struct features *f, const struct scene *scene, const struct elements_host *e, double r[2])
{
    r[0] = INFINITY;
    r[1] = 0;
    for (int64_t i = 0; i < e->n; i++) {
        double m = scene->material[e->material[i]].density * pow(e->radius[i], 3);
        double m0 = scene->material[e->material[0]].density * pow(e->radius[0], 3);
        f->sizes |= e->radius[i] < e->radius[0] || e->radius[i] > e->radius[0] || m < m0 || m > m0;
        f->materials |= e->material[i] != e->material[0];
        for (int a = 0; a < 3; a++) f->spin |= fabs(e->w[3 * i + a]) > 0;
        r[0] = fmin(r[0], e->radius[i]);
        r[1] = fmax(r[1], e->radius[i]);
    }
}

static bool rolls(const struct law_features *law)
{
    return law->rolling_cdt || law->rolling_epsd;
}

static bool rotates(const struct law_features *law)
{
    return law->tangential || rolls(law);
}

struct features features_of(
    const struct scene *scene, const struct walls *walls, const struct elements_host *elements)
{
    struct features f = {0};
    double r[2]; /* smallest, largest [m] */
    f.real_is_float = scene->precision == PRECISION_SINGLE || scene->precision == PRECISION_MIXED;
    f.position_is_float = scene->precision == PRECISION_SINGLE;
    element_features(&f, scene, elements, r);
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
            add_contact(&f.pair, scene, c);
            f.bond_range = fmax(f.bond_range, bond_range(scene, c, r, false));
        }
        if ((is_element[0] && is_wall[1]) || (is_element[1] && is_wall[0])) {
            add_contact(&f.wall, scene, c);
            f.bond_range = fmax(f.bond_range, bond_range(scene, c, r, true));
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
    f.joined = f.triangle || walls_flush(walls);
    f.moving = walls->n_moving > 0;
    for (int w = 0; w < scene->n_wall; w++)
        f.timed |= scene->wall[w].appear_at > 0 || isfinite(scene->wall[w].remove_at);
    f.orientation = is_wanted(scene, "orientation");
    f.spin |= f.materials || f.orientation || is_wanted(scene, "angular_velocity");
    const struct law_features *law[2] = {&f.pair, &f.wall};
    for (int k = 0; k < 2; k++) {
        f.spin |= rotates(law[k]);
        f.spin_kick |= law[k]->tangential_damping || rolls(law[k]);
        f.kick |= law[k]->damped || f.spin_kick;
    }
    for (int a = 0; a < 3; a++) f.periodic[a] = scene->domain.periodic[a];
    f.remove_outside = scene->domain.remove_outside;
    return f;
}

/* clang-format off */
#define ROW(member, option, programs) {#member, option, offsetof(struct features, member), programs}
#define AXIS_ROW(name, axis, option) \
    {name, option, offsetof(struct features, periodic[axis]), ~FEATURES_BODY}
#define LAW_ROW(name, part, member, option, program) \
    {name, option, offsetof(struct features, part.member), program},
#define PAIR_ROW(member, flag, needed) \
    LAW_ROW("pair_" #member, pair, member, "WITH_" #flag, FEATURES_PAIR)
#define WALL_ROW(member, flag, needed) \
    LAW_ROW("wall_" #member, wall, member, "WITH_" #flag, FEATURES_WALL)

const struct feature_row features_table[] = {
    {NULL, "REAL_IS_FLOAT", offsetof(struct features, real_is_float), ~0},
    {NULL, "POSITION_IS_FLOAT", offsetof(struct features, position_is_float), ~0},
    ROW(spin, "WITH_SPIN", ~0),
    ROW(sizes, "WITH_SIZES", ~FEATURES_LISTS),
    ROW(materials, "WITH_MATERIALS", FEATURES_PAIR | FEATURES_WALL),
    ROW(wall_table, "WITH_TABLE", FEATURES_WALL),
    ROW(energy, "WITH_ENERGY", FEATURES_PAIR | FEATURES_WALL),
    ROW(kick, "WITH_KICK", ~0),
    ROW(spin_kick, "WITH_SPIN_KICK", ~0),
    ROW(orientation, "WITH_ORIENTATION", FEATURES_BODY),
    AXIS_ROW("periodic_x", 0, "WITH_PERIODIC_X"),
    AXIS_ROW("periodic_y", 1, "WITH_PERIODIC_Y"),
    AXIS_ROW("periodic_z", 2, "WITH_PERIODIC_Z"),
    ROW(walls, "WITH_WALLS", FEATURES_WALL | FEATURES_BODY),
    ROW(plane, "WITH_PLANE", FEATURES_WALL),
    ROW(rectangle, "WITH_RECTANGLE", FEATURES_WALL),
    ROW(cylinder, "WITH_CYLINDER", FEATURES_WALL),
    ROW(triangle, "WITH_TRIANGLE", FEATURES_WALL),
    ROW(joined, "WITH_JOINED", FEATURES_WALL),
    ROW(moving, "WITH_MOVING", FEATURES_WALL),
    ROW(timed, NULL, 0),
    ROW(remove_outside, NULL, 0),
    CONTACT_FEATURES(PAIR_ROW)
    CONTACT_FEATURES(WALL_ROW)
    {NULL, NULL, 0, 0}};
/* clang-format on */

/* What moves elements knows of the laws only whether their results have torques. */
char *features_options(const struct features *f, enum features_program program)
{
    char *rows = feature_table_options(features_table, f, program);
    if (program != FEATURES_BODY) return rows;
    char *text = fail_format("%s -DWITH_PAIR_ROTATION=%d -DWITH_PAIR_ROLLING=%d "
                             "-DWITH_WALL_ROTATION=%d",
        rows, rotates(&f->pair), rolls(&f->pair), rotates(&f->wall));
    free(rows);
    return text;
}
