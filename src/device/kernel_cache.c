#define _GNU_SOURCE /* F_OFD_SETLK */
#include "kernel_cache.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "base/signals.h"
#include "cache_folder.h"
#include "comm/fail.h"

enum { PATIENCE_S = 60, TOLD_AFTER_S = 2, POLL_MS = 5, MARK_SIZE = 400 };

static const char compiled[] = "compiled\n";

/* What the file says: that all is done, or who holds the lock. */
static void read_mark(int file, char mark[MARK_SIZE])
{
    ssize_t n = pread(file, mark, MARK_SIZE - 1, 0);
    mark[n > 0 ? n : 0] = '\0';
}

/* A lock needs no mark: whoever cannot write it has the lock all the same. */
static void write_mark(int file, const char *mark)
{
    if (ftruncate(file, 0) != 0 || pwrite(file, mark, strlen(mark), 0) < 0) return;
}

static void write_holder(int file)
{
    char host[256] = "", mark[MARK_SIZE];
    gethostname(host, sizeof host - 1);
    snprintf(
        mark, sizeof mark, "process %d on %s, parent %d\n", (int)getpid(), host, (int)getppid());
    write_mark(file, mark);
}

/* Such a lock belongs to the open file and ends with it. */
static bool try_lock(int file)
{
    struct flock all = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    return fcntl(file, F_OFD_SETLK, &all) == 0;
}

/* Another rank of the same job on this node, of which nobody wants to hear. */
static bool is_own_job(const struct device *dev, const char *mark)
{
    const char *parent = strstr(mark, "parent ");
    return dev->n_share > 1 && parent && atoi(parent + strlen("parent ")) == (int)getppid();
}

static void tell(const struct device *dev, int file, const char *path)
{
    char mark[MARK_SIZE];
    struct flock all = {.l_type = F_WRLCK, .l_whence = SEEK_SET};
    read_mark(file, mark);
    if (is_own_job(dev, mark)) return;
    mark[strcspn(mark, ",\n")] = '\0';
    /* a lock of the older kind is the process's that the system names */
    if (fcntl(file, F_OFD_GETLK, &all) == 0 && all.l_type != F_UNLCK && all.l_pid > 0)
        snprintf(mark, sizeof mark, "process %d", (int)all.l_pid);
    fprintf(stderr,
        "democles: warning: waits for %s, which compiles the same kernels and holds '%s'; if that "
        "process hangs, end it, or set POCL_CACHE_DIR to another folder; after %d s this run goes "
        "on without waiting\n",
        mark[0] ? mark : "another process", path, PATIENCE_S);
}

/* Waits for whoever compiles, but not for ever: a process that holds the lock may be stopped
 * (Ctrl-Z, a debugger, a paused job), and all others would hang with it. Without the lock the race
 * is possible, once in about a hundred cold builds. */
static bool lock_within_patience(const struct device *dev, int file, const char *path)
{
    static bool lost_patience, told;
    const struct timespec pause = {0, POLL_MS * 1000000L};
    for (int waited = 0; !try_lock(file); waited += POLL_MS) {
        if (errno != EAGAIN && errno != EACCES)
            return false; /* this file system knows no such locks */
        lost_patience |= waited >= PATIENCE_S * 1000;
        if (lost_patience || signals_wait()) return false;
        if (waited >= TOLD_AFTER_S * 1000 && !told) {
            tell(dev, file, path);
            told = true;
        }
        nanosleep(&pause, NULL);
    }
    return true;
}

/* FNV-1a. */
static uint64_t add_text(uint64_t hash, const char *text)
{
    for (const unsigned char *c = (const unsigned char *)text; *c; c++)
        hash = (hash ^ *c) * UINT64_C(0x100000001b3);
    return hash;
}

uint64_t kernel_cache_key(const char *options, const char *source)
{
    return add_text(add_text(UINT64_C(0xcbf29ce484222325), options), source);
}

uint64_t kernel_cache_launch_key(uint64_t program, const char *kernel, size_t local, size_t global)
{
    char sizes[64];
    int power = 0;
    while (global >> power > 1) power++; /* few keys, whatever the sizes of scenes */
    snprintf(sizes, sizeof sizes, " %zu %d", local, power);
    return add_text(add_text(program, kernel), sizes);
}

/* The lock file of a key, on this device with this driver. */
static char *path_of(const struct device *dev, uint64_t key)
{
    cache_folder_prepare();
    char *folder = fail_format("%s/democles", cache_folder_path());
    mkdir(folder, 0777); /* where that fails the file cannot be made either */
    char *path = fail_format("%s/%016" PRIx64, folder,
        add_text(add_text(add_text(key, dev->name), dev->platform_version), dev->driver));
    free(folder);
    return path;
}

/* Whether processes share what they compile, and need a lock for it. */
static bool is_shared(const struct device *dev)
{
    const char *cache = getenv("POCL_KERNEL_CACHE");
    return dev->is_pocl && !(cache && !strcmp(cache, "0"));
}

bool kernel_cache_has(const struct device *dev, uint64_t key)
{
    if (!is_shared(dev)) return false;
    char mark[MARK_SIZE] = "", *path = path_of(dev, key);
    int file = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOFOLLOW);
    if (file >= 0) {
        read_mark(file, mark);
        close(file);
    }
    free(path);
    return strcmp(mark, compiled) == 0;
}

int kernel_cache_lock(const struct device *dev, uint64_t key)
{
    if (!is_shared(dev)) return -1;
    char mark[MARK_SIZE], *path = path_of(dev, key);
    int lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    bool wanted = lock >= 0;
    for (int look = 0; look < 2 && wanted; look++) { /* before the lock, and once it is there */
        read_mark(lock, mark);
        wanted = strcmp(mark, compiled) != 0;
        if (wanted && look == 0) wanted = lock_within_patience(dev, lock, path);
    }
    free(path);
    if (wanted) write_holder(lock);
    else if (lock >= 0) close(lock);
    return wanted ? lock : -1;
}

void kernel_cache_unlock(int lock)
{
    if (lock < 0) return;
    write_mark(lock, compiled);
    close(lock); /* releases it, as the end of the process would */
}
