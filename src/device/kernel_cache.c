#define _GNU_SOURCE /* F_OFD_SETLK */
#include "kernel_cache.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

#include "comm/fail.h"

enum { PATIENCE_S = 60, POLL_MS = 5 };

/* One byte of the file is locked for each program, far beyond its end: keys are cut to what an
 * offset may be. Such a lock belongs to the open file and ends with it. */
static bool try_lock(int file, uint64_t key)
{
    struct flock byte = {
        .l_type = F_WRLCK, .l_whence = SEEK_SET, .l_start = (off_t)(key >> 2), .l_len = 1};
    return fcntl(file, F_OFD_SETLK, &byte) == 0;
}

/* Waits for whoever compiles, but not for ever: a process that holds the lock may be stopped
 * (Ctrl-Z, a debugger, a paused job), and all others of this user would hang with it. Without the
 * lock the race is possible, once in about a hundred cold builds. */
static bool lock_within_patience(int file, uint64_t key)
{
    static bool lost_patience;
    const struct timespec pause = {0, POLL_MS * 1000000L};
    for (int waited = 0; !try_lock(file, key); waited += POLL_MS) {
        if (errno != EAGAIN && errno != EACCES)
            return false; /* this file system knows no such locks */
        if (lost_patience || waited >= PATIENCE_S * 1000) {
            lost_patience = true;
            return false;
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

int kernel_cache_lock(const struct device *dev, uint64_t key)
{
    if (!dev->is_pocl) return -1;
    const char *folder = getenv("TMPDIR");
    char *path = fail_format(
        "%s/democles-kernels-%d.lock", folder && folder[0] ? folder : "/tmp", (int)getuid());
    int lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    free(path);
    if (lock >= 0 && !lock_within_patience(lock, key)) {
        close(lock);
        lock = -1;
    }
    return lock;
}

void kernel_cache_unlock(int lock)
{
    if (lock >= 0) close(lock); /* releases it, as the end of the process would */
}
