/* What a row of the table of keys means: its name, its place in the table, its range. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "comm/fail.h"
#include "scene_keys.h"

const char *scene_key_name(const struct scene_key *key)
{
    const char *dot = strrchr(key->path, '.');
    return dot ? dot + 1 : key->path;
}

char *scene_key_word(const char *path, int value)
{
    const struct scene_key *key = scene_keys;
    while (strcmp(key->path, path)) key++;
    const char *word = key->words;
    for (int k = 0; k < value; k++) word = strchr(word, '|') + 1;
    size_t n = strcspn(word, "|");
    return n > 0 ? fail_format("%.*s", (int)n, word) : fail_strdup(key->fallback);
}

bool scene_key_is_child(const struct scene_key *key, const char *pattern)
{
    size_t n = strlen(pattern);
    if (n == 0) return !strchr(key->path, '.');
    return strncmp(key->path, pattern, n) == 0 && key->path[n] == '.' &&
           !strchr(key->path + n + 1, '.');
}

bool scene_key_is_in_record(const struct scene_key *key, const char *pattern)
{
    size_t n = strlen(pattern);
    if (n > 0 && (strncmp(key->path, pattern, n) != 0 || key->path[n] != '.')) return false;
    return !strstr(key->path + n, "[]") && !strstr(key->path + n, ".NAME");
}

bool scene_key_belongs(const struct scene_key *key, enum method method)
{
    return !key->only || strcmp(key->only, method == METHOD_LATTICE ? "lattice" : "particles") == 0;
}

void *scene_key_place(const struct scene_key *key, void *record)
{
    return key->at ? (char *)record + (key->at - 1) : NULL;
}

void scene_key_range_text(const struct key_range *range, char *text, size_t size)
{
    if (!range->given) snprintf(text, size, "%s", "");
    else if (isinf(range->high))
        snprintf(text, size, "must be %s %g", range->low_open ? ">" : ">=", range->low);
    else
        snprintf(text, size, "must be %s %g and %s %g", range->low_open ? ">" : ">=", range->low,
            range->high_open ? "<" : "<=", range->high);
}

bool scene_key_in_range(const struct key_range *range, double value)
{
    if (!range->given) return true;
    bool low = range->low_open ? value > range->low : value >= range->low;
    bool high = range->high_open ? value < range->high : value <= range->high;
    return low && high;
}
