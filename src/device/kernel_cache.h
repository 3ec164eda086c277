/* One process of a node at a time compiles a program with pocl.
 *
 * Up to version 5 pocl's kernel cache on disk is not safe against two processes that compile the
 * same kernel together (pocl #430, #1480), and it compiles both in clBuildProgram and at the first
 * launch. A lock file per user in the temporary folder, in which each program has a byte of its
 * own, covers all ranks and all jobs of the node; processes that compile different programs do not
 * wait for each other. With any other driver these functions do nothing. */
#ifndef DEMOCLES_KERNEL_CACHE_H
#define DEMOCLES_KERNEL_CACHE_H

#include "device.h"

/* Stands for a program: the same text and options give the same key. */
uint64_t kernel_cache_key(const char *options, const char *source);

/* Locks the program of that key. Returns what unlock takes; -1 if there is nothing to lock or the
 * lock file cannot be made or locked, or if the lock is held for a minute, which is no error. A
 * process that forks shares its locks with its child. Not collective. */
int kernel_cache_lock(const struct device *dev, uint64_t key);
void kernel_cache_unlock(int lock);

#endif
