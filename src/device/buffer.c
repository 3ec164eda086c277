#include "buffer.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

#include "comm/fail.h"
#include "trace.h"

enum {
    GRAIN = 256,        /* [byte] of capacity: one fill pattern, one GPU line at least */
    HUGE_PAGE = 2 << 20 /* [byte] on x86-64 and with 4 KiB pages on arm64 */
};

void buffer_init(struct buffer *buffer, const char *name)
{
    *buffer = (struct buffer){.name = name};
}

static void fill(struct device *dev, struct buffer *buffer, cl_uint pattern)
{
    cl_event *event = trace_event(dev->trace, NULL);
    check_cl(clEnqueueFillBuffer(
        dev->compute, buffer->mem, &pattern, sizeof pattern, 0, buffer->capacity, 0, NULL, event));
    trace_command(dev->trace, dev->compute, buffer->name, buffer->capacity, event);
    check_cl(clFinish(dev->compute)); /* the copy queue may use it next */
}

static _Noreturn void too_large(
    const struct device *dev, const struct buffer *buffer, size_t bytes, const char *why)
{
    fail_stop(EXIT_DEVICE,
        "array `%s` of %.1f MiB does not fit on %s: %s (in use %.1f MiB, device %.1f MiB, largest "
        "array %.1f MiB). Use more devices, or "
        "--precision single",
        buffer->name, (double)bytes / (1 << 20), dev->name, why,
        (double)dev->counters.now_bytes / (1 << 20), (double)dev->global_mem / (1 << 20),
        (double)dev->max_alloc / (1 << 20));
}

/* On a CPU: our own memory for a large buffer, in the large pages that Linux gives to those who
 * ask. Kernels that go through many arrays at once spend much of their time on 4 KiB pages
 * otherwise: measured on a million lattice cells, pocl 3.1, AMD Zen 5, 20 % and in single precision
 * 50 % more cells per second. NULL: leave it to the driver. */
static void *huge_pages(const struct device *dev, cl_mem_flags flags, size_t capacity)
{
    void *pages = NULL;
    if (!(dev->type & CL_DEVICE_TYPE_CPU) || flags & CL_MEM_ALLOC_HOST_PTR ||
        capacity < HUGE_PAGE / 2)
        return NULL;
    size_t bytes = (capacity + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
    if (posix_memalign(&pages, HUGE_PAGE, bytes)) return NULL;
    /* no more than advice: what it does not change works all the same */
    madvise(pages, bytes, MADV_HUGEPAGE);
    return pages;
}

static void CL_CALLBACK free_pages(cl_mem mem, void *pages)
{
    (void)mem;
    free(pages);
}

/* New memory of at least `bytes`, not initialised. */
static void allocate(struct device *dev, struct buffer *buffer, size_t bytes, cl_mem_flags flags)
{
    /* Room to grow only where growth has been seen. */
    size_t capacity = buffer->capacity > 0 ? bytes + bytes / 4 : bytes;
    if (capacity > dev->max_alloc) capacity = bytes;
    capacity = (capacity / GRAIN + (capacity % GRAIN > 0 || capacity == 0)) * GRAIN;
    buffer_free(dev, buffer);
    if (capacity > dev->max_alloc)
        too_large(dev, buffer, capacity, "larger than its largest array");
    if (dev->counters.now_bytes + (int64_t)capacity > (int64_t)dev->global_mem)
        too_large(dev, buffer, capacity, "its memory is used up");

    cl_int code;
    void *pages = huge_pages(dev, flags, capacity);
    buffer->mem = clCreateBuffer(
        dev->context, flags | (pages ? CL_MEM_USE_HOST_PTR : 0), capacity, pages, &code);
    if (code == CL_MEM_OBJECT_ALLOCATION_FAILURE || code == CL_OUT_OF_RESOURCES ||
        code == CL_OUT_OF_HOST_MEMORY || code == CL_INVALID_BUFFER_SIZE)
        too_large(dev, buffer, capacity, device_error_name(code));
    check_cl_as(code, "clCreateBuffer");
    /* commands may use it until then */
    if (pages) check_cl(clSetMemObjectDestructorCallback(buffer->mem, free_pages, pages));
    buffer->capacity = capacity;
    buffer->bytes = bytes;
    struct device_counters *c = &dev->counters;
    buffer->serial = ++c->n_alloc;
    c->now_bytes += (int64_t)capacity;
    if (c->now_bytes > c->peak_bytes) c->peak_bytes = c->now_bytes;
    memory_table_add(&dev->memory, buffer->name, (int64_t)capacity);
}

/* 0, or all bits set where a test looks for reads of what was never written. */
static cl_uint initial_pattern(void)
{
    const char *poison = getenv("DEMOCLES_POISON");
    return poison && strcmp(poison, "1") == 0 ? 0xffffffffu : 0;
}

bool buffer_reserve(struct device *dev, struct buffer *buffer, size_t bytes)
{
    if (buffer->mem && bytes <= buffer->capacity) {
        buffer->bytes = bytes;
        return false;
    }
    allocate(dev, buffer, bytes, CL_MEM_READ_WRITE);
    fill(dev, buffer, initial_pattern());
    return true;
}

bool buffer_reserve_staging(struct device *dev, struct buffer *buffer, size_t bytes)
{
    if (buffer->mem && bytes <= buffer->capacity) {
        buffer->bytes = bytes;
        return false;
    }
    cl_int code;
    allocate(dev, buffer, bytes, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR);
    buffer->host = clEnqueueMapBuffer(dev->compute, buffer->mem, CL_TRUE,
        CL_MAP_READ | CL_MAP_WRITE, 0, buffer->capacity, 0, NULL, NULL, &code);
    check_cl_as(code, "clEnqueueMapBuffer");
    memset(buffer->host, (int)(initial_pattern() & 0xff), buffer->capacity);
    return true;
}

void buffer_free(struct device *dev, struct buffer *buffer)
{
    if (buffer->mem) {
        if (buffer->host) {
            check_cl(
                clEnqueueUnmapMemObject(dev->compute, buffer->mem, buffer->host, 0, NULL, NULL));
            check_cl(clFinish(dev->compute));
        }
        check_cl(clReleaseMemObject(buffer->mem));
        dev->counters.now_bytes -= (int64_t)buffer->capacity;
        memory_table_add(&dev->memory, buffer->name, -(int64_t)buffer->capacity);
    }
    buffer_init(buffer, buffer->name);
}

void buffer_write(
    struct device *dev, struct buffer *buffer, size_t offset, size_t bytes, const void *data)
{
    if (bytes == 0) return;
    buffer_write_begin(dev, dev->compute, buffer, offset, bytes, data, 0, NULL, NULL);
    check_cl(clFinish(dev->compute));
}

void buffer_read(
    struct device *dev, const struct buffer *buffer, size_t offset, size_t bytes, void *data)
{
    if (bytes == 0) return;
    buffer_read_begin(dev, dev->compute, buffer, offset, bytes, data, 0, NULL, NULL);
    check_cl(clFinish(dev->compute));
}

void buffer_zero(struct device *dev, struct buffer *buffer)
{
    if (buffer->mem) fill(dev, buffer, 0);
}

void buffer_write_begin(struct device *dev, cl_command_queue queue, struct buffer *buffer,
    size_t offset, size_t bytes, const void *data, cl_uint n_wait, const cl_event *wait,
    cl_event *event)
{
    assert(offset + bytes <= buffer->bytes);
    if (bytes == 0) {
        if (n_wait > 0 || event) check_cl(clEnqueueMarkerWithWaitList(queue, n_wait, wait, event));
        return;
    }
    event = trace_event(dev->trace, event);
    check_cl(clEnqueueWriteBuffer(
        queue, buffer->mem, CL_FALSE, offset, bytes, data, n_wait, wait, event));
    trace_command(dev->trace, queue, buffer->name, bytes, event);
    dev->counters.n_h2d++;
    dev->counters.h2d_bytes += (int64_t)bytes;
}

void buffer_read_begin(struct device *dev, cl_command_queue queue, const struct buffer *buffer,
    size_t offset, size_t bytes, void *data, cl_uint n_wait, const cl_event *wait, cl_event *event)
{
    assert(offset + bytes <= buffer->bytes);
    if (bytes == 0) {
        if (n_wait > 0 || event) check_cl(clEnqueueMarkerWithWaitList(queue, n_wait, wait, event));
        return;
    }
    event = trace_event(dev->trace, event);
    check_cl(clEnqueueReadBuffer(
        queue, buffer->mem, CL_FALSE, offset, bytes, data, n_wait, wait, event));
    trace_command(dev->trace, queue, buffer->name, bytes, event);
    dev->counters.n_d2h++;
    dev->counters.d2h_bytes += (int64_t)bytes;
}
