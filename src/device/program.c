#include "program.h"

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/files.h"
#include "base/signals.h"
#include "comm/fail.h"
#include "kernel_cache.h"

/* Writes what the compiler saw beside the results, or into the temporary folder; returns the path,
 * or why there is none. Beside the results under a name that `run --force` knows. */
static char *dump(const struct program *program, const char *source)
{
    const char *folder = program->dev->dump_dir ? program->dev->dump_dir : getenv("TMPDIR");
    char *path =
        fail_format("%s/failed_build_%d.cl", folder && folder[0] ? folder : "/tmp", (int)getpid());
    char error[FILES_ERROR_SIZE];
    int fd = files_create(path, error);
    FILE *file = fd >= 0 ? fdopen(fd, "w") : NULL;
    bool good = file && fprintf(file, "/* %s */\n%s", program->options, source) > 0;
    if (file && fclose(file) != 0) good = false;
    if (good) return path;
    char *text = fail_format("nowhere: %s cannot be written", path);
    free(path);
    return text;
}

/* The code of a failed build differs between drivers for the same mistake: all of them end here. */
static _Noreturn void build_failed(const struct program *program, const char *source, cl_int code)
{
    size_t bytes = 0;
    clGetProgramBuildInfo(program->id, program->dev->id, CL_PROGRAM_BUILD_LOG, 0, NULL, &bytes);
    char *log = fail_alloc(bytes + 1);
    clGetProgramBuildInfo(program->id, program->dev->id, CL_PROGRAM_BUILD_LOG, bytes, log, NULL);
    fprintf(stderr, "%s\n", log); /* may be longer than a message */
    fail_stop(EXIT_DEVICE,
        "program %s does not build on %s (%s): %s; log above; options: %s; source: %s",
        program->name, program->dev->name, program->dev->platform_version, device_error_name(code),
        program->options, dump(program, source));
}

static cl_int try_build(struct program *program, const char *source, const char *options)
{
    cl_int code;
    program->id = clCreateProgramWithSource(program->dev->context, 1, &source, NULL, &code);
    check_cl_as(code, "clCreateProgramWithSource");
    return clBuildProgram(program->id, 1, &program->dev->id, options, NULL, NULL);
}

/* pocl's header of all functions is guarded by _OPENCL_H_; with the guard up, and our declarations
 * (kernels/common/builtins.h) in its place, it is not read. Kernels from a folder may call others,
 * and another version of pocl may need its header: then in the ordinary way. */
static cl_int build_without_header(struct program *program, const char *source)
{
    char *options = fail_format("%s -DDECLARE_BUILTINS -D_OPENCL_H_", program->options);
    cl_int code = try_build(program, source, options);
    if (code != CL_SUCCESS) check_cl(clReleaseProgram(program->id));
    free(options);
    return code;
}

static void build(struct program *program, const char *source)
{
    signals_hold();
    int lock = kernel_cache_lock(program->dev, program->cache_key);
    if (!program->dev->is_pocl || build_without_header(program, source) != CL_SUCCESS) {
        cl_int code = try_build(program, source, program->options);
        if (code != CL_SUCCESS) build_failed(program, source, code);
    }
    kernel_cache_unlock(lock);
    signals_pass();
}

/* The first rank of a node compiles, the others find what it has left in the driver's cache; where
 * it is there already nobody waits. */
static void build_in_turns(struct program *program, const struct comm *comm, const char *source)
{
    uint8_t is_new = !kernel_cache_has(program->dev, program->cache_key);
    if (comm) comm_node_or(comm, &is_new, sizeof is_new);
    bool first = !comm || comm->node_rank == 0 || !is_new;
    if (first) build(program, source);
    if (comm && is_new) comm_node_barrier(comm);
    if (!first) build(program, source);
}

struct program *program_build(struct device *dev, const struct comm *comm, const char *name,
    const char *options, const char *const *sources)
{
    struct program *program = fail_alloc(sizeof *program);
    char *source = program_source(sources);
    program->dev = dev;
    program->name = fail_strdup(name);
    program->options = fail_format("-cl-std=CL1.2 -w -cl-kernel-arg-info%s -DWITH_ONE_LANE=%d %s",
        dev->fp32_correct_divide ? " -cl-fp32-correctly-rounded-divide-sqrt" : "", dev->one_lane,
        options);
    program->real_is_float = strstr(options, "-DREAL_IS_FLOAT=1");
    program->position_is_float = strstr(options, "-DPOSITION_IS_FLOAT=1");

    program->cache_key = kernel_cache_key(program->options, source);
    build_in_turns(program, comm, source);
    free(source);
    return program;
}

void program_free(struct program *program)
{
    if (!program) return;
    check_cl(clReleaseProgram(program->id));
    free(program->name);
    free(program->options);
    free(program);
}

cl_kernel program_kernel(const struct program *program, const char *kernel)
{
    cl_int code;
    cl_kernel id = clCreateKernel(program->id, kernel, &code);
    if (code == CL_INVALID_KERNEL_NAME) {
        char names[2048] = "";
        clGetProgramInfo(program->id, CL_PROGRAM_KERNEL_NAMES, sizeof names, names, NULL);
        fail_stop(
            EXIT_DEVICE, "program %s has no kernel %s; it has: %s", program->name, kernel, names);
    }
    check_cl_as(code, "clCreateKernel");
    return id;
}
