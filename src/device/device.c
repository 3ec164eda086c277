#define _GNU_SOURCE /* CPU sets, strcasestr */
#include "device.h"

#include <sched.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "cache_folder.h"
#include "device_find.h"
#include "comm/fail.h"

/* pocl makes one worker per hardware thread of the node in every rank and ignores what mpirun
 * bound: give each rank its share of the cores that the node's ranks may use together, at most
 * those it may use itself, at least one. Before the first OpenCL call, because the workers start
 * there. The name depends on pocl's version: up to 3, 4 to 6, from 7. A setting of the user's own
 * wins.
 *
 * With one core pocl's driver without workers is the better one: to hand a command to a worker and
 * to wake the host again takes some 200 us per step where both share the core. Newer versions call
 * it cpu-minimal, and know its old name. `choice` may ask for the other one.
 *
 * Returns whether each rank of the node has a core of its own. */
static bool set_up_pocl(const struct comm *comm, const char *choice)
{
    cpu_set_t own, all;
    char text[16];
    CPU_ZERO(&own);
    /* more than 1024 CPUs: unknown */
    if (sched_getaffinity(0, sizeof own, &own) != 0) CPU_ZERO(&own);
    all = own;
    comm_node_or(comm, &all, sizeof all);
    int n = CPU_COUNT(&all) / comm->n_node_rank;
    bool own_core = n >= 1;
    if (n > CPU_COUNT(&own)) n = CPU_COUNT(&own);
    if (n < 1) n = 1;
    snprintf(text, sizeof text, "%d", n);
    setenv("POCL_MAX_PTHREAD_COUNT", text, 0);
    setenv("POCL_CPU_MAX_CU_COUNT", text, 0);
    setenv("POCL_MAX_COMPUTE_UNITS", text, 0);
    if (n == 1 && !(choice && strcasestr(choice, "pthread"))) setenv("POCL_DEVICES", "basic", 0);
    return own_core;
}

/* What was looked for, what there is, and how to go on. */
static char *no_device(
    const struct device_entry *entry, int n_entry, cl_int code, const char *choice)
{
    char *text = NULL;
    size_t bytes = 0;
    FILE *file = open_memstream(&text, &bytes);
    const char *vendors = getenv("OCL_ICD_VENDORS"), *pocl_devices = getenv("POCL_DEVICES");
    if (!file) fail_stop(EXIT_IO, "out of memory");
    if (choice)
        fprintf(file,
            "--device %s: no usable OpenCL device matches (PLATFORM:DEVICE, each an index or part "
            "of a name). ",
            choice);
    if (n_entry > 0) {
        fprintf(file, "%s", choice ? "There are:\n" : "no usable OpenCL device, of these:\n");
        for (int i = 0; i < n_entry; i++) device_print_short(&entry[i], file);
        fprintf(file, "choose one of them with --device; `democles devices` tells more");
    } else {
        fprintf(file, "no OpenCL device was found: drivers are looked for in %s (%s). ",
            vendors ? vendors : "/etc/OpenCL/vendors",
            code == CL_SUCCESS ? "no driver there has a device" : device_error_name(code));
        fprintf(file,
            "Install the driver of your GPU, or for the CPU: apt-get install pocl-opencl-icd%s",
            vendors ? "; or unset OCL_ICD_VENDORS" : "");
        if (pocl_devices && strcmp(pocl_devices, "basic") != 0) /* set_up_pocl's own */
            fprintf(file, ". POCL_DEVICES is '%s': unset it unless pocl has such a device",
                pocl_devices);
    }
    char *trouble = cache_folder_trouble();
    if (trouble) fprintf(file, ". If pocl is installed: %s", trouble);
    free(trouble);
    fclose(file);
    return text;
}

static char *no_fp64(const struct device *dev, const struct device_entry *entry, int n_entry)
{
    char *text = NULL;
    size_t bytes = 0;
    FILE *file = open_memstream(&text, &bytes);
    if (!file) fail_stop(EXIT_IO, "out of memory");
    fprintf(file,
        "precision double or mixed needs fp64, which this device does not have: %s: %s. Run with "
        "--precision single",
        dev->platform_name, dev->name);
    int n = 0;
    for (int i = 0; i < n_entry; i++)
        if (entry[i].info.fp64 && !entry[i].unusable) {
            fprintf(file, "%s", n++ == 0 ? ", or on a device with fp64 by --device:\n" : "");
            device_print_short(&entry[i], file);
        }
    fclose(file);
    if (n > 0) text[strlen(text) - 1] = 0; /* the last line end */
    return text;
}

/* Collective. If any rank has an error, that of the lowest is printed once and all ranks leave. */
static void stop_together(const struct comm *comm, char *error)
{
    if (!comm) {
        if (error) fail_stop(EXIT_DEVICE, "%s", error);
        return;
    }
    char text[4000] = "";
    int64_t first = error ? comm->rank : comm->n_rank;
    comm_min_i64(comm, &first, 1);
    if (first == comm->n_rank) return;
    if (error) {
        char host[256] = "";
        gethostname(host, sizeof host - 1);
        snprintf(text, sizeof text, "rank %d on %s: %s", comm->rank, host, error);
        free(error);
    }
    comm_bcast(comm, text, sizeof text, (int)first);
    fail_stop_together(EXIT_DEVICE, "%s", text);
}

/* Context and queues of a device that is chosen. */
static void open_queues(struct device *dev)
{
    cl_context_properties properties[] = {
        CL_CONTEXT_PLATFORM, (cl_context_properties)dev->platform, 0};
    cl_command_queue_properties queue = dev->profile ? CL_QUEUE_PROFILING_ENABLE : 0;
    cl_int code;
    dev->context = clCreateContext(properties, 1, &dev->id, NULL, NULL, &code);
    check_cl_as(code, "clCreateContext");
    dev->compute = clCreateCommandQueue(dev->context, dev->id, queue, &code);
    check_cl_as(code, "clCreateCommandQueue");
    dev->copy = clCreateCommandQueue(dev->context, dev->id, queue, &code);
    check_cl_as(code, "clCreateCommandQueue");
}

struct device *device_open(
    const struct comm *comm, const char *choice, bool need_fp64, bool profile)
{
    struct device_entry *entry;
    cl_int code;
    int node_rank = comm ? comm->node_rank : 0, n_node_rank = comm ? comm->n_node_rank : 1;

    bool own_core = comm && set_up_pocl(comm, choice);
    int n_entry = device_find(&entry, &code);
    int *order = fail_alloc((size_t)n_entry * sizeof *order);
    int n = device_deal(entry, n_entry, choice, need_fp64, order);
    struct device *dev = fail_alloc(sizeof *dev);
    char *error = NULL;
    if (n == 0) error = no_device(entry, n_entry, code, choice);
    else {
        *dev = entry[order[node_rank % n]].info;
        if (need_fp64 && !dev->fp64) error = no_fp64(dev, entry, n_entry);
    }
    stop_together(comm, error);
    free(order);
    free(entry);

    if (comm) { /* a program is built on all ranks or on none */
        int32_t lacks = !dev->fp64;
        comm_or_i32(comm, &lacks, 1);
        dev->fp64 = !lacks;
    }
    if (dev->is_pocl && cache_folder_instead_of() && comm)
        fail_warn("pocl keeps its kernels in '%s', since '%s' cannot be written; POCL_CACHE_DIR "
                  "names another folder",
            cache_folder_path(), cache_folder_instead_of());
    dev->profile = profile;
    dev->own_core = own_core;
    dev->n_share = dev->type & CL_DEVICE_TYPE_CPU ? n_node_rank : (n_node_rank + n - 1) / n;
    open_queues(dev);
    return dev;
}

void device_free(struct device *dev)
{
    if (!dev) return;
    device_finish(dev);
    check_cl(clReleaseCommandQueue(dev->copy));
    check_cl(clReleaseCommandQueue(dev->compute));
    check_cl(clReleaseContext(dev->context));
    free(dev);
}

void device_flush(struct device *dev)
{
    check_cl(clFlush(dev->compute));
}

void device_finish(struct device *dev)
{
    /* Each queue may wait for events of the other, so both have to be on their way first. */
    check_cl(clFlush(dev->compute));
    check_cl(clFlush(dev->copy));
    check_cl(clFinish(dev->compute));
    check_cl(clFinish(dev->copy));
}

bool device_event_done(cl_event event)
{
    cl_int status;
    check_cl(
        clGetEventInfo(event, CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof status, &status, NULL));
    if (status < 0) check_cl_as(status, "a command on the device");
    return status == CL_COMPLETE;
}

static void print_device(const struct device_entry *e, FILE *file)
{
    const struct device *d = &e->info;
    fprintf(file, "%d:%d  %s\n", e->platform_index, e->device_index, d->name);
    fprintf(file, "     kind            %s%s%s, %s\n", device_kind(d),
        e->unusable ? ", UNUSABLE: " : "", e->unusable ? e->unusable : "", d->vendor);
    fprintf(file, "     driver          %s; %s; kernels: %s\n", d->driver, d->version, d->opencl_c);
    if (e->bus[0]) fprintf(file, "     PCI address     %s\n", e->bus);
    fprintf(
        file, "     double          %s\n", d->fp64 ? "yes (fp64)" : "no: --precision single only");
    fprintf(file, "     float rounding  divide and sqrt %s\n",
        d->fp32_correct_divide ? "can be correct" : "to 2.5 and 3 ulp");
    fprintf(file, "     memory          %.2f GiB, largest array %.2f GiB, local %.0f KiB%s\n",
        (double)d->global_mem / (1 << 30), (double)d->max_alloc / (1 << 30),
        (double)d->local_mem / 1024, d->unified ? ", shared with the host" : "");
    fprintf(
        file, "     compute units   %u, work-groups up to %zu\n", d->compute_units, d->max_group);
}

int device_list(int n_rank, FILE *file)
{
    struct device_entry *entry;
    cl_int code;
    int n_entry = device_find(&entry, &code), platform = -1;
    int *order = fail_alloc((size_t)n_entry * sizeof *order);
    int n = device_deal(entry, n_entry, NULL, true, order);
    if (n == 0) {
        char *text = no_device(entry, n_entry, code, NULL);
        fprintf(file, "%s\n", text);
        free(text);
    }
    for (int i = 0; i < n_entry && n > 0; i++) {
        const struct device_entry *e = &entry[i];
        if (e->platform_index != platform)
            fprintf(file, "platform %d: %s (%s)\n", e->platform_index, e->info.platform_name,
                e->info.platform_version);
        platform = e->platform_index;
        print_device(e, file);
    }
    for (int r = 0; r < n_rank && n > 0; r++) {
        const struct device_entry *e = &entry[order[r % n]];
        fprintf(file, "rank %d of a node takes %d:%d  %s\n", r, e->platform_index, e->device_index,
            e->info.name);
    }
    free(order);
    free(entry);
    return n;
}
