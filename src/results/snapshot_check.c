/* Whether a frame is whole. Every rank opens the file by itself, without MPI's files: what is
 * damaged may fail on one rank and not on others, and then none must wait inside of HDF5. */
#include "snapshot.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "h5_check.h"

/* Datasets in the order of the walk, the same on every rank of a whole file. */
struct walk {
    int part, n_part;
    int64_t n;
    char **path;
    uint64_t *sum, *expected;
};

static const char *add_dataset(struct walk *w, hid_t dataset, const char *path)
{
    size_t n = (size_t)w->n + 1;
    w->path = fail_realloc(w->path, n * sizeof *w->path);
    w->sum = fail_realloc(w->sum, n * sizeof *w->sum);
    w->expected = fail_realloc(w->expected, n * sizeof *w->expected);
    w->path[w->n] = fail_strdup(path);
    w->n++;
    return h5_check_part(dataset, w->part, w->n_part, &w->sum[n - 1], &w->expected[n - 1]);
}

/* What is wrong with the object `name` below `parent` (and with all below it), or NULL. An own
 * walk: H5Ovisit of HDF5 1.10 loses handles where an object cannot be opened. Hard links are read
 * twice. */
static char *walk_object(struct walk *w, hid_t parent, const char *name, const char *path)
{
    hid_t object = H5Oopen(parent, name, H5P_DEFAULT);
    if (object < 0) return fail_format("%s: cannot be opened", path);
    char *wrong = NULL, child[256];
    H5G_info_t info = {.nlinks = 0};
    if (H5Iget_type(object) == H5I_DATASET) {
        const char *text = add_dataset(w, object, path);
        if (text) wrong = fail_format("%s: %s", path, text);
    } else if (H5Gget_info(object, &info) < 0) {
        wrong = fail_format("%s: cannot be listed", path);
    }
    for (hsize_t k = 0; k < info.nlinks && !wrong; k++) {
        ssize_t n = H5Lget_name_by_idx(
            object, ".", H5_INDEX_NAME, H5_ITER_INC, k, child, sizeof child, H5P_DEFAULT);
        char *child_path = fail_format("%s/%s", path, n > 0 ? child : "?");
        wrong = n > 0 ? walk_object(w, object, child, child_path)
                      : fail_format("%s: cannot be listed", path);
        free(child_path);
    }
    H5Oclose(object);
    return wrong;
}

/* An integer attribute of /democles; -1: there is none that can be read. */
static int64_t number_of(hid_t file, const char *name)
{
    int64_t value = -1;
    hid_t attribute = H5Aopen_by_name(file, "democles", name, H5P_DEFAULT, H5P_DEFAULT);
    if (attribute >= 0 && H5Aread(attribute, H5T_NATIVE_INT64, &value) < 0) value = -1;
    if (attribute >= 0) H5Aclose(attribute);
    return value;
}

static char *walk_file(struct walk *w, hid_t file)
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
    for (int k = 0; k < 2 && !wrong; k++) wrong = walk_object(w, file, group[k], group[k]);
    if (!wrong && w->n != n)
        wrong = fail_format("it has %lld of %lld datasets", (long long)w->n, (long long)n);
    return wrong;
}

static char *open_and_walk(struct walk *w, const char *path)
{
    H5E_auto2_t print;
    void *print_data;
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

/* The message of the lowest rank that has one, on every rank. */
static char *agree(const struct comm *comm, char *wrong)
{
    char text[512] = "";
    int64_t first = wrong ? comm->rank : comm->n_rank;
    comm_min_i64(comm, &first, 1);
    if (first == comm->n_rank) return NULL;
    if (wrong) snprintf(text, sizeof text, "%s", wrong);
    free(wrong);
    comm_bcast(comm, text, sizeof text, (int)first);
    return fail_strdup(text);
}

static char *compare(const struct walk *w)
{
    for (int64_t k = 0; k < w->n; k++)
        if (w->sum[k] != w->expected[k]) return fail_format("%s: %s", w->path[k], h5_check_wrong);
    return NULL;
}

char *snapshot_check(const struct comm *comm, const char *path)
{
    struct walk w = {.part = comm ? comm->rank : 0, .n_part = comm ? comm->n_rank : 1};
    char *wrong = open_and_walk(&w, path);
    if (comm) wrong = agree(comm, wrong);
    if (!wrong && comm) comm_sum_i64(comm, (int64_t *)w.sum, (int)w.n); /* wraps modulo 2^64 */
    if (!wrong) wrong = compare(&w);
    for (int64_t k = 0; k < w.n; k++) free(w.path[k]);
    free(w.path);
    free(w.sum);
    free(w.expected);
    return wrong;
}
