/* What every reader of values begins with: the kind of a node, and a number with unit and range. */
#include <stdio.h>
#include <string.h>

#include "scene_values.h"
#include "units.h"

bool scene_is_kind(const struct scene_place *p, const struct scene_node *node,
    enum scene_node_kind kind, const char *expected)
{
    if (node->kind == kind && !scene_yaml_is_null(node)) return true;
    scene_issue_at(
        p->reader, node, p->path, "expected %s, found %s", expected, scene_yaml_kind_name(node));
    return false;
}

bool scene_number(
    const struct scene_place *p, const struct scene_node *node, const char *path, double *value)
{
    const struct scene_key *key = p->key;
    struct scene_place own = *p;
    own.path = path;
    if (!scene_is_kind(&own, node, NODE_SCALAR, "a number")) return false;
    if (key->special && strcmp(node->text, key->special) == 0) {
        *value = key->special_value;
        return true;
    }
    char problem[256], range[64];
    if (!units_parse(node->text, key->unit, value, problem, sizeof problem)) {
        if (key->special)
            scene_issue_at(p->reader, node, path, "%s, or '%s'", problem, key->special);
        else scene_issue_at(p->reader, node, path, "%s", problem);
        return false;
    }
    if (scene_key_in_range(&key->range, *value)) return true;
    scene_key_range_text(&key->range, range, sizeof range);
    scene_issue_at(p->reader, node, path, "%s is out of range: %s", node->text, range);
    return false;
}
