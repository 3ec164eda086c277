/* Whether a frame is whole, in a process of its own (snapshot_child.c): HDF5 1.10 itself may fail
 * on a damaged file. What the file says is trusted in nothing: it may have been made to harm. */
#include "snapshot.h"
#include "snapshot_walk.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/files.h"
#include "comm/fail.h"
#include "h5_check.h"

/* Frames have objects in groups in groups, fewer than a hundred. */
enum { DEPTH_MOST = 4, OBJECTS_MOST = 1000 };

void snapshot_walk_add(struct snapshot_walk *w, const char *path, uint64_t sum, uint64_t expected)
{
    size_t n = (size_t)w->n + 1;
    w->path = fail_realloc(w->path, n * sizeof *w->path);
    w->sum = fail_realloc(w->sum, n * sizeof *w->sum);
    w->expected = fail_realloc(w->expected, n * sizeof *w->expected);
    w->path[w->n] = fail_strdup(path);
    w->sum[w->n] = sum;
    w->expected[w->n++] = expected;
}

void snapshot_walk_free(struct snapshot_walk *w)
{
    for (int64_t k = 0; k < w->n; k++) free(w->path[k]);
    free(w->path);
    free(w->sum);
    free(w->expected);
}

static const char *add_dataset(struct snapshot_walk *w, hid_t dataset, const char *path)
{
    uint64_t sum, expected;
    /* places of particles; of cells, which are those of the start, with what they have moved */
    bool finite = !strcmp(path, "VTKHDF/Points") || !strcmp(path, "VTKHDF/PointData/displacement");
    const char *wrong = h5_check_part(dataset, w->part, w->n_part, finite, &sum, &expected);
    snapshot_walk_add(w, path, sum, expected);
    return wrong;
}

/* Only what lies in the file itself: other links lead to other files, or nowhere. */
static bool is_hard(hid_t parent, const char *name)
{
    H5L_info_t info;
    return H5Lget_info(parent, name, &info, H5P_DEFAULT) >= 0 && info.type == H5L_TYPE_HARD;
}

/* What is wrong with the object `name` below `parent` (and with all below it), or NULL. An own
 * walk: H5Ovisit of HDF5 1.10 loses handles where an object cannot be opened. Hard links are read
 * twice; groups that contain themselves end at the depth and number that frames have. */
static char *walk_object(
    struct snapshot_walk *w, hid_t parent, const char *name, const char *path, int depth)
{
    if (depth > DEPTH_MOST || ++w->n_object > OBJECTS_MOST)
        return fail_format("%s: groups in groups that no frame has", path);
    if (!is_hard(parent, name)) return fail_format("%s: a link that leads out of the file", path);
    hid_t object = H5Oopen(parent, name, H5P_DEFAULT);
    if (object < 0) return fail_format("%s: cannot be opened", path);
    char *wrong = NULL, child[256];
    H5G_info_t info = {.nlinks = 0};
    if (H5Iget_type(object) == H5I_DATASET) {
        const char *text = add_dataset(w, object, path);
        if (text) wrong = fail_format("%s: %s", path, text);
    } else if (H5Gget_info(object, &info) < 0) {
        wrong = fail_format("%s: cannot be listed", path);
    } else if (info.nlinks > OBJECTS_MOST) { /* each look for a name takes as long as there are */
        wrong = fail_format("%s: more objects than a frame has", path);
    }
    for (hsize_t k = 0; k < info.nlinks && !wrong; k++) {
        ssize_t n = H5Lget_name_by_idx(
            object, ".", H5_INDEX_NAME, H5_ITER_INC, k, child, sizeof child, H5P_DEFAULT);
        char *child_path = fail_format("%s/%s", path, n > 0 ? child : "?");
        wrong = n > 0 ? walk_object(w, object, child, child_path, depth + 1)
                      : fail_format("%s: cannot be listed", path);
        free(child_path);
    }
    H5Oclose(object);
    return wrong;
}

/* An integer attribute of /democles; -1: there is none that can be read. */
static int64_t number_of(hid_t file, const char *name)
{
    int64_t value;
    return h5_check_number(file, "democles", name, H5T_NATIVE_INT64, &value) ? value : -1;
}

/* Attributes of /democles are single numbers; opened by name too, as the reader does. */
static char *walk_numbers(hid_t file)
{
    hid_t group = H5Oopen(file, "democles", H5P_DEFAULT);
    H5O_info_t info = {.num_attrs = 0};
    char *wrong = NULL, name[256] = "";
    if (H5Oget_info(group, &info) < 0) wrong = fail_strdup("democles: its header cannot be read");
    for (hsize_t k = 0; k < info.num_attrs && k < OBJECTS_MOST && !wrong; k++) {
        int64_t integer;
        double real;
        ssize_t n = H5Aget_name_by_idx(
            group, ".", H5_INDEX_NAME, H5_ITER_INC, k, name, sizeof name, H5P_DEFAULT);
        if (n <= 0 || (!h5_check_number(group, ".", name, H5T_NATIVE_INT64, &integer) &&
                          !h5_check_number(group, ".", name, H5T_NATIVE_DOUBLE, &real)))
            wrong = fail_format("democles: its attribute %s is not one number", n > 0 ? name : "?");
    }
    if (group >= 0) H5Oclose(group);
    return wrong;
}

static char *walk_file(struct snapshot_walk *w, hid_t file)
{
    const char *const group[] = {"VTKHDF", "democles"};
    char *wrong = NULL;
    for (int k = 0; k < 2 && !wrong; k++) {
        htri_t exists = H5Lexists(file, group[k], H5P_DEFAULT);
        if (exists < 0) wrong = fail_strdup("its list of groups cannot be read");
        else if (exists == 0)
            wrong = fail_format("not a frame of democles: it has no group %s", group[k]);
    }
    if (wrong) return wrong;
    int64_t version = number_of(file, "format_version"), n = number_of(file, "n_dataset");
    if (version < 0) return fail_strdup("its format version cannot be read");
    if (version != SNAPSHOT_FORMAT_VERSION)
        return fail_format("its format version is %lld, this program's %d", (long long)version,
            SNAPSHOT_FORMAT_VERSION);
    wrong = walk_numbers(file);
    for (int k = 0; k < 2 && !wrong; k++) wrong = walk_object(w, file, group[k], group[k], 1);
    if (!wrong && w->n != n)
        wrong = fail_format("it has %lld of %lld datasets", (long long)w->n, (long long)n);
    return wrong;
}

char *snapshot_walk(struct snapshot_walk *w, const char *path)
{
    H5E_auto2_t print;
    void *print_data;
    if (!files_is_ordinary(path)) return fail_strdup("no ordinary file");
    /* frames are whole once they have their name, and some file systems know no locks */
    setenv("HDF5_USE_FILE_LOCKING", "FALSE", 0);
    /* HDF5 1.10 loses count of a damaged file, and would complain on stderr when the program
     * ends */
    H5dont_atexit();
    H5Eget_auto2(H5E_DEFAULT, &print, &print_data);
    H5Eset_auto2(H5E_DEFAULT, NULL, NULL);
    hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
    char *wrong =
        file < 0 ? fail_format("cannot be opened: %s", h5_check_error()) : walk_file(w, file);
    if (file >= 0) H5Fclose(file);
    H5Eset_auto2(H5E_DEFAULT, print, print_data);
    return wrong;
}
