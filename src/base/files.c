#define _GNU_SOURCE /* fopencookie */
#include "files.h"
#include "comm/fail.h"
#include "signals.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

enum { PATIENCE = 50 }; /* between two looks for signals [ms] */

static bool failed(char error[FILES_ERROR_SIZE], const char *what, const char *path)
{
    snprintf(error, FILES_ERROR_SIZE, "cannot %s '%s': %s", what, path, strerror(errno));
    return false;
}

/* Waits for a writer, or obeys a request to stop: it is held while a run sets up, and SA_RESTART
 * would go on with the read even where it is not. */
static ssize_t read_patiently(void *cookie, char *text, size_t n)
{
    struct pollfd in = {.fd = *(int *)cookie, .events = POLLIN};
    for (;;) {
        signals_obey();
        if (poll(&in, 1, PATIENCE) <= 0) continue;
        ssize_t got = read(in.fd, text, n);
        if (got >= 0 || (errno != EINTR && errno != EAGAIN)) return got;
    }
}

static int close_cookie(void *cookie)
{
    int code = close(*(int *)cookie);
    free(cookie);
    return code;
}

FILE *files_input(const char *path)
{
    /* O_NONBLOCK: the open of a pipe would wait for its writer, where no signal ends it */
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
    struct stat status;
    if (fd < 0) return NULL;
    bool is_known = fstat(fd, &status) == 0;
    bool is_null = is_known && S_ISCHR(status.st_mode) && status.st_rdev == makedev(1, 3);
    if (is_null || (is_known && (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode))))
        return fdopen(fd, "rb");
    if (is_known && (isatty(fd) || !(S_ISCHR(status.st_mode) || S_ISBLK(status.st_mode)))) {
        static const cookie_io_functions_t patient = {
            .read = read_patiently, .close = close_cookie};
        int *cookie = fail_alloc(sizeof *cookie);
        *cookie = fd;
        return fopencookie(cookie, "rb", patient);
    }
    close(fd);
    errno = ENOTSUP;
    return NULL;
}

bool files_is_ordinary(const char *path)
{
    struct stat status;
    return stat(path, &status) != 0 || S_ISREG(status.st_mode) || S_ISDIR(status.st_mode);
}

/* Without waiting for whoever writes into a pipe. */
static FILE *open_ordinary(const char *path)
{
    if (!files_is_ordinary(path)) {
        errno = ENOTSUP;
        return NULL;
    }
    int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    return fd < 0 ? NULL : fdopen(fd, "rb");
}

char *files_read(const char *path, size_t *n, char error[FILES_ERROR_SIZE])
{
    FILE *file = open_ordinary(path);
    if (!file) {
        failed(error, "open", path);
        return NULL;
    }
    size_t room = 4096;
    char *text = fail_alloc(room);
    *n = 0;
    for (;;) {
        *n += fread(text + *n, 1, room - 1 - *n, file);
        if (*n < room - 1) break;
        room *= 2;
        text = fail_realloc(text, room);
    }
    text[*n] = '\0';
    if (ferror(file)) { /* a folder opens, but does not read */
        failed(error, "read", path);
        free(text);
        text = NULL;
    }
    fclose(file);
    return text;
}

bool files_begins(const char *path, const char *text)
{
    size_t n = strlen(text);
    char *found = fail_alloc(n + 1);
    struct stat status;
    int fd = open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
    bool same = fd >= 0 && fstat(fd, &status) == 0 && S_ISREG(status.st_mode) &&
                read(fd, found, n) == (ssize_t)n && !memcmp(found, text, n);
    if (fd >= 0) close(fd);
    free(found);
    return same;
}

void files_hold_standard(void)
{
    int fd;
    do fd = open("/dev/null", O_RDWR);
    while (fd >= 0 && fd <= STDERR_FILENO);
    if (fd >= 0) close(fd);
}

bool files_reader_is_gone(void)
{
    struct pollfd out = {.fd = STDOUT_FILENO, .events = POLLOUT};
    return poll(&out, 1, 0) > 0 && (out.revents & (POLLERR | POLLHUP));
}

char *files_tmp(const char *path)
{
    return fail_format("%s.%ld.tmp", path, (long)getpid());
}

char *files_tmp_of(const char *name)
{
    size_t n = strlen(name);
    if (n < 4 || strcmp(name + n - 4, ".tmp") != 0) return NULL;
    size_t end = n -= 4;
    while (n > 0 && isdigit((unsigned char)name[n - 1])) n--;
    if (n == end || n < 2 || name[n - 1] != '.') return NULL;
    return fail_format("%.*s", (int)(n - 1), name);
}

int files_create(const char *path, char error[FILES_ERROR_SIZE])
{
    int fd = open(path, O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
    if (fd < 0) failed(error, "create", path);
    return fd;
}

int files_append(const char *path, char error[FILES_ERROR_SIZE])
{
    /* O_NONBLOCK: the open of a pipe would wait for its other end */
    int fd = open(path, O_RDWR | O_APPEND | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
    struct stat status;
    if (fd < 0) {
        if (errno == ELOOP)
            snprintf(error, FILES_ERROR_SIZE,
                "cannot write '%s': it is a symbolic link, and links out of the folder of results "
                "are not followed",
                path);
        else failed(error, "open", path);
        return -1;
    }
    if (fstat(fd, &status) == 0 && S_ISREG(status.st_mode)) return fd;
    snprintf(error, FILES_ERROR_SIZE, "cannot write '%s': it is no ordinary file", path);
    close(fd);
    return -1;
}

/* A rename is safe against a power cut only once the folder itself is on disk. */
static bool sync_folder_of(const char *path)
{
    char *folder = fail_strdup(path), *slash = strrchr(folder, '/');
    if (slash == folder) slash[1] = '\0';
    else if (slash) *slash = '\0';
    int fd = open(slash ? folder : ".", O_RDONLY | O_DIRECTORY);
    free(folder);
    if (fd < 0) return false;
    /* Some network file systems cannot sync a folder and say EINVAL. */
    bool ok = fsync(fd) == 0 || errno == EINVAL;
    close(fd);
    return ok;
}

bool files_commit(const char *tmp, const char *path, char error[FILES_ERROR_SIZE])
{
    if (rename(tmp, path)) {
        failed(error, "rename to", path);
        unlink(tmp);
        return false;
    }
    if (!sync_folder_of(path)) return failed(error, "sync the folder of", path);
    return true;
}

static bool write_all(int fd, const char *data, size_t n)
{
    while (n > 0) {
        ssize_t done = write(fd, data, n);
        if (done < 0 && errno == EINTR) continue;
        if (done < 0) return false;
        data += done;
        n -= (size_t)done;
    }
    return true;
}

bool files_replace(const char *path, const void *data, size_t n, char error[FILES_ERROR_SIZE])
{
    char *tmp = files_tmp(path);
    int fd = files_create(tmp, error);
    bool ok = fd >= 0;
    if (ok && (!write_all(fd, data, n) || fsync(fd))) ok = failed(error, "write", tmp);
    if (fd >= 0 && close(fd) && ok) ok = failed(error, "write", tmp);
    if (ok) ok = files_commit(tmp, path, error);
    else if (fd >= 0) unlink(tmp);
    free(tmp);
    return ok;
}
