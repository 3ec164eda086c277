/* Rules of a scene of method lattice that tie several keys together. What only the cells can tell
 * is in lattice_cells.c. */
#include <math.h>
#include <stdlib.h>

#include "comm/fail.h"
#include "laws/lattice_limit.h"
#include "scene_path.h"
#include "scene_reader.h"

_Static_assert((int)LAW_REFERENCE == LINK_REFERENCE && (int)SCHEME_VEFRL == LATTICE_VEFRL &&
                   (int)SCHEME_RKN4 == LATTICE_RKN4,
    "the scene's words and the laws");

static bool is_given(const struct scene_reader *reader, const char *path)
{
    return scene_path_find(reader->root, path) != NULL;
}

static void check_damping(struct scene_reader *reader, const struct material *m)
{
    char *path = fail_format("materials.%s.damping", m->name);
    char *ratio = fail_format("%s.ratio", path), *mass = fail_format("%s.mass", path),
         *link = fail_format("%s.link", path);
    if (!scene_issue_is_below(reader, path) && is_given(reader, ratio) &&
        (is_given(reader, mass) || is_given(reader, link)))
        scene_issue_on(reader, ratio, "cannot be combined with 'mass' and 'link'");
    else if (!scene_issue_is_below(reader, path) && !scene_issue_is_below(reader, "time.scheme")) {
        bool by_link =
            m->link_damping > 0 || (m->damping_ratio > 0 && m->damping_by == DAMPING_LINK);
        if (by_link &&
            !(lattice_limit_factor((enum lattice_scheme)reader->scene->time.scheme, 1) > 0))
            scene_issue_on(reader, path,
                "this scheme does not support stiffness-proportional (link) damping; leapfrog "
                "and rk4 do");
    }
    free(path);
    free(ratio);
    free(mass);
    free(link);
}

/* Where nothing is said the criterion is `stress`, beside `energy` `largest`: the link at a crack's
 * tip also bends, and the sum of both would break it at 0.64 of the load (cases/notched_bar). */
static void check_strength(struct scene_reader *reader, struct material *m)
{
    char *path = fail_format("materials.%s.strength", m->name);
    char *criterion = fail_format("%s.criterion", path), *shear = fail_format("%s.shear", path),
         *way = fail_format("%s.path", path);
    if (!scene_issue_is_below(reader, path)) {
        if (!is_given(reader, criterion))
            m->criterion = m->energy > 0 ? CRITERION_LARGEST : CRITERION_STRESS;
        if (m->energy > 0 && m->criterion != CRITERION_LARGEST &&
            m->criterion != CRITERION_PRINCIPAL)
            scene_issue_on(reader, criterion, "beside 'energy' it is largest or principal");
        if (m->criterion == CRITERION_PRINCIPAL && isfinite(m->shear))
            scene_issue_on(reader, shear,
                "not with criterion: principal, which breaks shear by its principal stress");
        if (m->criterion != CRITERION_PRINCIPAL && m->crack_path != PATH_GRID)
            scene_issue_on(reader, way, "with criterion: principal only");
    }
    free(path);
    free(criterion);
    free(shear);
    free(way);
}

static void check_materials(struct scene_reader *reader)
{
    for (int k = 0; k < reader->scene->n_material; k++) {
        struct material *m = &reader->scene->material[k];
        if (m->has_strength) check_strength(reader, m);
        char *path = fail_format("materials.%s", m->name),
             *poisson = fail_format("%s.poisson", path);
        check_damping(reader, m);
        if (!scene_issue_is_below(reader, path)) {
            struct link_material own = {m->density, m->young, m->poisson, m->link_damping};
            const char *refusal =
                link_constants_refusal((enum link_set)reader->scene->lattice.law, own);
            if (refusal) scene_issue_on(reader, poisson, "%s", refusal);
        }
        free(poisson);
        free(path);
    }
}

static void check_bodies(struct scene_reader *reader)
{
    for (int k = 0; k < reader->scene->n_body; k++) {
        const struct body *body = &reader->scene->body[k];
        scene_check_region(reader, fail_format("bodies[%d].shape", k), &body->shape, false);
        for (int m = 0; m < body->n_minus; m++)
            scene_check_region(
                reader, fail_format("bodies[%d].minus[%d]", k, m), &body->minus[m], false);
        for (int c = 0; c < body->n_crack; c++)
            scene_check_region(
                reader, fail_format("bodies[%d].cracks[%d]", k, c), &body->crack[c], true);
    }
}

static bool is_all_free(const struct boundary *b)
{
    return isinf(b->value[0]) && isinf(b->value[1]) && isinf(b->value[2]);
}

static void check_boundary(struct scene_reader *reader, int k)
{
    const struct boundary *b = &reader->scene->boundary[k];
    char *path = fail_format("boundaries[%d]", k), *where = fail_format("%s.where", path),
         *history = fail_format("%s.history", path);
    char *fix = fail_format("%s.fix", path);
    const struct scene_node *node = scene_path_find(reader->root, where);
    if (node && node->kind == NODE_MAPPING && node->n == 0)
        scene_issue_on(reader, where, "needs a shape, a body, or the word all");
    if (!scene_issue_is_below(reader, path)) {
        bool fixes = false;
        for (int c = 0; c < 6; c++) fixes = fixes || b->fix[c];
        if (b->kind == BOUNDARY_FIX && !fixes)
            scene_issue_on(reader, fix, "an empty list fixes nothing");
        if (b->kind == BOUNDARY_FIX && b->history.kind != HISTORY_CONSTANT)
            scene_issue_on(
                reader, history, "'fix' takes no history: a support holds for the whole run");
        bool prescribes = b->kind == BOUNDARY_VELOCITY || b->kind == BOUNDARY_ANGULAR_VELOCITY;
        if (prescribes && is_all_free(b)) scene_issue_on(reader, path, "all components are free");
    }
    scene_check_region(reader, where, &b->where, true);
    free(fix);
    free(history);
    free(path);
}

void scene_check_lattice(struct scene_reader *reader)
{
    check_materials(reader);
    check_bodies(reader);
    for (int k = 0; k < reader->scene->n_boundary; k++) check_boundary(reader, k);
    if (reader->scene->lattice.relax && !scene_issue_is_below(reader, "time.scheme") &&
        reader->scene->time.scheme != SCHEME_LEAPFROG)
        scene_issue_on(reader, "time.scheme", "lattice.relax supports leapfrog only");
    if (!scene_issue_is_below(reader, "partition.boundary") &&
        reader->scene->partition.boundary == CUT_PAIRS_ASSIGNED)
        scene_issue_on(
            reader, "partition.boundary", "'assigned' is only valid with method: particles");
}

void scene_check_derive_damping(struct scene *scene)
{
    for (int k = 0; k < scene->n_material; k++) {
        struct material *m = &scene->material[k];
        if (!(m->damping_ratio > 0)) continue;
        /* zeta = alpha/(2 w) + eta w/2 at w = 2 pi f */
        if (m->damping_by == DAMPING_MASS)
            m->mass_damping = 4 * M_PI * m->damping_at * m->damping_ratio;
        else m->link_damping = m->damping_ratio / (M_PI * m->damping_at);
    }
}
