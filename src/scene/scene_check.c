/* Rules of a scene that tie several keys together, and what is derived from several keys. Each rule
 * looks only at what was read without issue, so that one mistake gives one message. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "comm/fail.h"
#include "laws/restitution.h"
#include "scene_path.h"
#include "scene_reader.h"

static void check_direction(struct scene_reader *reader, char *path, const double v[3])
{
    bool is_zero = v[0] == 0 && v[1] == 0 && v[2] == 0;
    if (scene_check_is_given(reader, path) && !scene_issue_is_below(reader, path) &&
        !vector_is_direction(v))
        scene_issue_on(reader, path,
            is_zero ? "a direction must not be zero"
                    : "too short for a direction: numbers below 2.2e-308 lose their digits");
    free(path);
}

static void check_elements(struct scene_reader *reader)
{
    for (int k = 0; k < reader->scene->n_group; k++) {
        const struct element_group *group = &reader->scene->group[k];
        scene_check_region(
            reader, fail_format("elements[%d].fill.region", k), &group->region, false);
        char *path = fail_format("elements[%d].shape", k);
        if (scene_check_is_given(reader, path) && !scene_issue_is_below(reader, path) &&
            group->diameter[0] > group->diameter[1])
            scene_issue_on(reader, path, "min must not be above max");
        free(path);
    }
}

static void check_walls(struct scene_reader *reader)
{
    for (int k = 0; k < reader->scene->n_wall; k++) {
        const struct wall *wall = &reader->scene->wall[k];
        check_direction(reader, fail_format("walls[%d].surface.plane.normal", k), wall->normal);
        check_direction(reader, fail_format("walls[%d].surface.rectangle.normal", k), wall->normal);
        scene_check_box(
            reader, fail_format("walls[%d].surface.box", k), wall->min, wall->max, false);
        scene_check_cylinder(reader, fail_format("walls[%d].surface.cylinder", k), wall->from,
            wall->to, wall->radius);
        check_direction(
            reader, fail_format("walls[%d].motion.rotation.axis", k), wall->rotation_axis);
        char *path = fail_format("walls[%d].motion", k),
             *remove = fail_format("%s.remove_at", path);
        if (!scene_issue_is_below(reader, path) && wall->remove_at <= wall->appear_at)
            scene_issue_on(reader, remove, "must be after appear_at");
        free(remove);
        free(path);
    }
}

/* Hertz takes its stiffness from both materials. */
static void check_hertz(struct scene_reader *reader, int k)
{
    const struct scene *scene = reader->scene;
    const struct contact *contact = &scene->contact[k];
    char *law = fail_format("contacts[%d].normal.law", k);
    for (int side = 0; side < 2; side++) {
        int index = contact->between[side];
        if (side == 1 && index == contact->between[0]) break;
        static const char *const NEEDED_KEY[] = {"young", "poisson"};
        for (int n = 0; n < 2; n++) {
            char *path = fail_format("materials.%s.%s", scene->material[index].name, NEEDED_KEY[n]);
            if (!scene_check_is_given(reader, path))
                scene_issue_on(reader, law, "hertz needs '%s' of material '%s'", NEEDED_KEY[n],
                    scene->material[index].name);
            free(path);
        }
    }
    free(law);
}

/* What the law along the normal asks of friction. */
static void check_tangential(
    struct scene_reader *reader, const struct contact *contact, const char *tangential)
{
    char *ratio = fail_format("%s.stiffness_ratio", tangential),
         *rescale = fail_format("%s.rescale", tangential);
    if (scene_check_is_given(reader, tangential) && !scene_check_is_given(reader, ratio) &&
        !scene_issue_is_below(reader, tangential))
        scene_issue_on(reader, tangential, "missing key 'stiffness_ratio' (law: linear)");
    if (scene_check_is_given(reader, rescale) && !contact->rescale)
        scene_issue_on(reader, rescale, "false is only valid with 'normal.law: hertz'");
    free(ratio);
    free(rescale);
}

static void check_contact(struct scene_reader *reader, int k)
{
    const struct contact *contact = &reader->scene->contact[k];
    char *path = fail_format("contacts[%d]", k), *normal = fail_format("%s.normal", path),
         *tangential = fail_format("%s.tangential", path);
    char *law = fail_format("%s.law", normal);
    bool both = contact->between[0] >= 0 && contact->between[1] >= 0;
    if (!scene_check_is_given(reader, normal)) {
        static const char *const PART[] = {"tangential", "rolling", "binding"};
        for (int n = 0; n < 3; n++) {
            char *part = fail_format("%s.%s", path, PART[n]);
            if (scene_check_is_given(reader, part))
                scene_issue_on(reader, part, "requires 'normal'");
            free(part);
        }
    } else if (scene_check_is_given(reader, law) && !scene_issue_is_below(reader, law)) {
        if (contact->normal_law == NORMAL_HERTZ && both) check_hertz(reader, k);
        if (contact->normal_law == NORMAL_LINEAR) check_tangential(reader, contact, tangential);
    }
    for (int other = 0; other < k && both; other++) {
        const int *a = contact->between, *b = reader->scene->contact[other].between;
        if ((a[0] == b[0] && a[1] == b[1]) || (a[0] == b[1] && a[1] == b[0])) {
            char *between = fail_format("%s.between", path);
            scene_issue_on(
                reader, between, "contacts[%d] is between these materials already", other);
            free(between);
            break;
        }
    }
    free(path);
    free(normal);
    free(tangential);
    free(law);
}

static bool has_contact(const struct scene *scene, int a, int b)
{
    for (int k = 0; k < scene->n_contact; k++) {
        const int *pair = scene->contact[k].between;
        if ((pair[0] == a && pair[1] == b) || (pair[0] == b && pair[1] == a)) return true;
    }
    return false;
}

/* Whether the number of elements in the group is not known, because its keys are wrong. */
static bool is_doubtful(const struct scene_reader *reader, int k)
{
    char *path = fail_format("elements[%d]", k);
    bool answer = scene_issue_is_below(reader, path);
    free(path);
    return answer;
}

/* Whether elements of materials a and b can meet, or an element of one and a wall of the other. One
 * element alone does not meet itself. */
static bool can_meet(const struct scene_reader *reader, int a, int b)
{
    const struct scene *scene = reader->scene;
    long n[2] = {0, 0}; /* elements of a, b; two stand for many */
    bool wall[2] = {false, false};
    for (int k = 0; k < scene->n_group; k++) {
        const struct element_group *group = &scene->group[k];
        long count = is_doubtful(reader, k) || (!group->from_file && group->count == 1) ? 1 : 2;
        if (group->material == a) n[0] += count;
        if (group->material == b) n[1] += count;
    }
    for (int k = 0; k < scene->n_wall; k++) {
        if (scene->wall[k].material == a) wall[0] = true;
        if (scene->wall[k].material == b) wall[1] = true;
    }
    if ((n[0] > 0 && wall[1]) || (n[1] > 0 && wall[0])) return true;
    return a == b ? n[0] > 1 : n[0] > 0 && n[1] > 0;
}

static void check_contact_list(struct scene_reader *reader)
{
    const struct scene *scene = reader->scene;
    bool all_known = true;
    for (int k = 0; k < scene->n_contact; k++) {
        check_contact(reader, k);
        all_known =
            all_known && scene->contact[k].between[0] >= 0 && scene->contact[k].between[1] >= 0;
    }
    if (!all_known) return; /* the pair in question may be the one that is misspelt */
    for (int a = 0; a < scene->n_material; a++)
        for (int b = a; b < scene->n_material; b++)
            if (can_meet(reader, a, b) && !has_contact(scene, a, b))
                scene_issue_on(reader, "contacts", "no entry between '%s' and '%s', which can meet",
                    scene->material[a].name, scene->material[b].name);
}

static void check_domain(struct scene_reader *reader)
{
    const struct domain *domain = &reader->scene->domain;
    scene_check_box(reader, fail_strdup("domain.box"), domain->min, domain->max, false);
    if ((domain->periodic[0] || domain->periodic[1] || domain->periodic[2]) && !domain->has_box)
        scene_issue_on(
            reader, "domain.periodic", "requires 'box', the extent of the periodic domain");
}

static void check_scheme(struct scene_reader *reader)
{
    if (reader->scene->time.scheme != SCHEME_LEAPFROG)
        scene_issue_on(reader, "time.scheme", "method: particles supports leapfrog only");
}

static void check_time(struct scene_reader *reader)
{
    const struct scene_time *time = &reader->scene->time;
    if (!scene_check_is_given(reader, "time.step") || scene_issue_is_below(reader, "time") ||
        !(time->step > 0))
        return;
    if (!(time->end / time->step <= SCENE_STEPS_MOST))
        scene_issue_on(reader, "time.step", "%.3g steps until time.end are too many, at most %.0g",
            time->end / time->step, SCENE_STEPS_MOST);
}

static void check_partition(struct scene_reader *reader)
{
    if (!HAVE_METIS && reader->scene->partition.method == PARTITION_GRAPH)
        scene_issue_on(reader, "partition.method",
            "graph needs METIS, without which this program was built; "
            "take geometric or interactions");
}

void scene_check(struct scene_reader *reader)
{
    check_time(reader);
    check_partition(reader);
    if (reader->scene->method == METHOD_LATTICE) {
        scene_check_lattice(reader);
        return;
    }
    check_scheme(reader);
    check_elements(reader);
    check_walls(reader);
    check_contact_list(reader);
    check_domain(reader);
}

void scene_check_derive(struct scene *scene)
{
    scene_check_derive_damping(scene);
    for (int k = 0; k < scene->n_contact; k++) {
        struct contact *contact = &scene->contact[k];
        if (contact->restitution > 0)
            contact->damping_ratio = restitution_damping(contact->restitution, contact->attraction);
    }
    for (int k = 0; k < scene->n_wall; k++) {
        struct wall *wall = &scene->wall[k];
        if (wall->kind == SURFACE_PLANE || wall->kind == SURFACE_RECTANGLE)
            vector_normalise(wall->normal);
        /* no rotation */
        if (wall->rotation_axis[0] == 0 && wall->rotation_axis[1] == 0 &&
            wall->rotation_axis[2] == 0)
            wall->rotation_axis[2] = 1;
        vector_normalise(wall->rotation_axis);
    }
}
