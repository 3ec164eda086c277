#include "frame_list.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "comm/fail.h"
#include "snapshot.h"

/* One frame a line, so that it is read back with ease. */
static const char head[] = "{\"file-series-version\": \"1.0\", \"files\": [", tail[] = "\n]}\n";
#define ENTRY "{\"name\": \"frame_%06lld.hdf\", \"time\": %.17g}"
#define ENTRY_READ "{\"name\": \"frame_%lld.hdf\", \"time\": %lf}"

struct frame_list {
    const struct comm *comm;
    const char *dir; /* borrowed */
    char *path;
    int64_t n; /* rank 0 alone */
    struct entry {
        int64_t index;
        double time;
    } * entry;
};

static void append(struct frame_list *list, int64_t index, double time)
{
    list->entry = fail_realloc(list->entry, (size_t)(list->n + 1) * sizeof *list->entry);
    list->entry[list->n++] = (struct entry){index, time};
}

static bool is_there(const struct frame_list *list, int64_t index)
{
    char *path = snapshot_path(list->dir, index);
    bool there = access(path, F_OK) == 0;
    free(path);
    return there;
}

/* Lines that are none of ours are skipped. */
static void read_back(struct frame_list *list, int64_t upto)
{
    char error[FILES_ERROR_SIZE], *rest = NULL;
    size_t n;
    char *text = files_read(list->path, &n, error);
    for (char *line = text ? strtok_r(text, "\n", &rest) : NULL; line;
         line = strtok_r(NULL, "\n", &rest)) {
        long long index;
        double time;
        if (sscanf(line, ENTRY_READ, &index, &time) != 2 || index < 0 || index > upto) continue;
        if (isfinite(time) && is_there(list, index)) append(list, index, time);
    }
    free(text);
}

static char *text_of(const struct frame_list *list)
{
    char *text = NULL;
    size_t n;
    FILE *file = open_memstream(&text, &n);
    if (!file) fail_stop(EXIT_IO, "out of memory");
    fputs(head, file);
    for (int64_t i = 0; i < list->n; i++)
        fprintf(file, "%s\n" ENTRY, i > 0 ? "," : "", (long long)list->entry[i].index,
            list->entry[i].time);
    fputs(tail, file);
    if (fclose(file) != 0) fail_stop(EXIT_IO, "out of memory");
    return text;
}

/* Rank 0 acts, all agree. */
static void write_file(const struct frame_list *list)
{
    char error[FILES_ERROR_SIZE] = "";
    if (list->comm->rank == 0) {
        char *text = text_of(list);
        files_replace(list->path, text, strlen(text), error);
        free(text);
    }
    comm_bcast(list->comm, error, sizeof error, 0);
    if (error[0]) fail_stop_together(EXIT_IO, "%s", error);
}

struct frame_list *frame_list_create(const struct comm *comm, const char *dir, int64_t upto)
{
    struct frame_list *list = fail_alloc(sizeof *list);
    list->comm = comm;
    list->dir = dir;
    list->path = fail_format("%s/" FRAME_LIST_NAME, dir);
    if (comm->rank == 0 && upto >= 0) read_back(list, upto);
    if (upto >= 0) write_file(list); /* later frames have gone */
    return list;
}

void frame_list_free(struct frame_list *list)
{
    if (!list) return;
    free(list->path);
    free(list->entry);
    free(list);
}

void frame_list_add(struct frame_list *list, int64_t index, double time)
{
    bool known = false;
    for (int64_t i = 0; i < list->n; i++) known |= list->entry[i].index == index;
    if (!known && list->comm->rank == 0) append(list, index, time);
    write_file(list);
}

bool frame_list_is_ours(const char *path)
{
    return access(path, F_OK) != 0 || files_begins(path, head);
}
