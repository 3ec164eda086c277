/* Preloaded into a program that runs in oclgrind 21.10, to keep the books of its plugin
 * `uninitialized` right.
 *
 * That plugin takes the bytes that the host writes for the whole buffer: it forgets what kernels
 * write behind them and reports whoever reads there. clEnqueueFillBuffer is a write per pattern,
 * and a buffer inherits the books of one that was released before. So here
 *
 *   a fill with zeros is one write of the whole buffer; with anything else (DEMOCLES_POISON) it
 *     leaves the buffer as it is when new: uninitialised
 *   a write to a part goes to a buffer of its own, from which a kernel copies it
 *   no buffer is released */
#define _GNU_SOURCE /* RTLD_NEXT */
#define CL_TARGET_OPENCL_VERSION 120
#define CL_USE_DEPRECATED_OPENCL_1_2_APIS
#include <CL/cl.h>
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void need(int ok, const char *what)
{
    if (ok) return;
    fprintf(stderr, "oclgrind_memory: %s\n", what);
    abort();
}

static size_t size_of(cl_mem mem)
{
    size_t bytes = 0;
    need(clGetMemObjectInfo(mem, CL_MEM_SIZE, sizeof bytes, &bytes, NULL) == CL_SUCCESS,
        "no size of a buffer");
    return bytes;
}

/* oclgrind's own clEnqueueWriteBuffer. */
static cl_int write_all(cl_command_queue queue, cl_mem mem, cl_bool block, size_t bytes,
    const void *data, cl_uint n_wait, const cl_event *wait, cl_event *event)
{
    static cl_int (*next)(cl_command_queue, cl_mem, cl_bool, size_t, size_t, const void *, cl_uint,
        const cl_event *, cl_event *);
    if (!next) *(void **)&next = dlsym(RTLD_NEXT, "clEnqueueWriteBuffer");
    need(next != NULL, "no OpenCL behind this library");
    return next(queue, mem, block, 0, bytes, data, n_wait, wait, event);
}

static cl_kernel copy_kernel(cl_context context)
{
    static const char *source =
        "__kernel void copy_part(ulong at, __global const char *from, __global char *to)\n"
        "{ size_t i = get_global_id(0); to[at + i] = from[i]; }\n";
    static cl_kernel kernel; /* one program, one context */
    if (kernel) return kernel;
    cl_program program = clCreateProgramWithSource(context, 1, &source, NULL, NULL);
    need(program && clBuildProgram(program, 0, NULL, "", NULL, NULL) == CL_SUCCESS,
        "its kernel does not build");
    kernel = clCreateKernel(program, "copy_part", NULL);
    return kernel;
}

cl_int clEnqueueWriteBuffer(cl_command_queue queue, cl_mem mem, cl_bool block, size_t offset,
    size_t bytes, const void *data, cl_uint n_wait, const cl_event *wait, cl_event *event)
{
    cl_context context = NULL;
    cl_ulong at = offset;
    if (bytes == size_of(mem))
        return write_all(queue, mem, block, bytes, data, n_wait, wait, event);
    clGetCommandQueueInfo(queue, CL_QUEUE_CONTEXT, sizeof context, &context, NULL);
    cl_kernel kernel = copy_kernel(context);
    cl_mem part = clCreateBuffer(context, CL_MEM_READ_WRITE, bytes, NULL, NULL);
    need(part && write_all(queue, part, CL_FALSE, bytes, data, n_wait, wait, NULL) == CL_SUCCESS,
        "cannot write");
    clSetKernelArg(kernel, 0, sizeof at, &at);
    clSetKernelArg(kernel, 1, sizeof part, &part);
    clSetKernelArg(kernel, 2, sizeof mem, &mem);
    cl_int code = clEnqueueNDRangeKernel(queue, kernel, 1, NULL, &bytes, NULL, 0, NULL, event);
    return code == CL_SUCCESS && block ? clFinish(queue) : code;
}

cl_int clEnqueueFillBuffer(cl_command_queue queue, cl_mem mem, const void *pattern,
    size_t pattern_size, size_t offset, size_t bytes, cl_uint n_wait, const cl_event *wait,
    cl_event *event)
{
    static const char zero[128]; /* the longest pattern */
    need(offset == 0 && bytes == size_of(mem) && !event, "a fill of a part, or with an event");
    if (memcmp(pattern, zero, pattern_size) != 0) return CL_SUCCESS;
    void *all = calloc(1, bytes);
    need(all != NULL, "out of memory");
    cl_int code = write_all(queue, mem, CL_TRUE, bytes, all, n_wait, wait, NULL);
    free(all);
    return code;
}

cl_int clReleaseMemObject(cl_mem mem)
{
    (void)mem;
    return CL_SUCCESS;
}
