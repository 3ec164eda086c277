#include "duration.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    char name;
    double seconds;
} unit[] = {{'d', 86400}, {'h', 3600}, {'m', 60}, {'s', 1}};

enum { N_UNIT = sizeof unit / sizeof *unit };

bool duration_parse(const char *text, double *seconds)
{
    double sum = 0;
    int next = 0; /* units before it are used up */
    if (!*text) return false;
    for (bool first = true; *text; first = false) {
        size_t n = strspn(text, "0123456789.");
        char *end;
        double value = strtod(text, &end);
        /* also where strtod would take a sign, an exponent, hex, inf or nan */
        if (n == 0 || end != text + n) return false;
        text += n;
        if (!*text) {
            if (!first) return false; /* as in 1h30: is that minutes? */
            *seconds = value;
            return true;
        }
        int k = next;
        while (k < N_UNIT && unit[k].name != *text) k++;
        if (k == N_UNIT) return false;
        sum += value * unit[k].seconds;
        next = k + 1;
        text++;
    }
    *seconds = sum;
    return true;
}
