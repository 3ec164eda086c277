#include "frame_list.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
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
    int64_t n;    /* rank 0 alone */
    int64_t size; /* of the file as this process left it [byte]; 0: it has not written it */
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

/* The file as a whole; entries from `first` on, with the end of the file. */
static char *text_of(const struct frame_list *list, int64_t first)
{
    char *text = NULL;
    size_t n;
    FILE *file = open_memstream(&text, &n);
    if (!file) fail_stop(EXIT_IO, "out of memory");
    if (first == 0) fputs(head, file);
    for (int64_t i = first; i < list->n; i++)
        fprintf(file, "%s\n" ENTRY, i > 0 ? "," : "", (long long)list->entry[i].index,
            list->entry[i].time);
    fputs(tail, file);
    if (fclose(file) != 0) fail_stop(EXIT_IO, "out of memory");
    return text;
}

/* The text over the end of the file; where there is no room for it the end is as it was. */
static bool write_end(int fd, const char *text, off_t at)
{
    size_t n = strlen(text);
    if (pwrite(fd, text, n, at) == (ssize_t)n) return true;
    if (pwrite(fd, tail, sizeof tail - 1, at) < 0 || ftruncate(fd, at + (off_t)sizeof tail - 1))
        fail_warn("the list of frames is not whole: %s", strerror(errno));
    return false;
}

/* Writes the newest entry over the end of the file, which then follows it: a list that is written
 * anew for each of its frames costs the square of their number. Small enough for one write, so a
 * reader sees the list before or after. False: there is no room, or the file is not as this process
 * left it. */
static bool write_newest(struct frame_list *list)
{
    struct stat status;
    int fd = list->size > 0 ? open(list->path, O_WRONLY | O_NOFOLLOW | O_CLOEXEC) : -1;
    if (fd < 0) return false;
    char *text = text_of(list, list->n - 1);
    off_t at = (off_t)(list->size - (int64_t)sizeof tail + 1);
    bool is_mine = fstat(fd, &status) == 0 && S_ISREG(status.st_mode) && status.st_nlink == 1 &&
                   status.st_size == list->size;
    bool good = is_mine && write_end(fd, text, at);
    if (close(fd)) good = false;
    if (good) list->size = at + (int64_t)strlen(text);
    free(text);
    return good;
}

/* Rank 0 acts, all agree. */
static void write_file(struct frame_list *list, bool is_longer)
{
    char error[FILES_ERROR_SIZE] = "";
    if (list->comm->rank == 0 && (!is_longer || !write_newest(list))) {
        char *text = text_of(list, 0);
        if (files_replace(list->path, text, strlen(text), error))
            list->size = (int64_t)strlen(text);
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
    if (upto >= 0) write_file(list, false); /* later frames have gone */
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
    bool is_new =
        list->comm->rank == 0 && !(list->n > 0 && list->entry[list->n - 1].index >= index);
    if (is_new) append(list, index, time);
    write_file(list, is_new && list->n > 1);
}

bool frame_list_is_ours(const char *path)
{
    return access(path, F_OK) != 0 || files_begins(path, head);
}
