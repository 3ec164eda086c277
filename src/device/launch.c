#include "launch.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "base/signals.h"
#include "comm/fail.h"
#include "kernel_cache.h"
#include "trace.h"

/* Runs whose times are not yet known. */
enum { MAX_PENDING = 64 };
struct profile {
    int n;
    cl_event event[MAX_PENDING];
};

static char *arg_text(const struct launch *launch, int i, cl_kernel_arg_info what)
{
    char text[256] = "";
    cl_int code = clGetKernelArgInfo(launch->kernel, (cl_uint)i, what, sizeof text, text, NULL);
    if (code == CL_KERNEL_ARG_INFO_NOT_AVAILABLE)
        fail_stop(EXIT_DEVICE,
            "%s does not tell the names of kernel arguments (clGetKernelArgInfo), which democles "
            "needs: use another driver",
            launch->program->dev->platform_version);
    check_cl_as(code, "clGetKernelArgInfo");
    return fail_strdup(text);
}

static void find_args(struct launch *launch)
{
    cl_uint n = 0;
    check_cl(clGetKernelInfo(launch->kernel, CL_KERNEL_NUM_ARGS, sizeof n, &n, NULL));
    launch->n_arg = (int)n;
    launch->arg = fail_alloc(n * sizeof *launch->arg);
    for (int i = 0; i < launch->n_arg; i++) {
        cl_kernel_arg_address_qualifier space;
        check_cl(clGetKernelArgInfo(launch->kernel, (cl_uint)i, CL_KERNEL_ARG_ADDRESS_QUALIFIER,
            sizeof space, &space, NULL));
        launch->arg[i].name = arg_text(launch, i, CL_KERNEL_ARG_NAME);
        launch->arg[i].type = arg_text(launch, i, CL_KERNEL_ARG_TYPE_NAME);
        launch->arg[i].is_global =
            space == CL_KERNEL_ARG_ADDRESS_GLOBAL || space == CL_KERNEL_ARG_ADDRESS_CONSTANT;
    }
}

/* Work-group size that the kernel declares, else our own, for which registers may allow less than
 * the device does. A size that is declared is known to the driver, who has built the kernel for it;
 * what it says of the kernel (rusticl 22.3 on llvmpipe: 32) need not be true then. */
static size_t local_size(const struct launch *launch)
{
    size_t declared[3] = {0, 0, 0}, most = 0;
    cl_device_id id = launch->program->dev->id;
    check_cl(clGetKernelWorkGroupInfo(
        launch->kernel, id, CL_KERNEL_COMPILE_WORK_GROUP_SIZE, sizeof declared, declared, NULL));
    check_cl(clGetKernelWorkGroupInfo(
        launch->kernel, id, CL_KERNEL_WORK_GROUP_SIZE, sizeof most, &most, NULL));
    size_t local = declared[0] > 0 ? declared[0] : LAUNCH_LOCAL;
    if (declared[0] == 0 && local > most)
        fail_stop(EXIT_DEVICE, "kernel %s: work-groups of %zu, but %s allows %zu", launch->name,
            local, launch->program->dev->name, most);
    return local;
}

struct launch *launch_create(const struct program *program, const char *kernel)
{
    struct launch *launch = fail_alloc(sizeof *launch);
    launch->program = program;
    launch->name = fail_strdup(kernel);
    launch->kernel = program_kernel(program, kernel);
    launch->local = launch->batch = local_size(launch);
    find_args(launch);
    if (program->dev->profile) launch->profile = fail_alloc(sizeof(struct profile));
    return launch;
}

void launch_free(struct launch *launch)
{
    if (!launch) return;
    if (launch->profile) launch_seconds(launch); /* releases the events */
    check_cl(clReleaseKernel(launch->kernel));
    for (int i = 0; i < launch->n_arg; i++) {
        free(launch->arg[i].name);
        free(launch->arg[i].type);
    }
    free(launch->arg);
    free(launch->profile);
    free(launch->name);
    free(launch);
}

void launch_set_batch(struct launch *launch, size_t n_item)
{
    launch->batch = n_item;
}

static int find(const struct launch *launch, const char *arg)
{
    for (int i = 0; i < launch->n_arg; i++)
        if (strcmp(launch->arg[i].name, arg) == 0) return i;
    return -1;
}

bool launch_has(const struct launch *launch, const char *arg)
{
    return find(launch, arg) >= 0;
}

/* Our bug: stops with what is wrong with argument `arg`, and all that the kernel has. */
static _Noreturn void stop(const struct launch *launch, const char *arg, const char *why)
{
    char all[2048] = "";
    for (int i = 0; i < launch->n_arg; i++) {
        size_t n = strlen(all);
        snprintf(all + n, sizeof all - n, "%s%s %s", i ? ", " : "", launch->arg[i].type,
            launch->arg[i].name);
    }
    fail_stop(EXIT_DEVICE, "kernel %s: argument `%s` %s; it has: %s", launch->name, arg, why, all);
}

static void set_mem(struct launch *launch, int i, cl_mem mem, const struct buffer *buffer)
{
    struct launch_arg *a = &launch->arg[i];
    if (!a->is_global) stop(launch, a->name, "is a value, not a buffer");
    a->buffer = buffer;
    a->serial = buffer ? buffer->serial : 0;
    a->bound = true;
    if (mem) check_cl(clSetKernelArg(launch->kernel, (cl_uint)i, sizeof mem, &mem));
}

bool launch_bind_if(struct launch *launch, const char *arg, cl_mem mem)
{
    int i = find(launch, arg);
    if (i < 0) return false;
    if (!mem) stop(launch, arg, "is given no memory");
    set_mem(launch, i, mem, NULL);
    return true;
}

bool launch_bind_buffer_if(struct launch *launch, const char *arg, const struct buffer *buffer)
{
    int i = find(launch, arg);
    if (i < 0) return false;
    set_mem(launch, i, buffer->mem, buffer); /* may have no memory yet: launch_run looks again */
    return true;
}

void launch_bind(struct launch *launch, const char *arg, cl_mem mem)
{
    if (!launch_bind_if(launch, arg, mem)) stop(launch, arg, "does not exist");
}

void launch_bind_buffer(struct launch *launch, const char *arg, const struct buffer *buffer)
{
    if (!launch_bind_buffer_if(launch, arg, buffer)) stop(launch, arg, "does not exist");
}

void launch_bind_all(struct launch *launch, const struct launch_binding *all)
{
    for (; all->arg; all++) launch_bind_buffer(launch, all->arg, all->buffer);
}

void launch_bind_all_if(struct launch *launch, const struct launch_binding *all)
{
    for (; all->arg; all++) launch_bind_buffer_if(launch, all->arg, all->buffer);
}

/* Bytes of a scalar type of this program; 0: not known here. */
static size_t type_size(const struct launch *launch, const char *type)
{
    static const struct {
        const char *name;
        size_t size;
    } known[] = {{"char", 1}, {"uchar", 1}, {"short", 2}, {"ushort", 2}, {"int", 4}, {"uint", 4},
        {"float", 4}, {"long", 8}, {"ulong", 8}, {"double", 8}};
    if (strcmp(type, "real") == 0) return launch->program->real_is_float ? 4 : 8;
    if (strcmp(type, "preal") == 0) return launch->program->position_is_float ? 4 : 8;
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strcmp(type, known[k].name) == 0) return known[k].size;
    return 0;
}

bool launch_set_if(struct launch *launch, const char *arg, const void *value, size_t size)
{
    int i = find(launch, arg);
    if (i < 0) return false;
    if (launch->arg[i].is_global) stop(launch, arg, "is a buffer, not a value");
    size_t declared = type_size(launch, launch->arg[i].type);
    if (declared > 0 && declared != size) stop(launch, arg, "is set with a value of another size");
    check_cl(clSetKernelArg(launch->kernel, (cl_uint)i, size, value));
    launch->arg[i].bound = true;
    return true;
}

bool launch_set_int_if(struct launch *launch, const char *arg, int32_t value)
{
    return launch_set_if(launch, arg, &value, sizeof value);
}

bool launch_set_real_if(struct launch *launch, const char *arg, double value)
{
    int i = find(launch, arg);
    if (i < 0) return false;
    const char *type = launch->arg[i].type;
    if (strcmp(type, "float") && strcmp(type, "double") && strcmp(type, "real") &&
        strcmp(type, "preal"))
        stop(launch, arg, "is no real number");
    float single = (float)value;
    return type_size(launch, type) == sizeof single
               ? launch_set_if(launch, arg, &single, sizeof single)
               : launch_set_if(launch, arg, &value, sizeof value);
}

bool launch_set_count_if(struct launch *launch, const char *arg, int64_t value)
{
    if (value < 0 || value > INT32_MAX)
        fail_stop(EXIT_DEVICE,
            "kernel %s: %s is %lld, but a rank counts from 0 to 2147483647: use more ranks",
            launch->name, arg, (long long)value);
    return launch_set_int_if(launch, arg, (int32_t)value);
}

/* Names of the components of a vector argument. */
struct component {
    char arg[64];
};
static struct component component(const char *arg, int axis)
{
    struct component c;
    snprintf(c.arg, sizeof c.arg, "%s_%c", arg, "xyz"[axis]);
    return c;
}

void launch_set_vector_if(struct launch *launch, const char *arg, const double value[3])
{
    for (int a = 0; a < 3; a++) launch_set_real_if(launch, component(arg, a).arg, value[a]);
}

void launch_set(struct launch *launch, const char *arg, const void *value, size_t size)
{
    if (!launch_set_if(launch, arg, value, size)) stop(launch, arg, "does not exist");
}

void launch_set_int(struct launch *launch, const char *arg, int32_t value)
{
    launch_set(launch, arg, &value, sizeof value);
}

void launch_set_long(struct launch *launch, const char *arg, int64_t value)
{
    launch_set(launch, arg, &value, sizeof value);
}

void launch_set_count(struct launch *launch, const char *arg, int64_t value)
{
    if (!launch_set_count_if(launch, arg, value)) stop(launch, arg, "does not exist");
}

void launch_set_real(struct launch *launch, const char *arg, double value)
{
    if (!launch_set_real_if(launch, arg, value)) stop(launch, arg, "does not exist");
}

void launch_set_vector(struct launch *launch, const char *arg, const double value[3])
{
    for (int a = 0; a < 3; a++) launch_set_real(launch, component(arg, a).arg, value[a]);
}

void launch_check(const struct launch *launch)
{
    char missing[1024] = "";
    for (int i = 0; i < launch->n_arg; i++) {
        const struct launch_arg *a = &launch->arg[i];
        size_t n = strlen(missing);
        if (!a->bound) snprintf(missing + n, sizeof missing - n, " %s", a->name);
        else if (a->buffer && !a->buffer->mem)
            snprintf(missing + n, sizeof missing - n, " %s (buffer %s has no memory)", a->name,
                a->buffer->name);
    }
    if (missing[0])
        fail_stop(EXIT_DEVICE, "kernel %s: arguments not bound:%s", launch->name, missing);
}

size_t launch_padded(int64_t n_item, size_t local)
{
    assert(n_item > 0);
    size_t n_group = ((size_t)n_item + local - 1) / local, step = 1;
    while (n_group / step > 128) step *= 2; /* 64 to 128 steps below n_group */
    return (n_group + step - 1) / step * step * local;
}

/* Buffers that have grown or changed places since the last run. */
static void refresh(struct launch *launch)
{
    for (int i = 0; i < launch->n_arg; i++) {
        const struct launch_arg *a = &launch->arg[i];
        if (!a->bound || (a->buffer && !a->buffer->mem)) launch_check(launch);
        if (a->buffer && a->buffer->serial != a->serial)
            set_mem(launch, i, a->buffer->mem, a->buffer);
    }
}

/* Takes the times of the runs that are pending, after they are done. */
static void harvest(struct launch *launch)
{
    struct profile *p = launch->profile;
    if (p->n > 0) check_cl(clWaitForEvents((cl_uint)p->n, p->event));
    for (int i = 0; i < p->n; i++) {
        cl_ulong start, end; /* [ns] */
        check_cl(clGetEventProfilingInfo(
            p->event[i], CL_PROFILING_COMMAND_START, sizeof start, &start, NULL));
        check_cl(
            clGetEventProfilingInfo(p->event[i], CL_PROFILING_COMMAND_END, sizeof end, &end, NULL));
        launch->seconds += 1e-9 * (double)(end - start);
        check_cl(clReleaseEvent(p->event[i]));
    }
    p->n = 0;
}

double launch_seconds(struct launch *launch)
{
    if (launch->profile) harvest(launch);
    return launch->seconds;
}

static void enqueue(const struct launch *launch, cl_command_queue queue, size_t global,
    const cl_event *after, cl_event *event)
{
    cl_int code = clEnqueueNDRangeKernel(
        queue, launch->kernel, 1, NULL, &global, &launch->local, after ? 1 : 0, after, event);
    if (code != CL_SUCCESS)
        fail_stop(EXIT_DEVICE, "kernel %s: clEnqueueNDRangeKernel: %s (%d)", launch->name,
            device_error_name(code), (int)code);
}

void launch_run_on(struct launch *launch, cl_command_queue queue, int64_t n_item,
    const cl_event *after, cl_event *event)
{
    if (n_item <= 0) {
        if (after || event)
            check_cl(clEnqueueMarkerWithWaitList(queue, after ? 1 : 0, after, event));
        return;
    }
    struct device *dev = launch->program->dev;
    struct profile *p = launch->profile;
    size_t n_group = ((size_t)n_item + launch->batch - 1) / launch->batch,
           global = launch_padded((int64_t)(n_group * launch->local), launch->local);
    cl_event own, *done = trace_event(dev->trace, event ? event : p ? &own : NULL);

    refresh(launch);
    if (dev->is_pocl && global > launch->largest) {
        uint64_t key = kernel_cache_launch_key(
            launch->program->cache_key, launch->name, launch->local, global);
        signals_hold();
        int lock = kernel_cache_lock(dev, key);
        enqueue(launch, queue, global, after, done);
        check_cl(clFinish(queue));
        kernel_cache_unlock(lock);
        signals_pass();
    } else {
        enqueue(launch, queue, global, after, done);
    }
    if (global > launch->largest) launch->largest = global;
    launch->n_run++;
    dev->counters.n_launch++;
    trace_command(dev->trace, queue, launch->name, (size_t)n_item, done);
    if (p) {
        if (p->n == MAX_PENDING) harvest(launch);
        if (event) check_cl(clRetainEvent(*done));
        p->event[p->n++] = *done;
    }
}

void launch_run(struct launch *launch, int64_t n_item)
{
    launch_run_on(launch, launch->program->dev->compute, n_item, NULL, NULL);
}
