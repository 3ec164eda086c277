/* Runs into one kind of trouble, named by the second argument, each of which has to end with its
 * message and exit code 4. Run by test_refusals. Arguments: alone (without MPI) or ranks, the
 * trouble, a choice of device. */
#define _GNU_SOURCE /* RTLD_NEXT */
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

#include "comm/fail.h"
#include "device/launch.h"

static bool hide_fp64;

/* Stands before the OpenCL library's own: devices without double precision, which this machine may
 * not have. */
cl_int clGetDeviceInfo(
    cl_device_id id, cl_device_info what, size_t size, void *value, size_t *size_out)
{
    static cl_int (*real_one)(cl_device_id, cl_device_info, size_t, void *, size_t *);
    if (!real_one) *(void **)&real_one = dlsym(RTLD_NEXT, "clGetDeviceInfo");
    cl_int code = real_one(id, what, size, value, size_out);
    if (hide_fp64 && what == CL_DEVICE_DOUBLE_FP_CONFIG && value && code == CL_SUCCESS)
        memset(value, 0, size);
    return code;
}

static void use(const struct comm *comm, struct device *dev, const char *what)
{
    static const char *const sources[] = {"scale.cl", NULL},
                             *const broken[] = {"scale.cl", "broken.cl", NULL},
                             *const missing[] = {"nowhere.cl", NULL};
    const char *options = "-DWITH_SHIFT=1 -DREAL_IS_FLOAT=1";
    if (!strcmp(what, "build")) program_build(dev, comm, "refused", options, broken);
    if (!strcmp(what, "options")) program_build(dev, comm, "refused", "-no-such-option", sources);
    if (!strcmp(what, "source")) program_build(dev, comm, "refused", options, missing);
    struct buffer buffer;
    buffer_init(&buffer, dev, "everything");
    if (!strcmp(what, "memory")) buffer_reserve(&buffer, (size_t)dev->global_mem + 1);
    struct program *program = program_build(dev, comm, "test", options, sources);
    if (!strcmp(what, "kernel")) program_kernel(program, "no_such_kernel");
    struct launch *launch = launch_create(program, "scale");
    if (!strcmp(what, "argument")) launch_set_int(launch, "fctor", 1);
    if (!strcmp(what, "size")) launch_set_int(launch, "bias", 1);
    if (!strcmp(what, "value")) launch_bind_buffer(launch, "n", &buffer);
    if (!strcmp(what, "count")) launch_set_count(launch, "n", (int64_t)INT32_MAX + 1);
    if (!strcmp(what, "negative")) launch_set_count(launch, "n", -1);
    launch_set_count(launch, "n", INT32_MAX);
    launch_bind_buffer(launch, "y", &buffer);
    if (!strcmp(what, "unbound")) launch_check(launch);
    if (!strcmp(what, "run")) launch_run(launch, 1);
}

int main(int argc, char **argv)
{
    if (argc < 3) return EXIT_USAGE;
    struct comm *comm = strcmp(argv[1], "alone") ? comm_create(&argc, &argv) : NULL;
    const char *what = argv[2], *choice = argc > 3 ? argv[3] : NULL;
    hide_fp64 = !strcmp(what, "fp64");
    struct device *dev = device_open(comm, choice, hide_fp64, false);
    if (!strcmp(what, "event")) device_event_done(NULL);
    use(comm, dev, what);
    device_free(dev);
    comm_free(comm);
    return EXIT_DONE;
}
