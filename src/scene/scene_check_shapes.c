/* Rules of shapes, which several parts of a scene share. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/vector.h"
#include "comm/fail.h"
#include "scene_path.h"
#include "scene_reader.h"

/* Of a cylinder, in radii. */
#define SHORTEST 1e-12

bool scene_check_is_given(const struct scene_reader *reader, const char *path)
{
    return scene_path_find(reader->root, path) != NULL;
}

void scene_check_box(struct scene_reader *reader, char *path, const double min[3],
    const double max[3], bool may_be_flat)
{
    if (scene_check_is_given(reader, path) && !scene_issue_is_below(reader, path))
        for (int k = 0; k < 3; k++)
            if (may_be_flat ? min[k] > max[k] : !(min[k] < max[k])) {
                scene_issue_on(reader, path, "min must %s max in %c",
                    may_be_flat ? "not be above" : "be below", "xyz"[k]);
                break;
            }
    free(path);
}

/* Shorter than the rounding of its own points, a cylinder has no direction and holds nothing. */
static const char *length_problem(const double from[3], const double to[3], double radius)
{
    double axis[3] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
    if (!isfinite(axis[0]) || !isfinite(axis[1]) || !isfinite(axis[2]))
        return "from and to are too far from each other";
    if (!(fabs(axis[0]) > 0) && !(fabs(axis[1]) > 0) && !(fabs(axis[2]) > 0))
        return "from and to are the same point";
    if (!vector_is_direction(axis) || vector_normalise(axis) < SHORTEST * radius)
        return "from and to are less than 1e-12 radii from each other, which is no length";
    return NULL;
}

void scene_check_cylinder(struct scene_reader *reader, char *path, const double from[3],
    const double to[3], double radius)
{
    bool is_read = scene_check_is_given(reader, path) && !scene_issue_is_below(reader, path);
    const char *problem = is_read ? length_problem(from, to, radius) : NULL;
    if (problem) scene_issue_on(reader, path, "%s", problem);
    free(path);
}

void scene_check_region(
    struct scene_reader *reader, char *path, const struct region *region, bool may_be_flat)
{
    scene_check_box(reader, fail_format("%s.box", path), region->min, region->max, may_be_flat);
    scene_check_cylinder(
        reader, fail_format("%s.cylinder", path), region->from, region->to, region->radius);
    free(path);
}
