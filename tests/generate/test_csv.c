/* Elements from CSV files: columns in any order, and for each fault file, line and column. */
#include "../walls/scratch.h"

#include "particle/generate.h"

static struct elements_host *read_bytes(
    const char *text, size_t size, char **path, struct scene_errors *errors)
{
    *path = scratch_file(text, size);
    struct element_group group = {.name = "grains",
        .from_file = true,
        .file = *path,
        .line = 4,
        .velocity = {1, 2, 3},
        .angular_velocity = {4, 5, 6}};
    struct scene scene = {
        .path = "scene.yaml", .group = &group, .n_group = 1, .domain = {.start_overlap = HUGE_VAL}};
    return generate_elements(&scene, errors);
}

static struct elements_host *read_csv(const char *text, char **path, struct scene_errors *errors)
{
    return read_bytes(text, strlen(text), path, errors);
}

static void test_columns_in_any_order(void **unused)
{
    (void)unused;
    struct scene_errors errors = {0};
    char *path;
    struct elements_host *e = read_csv(
        "radius, z,vx ,y,x,wz\r\n0.5,3,-7,2,1,9\r\n\r\n 0.25 ,\t6, 8e0 ,5,4,-0.5", &path, &errors);
    const double x[6] = {1, 2, 3, 4, 5, 6}, v[6] = {-7, 2, 3, 8, 2, 3},
                 w[6] = {4, 5, 9, 4, 5, -0.5}, radius[2] = {0.5, 0.25};
    assert_int_equal(errors.n, 0);
    assert_int_equal(e->n, 2);
    assert_memory_equal(e->x, x, sizeof x);
    assert_memory_equal(e->v, v, sizeof v); /* what has no column is the group's */
    assert_memory_equal(e->w, w, sizeof w);
    assert_memory_equal(e->radius, radius, sizeof radius);
    generate_free(e);
    scratch_remove(path);
}

/* Every message must be path + one of the expected, in order. */
static void refuse_bytes(const char *text, size_t size, const char *const *expected, int n)
{
    struct scene_errors errors = {0};
    char *path;
    assert_null(read_bytes(text, size, &path, &errors));
    assert_int_equal(errors.n, n);
    for (int k = 0; k < n; k++) {
        assert_memory_equal(errors.text[k], path, strlen(path));
        assert_string_equal(errors.text[k] + strlen(path), expected[k]);
    }
    scene_errors_free(&errors);
    scratch_remove(path);
}

static void refuse(const char *text, const char *const *expected, int n)
{
    refuse_bytes(text, strlen(text), expected, n);
}

/* As in the tail of a file that was not whole on disk when the power failed: no row is lost without
 * a word. */
static void test_nul(void **unused)
{
    (void)unused;
#define NUL ": NUL byte: this is no text, or damaged"
    static const char inside[] = "x,y,z,radius\n1,2,3,1\n4,5\0,6,1\n7,8,9,1\0\n",
                      tail[] = "x,y,z,radius\n1,2,3,1\n\0\0\0\0\0\0\0\0",
                      row[] = "x,y,z,radius\n1,2,3,1\n\0\0\0\0\n4,5,6,1\n",
                      header[] = "x,y,z,radius\0\n1,2,3,1\n",
                      wide[] = "\xff\xfex\0,\0y\0,\0z\0\n\0";
    refuse_bytes(inside, sizeof inside - 1, (const char *const[]){":3:4" NUL, ":4:8" NUL}, 2);
    refuse_bytes(tail, sizeof tail - 1, (const char *const[]){":3:1" NUL}, 1);
    refuse_bytes(row, sizeof row - 1, (const char *const[]){":3:1" NUL}, 1);
    refuse_bytes(header, sizeof header - 1, (const char *const[]){":1:13" NUL}, 1);
    refuse_bytes(wide, sizeof wide - 1, (const char *const[]){":1:4" NUL}, 1);
}

static void test_values(void **unused)
{
    (void)unused;
    const char *const expected[] = {":2:7: z: 'nan' is not finite", ":3:5: y is empty",
        ":3:6: z: 'three' is not a number", ":3:12: radius: '-1' is not positive",
        ":4:5: 3 columns, the header has 4", ":5:9: 5 columns, the header has 4",
        ":6:1: x: '1e999' is not finite", ":8:7: radius: '0' is not positive"};
    refuse("x,y,z,radius\n1, 2, nan,1\n 1, "
           ",three,-1\n1,2,3\n1,2,3,4,5\n1e999,2,3,1\n1,2,3,1\n4,5,6,0\n",
        expected, 8);
}

static void test_header(void **unused)
{
    (void)unused;
    const char *const misspelt[] = {
        ":1:7: unknown column 'radis'; did you mean 'radius'?", ":1:1: column 'radius' is missing"};
    const char *const twice[] = {":1:3: column 'x' is there twice", ":1:1: column 'y' is missing"};
    const char *const none[] = {":2:1: unknown column '0.1'; the first line names columns of "
                                "x,y,z,radius,vx,vy,vz,wx,wy,wz",
        ":2:5: unknown column '0.2'; the first line names columns of "
        "x,y,z,radius,vx,vy,vz,wx,wy,wz",
        ":2:1: column 'x' is missing", ":2:1: column 'y' is missing", ":2:1: column 'z' is missing",
        ":2:1: column 'radius' is missing"};
    const char *const nothing[] = {": no element"};
    refuse("x,y,z,radis\n1,2,3,4\n", misspelt, 2);
    refuse("x,x,z,radius\n1,2,3,4\n", twice, 2);
    refuse("\n0.1,0.2\n", none, 6);
    refuse("", nothing, 1);
    refuse("x,y,z,radius\n\n", nothing, 1);
}

/* Ten faults are told, the rest counted. */
static void test_many(void **unused)
{
    (void)unused;
    char text[2000] = "x,y,z,radius\n";
    struct scene_errors errors = {0};
    char *path;
    for (int k = 0; k < 25; k++) strcat(text, "inf,0,0,1\n");
    assert_null(read_csv(text, &path, &errors));
    assert_int_equal(errors.n, 11);
    assert_string_equal(errors.text[10] + strlen(path), ": and 15 more");
    scene_errors_free(&errors);
    scratch_remove(path);
}

static void test_missing_file(void **unused)
{
    (void)unused;
    struct element_group group = {.name = "grains", .from_file = true, .file = "no.csv", .line = 4};
    struct scene scene = {.path = "scene.yaml", .group = &group, .n_group = 1};
    struct scene_errors errors = {0};
    assert_null(generate_elements(&scene, &errors));
    scratch_expect(
        &errors, 0, "scene.yaml:4: elements 'grains': no.csv: No such file or directory");
    scene_errors_free(&errors);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_columns_in_any_order),
        cmocka_unit_test(test_values), cmocka_unit_test(test_nul), cmocka_unit_test(test_header),
        cmocka_unit_test(test_many), cmocka_unit_test(test_missing_file)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
