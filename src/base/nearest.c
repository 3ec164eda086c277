#include "nearest.h"

#include <ctype.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"

static int low(char c)
{
    return tolower((unsigned char)c);
}

static int smallest(int a, int b)
{
    return a < b ? a : b;
}

/* Dynamic programme over prefixes; three rows suffice: the swap looks two rows back. */
int nearest_distance(const char *a, const char *b)
{
    size_t na = strlen(a), nb = strlen(b), width = nb + 1;
    int *rows = fail_alloc(3 * width * sizeof *rows);
    int *before = rows, *last = rows + width, *now = rows + 2 * width;
    for (size_t j = 0; j <= nb; j++) now[j] = (int)j;
    for (size_t i = 1; i <= na; i++) {
        int *recycled = before;
        before = last, last = now, now = recycled;
        now[0] = (int)i;
        for (size_t j = 1; j <= nb; j++) {
            int cost = low(a[i - 1]) != low(b[j - 1]);
            now[j] = smallest(smallest(last[j] + 1, now[j - 1] + 1), last[j - 1] + cost);
            if (i > 1 && j > 1 && low(a[i - 1]) == low(b[j - 2]) && low(a[i - 2]) == low(b[j - 1]))
                now[j] = smallest(now[j], before[j - 2] + 1);
        }
    }
    int distance = now[nb];
    free(rows);
    return distance;
}

const char *nearest_name(const char *name, const char *const *names, int n)
{
    const char *best = NULL;
    int best_distance = 0;
    for (int k = 0; k < n; k++) {
        size_t longer = strlen(name) > strlen(names[k]) ? strlen(name) : strlen(names[k]);
        int allowed = longer < 6 ? 1 + (longer > 3) : (int)(longer / 3);
        int distance = nearest_distance(name, names[k]);
        /* nothing in common is not near */
        if (distance > allowed || (size_t)distance >= longer) continue;
        if (best && distance >= best_distance) continue;
        best = names[k];
        best_distance = distance;
    }
    return best;
}
