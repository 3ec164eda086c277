#include "resume.h"

#include <dirent.h>
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "base/files.h"
#include "scene/scene_report.h"
#include "sim.h"

static int descending(const void *a, const void *b)
{
    int64_t x = *(const int64_t *)a, y = *(const int64_t *)b;
    return (x < y) - (x > y);
}

/* Numbers of the frames in a folder, newest first; n < 0: errno of the folder. */
static int64_t *frames_of(const char *dir, int64_t *n)
{
    DIR *folder = opendir(dir);
    int64_t *index = NULL;
    *n = folder ? 0 : -errno;
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        int64_t number = snapshot_index(entry->d_name);
        if (number < 0) continue;
        index = fail_realloc(index, (size_t)(*n + 1) * sizeof *index);
        index[(*n)++] = number;
    }
    if (folder) closedir(folder);
    if (*n > 0) qsort(index, (size_t)*n, sizeof *index, descending);
    return index;
}

/* The same on every rank, as rank 0 sees them. */
static int64_t *share_frames(const struct comm *comm, const char *dir, int64_t *n)
{
    int64_t *index = comm->rank == 0 ? frames_of(dir, n) : NULL;
    comm_bcast(comm, n, sizeof *n, 0);
    if (*n < 0)
        fail_stop_together(*n == -ENOENT || *n == -ENOTDIR ? EXIT_SCENE : EXIT_IO,
            "cannot open the folder '%s': %s", dir, strerror((int)-*n));
    if (*n == 0) fail_stop_together(EXIT_SCENE, "'%s' contains no frame_*.hdf to resume from", dir);
    if (comm->rank > 0) index = fail_alloc((size_t)*n * sizeof *index);
    comm_bcast(comm, index, (size_t)*n * sizeof *index, 0);
    return index;
}

/* What every frame notes of the run as a whole. */
static const struct {
    const char *name;
    enum column_type type;
    size_t at; /* in struct sim, or in its balance */
    bool is_balance;
} noted[RESUME_SCALARS] = {{"dt", COLUMN_F64, offsetof(struct sim, dt), false},
    {"inputs", COLUMN_I64, offsetof(struct sim, inputs), false},
    {"limit_at", COLUMN_I64, offsetof(struct sim, limit_at), false},
    {"dt_limit", COLUMN_F64, offsetof(struct sim, dt_limit), false},
    {"n_removed", COLUMN_I64, offsetof(struct sim, n_removed), false},
    {"n_rebuild", COLUMN_I64, offsetof(struct sim, n_rebuild), false},
    {"n_repartition", COLUMN_I64, offsetof(struct balance, n_deal), true},
    {"n_moved", COLUMN_I64, offsetof(struct balance, n_moved), true}};

static char *wrong_integer(const char *name, int64_t value, int64_t most)
{
    return value >= 0 && value <= most
               ? NULL
               : fail_format("democles: %s is %lld", name, (long long)value);
}

static char *wrong_real(const char *name, double value, bool may_be_infinite)
{
    return value >= 0 && (may_be_infinite || isfinite(value))
               ? NULL
               : fail_format("democles: %s is %g", name, value);
}

/* What is wrong with the numbers of the frame as a whole, whose checksums are right, or NULL. */
static char *wrong_numbers(const struct h5_reader *reader)
{
    int64_t step = h5_read_i64(reader, "step");
    char *wrong = wrong_integer("step", step, INT64_MAX / 2);
    if (!wrong && !(h5_read_f64(reader, "dt") > 0))
        wrong = fail_strdup("democles: dt is not above 0");
    for (int k = 0; k < RESUME_SCALARS && !wrong; k++) {
        const char *name = noted[k].name;
        if (noted[k].type == COLUMN_F64)
            wrong = wrong_real(name, h5_read_f64(reader, name), !strcmp(name, "dt_limit"));
        else if (strcmp(name, "inputs") != 0) /* a checksum, any number */
            wrong = wrong_integer(
                name, h5_read_i64(reader, name), !strcmp(name, "limit_at") ? step : INT64_MAX / 2);
    }
    return wrong;
}

/* What is wrong with a frame, or NULL, with its reader. */
static char *open_frame(const struct comm *comm, const char *path, struct h5_reader **reader)
{
    char *wrong = snapshot_check(comm, path);
    if (wrong) return wrong;
    *reader = h5_open(path);
    wrong = wrong_numbers(*reader);
    if (wrong) h5_close(*reader);
    return wrong;
}

struct resume *resume_open(const struct comm *comm, struct log *log, const char *dir)
{
    int64_t n = 0, k = 0, *index = share_frames(comm, dir, &n);
    char *path = NULL;
    struct h5_reader *reader = NULL;
    for (; k < n; k++) {
        path = snapshot_path(dir, index[k]);
        char *wrong = open_frame(comm, path, &reader);
        if (!wrong) break;
        log_warn(log, "'%s' cannot be used: %s%s", path, wrong,
            k + 1 < n ? "; trying the frame before it" : "");
        free(wrong);
        free(path);
    }
    if (k == n) fail_stop_together(EXIT_SCENE, "no frame in '%s' can be used", dir);
    struct resume *r = fail_alloc(sizeof *r);
    r->reader = reader;
    r->dir = fail_strdup(dir);
    r->path = path;
    r->index = index[k];
    r->step = h5_read_i64(r->reader, "step");
    r->dt = h5_read_f64(r->reader, "dt");
    free(index);
    return r;
}

void resume_close(struct resume *r)
{
    h5_close(r->reader);
    r->reader = NULL;
}

void resume_free(struct resume *r)
{
    if (!r) return;
    resume_close(r);
    scene_free(r->before);
    free(r->dir);
    free(r->path);
    free(r);
}

/* Keys, with all below them, that the state does not depend on; and the last words of keys that
 * name files, whose content is compared. */
static const char *const may_change[] = {"title", "time.end", "time.allow_unstable",
    "lattice.relax.tolerance", "output", "measure", "partition"};
static const char *const names_file[] = {".stl", ".file", ".table"};

static bool is_file(const char *set)
{
    size_t n = strcspn(set, "=");
    for (size_t k = 0; k < sizeof names_file / sizeof *names_file; k++) {
        size_t m = strlen(names_file[k]);
        if (n > m && !strncmp(set + n - m, names_file[k], m)) return true;
    }
    return false;
}

static bool can_change(const char *set)
{
    size_t n = strcspn(set, "=");
    for (size_t k = 0; k < sizeof may_change / sizeof *may_change; k++) {
        size_t m = strlen(may_change[k]);
        if (n >= m && !strncmp(set, may_change[k], m) && strchr("=.[", set[m])) return true;
    }
    return is_file(set);
}

static void refuse_changes(const char *const *set, int n_set)
{
    char keys[256] = "";
    for (size_t k = 0, n = 0; k < sizeof may_change / sizeof *may_change; k++)
        n += (size_t)snprintf(keys + n, sizeof keys - n, "%s, ", may_change[k]);
    for (int k = 0; k < n_set; k++)
        if (!can_change(set[k]))
            fail_stop_together(EXIT_SCENE,
                "--set %s: a restarted run cannot change '%.*s'; it can change %sand the paths of "
                "files",
                set[k], (int)strcspn(set[k], "="), set[k], keys);
}

/* Whoever has edited the copy of the scene means something by it. */
static void warn_of_edits(const struct comm *comm, const char *path, const char *text)
{
    char error[FILES_ERROR_SIZE];
    size_t n = 0;
    char *file = comm->rank == 0 ? files_read(path, &n, error) : NULL;
    if (file && strcmp(file, text))
        fail_warn(
            "'%s' differs from the scene in the frame and is ignored; use --set to change a key",
            path);
    free(file);
}

struct scene *resume_scene(
    const struct comm *comm, struct resume *r, const char *const *set, int n_set)
{
    refuse_changes(set, n_set);
    struct scene_errors errors = {0};
    char *text = h5_read_text(r->reader, "resolved"),
         *path = fail_format("%s/resolved.yaml", r->dir);
    warn_of_edits(comm, path, text);
    const char **file = fail_alloc((size_t)n_set * sizeof *file);
    int n_file = 0;
    for (int k = 0; k < n_set; k++)
        if (is_file(set[k])) file[n_file++] = set[k];
    struct scene *scene = scene_read_text(path, text, strlen(text), set, n_set, &errors);
    scene_report_errors(comm, &errors);
    r->before = scene_read_text(path, text, strlen(text), file, n_file, &errors);
    scene_report_errors(comm, &errors);
    free(file);
    free(path);
    free(text);
    return scene;
}

static void *noted_at(const struct sim *s, int k)
{
    return (char *)(noted[k].is_balance ? (void *)s->balance : (void *)s) + noted[k].at;
}

void resume_note(const struct sim *s, struct frame_scalar scalar[RESUME_SCALARS])
{
    for (int k = 0; k < RESUME_SCALARS; k++) {
        const void *at = noted_at(s, k);
        scalar[k] = (struct frame_scalar){.name = noted[k].name, .type = noted[k].type};
        if (noted[k].type == COLUMN_F64) memcpy(&scalar[k].f64, at, sizeof scalar[k].f64);
        else memcpy(&scalar[k].i64, at, sizeof scalar[k].i64);
    }
}

void resume_recall(struct sim *s)
{
    const struct h5_reader *reader = s->from->reader;
    for (int k = 0; k < RESUME_SCALARS; k++) {
        void *at = noted_at(s, k);
        int64_t integer = noted[k].type == COLUMN_I64 ? h5_read_i64(reader, noted[k].name) : 0;
        double real = noted[k].type == COLUMN_F64 ? h5_read_f64(reader, noted[k].name) : 0;
        memcpy(at, noted[k].type == COLUMN_F64 ? (const void *)&real : &integer, sizeof integer);
    }
}

/* Once a method reads on, there is no way back to the frame before. */
static void insist(const struct sim *s, char *wrong)
{
    if (wrong)
        fail_stop_together(EXIT_IO,
            "'%s' cannot be used: %s; without this file the frame before it is taken",
            s->from->path, wrong);
}

int64_t resume_integer(const struct sim *s, const char *name, int64_t most)
{
    int64_t value = h5_read_i64(s->from->reader, name);
    insist(s, wrong_integer(name, value, most));
    return value;
}

double resume_real(const struct sim *s, const char *name)
{
    double value = h5_read_f64(s->from->reader, name);
    insist(s, wrong_real(name, value, false));
    return value;
}

void resume_check_inputs(const struct sim *s)
{
    if (h5_read_i64(s->from->reader, "inputs") == s->inputs) return;
    fail_stop_together(EXIT_SCENE,
        "the scene of '%s' no longer gives the initial state that this run began with: a file "
        "that it reads, or this program, has changed since",
        s->from->path);
}
