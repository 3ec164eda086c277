#include "lattice_features.h"

#include <stddef.h>
#include <string.h>

#include "lattice_frequency.h"
#include "lattice_loads.h"

static const struct material *material_of(const struct scene *scene, const struct lattice_cells *cells, int kind)
{
    return &scene->material[cells->kind[kind].material];
}

/* Links that can occur: between cells on one grid. */
static void link_features(struct lattice_features *f, const struct scene *scene, const struct lattice_cells *cells)
{
    enum link_set set = (enum link_set)scene->lattice.law;
    for (int i = 0; i < cells->n_kind; i++)
        for (int j = i; j < cells->n_kind; j++) {
            if (cells->kind[i].grid != cells->kind[j].grid) continue;
            struct link_material a = lattice_frequency_material(material_of(scene, cells, i)),
                                 b = lattice_frequency_material(material_of(scene, cells, j));
            struct link_stiffness k = link_constants_between(set, a, b, cells->grid[cells->kind[i].grid].h);
            f->shear_apart |= link_constants_shear_apart(k);
            f->twist_apart |= link_constants_twist_apart(k);
        }
}

static bool is_stress(const char *field)
{
    return strcmp(field, "stress") == 0 || strcmp(field, "von_mises") == 0;
}

static bool wants_stress(const struct scene *scene)
{
    bool wants = false;
    for (int k = 0; k < scene->output.n_field; k++) wants |= is_stress(scene->output.field[k]);
    for (int m = 0; m < scene->n_measure; m++) {
        wants |= scene->measure[m].kind == MEASURE_STRESS_MAX;
        for (int k = 0; k < scene->measure[m].n_field; k++) wants |= is_stress(scene->measure[m].field[k]);
    }
    return wants;
}

struct lattice_features lattice_features_of(const struct scene *scene, const struct lattice_cells *cells)
{
    struct lattice_features f = {0};
    f.real_is_float = scene->precision == PRECISION_SINGLE || scene->precision == PRECISION_MIXED;
    f.position_is_float = scene->precision == PRECISION_SINGLE;
    f.turn = scene->lattice.rotation == ROTATION_FINITE;
    for (int k = 0; k < cells->n_kind; k++) {
        const struct material *m = material_of(scene, cells, k);
        f.volume |= m->poisson < 0 || m->poisson > 0;
        f.link_damping |= m->link_damping > 0;
        f.mass_damping |= m->mass_damping > 0;
        f.breakage |= m->has_strength;
    }
    link_features(&f, scene, cells);
    for (int64_t i = 0; i < cells->n && !f.fix; i++) f.fix = (cells->bits[i] & CELL_FIXED) != 0;
    f.loads = cells->loads->n_row > 1;
    for (int a = 0; a < 3; a++) f.gravity |= scene->gravity[a] < 0 || scene->gravity[a] > 0;
    f.kinds = cells->n_kind > 1;
    f.rk = scene->time.scheme == SCHEME_RK4 || scene->time.scheme == SCHEME_RKN4;
    f.stress = wants_stress(scene);
    f.relax = scene->lattice.relax;
    return f;
}

#define FEATURE(member)                                                                                                                              \
    {                                                                                                                                                \
#member, offsetof(struct lattice_features, member)                                                                                           \
    }
static const struct {
    const char *name;
    size_t at;
} feature_table[] = {FEATURE(turn), FEATURE(volume), FEATURE(shear_apart), FEATURE(twist_apart), FEATURE(link_damping), FEATURE(mass_damping),
    FEATURE(fix), FEATURE(loads), FEATURE(gravity), FEATURE(kinds), FEATURE(rk), FEATURE(stress), FEATURE(breakage), FEATURE(relax), {NULL, 0}};

const char *lattice_features_name(int i)
{
    return feature_table[i].name;
}

bool lattice_features_value(const struct lattice_features *features, int i)
{
    return *(const bool *)((const char *)features + feature_table[i].at);
}
