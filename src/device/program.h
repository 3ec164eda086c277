/* A built OpenCL program: some of the embedded kernel files, joined, with the options of the scene.
 *
 * Kernel sources lie in the executable (kernel_source.h); the environment variable
 * DEMOCLES_KERNELS=dir reads them from a directory instead. `#include "x.h"` is resolved here, each
 * header once, so no driver needs a search path. Knows no argument and no launch (launch.h). */
#ifndef DEMOCLES_PROGRAM_H
#define DEMOCLES_PROGRAM_H

#include "device.h"

struct program {
    struct device *dev; /* borrowed */
    cl_program id;
    char *name;         /* for messages */
    char *options;      /* as given to the compiler, complete */
    uint64_t cache_key; /* of options and source, for kernel_cache_lock */
    /* from -DREAL_IS_FLOAT=1 in the options: what kernels/common/types.h makes of `real` */
    bool real_is_float;
    bool position_is_float; /* likewise `preal`, from -DPOSITION_IS_FLOAT=1 */
};

/* Collective over the ranks of the node: node-local rank 0 builds first and fills the driver's
 * cache, the others follow. `sources`: names of kernel files such as "pair_force.cl", ended by
 * NULL. To `options` are added -cl-std=CL1.2 -cl-kernel-arg-info, -w (the lint warns) and, where
 * the device offers it,
 * -cl-fp32-correctly-rounded-divide-sqrt. A build that fails prints options, log and where the
 * joined source was written, exit code 4. */
struct program *program_build(struct device *dev, const struct comm *comm, const char *name,
    const char *options, const char *const *sources);
void program_free(struct program *program);

/* A new kernel object, released by the caller. Unknown name: message with those that exist, exit
 * code 4. */
cl_kernel program_kernel(const struct program *program, const char *kernel);

/* The joined source, as program_build gives it to the compiler, with #line marks; freed by the
 * caller. For lint and tests; needs no device. */
char *program_source(const char *const *sources);

#endif
