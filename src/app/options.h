/* The command line: one table of commands and options behind parsing, its errors and --help. Knows
 * no MPI and no scene; prints only help. */
#ifndef DEMOCLES_OPTIONS_H
#define DEMOCLES_OPTIONS_H

#include <stdio.h>

#include "run/sim.h"

enum options_command {
    OPTIONS_RUN,
    OPTIONS_RESUME,
    OPTIONS_CHECK,
    OPTIONS_DEVICES,
    OPTIONS_EXPLAIN,
    OPTIONS_NONE
};

struct options {
    enum options_command command; /* OPTIONS_NONE: only --help or --version */
    bool help, version;           /* print this, and nothing else */
    const char *operand;          /* SCENE, DIR; KEY of explain, NULL if not given */
    const char **set;             /* [n_set] KEY=VALUE for scene_read, last --precision */
    int n_set;
    /* dir: NULL if not given; precision: always PRECISION_DEFAULT, since --precision is one of
     * `set` */
    struct sim_options run;
    bool resolved;   /* check */
    int n_rank;      /* devices; 0: not given */
    char *error;     /* what is wrong with the usage, for exit code 2; NULL: nothing */
    char *precision; /* owned text of `set` */
};

/* Texts are borrowed from argv, except `set`, `error` and `precision`. Not collective: the same on
 * every rank. */
struct options options_parse(int argc, char **argv);
void options_free(struct options *options);

/* Of one command, or of the program (OPTIONS_NONE). */
void options_help(enum options_command command, FILE *file);

#endif
