/* One process of a node at a time through pocl's compiler.
 *
 * Up to version 5 pocl's kernel cache on disk is not safe against two processes that compile the
 * same kernel together (pocl #430, #1480), and it compiles both in clBuildProgram and at the first
 * launch. A lock file per user in the temporary folder covers all ranks and all jobs of the node.
 * Other drivers: nothing happens. */
#ifndef DEMOCLES_KERNEL_CACHE_H
#define DEMOCLES_KERNEL_CACHE_H

#include "device.h"

/* Returns what unlock takes; -1 if there is nothing to lock or the lock file cannot be made, or if
 * it is held for a minute, which is no error. Not collective. */
int kernel_cache_lock(const struct device *dev);
void kernel_cache_unlock(int lock);

#endif
