/* The reference page: complete, and in parts. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "scene/output_fields.h"
#include "scene/scene.h"
#include "scene/scene_keys.h"

/* What scene_explain prints to *stream (stdout or stderr); owned by the caller. */
static char *explain(const char *key, FILE **stream, bool expected)
{
    char *text = NULL;
    size_t n;
    FILE *before = *stream;
    *stream = open_memstream(&text, &n);
    bool found = scene_explain(key);
    fclose(*stream);
    *stream = before;
    assert_int_equal(found, expected);
    return text;
}

static int lines(const char *text)
{
    int n = 0;
    for (; *text; text++) n += *text == '\n';
    return n;
}

static void every_key_has_its_line(void **state)
{
    (void)state;
    char *text = explain(NULL, &stdout, true);
    for (int k = 0; k < scene_keys_n; k++) {
        char line[128];
        snprintf(line, sizeof line, "\n%s ", scene_keys[k].path);
        if (!strstr(text, line)) fail_msg("%s is not explained", scene_keys[k].path);
        assert_true(strlen(scene_keys[k].text) > 0);
    }
    free(text);
}

static void a_part(void **state)
{
    (void)state;
    char *text = explain("contacts.normal", &stdout, true);
    assert_int_equal(lines(text), 1 + 6);
    assert_non_null(strstr(text, "contacts[].normal.stiffness "));
    assert_null(strstr(text, "tangential"));
    free(text);
    char *again = explain("contacts[0].normal", &stdout, true),
         *same = explain("contacts[].normal", &stdout, true);
    assert_string_equal(again, same);
    free(again);
    free(same);
}

static void one_key(void **state)
{
    (void)state;
    char *text = explain("time.step", &stdout, true);
    assert_string_equal(text,
        "key        type                  unit   default                 meaning\n"
        "time.step  number                s      auto                    "
        "time step; auto: safety factor times the critical time step [> 0]\n");
    free(text);
}

static void materials_have_names(void **state)
{
    (void)state;
    const char *const key[] = {"materials.NAME.young", "materials.steel.young"};
    for (int k = 0; k < 2; k++) {
        char *text = explain(key[k], &stdout, true);
        assert_int_equal(lines(text), 1 + 2); /* one for each method */
        assert_non_null(strstr(text, "Young's modulus, needed by contacts of law: hertz"));
        assert_non_null(strstr(text, "needed (lattice)"));
        free(text);
    }
    char *text = explain("materials.steel", &stdout, true);
    assert_int_equal(lines(text), 1 + 1 + 2 * 2 + 6 + 7);
    free(text);
}

/* A key whose words are fields says what each is, if asked for by itself. */
static void fields_are_explained(void **state)
{
    (void)state;
    char *text = explain("output.fields", &stdout, true), *above = explain("output", &stdout, true);
    for (int k = 0; k < 2; k++) {
        const struct scene_item *i = k ? output_fields_lattice : output_fields_particles;
        for (; i->name; i++) {
            char line[256];
            snprintf(line, sizeof line, "\n    %-16s  %-7s  %s\n", i->name, i->unit, i->text);
            if (!strstr(text, line)) fail_msg("%s is not explained", i->name);
        }
    }
    assert_non_null(strstr(text, "net contact force"));
    assert_int_equal(lines(above), 1 + 5); /* what is above them stays short */
    free(text);
    free(above);
}

static void unknown_key_names_the_nearest(void **state)
{
    (void)state;
    char *text = explain("contacts.normal.stifness", &stderr, false);
    assert_string_equal(text, "democles: error: no key 'contacts.normal.stifness'; did you mean "
                              "'contacts.normal.stiffness'?\n");
    free(text);
    text = explain("xyzzy", &stderr, false);
    assert_string_equal(text, "democles: error: no key 'xyzzy'; `democles explain` lists all\n");
    free(text);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_key_has_its_line),
        cmocka_unit_test(a_part),
        cmocka_unit_test(one_key),
        cmocka_unit_test(materials_have_names),
        cmocka_unit_test(fields_are_explained),
        cmocka_unit_test(unknown_key_names_the_nearest),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
