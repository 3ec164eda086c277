/* The command line: what is taken, what is refused and in which words, and that --help offers what
 * is known. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "app/options.h"

enum { MOST_WORDS = 32 };

/* Parses "democles" and the words of `line`, which are split in place and have to outlive the
 * options. */
static struct options parse(char *line)
{
    char *word[MOST_WORDS] = {(char[]){"democles"}};
    int n = 1;
    for (char *w = strtok(line, " "); w; w = strtok(NULL, " ")) {
        assert_true(n < MOST_WORDS);
        word[n++] = w;
    }
    return options_parse(n, word);
}

static void refuses(const char *line, const char *error)
{
    char *words = fail_strdup(line);
    struct options o = parse(words);
    assert_non_null(o.error);
    assert_string_equal(o.error, error);
    options_free(&o);
    free(words);
}

static void refuses_with_the_nearest_word(void **state)
{
    (void)state;
    refuses("", "a command is missing; see `democles --help`");
    refuses("rnu a.yaml", "there is no command 'rnu'; did you mean 'run'?");
    refuses("simulate a.yaml", "there is no command 'simulate'; see `democles --help`");
    refuses(
        "--quiet run a.yaml", "a command has to come first, not '--quiet'; see `democles --help`");
    refuses("resume", "`democles resume` needs a DIR");
    refuses("resume out --force",
        "`democles resume` has no option '--force'; see `democles resume --help`");
    refuses("run", "`democles run` needs a SCENE");
    refuses("check --resolved", "`democles check` needs a SCENE");
    refuses("run a.yaml b.yaml", "`democles run` takes one SCENE, not both 'a.yaml' and 'b.yaml'");
    refuses("devices a.yaml", "`democles devices` takes no argument 'a.yaml'");
    refuses(
        "run a.yaml --stpes 5", "`democles run` has no option '--stpes'; did you mean '--steps'?");
    refuses(
        "run a.yaml --stpes=5", "`democles run` has no option '--stpes'; did you mean '--steps'?");
    refuses(
        "run a.yaml --step 5", "`democles run` has no option '--step'; did you mean '--steps'?");
    refuses("check a.yaml --force",
        "`democles check` has no option '--force'; see `democles check --help`");
    refuses("explain --resolved",
        "`democles explain` has no option '--resolved'; see `democles explain --help`");
}

static void refuses_values(void **state)
{
    (void)state;
    refuses("run a.yaml -o", "-o needs a value: DIR");
    refuses("run a.yaml -o --force", "-o needs a value: DIR");
    refuses("run a.yaml --device=", "--device needs a value: PLATFORM:DEVICE");
    refuses("run a.yaml --quiet=1", "--quiet takes no value");
    refuses("run a.yaml --set time.end", "--set 'time.end': expected KEY=VALUE");
    refuses("run a.yaml --set =1s", "--set '=1s': expected KEY=VALUE");
    refuses("run a.yaml --steps many", "--steps 'many': expected a whole number, at least 0");
    refuses("run a.yaml --steps 1.5", "--steps '1.5': expected a whole number, at least 0");
    refuses("run a.yaml --steps -1", "--steps '-1': expected a whole number, at least 0");
    refuses("run a.yaml --steps +-1", "--steps '+-1': expected a whole number, at least 0");
    refuses("run a.yaml --steps 99999999999999999999",
        "--steps '99999999999999999999': expected a whole number, at least 0");
    refuses("devices --ranks 0", "--ranks '0': expected a whole number, at least 1");
    refuses("run a.yaml --trace-steps 0", "--trace-steps '0': expected a whole number, at least 1");
    refuses(
        "run a.yaml --max-time 1h30", "--max-time '1h30': expected a time like 1h30m, 90s or 3600");
    refuses("run a.yaml --precision singel", "--precision 'singel': did you mean 'single'?");
    refuses("run a.yaml --precision half", "--precision 'half': expected double, mixed or single");
}

static void takes_all_of_run(void **state)
{
    (void)state;
    char line[] =
        "run --precision mixed -o a/b s.yaml --set time.end=1s --steps=7 --max-time 1h30m --force "
        "--device pocl:0 --set k==v --quiet --profile";
    struct options o = parse(line);
    assert_null(o.error);
    assert_int_equal(o.command, OPTIONS_RUN);
    assert_string_equal(o.operand, "s.yaml");
    assert_string_equal(o.run.dir, "a/b");
    assert_string_equal(o.run.device, "pocl:0");
    assert_true(o.run.force && o.run.quiet && o.run.profile && !o.help && !o.version);
    assert_int_equal(o.run.n_step, 7);
    assert_true(o.run.max_time == 5400);
    /* --precision comes last, wherever it stood, so that it wins */
    assert_int_equal(o.n_set, 3);
    assert_string_equal(o.set[0], "time.end=1s");
    assert_string_equal(o.set[1], "k==v");
    assert_string_equal(o.set[2], "precision=mixed");
    options_free(&o);
}

static void defaults_of_run(void **state)
{
    (void)state;
    char line[] = "run s.yaml";
    struct options o = parse(line);
    assert_null(o.error);
    assert_null(o.run.dir);
    assert_null(o.run.device);
    assert_true(!o.run.force && !o.run.quiet && o.n_set == 0);
    assert_int_equal(o.run.n_step, -1);
    assert_false(o.run.trace);
    assert_true(isinf(o.run.max_time));
    options_free(&o);
}

static void traces(void **state)
{
    (void)state;
    char plain[] = "run s.yaml --trace", from[] = "run s.yaml --trace-from 7",
         length[] = "run s.yaml --trace-steps=3";
    struct options o = parse(plain);
    assert_true(
        !o.error && o.run.trace && o.run.trace_from == -1 && o.run.trace_steps == TRACE_STEPS);
    options_free(&o);
    o = parse(from);
    assert_true(
        !o.error && o.run.trace && o.run.trace_from == 7 && o.run.trace_steps == TRACE_STEPS);
    options_free(&o);
    o = parse(length);
    assert_true(!o.error && o.run.trace && o.run.trace_from == -1 && o.run.trace_steps == 3);
    options_free(&o);
}

static void takes_other_commands(void **state)
{
    (void)state;
    char resume[] = "resume out/a --steps 9 --set time.end=1s --max-time 2m --device 0:0 --quiet";
    char check[] = "check --resolved s.yaml", devices[] = "devices --ranks 4",
         explain[] = "explain", help[] = "run --help", version[] = "--version";
    struct options o = parse(resume);
    assert_true(!o.error && o.command == OPTIONS_RESUME && o.run.n_step == 9 && o.n_set == 1);
    assert_string_equal(o.operand, "out/a");
    options_free(&o);
    o = parse(check);
    assert_true(!o.error && o.command == OPTIONS_CHECK && o.resolved);
    options_free(&o);
    o = parse(devices);
    assert_true(!o.error && o.command == OPTIONS_DEVICES && o.n_rank == 4);
    options_free(&o);
    o = parse(explain);
    assert_true(!o.error && o.command == OPTIONS_EXPLAIN && !o.operand);
    options_free(&o);
    o = parse(help); /* needs no SCENE */
    assert_true(!o.error && o.command == OPTIONS_RUN && o.help);
    options_free(&o);
    o = parse(version);
    assert_true(!o.error && o.command == OPTIONS_NONE && o.version);
    options_free(&o);
}

static char *help_of(enum options_command command)
{
    char *text = NULL;
    size_t n = 0;
    FILE *file = open_memstream(&text, &n);
    assert_non_null(file);
    options_help(command, file);
    assert_int_equal(fclose(file), 0);
    char *copy = fail_strdup(text);
    free(text);
    return copy;
}

/* Each line of a command's help that begins with an option names one that the command knows, and
 * what users rely on is among them. */
static void help_offers_what_is_known(void **state)
{
    (void)state;
    static const struct {
        enum options_command command;
        const char *name, *option[9];
    } expected[] = {{OPTIONS_RUN, "run",
                        {"-o DIR", "--set KEY=VALUE", "--force", "--device", "--precision",
                            "--steps N", "--max-time", "--quiet"}},
        {OPTIONS_RESUME, "resume",
            {"--set KEY=VALUE", "--device", "--steps N", "--max-time", "--quiet", "--profile"}},
        {OPTIONS_CHECK, "check", {"--set KEY=VALUE", "--resolved"}},
        {OPTIONS_DEVICES, "devices", {"--ranks N"}}, {OPTIONS_EXPLAIN, "explain", {"--help"}}};
    for (int c = 0; c < 5; c++) {
        char *text = help_of(expected[c].command);
        for (int k = 0; expected[c].option[k]; k++) {
            char *begin = fail_format("\n    %s ", expected[c].option[k]);
            assert_non_null(strstr(text, begin));
            free(begin);
        }
        for (char *line = strstr(text, "\n    -"); line; line = strstr(line + 1, "\n    -")) {
            char *words =
                fail_format("%s %.*s", expected[c].name, (int)strcspn(line + 5, " "), line + 5);
            struct options o = parse(words);
            assert_true(!o.error || !strstr(o.error, "has no option"));
            options_free(&o);
            free(words);
        }
        free(text);
    }
    char *text = help_of(OPTIONS_NONE);
    for (int c = 0; c < 5; c++) assert_non_null(strstr(text, expected[c].name));
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(refuses_with_the_nearest_word),
        cmocka_unit_test(refuses_values), cmocka_unit_test(takes_all_of_run),
        cmocka_unit_test(defaults_of_run), cmocka_unit_test(traces),
        cmocka_unit_test(takes_other_commands), cmocka_unit_test(help_offers_what_is_known)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
