/* One process at a time compiles a program with pocl.
 *
 * Up to version 5 pocl's kernel cache on disk is not safe against two processes that compile the
 * same kernel together (pocl #430, #1480), and it compiles both in clBuildProgram and at the first
 * launch. Each program and each kernel of it has a lock file in a folder `democles` of the cache,
 * which covers all ranks and jobs that share the cache, of any user and node, and no others. Who
 * has compiled marks the file; from then on nobody locks it, so that a run whose kernels are there
 * waits for no one. (Where somebody has cleared the cache and left the marks, the race is possible
 * again.) With any other driver these functions do nothing. */
#ifndef DEMOCLES_KERNEL_CACHE_H
#define DEMOCLES_KERNEL_CACHE_H

#include "device.h"

/* Stands for a program: the same text and options give the same key. */
uint64_t kernel_cache_key(const char *options, const char *source);

/* The same for a launch of a kernel: pocl compiles for a size of groups, and for few or many. */
uint64_t kernel_cache_launch_key(uint64_t program, const char *kernel, size_t local, size_t global);

/* Whether a process has compiled that key before: then nobody needs a lock. */
bool kernel_cache_has(const struct device *dev, uint64_t key);

/* Locks what has that key. Returns what unlock takes; -1 if there is nothing to lock: it has been
 * compiled already, or the file cannot be made or locked, or the lock is held for a minute, or a
 * signal asks the run to stop, which is no error. A wait of seconds for another job is told, with
 * the process that holds the lock. A process that forks shares its locks with its child. Not
 * collective. */
int kernel_cache_lock(const struct device *dev, uint64_t key);
/* After success, with what lock returned: all that come later know. */
void kernel_cache_unlock(int lock);

#endif
