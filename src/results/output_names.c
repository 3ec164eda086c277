#include "output_names.h"

#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "frame_list.h"
#include "snapshot.h"

static bool is_one_of(const char *name, const char *const *list)
{
    for (; *list; list++)
        if (!strcmp(name, *list)) return true;
    return false;
}

static bool is_unfinished(const char *name)
{
    static const char *const replaced[] = {
        "run.json", "scene.yaml", "resolved.yaml", "trace.json", FRAME_LIST_NAME, NULL};
    char *whole = files_tmp_of(name);
    bool ours = whole && (snapshot_index(whole) >= 0 || is_one_of(whole, replaced));
    free(whole);
    return ours;
}

/* What a compiler that failed has seen, with the number of the process (device/program.c). */
static bool is_failed_build(const char *name)
{
    static const char before[] = "failed_build_";
    size_t n = sizeof before - 1;
    if (strncmp(name, before, n) != 0) return false;
    size_t digits = strspn(name + n, "0123456789");
    return digits > 0 && !strcmp(name + n + digits, ".cl");
}

bool output_names_are_results(const char *name)
{
    return snapshot_index(name) >= 0 || !strcmp(name, "run.json");
}

bool output_names_are_ours(const char *name)
{
    static const char *const single[] = {
        "log.txt", "run.balance.csv", "trace.json", "stop", FRAME_LIST_NAME, NULL};
    return output_names_are_results(name) || is_unfinished(name) || is_failed_build(name) ||
           is_one_of(name, single);
}

bool output_names_are_over(const char *name, int64_t index)
{
    static const char *const single[] = {"run.json", "stop", NULL};
    return snapshot_index(name) > index || is_unfinished(name) || is_one_of(name, single);
}
