/* A frame on disk: what ParaView 5.11 asks for to the byte, the state that a run continues from,
 * and nothing half done. Run on 1 to 3 ranks. */
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "comm/fail.h"
#include "frame_fixture.h"
#include "results/h5_check.h"
#include "results/h5_write.h"

static struct comm *comm;
static struct fixture fixture;
static char dir[64]; /* the same on all ranks */
static char *path;

static hid_t open_frame(void)
{
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    assert_true(file >= 0);
    return file;
}

static int64_t total(void)
{
    int64_t n = 0;
    for (int r = 0; r < comm->n_rank; r++) n += fixture_count(r);
    return n;
}

static void read_all(hid_t file, const char *name, hid_t memory, int width, void *data)
{
    hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
    assert_true(dataset >= 0);
    hid_t space = H5Dget_space(dataset);
    assert_int_equal(H5Sget_simple_extent_npoints(space) % width, 0);
    assert_true(H5Sget_simple_extent_npoints(space) <= width * FIXTURE_LARGEST);
    assert_int_equal(H5Sget_simple_extent_ndims(space), width > 1 ? 2 : 1);
    assert_true(H5Dread(dataset, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) >= 0);
    H5Sclose(space);
    H5Dclose(dataset);
}

/* `Type` must be 16 bytes of ASCII without a terminator: VTK 9.1 reads other forms too, ParaView
 * 5.11 does not. */
static void test_type_is_16_ascii_bytes(void **state)
{
    (void)state;
    hid_t file = open_frame(), grid = H5Gopen2(file, "VTKHDF", H5P_DEFAULT),
          attribute = H5Aopen(grid, "Type", H5P_DEFAULT);
    hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    char text[17] = "";
    assert_int_equal(H5Tget_class(type), H5T_STRING);
    assert_int_equal(H5Tis_variable_str(type), 0);
    assert_int_equal(H5Tget_size(type), 16);
    assert_int_equal(H5Tget_cset(type), H5T_CSET_ASCII);
    assert_int_equal(H5Sget_simple_extent_type(space), H5S_SCALAR);
    assert_true(H5Aread(attribute, type, text) >= 0);
    assert_string_equal(text, "UnstructuredGrid");
    H5Sclose(space);
    H5Tclose(type);
    H5Aclose(attribute);
    int64_t version[2];
    attribute = H5Aopen(grid, "Version", H5P_DEFAULT);
    assert_true(H5Aread(attribute, H5T_NATIVE_INT64, version) >= 0);
    assert_int_equal(version[0], 1);
    assert_int_equal(version[1], 0);
    H5Aclose(attribute);
    H5Gclose(grid);
    H5Fclose(file);
}

static void test_parts_follow_ranks(void **state)
{
    (void)state;
    int64_t count[8], offset[FIXTURE_LARGEST + 8], connectivity[FIXTURE_LARGEST];
    unsigned char types[FIXTURE_LARGEST];
    hid_t file = open_frame();
    const char *const counts[] = {"VTKHDF/NumberOfPoints", "VTKHDF/NumberOfCells",
        "VTKHDF/NumberOfConnectivityIds", "democles/rows/elements"};
    for (int k = 0; k < 4; k++) {
        read_all(file, counts[k], H5T_NATIVE_INT64, 1, count);
        for (int r = 0; r < comm->n_rank; r++) assert_int_equal(count[r], fixture_count(r));
    }
    read_all(file, "VTKHDF/Offsets", H5T_NATIVE_INT64, 1, offset);
    read_all(file, "VTKHDF/Connectivity", H5T_NATIVE_INT64, 1, connectivity);
    read_all(file, "VTKHDF/Types", H5T_NATIVE_UINT8, 1, types);
    const int64_t *begin = offset, *ids = connectivity;
    for (int r = 0; r < comm->n_rank; r++) {
        for (int64_t i = 0; i <= fixture_count(r); i++) assert_int_equal(*begin++, i);
        for (int64_t i = 0; i < fixture_count(r); i++) assert_int_equal(*ids++, i);
    }
    for (int64_t i = 0; i < total(); i++) assert_int_equal(types[i], 1);
    hid_t dataset = H5Dopen2(file, "VTKHDF/Types", H5P_DEFAULT), type = H5Dget_type(dataset);
    assert_true(H5Tequal(type, H5T_STD_U8LE) > 0);
    H5Tclose(type);
    H5Dclose(dataset);
    H5Fclose(file);
}

static void test_state_comes_back_bit_for_bit(void **state)
{
    (void)state;
    double position[FIXTURE_LARGEST][3], velocity[FIXTURE_LARGEST][3];
    int64_t gid[FIXTURE_LARGEST];
    hid_t file = open_frame();
    read_all(file, "democles/elements/id", H5T_NATIVE_INT64, 1, gid);
    read_all(file, "democles/elements/position", H5T_NATIVE_DOUBLE, 3, position);
    read_all(file, "democles/elements/displacement", H5T_NATIVE_DOUBLE, 3, velocity);
    for (int64_t i = 0; i < total(); i++) {
        assert_int_equal(gid[i], i);
        for (int k = 0; k < 3; k++) {
            assert_true(position[i][k] == fixture_position(i, k));
            assert_true(velocity[i][k] == fixture_velocity(i, k));
        }
    }
    char resolved[64] = "";
    hid_t dataset = H5Dopen2(file, "democles/resolved", H5P_DEFAULT), type = H5Dget_type(dataset);
    assert_int_equal(H5Tget_size(type), strlen("title: a scene\n"));
    assert_true(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, resolved) >= 0);
    assert_string_equal(resolved, "title: a scene\n");
    H5Tclose(type);
    H5Dclose(dataset);
    H5Fclose(file);
}

static int64_t integer_of(hid_t object, const char *name)
{
    int64_t value = -1;
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    assert_true(attribute >= 0);
    assert_true(H5Aread(attribute, H5T_NATIVE_INT64, &value) >= 0);
    H5Aclose(attribute);
    return value;
}

static void assert_text_of(hid_t object, const char *name, const char *expected)
{
    char text[64] = "";
    hid_t attribute = H5Aopen(object, name, H5P_DEFAULT), type = H5Aget_type(attribute);
    assert_true(H5Tget_size(type) < sizeof text);
    assert_true(H5Aread(attribute, type, text) >= 0);
    assert_string_equal(text, expected);
    H5Tclose(type);
    H5Aclose(attribute);
}

static void test_attributes(void **state)
{
    (void)state;
    hid_t file = open_frame(), group = H5Gopen2(file, "democles", H5P_DEFAULT);
    assert_int_equal(integer_of(group, "format_version"), SNAPSHOT_FORMAT_VERSION);
    assert_int_equal(integer_of(group, "step"), FIXTURE_STEP);
    assert_int_equal(integer_of(group, "index"), FIXTURE_INDEX);
    assert_int_equal(integer_of(group, "n_element"), total());
    assert_int_equal(integer_of(group, "n_removed"), 12);
    H5Gclose(group);
    hid_t dataset = H5Dopen2(file, "democles/elements/displacement", H5P_DEFAULT);
    assert_text_of(dataset, "name", "displacement");
    assert_text_of(dataset, "unit", "m");
    assert_text_of(dataset, "description", "since the lists were built, in µm steps");
    H5Dclose(dataset);
    H5Fclose(file);
}

/* The same memory under the same name is stored once. */
static void test_shared_columns_are_links(void **state)
{
    (void)state;
    hid_t file = open_frame();
    const char *const name[][2] = {{"democles/elements/position", "VTKHDF/Points"},
        {"democles/elements/velocity", "VTKHDF/PointData/velocity"},
        {"democles/elements/displacement", "VTKHDF/PointData/velocity"}};
    for (int k = 0; k < 3; k++) {
        H5O_info_t one, other;
        assert_true(H5Oget_info_by_name(file, name[k][0], &one, H5P_DEFAULT) >= 0);
        assert_true(H5Oget_info_by_name(file, name[k][1], &other, H5P_DEFAULT) >= 0);
        assert_true((one.addr == other.addr) == (k < 2));
    }
    H5Fclose(file);
}

static void test_whole_frame_passes_check(void **state)
{
    (void)state;
    char *wrong = snapshot_check(NULL, path);
    if (wrong) print_message("%s\n", wrong);
    assert_null(wrong);
    assert_int_not_equal(access(dir, F_OK), -1);
    DIR *folder = opendir(dir);
    for (struct dirent *entry; (entry = readdir(folder));)
        assert_null(strstr(entry->d_name, ".tmp"));
    closedir(folder);
}

/* No other name is that of a frame. */
static void test_names(void **state)
{
    static const char *const other[] = {"frame_7.hdf", "frame_0000007.hdf", "frame_000007_kept.hdf",
        "frame_000007.old.hdf", "frame_-00007.hdf", "frame_+00007.hdf", "frame_ 00007.hdf",
        "frame_000007.hdf.tmp", "frame_000007.hdf ", "frame_.hdf", "frame_0x0007.hdf",
        "frame_99999999999999999999999.hdf", "aframe_000007.hdf", ""};
    (void)state;
    assert_int_equal(snapshot_index("frame_000007.hdf"), 7);
    assert_int_equal(snapshot_index("frame_1234567.hdf"), 1234567);
    for (size_t k = 0; k < sizeof other / sizeof *other; k++)
        if (snapshot_index(other[k]) >= 0) fail_msg("%s is taken for a frame", other[k]);
}

/* Several H5Dwrite per column, as many as the fullest rank needs, give the same file content as
 * one. */
static void write_in_pieces(void)
{
    char *name = fail_format("%s/pieces.hdf", dir);
    struct h5_writer *writer = h5_create(comm, name, 0);
    writer->piece = 2 * 3 * sizeof(double); /* two rows */
    h5_column(
        writer, writer->file, &fixture.point[0], h5_rows_of(comm, fixture.frame.points.n_row));
    h5_finish(writer);
    free(name);
}

static void test_pieces(void **state)
{
    (void)state;
    double position[FIXTURE_LARGEST][3];
    char *name = fail_format("%s/pieces.hdf", dir);
    hid_t file = H5Fopen(name, H5F_ACC_RDONLY, H5P_DEFAULT),
          dataset = H5Dopen2(file, "position", H5P_DEFAULT);
    uint64_t sum = 0, expected = 0;
    for (int part = 0; part < 3; part++) { /* in thirds */
        uint64_t mine;
        assert_null(h5_check_part(dataset, part, 3, true, &mine, &expected));
        sum += mine;
    }
    assert_true(sum == expected);
    H5Dclose(dataset);
    read_all(file, "position", H5T_NATIVE_DOUBLE, 3, position);
    for (int64_t i = 0; i < total(); i++) assert_true(position[i][2] == fixture_position(i, 2));
    H5Fclose(file);
    unlink(name);
    free(name);
}

int main(int argc, char **argv)
{
    snapshot_serve(argc, argv);
    comm = comm_create(&argc, &argv);
    if (comm->rank == 0) {
        strcpy(dir, "/tmp/democles_frame_XXXXXX");
        if (!mkdtemp(dir)) fail_stop(EXIT_IO, "no folder for the test");
    }
    comm_bcast(comm, dir, sizeof dir, 0);
    fixture_fill(&fixture, comm);
    snapshot_write(comm, dir, &fixture.frame);
    write_in_pieces();
    path = snapshot_path(dir, FIXTURE_INDEX);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_type_is_16_ascii_bytes),
        cmocka_unit_test(test_parts_follow_ranks),
        cmocka_unit_test(test_state_comes_back_bit_for_bit),
        cmocka_unit_test(test_attributes),
        cmocka_unit_test(test_shared_columns_are_links),
        cmocka_unit_test(test_whole_frame_passes_check),
        cmocka_unit_test(test_names),
        cmocka_unit_test(test_pieces),
    };
    int failed = comm->rank == 0 ? cmocka_run_group_tests_name("frame", tests, NULL, NULL) : 0;
    if (comm->rank == 0) {
        unlink(path);
        rmdir(dir);
    }
    free(path);
    comm_free(comm);
    return failed;
}
