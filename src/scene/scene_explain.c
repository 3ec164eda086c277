#include "scene.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "base/nearest.h"
#include "scene_keys.h"

static const char *const TYPE[] = {
    [KEY_MAP] = "mapping",
    [KEY_LIST] = "list of mappings",
    [KEY_NAMED] = "mapping of names",
    [KEY_NUMBER] = "number",
    [KEY_SPAN] = "number or {min, max}",
    [KEY_VECTOR] = "list of numbers",
    [KEY_INTEGER] = "whole number",
    [KEY_BOOL] = "true or false",
    [KEY_CHOICE] = "word",
    [KEY_TEXT] = "text",
    [KEY_NAME] = "name",
    [KEY_FILE] = "file",
    [KEY_MATERIAL] = "material",
    [KEY_WALL] = "name of a wall",
    [KEY_BODY] = "name of a body",
    [KEY_PAIR] = "two materials",
    [KEY_AXES] = "list of words",
    [KEY_WORDS] = "list of words",
    [KEY_TABLE] = "list of pairs, file",
};

/* Steps past one segment of a path or pattern and what belongs to it: "contacts[0]." and
 * "contacts[]." both leave "contacts". */
static size_t segment(const char **path)
{
    const char *p = *path;
    size_t n = strcspn(p, ".[");
    p += strcspn(p, ".");
    *path = *p == '.' ? p + 1 : p;
    return n;
}

/* Whether the pattern is `key` or lies below it. Any name may stand for NAME. */
static bool is_below(const char *pattern, const char *key)
{
    while (*key) {
        const char *p = pattern, *k = key;
        size_t np = segment(&p), nk = segment(&k);
        if (np == 0) return false;
        bool name = np == 4 && memcmp(pattern, "NAME", 4) == 0;
        if (!name && (np != nk || memcmp(pattern, key, np) != 0)) return false;
        pattern = p;
        key = k;
    }
    return true;
}

/* "needed", "one of", the default, or "-"; with the method that has the key, and the condition
 * under which it exists. */
static void default_text(const struct scene_key *key, char *text, size_t size)
{
    const char *what = key->fallback         ? key->fallback
                       : key->need == NEEDED ? "needed"
                       : key->need == ONE_OF ? "one of these"
                                             : "-";
    if (strcmp(what, "''") == 0 || strcmp(what, "{}") == 0) what = "-";
    if (key->only || key->when)
        snprintf(text, size, "%s (%s%s%s)", what, key->only ? key->only : "",
            key->only && key->when ? ", " : "", key->when ? key->when : "");
    else snprintf(text, size, "%s", what);
}

/* The sentence, the words to choose from, the range. */
static char *meaning(const struct scene_key *key)
{
    char range[64], words[256] = "";
    scene_key_range_text(&key->range, range, sizeof range);
    for (const char *w = key->words; w && *w; w++) {
        size_t used = strlen(words);
        if (*w == '|' && used > 0) snprintf(words + used, sizeof words - used, ", ");
        else if (*w != '|') snprintf(words + used, sizeof words - used, "%c", *w);
    }
    const char *limits = *range ? range + strlen("must be ") : "";
    return *words || *range ? fail_format("%s [%s%s]", key->text, words, limits)
                            : fail_strdup(key->text);
}

static void print_row(const struct scene_key *key, int path_width)
{
    char type[32], value[64];
    snprintf(type, sizeof type, "%s", TYPE[key->type]);
    if (key->type == KEY_VECTOR) snprintf(type, sizeof type, "%d numbers", key->width);
    default_text(key, value, sizeof value);
    char *text = meaning(key);
    bool quantity = key->type == KEY_NUMBER || key->type == KEY_SPAN || key->type == KEY_VECTOR ||
                    key->type == KEY_TABLE;
    const char *unit = !quantity ? "" : key->unit == UNIT_NONE ? "1" : units_si(key->unit);
    printf("%-*s  %-20s  %-5s  %-22s  %s\n", path_width, key->path, type, unit, value, text);
    free(text);
}

/* What the key's words mean, or what its columns are. */
static void print_items(const struct scene_item *items)
{
    int width = 0;
    for (const struct scene_item *i = items; i->name; i++) {
        int length = (int)strlen(i->name);
        width = length > width ? length : width;
    }
    for (const struct scene_item *i = items; i->name; i++)
        printf("    %-*s  %-7s  %s\n", width, i->name, i->unit, i->text);
}

/* Whether the pattern is `key` itself, and not below it. */
static bool is_itself(const char *pattern, const char *key)
{
    int depth = 0;
    for (; *pattern; pattern++) depth += *pattern == '.';
    for (; *key; key++) depth -= *key == '.';
    return depth == 0;
}

/* Names the key nearest to `key` on stderr. */
static void report_unknown(const char *key)
{
    const char **name = fail_alloc((size_t)scene_keys_n * sizeof *name);
    for (int k = 0; k < scene_keys_n; k++) {
        /* As a user would write it: without the marks of lists. */
        char *plain = fail_alloc(strlen(scene_keys[k].path) + 1), *to = plain;
        for (const char *from = scene_keys[k].path; *from; from++)
            if (*from != '[' && *from != ']') *to++ = *from;
        name[k] = plain;
    }
    const char *near = nearest_name(key, name, scene_keys_n);
    if (near) fprintf(stderr, "democles: error: no key '%s'; did you mean '%s'?\n", key, near);
    else fprintf(stderr, "democles: error: no key '%s'; `democles explain` lists all\n", key);
    for (int k = 0; k < scene_keys_n; k++) free((char *)name[k]);
    free(name);
}

bool scene_explain(const char *key)
{
    int width = 3, n = 0;
    for (int k = 0; k < scene_keys_n; k++) {
        if (key && !is_below(scene_keys[k].path, key)) continue;
        int length = (int)strlen(scene_keys[k].path);
        width = length > width ? length : width;
        n++;
    }
    if (n == 0) {
        report_unknown(key);
        return false;
    }
    printf("%-*s  %-20s  %-5s  %-22s  %s\n", width, "key", "type", "unit", "default", "meaning");
    for (int k = 0; k < scene_keys_n; k++)
        if (!key || is_below(scene_keys[k].path, key)) {
            print_row(&scene_keys[k], width);
            if (key && scene_keys[k].items && is_itself(scene_keys[k].path, key))
                print_items(scene_keys[k].items);
        }
    if (!key)
        printf(
            "\nA number may carry a unit, also a compound one: 5 mm, 1 kN/m, 210 GPa, 7.85 g/cm3, "
            "30 deg, 10 rpm, 50 Hz. Without, it is in SI.\n"
            "Files are relative to the scene. --set KEY=VALUE changes one key, --set KEY= takes "
            "it away:\n"
            "    --set time.end=1s --set contacts[0].normal.stiffness=2e3 --set "
            "walls.gate.motion.remove_at=0.2\n");
    return true;
}
