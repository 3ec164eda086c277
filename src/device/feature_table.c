#include "feature_table.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"

bool feature_table_more(const struct feature_row *row)
{
    return row->name || row->option;
}

bool feature_table_value(const struct feature_row *row, const void *features)
{
    return *(const bool *)((const char *)features + row->at);
}

static bool has_option(const struct feature_row *row, const char *option)
{
    return row->option && !strcmp(row->option, option);
}

bool feature_table_option(
    const struct feature_row *row, const void *features, int program, const char *option)
{
    bool known = false;
    for (; feature_table_more(row); row++) {
        if (!has_option(row, option)) continue;
        known = true;
        if (row->programs & program) return feature_table_value(row, features);
    }
    assert(known);
    (void)known;
    return false;
}

char *feature_table_options(const struct feature_row *row, const void *features, int program)
{
    char *text = fail_strdup("");
    for (const struct feature_row *r = row; feature_table_more(r); r++) {
        const struct feature_row *first = row;
        if (!r->option) continue;
        while (!has_option(first, r->option)) first++;
        if (first != r) continue; /* written already */
        char *more = fail_format("%s%s-D%s=%d", text, *text ? " " : "", r->option,
            feature_table_option(row, features, program, r->option));
        free(text);
        text = more;
    }
    return text;
}
