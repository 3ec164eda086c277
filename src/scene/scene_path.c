#include "scene_path.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

bool scene_path_step(const char **path, struct scene_step *step)
{
    const char *p = *path;
    *step = (struct scene_step){0};
    if (*p == '[') {
        if (!isdigit((unsigned char)p[1])) return false;
        char *end;
        step->index = strtol(p + 1, &end, 10);
        if (*end != ']') return false;
        p = end + 1;
    } else {
        step->word = p;
        step->length = strcspn(p, ".[");
        if (step->length == 0) return false;
        p += step->length;
    }
    /* A dot stands between a step and a word, and nowhere else. */
    if (*p == '.' && p[1] != '[' && p[1] != '.' && p[1]) p++;
    else if (*p && *p != '[') return false;
    *path = p;
    return true;
}

static bool same_text(const char *text, const struct scene_step *step)
{
    return strlen(text) == step->length && memcmp(text, step->word, step->length) == 0;
}

int scene_path_follow(const struct scene_node *node, const struct scene_step *step)
{
    for (int k = 0; step->word && k < node->n; k++) {
        if (node->kind == NODE_MAPPING && same_text(node->key[k]->text, step)) return k;
        const struct scene_node *name =
            node->kind == NODE_SEQUENCE ? scene_yaml_get(node->item[k], "name", NULL) : NULL;
        if (name && name->kind == NODE_SCALAR && same_text(name->text, step)) return k;
    }
    if (!step->word && node->kind == NODE_SEQUENCE && step->index < node->n)
        return (int)step->index;
    return -1;
}

static const struct scene_node *walk(const struct scene_node *root, const char **path)
{
    const struct scene_node *node = root;
    struct scene_step step;
    for (const char *next = *path; scene_path_step(&next, &step); *path = next) {
        int k = scene_path_follow(node, &step);
        if (k < 0) break;
        node = node->item[k];
    }
    return node;
}

const struct scene_node *scene_path_deepest(const struct scene_node *root, const char *path)
{
    return walk(root, &path);
}

const struct scene_node *scene_path_find(const struct scene_node *root, const char *path)
{
    const struct scene_node *node = walk(root, &path);
    return *path ? NULL : node;
}
