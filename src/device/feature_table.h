/* Features: switches of a struct, each 0 or 1, of which a program is built with some. One row for
 * each; build options, the list in run.json and what `check` prints follow from the rows.
 *
 * Knows no feature of its own: src/particle/features.c and src/lattice/lattice_features.c do. */
#ifndef DEMOCLES_FEATURE_TABLE_H
#define DEMOCLES_FEATURE_TABLE_H

#include <stdbool.h>
#include <stddef.h>

struct feature_row {
    const char *name;   /* for people and run.json; NULL: not shown */
    const char *option; /* of the compiler: "WITH_SPIN"; NULL: no program has it */
    size_t at;          /* offset of a bool in the struct */
    /* programs, as bits, for which the option has this value. It is 0 for those that no row of the
     * same option names. */
    int programs;
};

/* A row that every program gets: FEATURE_ROW(struct features, spin, "WITH_SPIN"). */
#define FEATURE_ROW(type, member, option)                                                          \
    {                                                                                              \
#member, option, offsetof(type, member), ~0                                                \
    }

/* `row` ends with a row of nothing but zeros. */
bool feature_table_value(const struct feature_row *row, const void *features);
/* Value of that option in the program (one bit); it must be there. */
bool feature_table_option(
    const struct feature_row *row, const void *features, int program, const char *option);
/* Build options "-DWITH_SPIN=1 -D..." of the program; owned by the caller. */
char *feature_table_options(const struct feature_row *row, const void *features, int program);

/* The rows one by one: `for (row = table; feature_table_more(row); row++)`. */
bool feature_table_more(const struct feature_row *row);

#endif
