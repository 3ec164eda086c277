/* What several tests of this area need: random numbers, files that vanish, a scene made of walls.
 * Includes cmocka. */
#ifndef SCRATCH_H
#define SCRATCH_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* xorshift64*, uniform in [low, high). */
static inline double scratch_random(uint64_t *state, double low, double high)
{
    *state ^= *state >> 12;
    *state ^= *state << 25;
    *state ^= *state >> 27;
    return low + (high - low) * (double)(*state * 0x2545f4914f6cdd1du >> 11) * 0x1p-53;
}

/* A random rotation by rows, from a random unit quaternion. */
static inline void scratch_rotation(uint64_t *state, double r[9])
{
    double q[4], square;
    do {
        square = 0;
        for (int k = 0; k < 4; k++) {
            q[k] = scratch_random(state, -1, 1);
            square += q[k] * q[k];
        }
    } while (square > 1 || square < 0.01);
    for (int k = 0; k < 4; k++) q[k] /= sqrt(square);
    double w = q[0], x = q[1], y = q[2], z = q[3];
    double rows[9] = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
        2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 2 * (x * z - w * y),
        2 * (y * z + w * x), 1 - 2 * (x * x + y * y)};
    memcpy(r, rows, sizeof rows);
}

static inline void scratch_turn(const double r[9], const double a[3], double b[3])
{
    double t[3];
    for (int k = 0; k < 3; k++) t[k] = r[3 * k] * a[0] + r[3 * k + 1] * a[1] + r[3 * k + 2] * a[2];
    memcpy(b, t, sizeof t);
}

/* A file with that content; the caller removes and frees the name. */
static inline char *scratch_file(const void *data, size_t size)
{
    char *path = strdup("/tmp/democles_XXXXXX");
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    assert_int_equal(write(descriptor, data, size), size);
    close(descriptor);
    return path;
}

static inline void scratch_remove(char *path)
{
    unlink(path);
    free(path);
}

/* ASCII STL of corners [n][3][3], every digit kept. */
static inline char *scratch_stl(const double *corner, int n)
{
    size_t room = 400 * (size_t)n + 100, size;
    char *text = malloc(room);
    size = (size_t)snprintf(text, room, "solid s\n");
    for (int t = 0; t < n; t++) {
        size += (size_t)snprintf(text + size, room - size, "facet normal 0 0 0\nouter loop\n");
        for (int k = 0; k < 3; k++) {
            const double *p = corner + 9 * t + 3 * k;
            size += (size_t)snprintf(
                text + size, room - size, "vertex %.17g %.17g %.17g\n", p[0], p[1], p[2]);
        }
        size += (size_t)snprintf(text + size, room - size, "endloop\nendfacet\n");
    }
    size += (size_t)snprintf(text + size, room - size, "endsolid s\n");
    char *path = scratch_file(text, size);
    free(text);
    return path;
}

/* Corners of an axis-parallel box's 12 triangles, facing outwards, into corner [12][3][3]. */
static inline void scratch_box(const double low[3], const double high[3], double *corner)
{
    static const int quad[6][4] = {
        {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    static const int cut[6] = {0, 1, 2, 0, 2, 3};
    for (int f = 0; f < 6; f++)
        for (int k = 0; k < 6; k++)
            for (int a = 0; a < 3; a++) *corner++ = quad[f][cut[k]] >> a & 1 ? high[a] : low[a];
}

static inline struct wall scratch_wall(enum surface_kind kind)
{
    struct wall wall = {.name = "wall",
        .kind = kind,
        .scale = 1,
        .remove_at = HUGE_VAL,
        .rotation_axis = {0, 0, 1},
        .line = 7};
    wall.normal[2] = 1;
    return wall;
}

static inline struct scene scratch_scene(struct wall *wall, int n)
{
    struct scene scene = {.path = "scene.yaml", .wall = wall, .n_wall = n};
    return scene;
}

static inline void scratch_expect(struct scene_errors *errors, int k, const char *text)
{
    assert_true(k < errors->n);
    assert_string_equal(errors->text[k], text);
}

#endif
