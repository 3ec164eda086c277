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

void buffer_init(struct buffer *buffer, struct device *dev, const char *name)
{
    *buffer = (struct buffer){.dev = dev, .name = name};
}

static void fill(struct buffer *buffer, cl_uint pattern)
{
    struct device *dev = buffer->dev;
    cl_event *event = trace_event(dev->trace, NULL);
    check_cl(clEnqueueFillBuffer(
        dev->compute, buffer->mem, &pattern, sizeof pattern, 0, buffer->capacity, 0, NULL, event));
    trace_command(dev->trace, dev->compute, buffer->name, buffer->capacity, event);
    check_cl(clFinish(dev->compute)); /* the copy queue may use it next */
}

static _Noreturn void too_large(const struct buffer *buffer, size_t bytes, const char *why)
{
    const struct device *dev = buffer->dev;
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
static void allocate(struct buffer *buffer, size_t bytes, cl_mem_flags flags)
{
    struct device *dev = buffer->dev;
    /* Room to grow only where growth has been seen. */
    size_t capacity = buffer->capacity > 0 ? bytes + bytes / 4 : bytes;
    if (capacity > dev->max_alloc) capacity = bytes;
    capacity = (capacity / GRAIN + (capacity % GRAIN > 0 || capacity == 0)) * GRAIN;
    buffer_free(buffer);
    if (capacity > dev->max_alloc) too_large(buffer, capacity, "larger than its largest array");
    if (dev->counters.now_bytes + (int64_t)capacity > (int64_t)dev->global_mem)
        too_large(buffer, capacity, "its memory is used up");

    cl_int code;
    void *pages = huge_pages(dev, flags, capacity);
    buffer->mem = clCreateBuffer(
        dev->context, flags | (pages ? CL_MEM_USE_HOST_PTR : 0), capacity, pages, &code);
    if (code == CL_MEM_OBJECT_ALLOCATION_FAILURE || code == CL_OUT_OF_RESOURCES ||
        code == CL_OUT_OF_HOST_MEMORY || code == CL_INVALID_BUFFER_SIZE)
        too_large(buffer, capacity, device_error_name(code));
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

bool buffer_reserve(struct buffer *buffer, size_t bytes)
{
    if (buffer->mem && bytes <= buffer->capacity) {
        buffer->bytes = bytes;
        return false;
    }
    allocate(buffer, bytes, CL_MEM_READ_WRITE);
    fill(buffer, initial_pattern());
    return true;
}

bool buffer_reserve_staging(struct buffer *buffer, size_t bytes)
{
    if (buffer->mem && bytes <= buffer->capacity) {
        buffer->bytes = bytes;
        return false;
    }
    cl_int code;
    allocate(buffer, bytes, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR);
    buffer->host = clEnqueueMapBuffer(buffer->dev->compute, buffer->mem, CL_TRUE,
        CL_MAP_READ | CL_MAP_WRITE, 0, buffer->capacity, 0, NULL, NULL, &code);
    check_cl_as(code, "clEnqueueMapBuffer");
    memset(buffer->host, (int)(initial_pattern() & 0xff), buffer->capacity);
    return true;
}

void buffer_free(struct buffer *buffer)
{
    struct device *dev = buffer->dev;
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
    buffer_init(buffer, dev, buffer->name);
}

void buffer_put(struct buffer *buffer, size_t bytes, const void *data)
{
    buffer_reserve(buffer, bytes);
    buffer_write(buffer, 0, bytes, data);
}

void buffer_zero(struct buffer *buffer)
{
    if (buffer->mem) fill(buffer, 0);
}

/* Either way: `to` is host memory to write into, else `from` what to read there. */
static void copy(const struct buffer *buffer, cl_command_queue queue, size_t offset, size_t bytes,
    void *to, const void *from, const cl_event *after, cl_event *event)
{
    struct device *dev = buffer->dev;
    cl_uint n_after = after ? 1 : 0;
    assert(offset + bytes <= buffer->bytes);
    if (bytes == 0) {
        if (after || event) check_cl(clEnqueueMarkerWithWaitList(queue, n_after, after, event));
        return;
    }
    event = trace_event(dev->trace, event);
    if (to)
        check_cl(clEnqueueReadBuffer(
            queue, buffer->mem, CL_FALSE, offset, bytes, to, n_after, after, event));
    else
        check_cl(clEnqueueWriteBuffer(
            queue, buffer->mem, CL_FALSE, offset, bytes, from, n_after, after, event));
    trace_command(dev->trace, queue, buffer->name, bytes, event);
    *(to ? &dev->counters.n_d2h : &dev->counters.n_h2d) += 1;
    *(to ? &dev->counters.d2h_bytes : &dev->counters.h2d_bytes) += (int64_t)bytes;
}

void buffer_write_begin(struct buffer *buffer, cl_command_queue queue, size_t offset, size_t bytes,
    const void *data, const cl_event *after, cl_event *event)
{
    copy(buffer, queue, offset, bytes, NULL, data, after, event);
}

void buffer_read_begin(const struct buffer *buffer, cl_command_queue queue, size_t offset,
    size_t bytes, void *data, const cl_event *after, cl_event *event)
{
    copy(buffer, queue, offset, bytes, data, NULL, after, event);
}

void buffer_write(struct buffer *buffer, size_t offset, size_t bytes, const void *data)
{
    if (bytes == 0) return;
    buffer_write_begin(buffer, buffer->dev->compute, offset, bytes, data, NULL, NULL);
    check_cl(clFinish(buffer->dev->compute));
}

void buffer_read(const struct buffer *buffer, size_t offset, size_t bytes, void *data)
{
    if (bytes == 0) return;
    buffer_read_begin(buffer, buffer->dev->compute, offset, bytes, data, NULL, NULL);
    check_cl(clFinish(buffer->dev->compute));
}
