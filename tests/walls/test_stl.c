/* STL files: what is read, welded and dropped, what is refused and with which words; the inside of
 * closed surfaces. */
#include "scratch.h"

#include "shape/solid.h"

static const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1}, two[3] = {2, 2, 2};

/* Reads text that must be refused with the message `path` + expected. */
static void refuse(const void *data, size_t size, const char *expected)
{
    char *path = scratch_file(data, size), *error = NULL;
    assert_null(stl_read(path, 1, &error));
    assert_non_null(error);
    assert_memory_equal(error, path, strlen(path));
    assert_string_equal(error + strlen(path), expected);
    free(error);
    scratch_remove(path);
}

static struct stl *read_corners(const double *corner, int n)
{
    char *path = scratch_stl(corner, n), *error = NULL;
    struct stl *stl = stl_read(path, 1, &error);
    assert_null(error);
    scratch_remove(path);
    return stl;
}

/* Binary STL of corners [n][3][3]; returns its size. */
static size_t make_binary(const double *corner, int n, unsigned char *data)
{
    size_t size = 84 + 50 * (size_t)n;
    memset(data, 0, size);
    memcpy(data, "solid made by a program that calls its binary files so", 54);
    for (int b = 0; b < 4; b++) data[80 + b] = (unsigned char)((unsigned)n >> 8 * b);
    for (int t = 0; t < n; t++)
        for (int k = 0; k < 9; k++) {
            float value = (float)corner[9 * t + k];
            memcpy(data + 84 + 50 * t + 12 + 4 * k, &value, 4);
        }
    return size;
}

#define FACET(a, b, c)                                                                             \
    "facet normal 0 0 1\nouter loop\nvertex " a "\nvertex " b "\nvertex " c "\nendloop\nendfacet\n"

static void refuse_text(const char *text, const char *expected)
{
    refuse(text, strlen(text), expected);
}

static void test_refused(void **unused)
{
    (void)unused;
    unsigned char data[84 + 50 * 12 + 8];
    double corner[108];
    scratch_box(zero, one, corner);
    size_t size = make_binary(corner, 12, data);
    refuse(data, size - 20, ": cut off: 12 triangles need 684 bytes, the file has 664");
    corner[9 * 7 + 4] = (double)NAN;
    make_binary(corner, 12, data);
    refuse(data, size, ": triangle 7: corner 2 is not finite");
    refuse(data, make_binary(corner, 0, data), ": no triangle");
    refuse("ab\1", 3, ": neither ASCII nor binary STL: 3 bytes");
    refuse_text("abc", ": not an STL file: text that does not begin with 'solid'");
    refuse_text(
        "v 500 500 500\nv 510 500 500\nv 500 510 500\nv 500 500 510\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf "
        "2 3 4\n",
        ": not an STL file: text that does not begin with 'solid'");
    refuse("", 0, ": neither ASCII nor binary STL: 0 bytes");
    refuse_text("solid\nendsolid\n", ": no triangle");
    refuse_text(
        "solid s\n" FACET("0 0 0", "1 0 0", "0 1 0"), ":8: the file is cut off: no 'endsolid'");
    refuse_text("solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0",
        ":5: the file ends within a triangle");
    refuse_text("solid s\n" FACET("0 0 0", "1 nan 0", "0 1 0") "endsolid\n",
        ":5: 'nan' is not a finite number");
    refuse_text("solid s\n" FACET("0 0 0", "1 0x 0", "0 1 0") "endsolid\n",
        ":5: '0x' is not a finite number");
    refuse_text("solid s\n" FACET("0 0 0", "1 0 0", "0 1 0\nvertex 3 3 3") "endsolid\n",
        ":7: more than three corners in a triangle");
    refuse_text("solid s\nouter loop\nvertex 0 0 0\nendloop\nendsolid\n",
        ":4: a triangle has 1 of its 3 corners");
    static const char damaged[] = "solid s\n" FACET("0 0 0", "1 0\0 0", "0 1 0") "endsolid\n",
                      tail[] = "solid s\n" FACET("0 0 0", "1 0 0", "0 1 0") "\0\0\0\0\0";
    refuse(damaged, sizeof damaged - 1, ":5:11: NUL byte: this text is damaged");
    refuse(tail, sizeof tail - 1, ":8: the file is cut off: no 'endsolid'");
    refuse_text("solid s\nfacte normal\nendsolid\n", ":2: 'facte' is not a keyword of STL");
    refuse_text("solid s\n" FACET("0 0 0", "1 0 0", "2 0 0") "endsolid\n",
        ": all triangles have zero area (1)");
}

/* What other programs write: two triangles each time, at the same places. */
static void accept(const void *data, size_t size)
{
    char *path = scratch_file(data, size), *error = NULL;
    struct stl *stl = stl_read(path, 1, &error);
    if (error) print_error("%s\n", error);
    assert_non_null(stl);
    assert_int_equal(stl->n_triangle, 2);
    assert_int_equal(stl->n_vertex, 4);
    assert_true(stl->vertex[3] == 1 && stl->vertex[10] == 1);
    stl_free(stl);
    scratch_remove(path);
}

#define LINE(a, b, c)                                                                              \
    "facet normal 0 0 1 outer loop vertex " a " vertex " b " vertex " c " endloop endfacet "

static void test_dialects(void **unused)
{
    (void)unused;
#define SECOND FACET("1 0 0", "0 1 0", "1 1 0")
#define BOTH FACET("0 0 0", "1 0 0", "0 1 0") SECOND
    static const char *const texts[] = {
        "solid s\n" BOTH "endsolid s\n",
        "solid\n" BOTH "endsolid",
        " \n\tsolid s\n" BOTH "endsolid s\n",
        "\xef\xbb\xbfsolid s\n" BOTH "endsolid s\n",
        "SOLID S\n" BOTH "ENDSOLID S\n\x1a",
        "solid s\n" BOTH "end solid s\n",
        "solid s\n" LINE("0 0 0", "1 0 0", "0 1 0") "\n" SECOND "endsolid s\n",
        "solid s " LINE("0 0 0", "1 0 0", "0 1 0") LINE("1 0 0", "0 1 0", "1 1 0") "endsolid s",
        "solid of facets\nfacet normal\nouter loop vertex 0 0 0 vertex 1 0 0 vertex 0 1.0D+0 0 "
        "end loop\nend facet\n" SECOND "endsolid\n",
        "solid a\n" FACET("0 0 0", "1 0 0", "0 1 0") "endsolid a\nsolid b\n" SECOND "endsolid b\n",
        "solid a " LINE("0 0 0", "1 0 0", "0 1 0") "endsolid a solid b " LINE(
            "1 0 0", "0 1 0", "1 1 0") "endsolid b",
    };
    for (size_t k = 0; k < sizeof texts / sizeof *texts; k++) {
        char text[1024];
        size_t n = strlen(texts[k]);
        accept(texts[k], n);
        accept(texts[k], n + 1); /* the NUL, too */
        memcpy(text, texts[k], n);
        for (size_t i = 0; i < n; i++)
            if (text[i] == '\n') text[i] = '\r';
        accept(text, n);
    }
    static const double corner[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    unsigned char data[84 + 50 * 2 + 600] = {0}, payload[sizeof data] = {0};
    size_t size = make_binary(corner, 2, data);
    for (size_t more = 0; more <= 600; more = 2 * more + 1) accept(data, size + more);
    memset(data + size, ' ', 600);
    accept(data, size + 600);
    memcpy(payload, data, 84 + 48);
    payload[84 + 48] = 4; /* bytes of attribute that follow the first triangle */
    memcpy(payload + 84 + 50 + 4, data + 84 + 50, 50);
    accept(payload, size + 4);
    refuse("\xff\xfes\0", 4, ": UTF-16 text; save it as ASCII or UTF-8");
    refuse("solid a\rfacet\0 normal\rendsolid", 31, ":2:6: NUL byte: this text is damaged");
    refuse_text(
        "solid s\r" FACET("0 0 0", "1 0 0", "0 x 0") "endsolid", ":6: 'x' is not a finite number");
}

/* Numbers of any size: a message, never a surface that is not there. */
static void test_sizes(void **unused)
{
    static const struct {
        const char *far;
        double scale;
        const char *message;
    } wrong[] = {{"1e308", 1, ": corners at 1e+308, and 1e+308 m with scale"},
        {"1", 1e308, ": corners at 1, and 1e+308 m with scale"},
        {"1e160", 1e-150, ": corners at 1e+160, and 1e+10 m with scale"},
        {"1", 1e-200, ": the surface is 2e-200 m wide with scale"}};
    (void)unused;
    for (size_t k = 0; k < sizeof wrong / sizeof *wrong; k++) {
        char *text = malloc(500), *error = NULL;
        sprintf(text,
            "solid s\nfacet normal 0 0 1\nouter loop\nvertex -%s 0 0\nvertex %s 0 0\n"
            "vertex 0 1 0\nendloop\nendfacet\nendsolid\n",
            wrong[k].far, wrong[k].far);
        char *path = scratch_file(text, strlen(text));
        assert_null(stl_read(path, wrong[k].scale, &error));
        assert_memory_equal(error, path, strlen(path));
        assert_memory_equal(error + strlen(path), wrong[k].message, strlen(wrong[k].message));
        free(text);
        free(error);
        scratch_remove(path);
    }
}

static void test_unreadable(void **unused)
{
    (void)unused;
    char *error = NULL;
    assert_null(stl_read("/nowhere/at_all.stl", 1, &error));
    assert_string_equal(error, "/nowhere/at_all.stl: No such file or directory");
    free(error);
    assert_null(stl_read("/tmp", 1, &error));
    assert_string_equal(error, "/tmp: Is a directory");
    free(error);
}

/* A cube has 8 corners and 18 edges, in binary and ASCII alike, and is closed; without one triangle
 * 3 edges are open. Lengths are scaled. */
static void test_cube(void **unused)
{
    (void)unused;
    unsigned char data[84 + 50 * 12];
    double corner[108];
    char *error = NULL;
    scratch_box(zero, two, corner);
    char *path = scratch_file(data, make_binary(corner, 12, data));
    struct stl *binary = stl_read(path, 1e-3, &error), *ascii = read_corners(corner, 12),
               *open = read_corners(corner, 11);
    assert_true(binary && binary->n_vertex == 8 && binary->n_edge == 18 &&
                binary->n_triangle == 12 && binary->n_dropped == 0);
    assert_true(ascii->n_vertex == 8 && ascii->n_edge == 18 && stl_is_closed(ascii) &&
                stl_is_closed(binary));
    assert_memory_equal(ascii->triangle, binary->triangle, 36 * sizeof(int));
    assert_memory_equal(ascii->edge, binary->edge, 36 * sizeof(int));
    for (int k = 0; k < 24; k++) assert_true(binary->vertex[k] == ascii->vertex[k] * 1e-3);
    assert_true(!stl_is_closed(open) && open->n_open == 3);
    stl_free(binary);
    stl_free(ascii);
    stl_free(open);
    scratch_remove(path);
}

/* Corners that differ by rounding are one; slivers and points go, counted; one flipped triangle
 * opens its edges. */
static void test_weld_and_drop(void **unused)
{
    (void)unused;
    double corner[9 * 15];
    scratch_box(zero, one, corner);
    for (int k = 0; k < 108; k++) corner[k] += 1e-8 * (k % 5 - 2);
    const double bad[27] = {0, 0, 0, 0, 0, 0, 1, 1, 1, 0, 0, 0, 0.5, 0, 0, 1, 0, 0, 1, 1, 1, 0, 0,
        1, 0.5, 0.5, 1 + 1e-9};
    memcpy(corner + 108, bad, sizeof bad);
    struct stl *stl = read_corners(corner, 15);
    assert_true(stl->n_triangle == 12 && stl->n_dropped == 3 && stl_is_closed(stl));
    stl_free(stl);
    scratch_box(zero, one, corner);
    memcpy(corner, corner + 3, 3 * sizeof(double)); /* corner a of triangle 0 in b's place */
    corner[3] = corner[4] = corner[5] = 0;
    stl = read_corners(corner, 12);
    assert_true(!stl_is_closed(stl) && stl->n_open == 3);
    stl_free(stl);
}

/* Points in and out of a cube that stands on a vertex grid, so rays run exactly through edges and
 * vertices. */
static void test_inside_of_a_cube(void **unused)
{
    (void)unused;
    double corner[108];
    scratch_box(zero, one, corner);
    struct stl *stl = read_corners(corner, 12);
    struct solid *solid = solid_create(stl);
    for (int i = -4; i <= 12; i++)
        for (int j = -4; j <= 12; j++)
            for (int k = -4; k <= 12; k++) {
                double x[3] = {i / 8.0, j / 8.0, k / 8.0},
                       edge = fmin(fmin(fmin(i, 8 - i), fmin(j, 8 - j)), fmin(k, 8 - k)) / 8.0;
                /* on the surface either answer is right */
                if (edge > 0 || edge < 0) assert_int_equal(solid_contains(solid, x), edge > 0);
                if (edge > 0) assert_true(fabs(solid_distance(solid, x, 10) - edge) < 1e-15);
                if (edge > 0.25) assert_true(solid_distance(solid, x, 0.25) == 0.25);
            }
    solid_free(solid);
    stl_free(stl);
}

/* An L of two overlapping boxes, turned at random and facing inwards: inside is where either box
 * is. */
static void test_overlapping_and_turned(void **unused)
{
    (void)unused;
    uint64_t state = 8;
    const double long_high[3] = {2, 0.5, 0.5};
    for (int trial = 0; trial < 20; trial++) {
        double corner[216], turn[9];
        scratch_rotation(&state, turn);
        scratch_box(zero, one, corner);
        scratch_box(zero, long_high, corner + 108);
        for (int t = 0; t < 24; t++) {
            for (int k = 0; k < 3; k++)
                scratch_turn(turn, corner + 9 * t + 3 * k, corner + 9 * t + 3 * k);
            for (int a = 0; a < 3 && trial % 2; a++) {
                double swap = corner[9 * t + a];
                corner[9 * t + a] = corner[9 * t + 3 + a];
                corner[9 * t + 3 + a] = swap;
            }
        }
        struct stl *stl = read_corners(corner, 24);
        assert_true(stl_is_closed(stl));
        struct solid *solid = solid_create(stl);
        for (int k = 0; k < 500; k++) {
            double q[3] = {scratch_random(&state, -0.5, 2.5), scratch_random(&state, -0.5, 1.5),
                scratch_random(&state, -0.5, 1.5)},
                   x[3];
            bool in = true, in_long = true;
            for (int a = 0; a < 3; a++) {
                in = in && q[a] > 0 && q[a] < 1;
                in_long = in_long && q[a] > 0 && q[a] < long_high[a];
            }
            scratch_turn(turn, q, x);
            assert_int_equal(solid_contains(solid, x), in || in_long);
        }
        solid_free(solid);
        stl_free(stl);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_refused),
        cmocka_unit_test(test_dialects), cmocka_unit_test(test_sizes),
        cmocka_unit_test(test_unreadable), cmocka_unit_test(test_cube),
        cmocka_unit_test(test_weld_and_drop), cmocka_unit_test(test_inside_of_a_cube),
        cmocka_unit_test(test_overlapping_and_turned)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
