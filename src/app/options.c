#include "options.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/duration.h"
#include "comm/fail.h"
#include "base/nearest.h"
#include "scene/scene_keys.h"
#include "version.h"

static const struct command {
    const char *name, *operand, *text;
    bool needed; /* the operand */
} COMMAND[] = {
    [OPTIONS_RUN] = {"run", "SCENE", "runs a scene; `mpirun -n N democles run SCENE` uses N ranks",
        true},
    [OPTIONS_RESUME] = {"resume", "DIR",
        "resumes the run from the latest intact frame in DIR, on any number of ranks, bit for bit",
        true},
    [OPTIONS_CHECK] = {"check", "SCENE", "validates a scene and prints what would run", true},
    [OPTIONS_DEVICES] = {"devices", NULL,
        "lists the OpenCL devices, and which one each rank "
        "would use",
        false},
    [OPTIONS_EXPLAIN] = {"explain", "KEY",
        "explains the scene language: every key, or those of KEY (contacts.normal)", false},
};

enum {
    DIRECTORY,
    SET,
    FORCE,
    DEVICE,
    PRECISION,
    STEPS,
    MAX_TIME,
    QUIET,
    PROFILE,
    TRACE,
    TRACE_FROM,
    TRACE_LENGTH,
    RESOLVED,
    RANKS,
    N_OPTION
};
enum {
    RUN = 1 << OPTIONS_RUN,
    RESUME = 1 << OPTIONS_RESUME,
    CHECK = 1 << OPTIONS_CHECK,
    DEVICES = 1 << OPTIONS_DEVICES
};

static const struct option {
    const char *name, *value, *text; /* value: NULL for a switch */
    int commands;                    /* that know it, bits */
} OPTION[N_OPTION] = {
    [DIRECTORY] = {"-o", "DIR", "folder for the results [out/<name of the scene>]", RUN},
    [SET] = {"--set", "KEY=VALUE", "changes a key of the scene, as in time.end=1s; may be repeated",
        RUN | RESUME | CHECK},
    [FORCE] = {"--force", NULL, "replaces earlier results in DIR", RUN},
    [DEVICE] = {"--device", "PLATFORM:DEVICE",
        "selects devices by indices or parts of names, as `democles devices` lists them, or by a "
        "part of one name [the best]",
        RUN | RESUME},
    [PRECISION] = {"--precision", "P", "precision: double, mixed or single [the scene's]",
        RUN | CHECK},
    [STEPS] = {"--steps", "N", "ends the run after step N, counted from the start of the scene",
        RUN | RESUME},
    [MAX_TIME] = {"--max-time", "1h30m",
        "stops after this wall-clock time, with exit code 75; "
        "`resume` continues",
        RUN | RESUME},
    [QUIET] = {"--quiet", NULL, "prints errors and warnings only", RUN | RESUME},
    [PROFILE] = {"--profile", NULL,
        "writes the device time of each kernel into run.json, at a small cost, and the load "
        "balance over time into DIR/run.balance.csv",
        RUN | RESUME},
    [TRACE] = {"--trace", NULL,
        "writes a timeline of some steps into DIR/trace.json, for Perfetto or chrome://tracing",
        RUN | RESUME},
    [TRACE_FROM] = {"--trace-from", "N", "first step of the timeline [about 100]", RUN | RESUME},
    [TRACE_LENGTH] = {"--trace-steps", "N", "number of steps in the timeline [20]", RUN | RESUME},
    [RESOLVED] = {"--resolved", NULL, "prints only the scene, with all defaults", CHECK},
    [RANKS] = {"--ranks", "N", "number of ranks per node to list devices for [those running]",
        DEVICES},
};

/* "; did you mean 'x'?", or where to look. Owned by the caller. */
static char *advice(const char *given, const char *const *name, int n, enum options_command command)
{
    const char *near = nearest_name(given, name, n);
    if (near) return fail_format("; did you mean '%s'?", near);
    if (command == OPTIONS_NONE) return fail_strdup("; see `democles --help`");
    return fail_format("; see `democles %s --help`", COMMAND[command].name);
}

static void parse_command(struct options *o, const char *word)
{
    const char *name[OPTIONS_NONE];
    for (int c = 0; c < OPTIONS_NONE; c++) {
        name[c] = COMMAND[c].name;
        if (strcmp(word, name[c]) == 0) o->command = (enum options_command)c;
    }
    if (o->command != OPTIONS_NONE) return;
    if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) o->help = true;
    else if (strcmp(word, "--version") == 0) o->version = true;
    else {
        char *more = advice(word, name, OPTIONS_NONE, OPTIONS_NONE);
        o->error = fail_format("%s '%s'%s",
            word[0] == '-' ? "a command has to come first, not" : "there is no command", word,
            more);
        free(more);
    }
}

static void report_unknown_option(struct options *o, const char *word)
{
    const char *name[N_OPTION + 1] = {"--help"};
    int n = 1;
    for (int k = 0; k < N_OPTION; k++)
        if (OPTION[k].commands & 1 << o->command) name[n++] = OPTION[k].name;
    char *more = advice(word, name, n, o->command);
    o->error =
        fail_format("`democles %s` has no option '%s'%s", COMMAND[o->command].name, word, more);
    free(more);
}

/* A whole number from `low` on; otherwise the error is set. */
static int64_t whole_number(
    struct options *o, int option, const char *value, int64_t low, int64_t high)
{
    char *end;
    errno = 0;
    long long n = strtoll(value, &end, 10);
    bool is_number = value[strspn(value, "+0123456789")] == '\0' && end != value && *end == '\0';
    if (is_number && errno == 0 && n >= low && n <= high) return n;
    o->error = fail_format("%s '%s': expected a whole number, at least %lld", OPTION[option].name,
        value, (long long)low);
    return low;
}

static void store_precision(struct options *o, const char *value)
{
    char *word[3];
    bool is_word = false;
    for (int k = 0; k < 3; k++) {
        word[k] = scene_key_word("precision", PRECISION_DOUBLE + k);
        is_word |= strcmp(value, word[k]) == 0;
    }
    const char *near = nearest_name(value, (const char *const *)word, 3);
    if (is_word) {
        free(o->precision);
        o->precision = fail_format("precision=%s", value);
    } else if (near) {
        o->error = fail_format("--precision '%s': did you mean '%s'?", value, near);
    } else {
        o->error = fail_format(
            "--precision '%s': expected %s, %s or %s", value, word[0], word[1], word[2]);
    }
    for (int k = 0; k < 3; k++) free(word[k]);
}

static void store(struct options *o, int option, const char *value)
{
    switch (option) {
    case DIRECTORY: o->run.dir = value; break;
    case SET:
        if (strchr(value, '=') && value[0] != '=') o->set[o->n_set++] = value;
        else o->error = fail_format("--set '%s': expected KEY=VALUE", value);
        break;
    case FORCE: o->run.force = true; break;
    case DEVICE: o->run.device = value; break;
    case PRECISION: store_precision(o, value); break;
    case STEPS: o->run.n_step = whole_number(o, option, value, 0, INT64_MAX); break;
    case MAX_TIME:
        if (!duration_parse(value, &o->run.max_time))
            o->error =
                fail_format("--max-time '%s': expected a time like 1h30m, 90s or 3600", value);
        break;
    case QUIET: o->run.quiet = true; break;
    case PROFILE: o->run.profile = true; break;
    case TRACE: o->run.trace = true; break;
    case TRACE_FROM:
        o->run.trace = true;
        o->run.trace_from = whole_number(o, option, value, 1, INT64_MAX);
        break;
    case TRACE_LENGTH:
        o->run.trace = true;
        o->run.trace_steps = whole_number(o, option, value, 1, TRACE_SPANS);
        break;
    case RESOLVED: o->resolved = true; break;
    case RANKS: o->n_rank = (int)whole_number(o, option, value, 1, INT_MAX); break;
    }
}

/* Reads the option argv[k], with its value there (--steps=5) or behind it; returns the index of the
 * next argument. */
static int parse_option(struct options *o, int argc, char **argv, int k)
{
    const char *word = argv[k++], *equals = strncmp(word, "--", 2) == 0 ? strchr(word, '=') : NULL;
    size_t length = equals ? (size_t)(equals - word) : strlen(word);
    if (strcmp(word, "--help") == 0 || strcmp(word, "-h") == 0) {
        o->help = true;
        return k;
    }
    int option = 0;
    while (option < N_OPTION &&
           (strncmp(word, OPTION[option].name, length) != 0 || OPTION[option].name[length] != '\0'))
        option++;
    if (option == N_OPTION || !(OPTION[option].commands & 1 << o->command)) {
        char *name = fail_format("%.*s", (int)length, word);
        report_unknown_option(o, name);
        free(name);
        return k;
    }
    const char *value = equals ? equals + 1 : NULL;
    if (OPTION[option].value && !value && k < argc && strncmp(argv[k], "--", 2) != 0)
        value = argv[k++];
    if (OPTION[option].value && (!value || !*value))
        o->error = fail_format("%s needs a value: %s", OPTION[option].name, OPTION[option].value);
    else if (!OPTION[option].value && value)
        o->error = fail_format("%s takes no value", OPTION[option].name);
    else store(o, option, value);
    return k;
}

static void parse_operand(struct options *o, const char *word)
{
    const struct command *c = &COMMAND[o->command];
    if (!c->operand) o->error = fail_format("`democles %s` takes no argument '%s'", c->name, word);
    else if (o->operand)
        o->error = fail_format("`democles %s` takes one %s, not both '%s' and '%s'", c->name,
            c->operand, o->operand, word);
    else o->operand = word;
}

struct options options_parse(int argc, char **argv)
{
    struct options o = {.command = OPTIONS_NONE,
        .run = {.precision = PRECISION_DEFAULT,
            .n_step = -1,
            .max_time = HUGE_VAL,
            .trace_from = -1,
            .trace_steps = TRACE_STEPS}};
    o.set = fail_alloc((size_t)(argc + 1) * sizeof *o.set);
    if (argc < 2) o.error = fail_strdup("a command is missing; see `democles --help`");
    else parse_command(&o, argv[1]);
    for (int k = 2; k < argc && !o.error && o.command != OPTIONS_NONE;) {
        if (argv[k][0] == '-' && argv[k][1]) k = parse_option(&o, argc, argv, k);
        else parse_operand(&o, argv[k++]);
    }
    if (!o.error && !o.help && o.command != OPTIONS_NONE && COMMAND[o.command].needed && !o.operand)
        o.error = fail_format(
            "`democles %s` needs a %s", COMMAND[o.command].name, COMMAND[o.command].operand);
    if (o.precision) o.set[o.n_set++] = o.precision;
    return o;
}

void options_free(struct options *o)
{
    free(o->set);
    free(o->error);
    free(o->precision);
}

static void help_command(enum options_command command, FILE *file)
{
    const struct command *c = &COMMAND[command];
    const char *before = !c->operand || c->needed ? "" : "[",
               *after = !c->operand || c->needed ? "" : "]";
    fprintf(file, "usage: democles %s%s%s%s%s [OPTION]...\n%s\n\n", c->name, c->operand ? " " : "",
        before, c->operand ? c->operand : "", after, c->text);
    for (int k = 0; k < N_OPTION; k++) {
        if (!(OPTION[k].commands & 1 << command)) continue;
        char *left = fail_format("%s %s", OPTION[k].name, OPTION[k].value ? OPTION[k].value : "");
        fprintf(file, "    %-25s  %s\n", left, OPTION[k].text);
        free(left);
    }
    fprintf(file, "    %-25s  %s\n", "--help", "prints this help");
}

void options_help(enum options_command command, FILE *file)
{
    if (command != OPTIONS_NONE) {
        help_command(command, file);
        return;
    }
    fprintf(file, "democles %s: a discrete element method solver for OpenCL devices and MPI\n\n",
        DEMOCLES_VERSION);
    for (int c = 0; c < OPTIONS_NONE; c++) {
        const struct command *row = &COMMAND[c];
        char *left = fail_format(row->needed || !row->operand ? "%s %s" : "%s [%s]", row->name,
            row->operand ? row->operand : "");
        fprintf(file, "    democles %-16s  %s\n", left, row->text);
        free(left);
    }
    fprintf(file, "    democles %-16s  %s\n", "COMMAND --help", "prints the options of a command");
    fprintf(file, "    democles %-16s  %s\n", "--version", "prints the version and commit");
    fprintf(file,
        "\nexit codes: 0 done, 2 usage, 3 scene or input file wrong, 4 no usable device, 5 "
        "numerical failure, 6 input/output, 75 stopped on request\n");
}
