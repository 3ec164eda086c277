/* Rules of shapes, which several parts of a scene share. */
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "scene_path.h"
#include "scene_reader.h"

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

void scene_check_cylinder(
    struct scene_reader *reader, char *path, const double from[3], const double to[3])
{
    if (scene_check_is_given(reader, path) && !scene_issue_is_below(reader, path) &&
        memcmp(from, to, 3 * sizeof *from) == 0)
        scene_issue_on(reader, path, "from and to are the same point");
    free(path);
}

void scene_check_region(
    struct scene_reader *reader, char *path, const struct region *region, bool may_be_flat)
{
    scene_check_box(reader, fail_format("%s.box", path), region->min, region->max, may_be_flat);
    scene_check_cylinder(reader, fail_format("%s.cylinder", path), region->from, region->to);
    free(path);
}
