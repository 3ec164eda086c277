#include "kernel_cache.h"

#include <fcntl.h>
#include <stdlib.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

#include "comm/fail.h"

enum { PATIENCE_S = 60, POLL_MS = 5 };

/* Waits for whoever compiles, but not for ever: a process that holds the lock may be stopped
 * (Ctrl-Z, a debugger, a paused job), and all others of this user would hang with it. Without the
 * lock the race is possible, once in about a hundred cold builds. */
static bool lock_within_patience(int lock)
{
    static bool lost_patience;
    const struct timespec pause = {0, POLL_MS * 1000000L};
    for (int waited = 0; flock(lock, LOCK_EX | LOCK_NB) != 0; waited += POLL_MS) {
        if (lost_patience || waited >= PATIENCE_S * 1000) {
            lost_patience = true;
            return false;
        }
        nanosleep(&pause, NULL);
    }
    return true;
}

int kernel_cache_lock(const struct device *dev)
{
    if (!dev->is_pocl) return -1;
    const char *folder = getenv("TMPDIR");
    char *path = fail_format(
        "%s/democles-kernels-%d.lock", folder && folder[0] ? folder : "/tmp", (int)getuid());
    int lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    free(path);
    if (lock >= 0 && !lock_within_patience(lock)) {
        close(lock);
        lock = -1;
    }
    return lock;
}

void kernel_cache_unlock(int lock)
{
    if (lock >= 0) close(lock); /* releases it, as the end of the process would */
}
