#include "whole_frame.h"

#include <setjmp.h>

#include "../results/frame_fixture.h"
#include "base/files.h"
#include "comm/fail.h"
#include "fuzz_input.h"
#include "results/frame_table.h"
#include "results/h5_read.h"

static struct comm *comm;
static char folder[] = "/dev/shm/democles_fuzz_XXXXXX";
static char *frame_path;
static uint8_t *frame_data;
static size_t frame_size;

int LLVMFuzzerInitialize(int *argc, char ***argv);

static void clean(void)
{
    unlink(frame_path);
    rmdir(folder);
}

/* Before any input; as the child that checks a frame, the process does nothing else. */
int LLVMFuzzerInitialize(int *argc, char ***argv)
{
    static struct fixture fixture;
    snapshot_serve(*argc, *argv);
    comm = comm_create(argc, argv);
    if (!mkdtemp(folder)) fail_stop(EXIT_IO, "cannot make %s", folder);
    fixture_fill(&fixture, comm);
    snapshot_write(comm, folder, &fixture.frame);
    frame_path = snapshot_path(folder, FIXTURE_INDEX);
    char error[FILES_ERROR_SIZE];
    frame_data = (uint8_t *)files_read(frame_path, &frame_size, error);
    atexit(clean);
    return 0;
}

const char *whole_frame_path(void)
{
    return frame_path;
}

/* What a reading has open; an error leaves it so, where the program would end. */
static struct {
    struct h5_reader *reader;
    struct frame_table table[2];
    int n_table;
    jmp_buf refused;
    int exit_code;
} now;

/* Handles of HDF5 that an error has left open would keep the file open. */
static void close_all(void)
{
    hid_t open[64];
    while (now.reader) {
        ssize_t n = H5Fget_obj_ids(now.reader->file,
            H5F_OBJ_DATASET | H5F_OBJ_GROUP | H5F_OBJ_DATATYPE | H5F_OBJ_ATTR, 64, open);
        if (n <= 0) break;
        for (ssize_t k = 0; k < n; k++) H5Idec_ref(open[k]);
    }
    h5_close(now.reader);
    now.reader = NULL;
    for (int k = 0; k < now.n_table; k++) frame_table_free(&now.table[k]);
    now.n_table = 0;
}

size_t whole_frame_put(void)
{
    close_all();
    FILE *file = fopen(frame_path, "wb");
    fuzz_expect(file && fwrite(frame_data, 1, frame_size, file) == frame_size && !fclose(file),
        "the frame can be written");
    return frame_size;
}

static void leave(void *context, int exit_code, const char *text)
{
    (void)context, (void)text;
    now.exit_code = exit_code;
    longjmp(now.refused, 1);
}

static struct frame_table *begin(const char *name, const char *first)
{
    struct frame_table *table = &now.table[now.n_table];
    *table = frame_table_begin(comm, now.reader, name, first);
    now.n_table++;
    return table;
}

static void read_elements(int64_t n)
{
    struct frame_table *t = begin("elements", "id");
    const int64_t *id = frame_table_add(t, now.reader, "id", COLUMN_I64, 1);
    frame_table_add(t, now.reader, "position", COLUMN_F64, 3);
    frame_table_add(t, now.reader, "velocity", COLUMN_F64, 3);
    frame_table_add(t, now.reader, "displacement", COLUMN_F64, 3);
    frame_table_check_range(t, comm, "id", 0, n - 1);
    frame_table_check_unique(t, comm, "id", n);
    frame_table_check_finite(t, comm);
    int32_t *to = frame_table_owners(comm, id, t->n, n);
    frame_table_send(t, comm, to, 1);
    free(to);
}

static void read_all(void)
{
    int64_t n = fixture_count(0);
    now.reader = h5_open(frame_path);
    h5_read_i64(now.reader, "step");
    h5_read_i64(now.reader, "n_removed");
    h5_read_f64(now.reader, "dt");
    free(h5_read_text(now.reader, "resolved"));
    read_elements(n);
    if (!h5_has(now.reader, "pairs", "partner")) return;
    struct frame_table *t = begin("pairs", "partner");
    frame_table_add(t, now.reader, "partner", COLUMN_I64, 1);
    frame_table_check_range(t, comm, "partner", 0, n - 1);
}

bool whole_frame_read(void)
{
    bool good = setjmp(now.refused) == 0;
    if (good) {
        fail_tell(leave, &now);
        read_all();
        fail_tell(NULL, &now);
    } else {
        fuzz_expect(now.exit_code == EXIT_IO, "what cannot be used ends with code 6");
    }
    return good;
}

void whole_frame_expect(void)
{
    fuzz_expect(whole_frame_read(), "what is whole can be read");
    const struct frame_table *t = &now.table[0];
    const int64_t *id = frame_table_get(t, "id");
    const double *x = frame_table_get(t, "position"), *v = frame_table_get(t, "velocity");
    for (int64_t i = 0; i < t->n; i++)
        for (int k = 0; k < 3; k++)
            fuzz_expect(x[3 * i + k] == fixture_position(id[i], k) &&
                            v[3 * i + k] == fixture_velocity(id[i], k),
                "what is whole is what was written");
}
