/* A folder of its own for every test: scenes and the files that they name are written there. */
#ifndef DEMOCLES_TEST_SCENE_FIXTURE_H
#define DEMOCLES_TEST_SCENE_FIXTURE_H

#define _XOPEN_SOURCE 700 /* nftw */
#include <ftw.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

#include "comm/fail.h"
#include "scene/scene.h"

struct fixture {
    char folder[64];
    char *path; /* of the scene written last */
};

static inline int fixture_setup(void **state)
{
    struct fixture *f = fail_alloc(sizeof *f);
    strcpy(f->folder, "/tmp/democles_scene_XXXXXX");
    *state = f;
    return mkdtemp(f->folder) ? 0 : -1;
}

static inline int fixture_remove(
    const char *path, const struct stat *info, int type, struct FTW *at)
{
    (void)info, (void)type, (void)at;
    return remove(path);
}

static inline int fixture_teardown(void **state)
{
    struct fixture *f = *state;
    int code = nftw(f->folder, fixture_remove, 8, FTW_DEPTH | FTW_PHYS);
    free(f->path);
    free(f);
    return code;
}

static inline void fixture_write(struct fixture *f, const char *name, const char *text, size_t n)
{
    free(f->path);
    f->path = fail_format("%s/%s", f->folder, name);
    FILE *file = fopen(f->path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, n, file), n);
    fclose(file);
}

static inline void fixture_scene(struct fixture *f, const char *text)
{
    fixture_write(f, "scene.yaml", text, strlen(text));
}

/* Copies a scene of this test folder, beside files that it may name. */
static inline void fixture_copy(struct fixture *f, const char *name)
{
    char *from = fail_format(SCENES "/%s", name), text[8192];
    FILE *file = fopen(from, "rb");
    assert_non_null(file);
    size_t n = fread(text, 1, sizeof text, file);
    fclose(file);
    free(from);
    fixture_write(f, "filling.stl", "", 0);
    fixture_write(f, "funnel.stl", "", 0);
    fixture_write(f, "bed.csv", "", 0);
    fixture_write(f, "load.csv", "time,factor\n0,0.5\n1,2\n", 22);
    fixture_write(f, name, text, n);
}

/* Reads the scene; it must be free of errors. */
static inline struct scene *fixture_read(const struct fixture *f, const char *const *set, int n_set)
{
    struct scene_errors errors = {0};
    struct scene *scene = scene_read(f->path, set, n_set, &errors);
    for (int k = 0; k < errors.n; k++) print_error("%s\n", errors.text[k]);
    assert_non_null(scene);
    assert_int_equal(errors.n, 0);
    scene_errors_free(&errors);
    return scene;
}

/* Reads the scene; it must give exactly these messages, each but those of --set with the folder
 * before it. */
static inline void fixture_expect(
    const struct fixture *f, const char *const *set, int n_set, const char *const *message, int n)
{
    struct scene_errors errors = {0};
    struct scene *scene = scene_read(f->path, set, n_set, &errors);
    assert_null(scene);
    for (int k = 0; k < errors.n; k++) {
        size_t skip =
            strncmp(errors.text[k], f->folder, strlen(f->folder)) == 0 ? strlen(f->folder) + 1 : 0;
        /* Paths of files stand within messages, too. */
        char *within = strstr(errors.text[k] + skip, f->folder);
        if (within)
            memmove(
                within, within + strlen(f->folder) + 1, strlen(within + strlen(f->folder) + 1) + 1);
        if (k < n) assert_string_equal(errors.text[k] + skip, message[k]);
        else print_error("one more: %s\n", errors.text[k]);
    }
    assert_int_equal(errors.n, n);
    scene_errors_free(&errors);
}

/* The same for one message of a scene without --set. */
static inline void fixture_expect_one(struct fixture *f, const char *text, const char *message)
{
    fixture_scene(f, text);
    fixture_expect(f, NULL, 0, &message, 1);
}

#endif
