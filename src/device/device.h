/* One OpenCL device per rank: which one, what it can do, one context and two in-order queues.
 *
 * Devices are chosen by node-local rank among all that this rank sees, GPUs and accelerators before
 * CPUs; nothing is ever taken silently in place of something better that was asked for. Knows ranks
 * and OpenCL, but no physics, no kernels and no buffers (program.h, launch.h, buffer.h). */
#ifndef DEMOCLES_DEVICE_H
#define DEMOCLES_DEVICE_H

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "comm/comm.h"
#include "memory_table.h"

enum { DEVICE_TEXT = 256 };

/* What has crossed between host and device and what was allocated since the device was opened, so
 * that a test can assert that a step allocates nothing and copies no state. Everything in buffer.h
 * and launch.h counts here. */
struct device_counters {
    int64_t n_alloc;               /* buffers created, ever */
    int64_t now_bytes, peak_bytes; /* device memory in buffers: now, and at most */
    int64_t n_h2d, h2d_bytes;      /* copies host to device */
    int64_t n_d2h, d2h_bytes;      /* copies device to host */
    int64_t n_launch;              /* kernels enqueued */
};

struct trace;

struct device {
    cl_platform_id platform;
    cl_device_id id;
    cl_context context;
    cl_command_queue compute, copy; /* in order; with profiling if asked */
    cl_device_type type;
    char name[DEVICE_TEXT], vendor[DEVICE_TEXT], driver[DEVICE_TEXT], version[DEVICE_TEXT],
        opencl_c[DEVICE_TEXT];
    char platform_name[DEVICE_TEXT], platform_version[DEVICE_TEXT];
    /* double precision; of a device that is open: of those of all ranks */
    bool fp64;
    /* float / and sqrt can be correctly rounded (program.c then asks for it) */
    bool fp32_correct_divide;
    bool unified; /* host and device share memory */
    /* pocl on a CPU: one work-item goes over a batch of contacts, see kernels/common/batch.h */
    bool one_lane;
    /* builds and first launches are then serialised per node, see kernel_cache.h */
    bool is_pocl;
    /* a command runs in the call that enqueues it, on the host's thread: pocl without workers */
    bool at_once;
    bool own_core; /* each rank of this node has a core of its own */
    bool profile;
    /* [byte] of the whole device: on a CPU the node's, shared by all its ranks */
    cl_ulong global_mem;
    cl_ulong max_alloc; /* [byte] largest single buffer */
    cl_ulong local_mem; /* [byte] per work-group */
    size_t max_group;   /* work-items per work-group */
    cl_uint compute_units;
    /* ranks of this node that share this rank's memory: n_node_rank for CPUs, an estimate for
     * GPUs */
    int n_share;
    /* where the source of a kernel that does not build is written; NULL: $TMPDIR or /tmp.
     * Borrowed */
    const char *dump_dir;
    struct device_counters counters;
    struct memory_table memory;
    /* where commands are noted; NULL but in steps that are traced (trace.h). Borrowed */
    struct trace *trace;
};

/* Collective. `choice`: NULL, or "PLATFORM:DEVICE" where each part is an index, a part of the
 * name (or of the platform's version: "pocl") in any case, or empty for any; "PLATFORM" alone
 * means any device of it. Of the devices that match, the best kind (GPU or accelerator, then CPU)
 * is dealt out by node-local rank, those with fp64 alone if `need_fp64` and there are any. Limits
 * pocl to this rank's share of the node's cores, and to its driver without threads where that is
 * one; has to be the first use of OpenCL in the process. No device, no match, no fp64 although
 * needed: message of what was looked for, what is there and how to go on, exit code 4, once for
 * all ranks. */
struct device *device_open(
    const struct comm *comm, const char *choice, bool need_fp64, bool profile);

/* Finishes both queues and releases them before the context. Buffers, programs and launches have to
 * be freed before. NULL is fine. */
void device_free(struct device *dev);

/* `democles devices`: every platform and device with what matters, and which one node-local ranks 0
 * to n_rank - 1 would take. Not collective. Returns how many usable devices there are. */
int device_list(int n_rank, FILE *file);

/* Waits until both queues are empty. */
void device_finish(struct device *dev);
/* Has the device begin with what is in the compute queue; without it a driver may wait for more. */
void device_flush(struct device *dev);

/* Whether the host's thread has to share cores with the device's. */
static inline bool device_shares_cores(const struct device *dev)
{
    return dev->type & CL_DEVICE_TYPE_CPU;
}

/* True when the event has completed; stops if its command failed. Does not block and does not
 * release. */
bool device_event_done(cl_event event);

/* Prints rank, place, call and the code's name and stops with exit code 4 unless the code is
 * CL_SUCCESS. check_cl_as is for calls that return their code through a pointer. */
#define check_cl(call) device_check((call), #call, __FILE__, __LINE__)
#define check_cl_as(code, call) device_check((code), (call), __FILE__, __LINE__)
void device_check(cl_int code, const char *call, const char *file, int line);
const char *device_error_name(cl_int code);

#endif
