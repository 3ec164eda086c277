/* Named device arrays that grow.
 *
 * Memory is initialised in full whenever it is allocated: with zeros, or with 0xff bytes (NaN, -1)
 * if the environment has DEMOCLES_POISON=1, which tests use to find reads of what was never
 * written: where zeros are meant, buffer_zero has to say so. Contents are lost when a buffer grows:
 * every user rebuilds what it keeps there. Knows no element type. */
#ifndef DEMOCLES_BUFFER_H
#define DEMOCLES_BUFFER_H

#include "device.h"

struct buffer {
    struct device *dev; /* borrowed; what has no memory yet may go without */
    const char *name;   /* borrowed, a literal as a rule; for messages and the memory table */
    cl_mem mem;         /* NULL until the first reserve */
    size_t bytes;       /* asked for last */
    size_t capacity;    /* allocated, a multiple of 256, >= bytes */
    /* number of the allocation, unique within the device: tells a launch when to bind anew */
    int64_t serial;
    void *host; /* host memory of a staging buffer, else NULL */
};

/* Names a buffer of the device; allocates nothing. */
void buffer_init(struct buffer *buffer, struct device *dev, const char *name);

/* Makes room for `bytes` (0 is fine: the smallest buffer, so that it can be bound). Returns true if
 * new memory was allocated (1.25 times what is asked if the buffer had some before), with its
 * contents initialised; false if what was there is enough, contents kept. Blocks only when it
 * allocates. More than the device can give: message with the name and sizes, exit code 4. */
bool buffer_reserve(struct buffer *buffer, size_t bytes);

/* The same for a staging buffer: host memory that the device reaches fast (pinned on GPUs), mapped
 * for reading and writing all its life. `buffer->host` is where MPI and the host read and write;
 * `mem` must never be a kernel argument. */
bool buffer_reserve_staging(struct buffer *buffer, size_t bytes);

/* Waits for nothing: commands that use the memory keep it alive. An empty buffer is fine. */
void buffer_free(struct buffer *buffer);

/* Set-up and output only, blocking, on the compute queue, so in order with kernels there. `offset`,
 * `bytes` within the asked size; 0 bytes is fine. */
void buffer_write(struct buffer *buffer, size_t offset, size_t bytes, const void *data);
void buffer_read(const struct buffer *buffer, size_t offset, size_t bytes, void *data);
/* Makes room for `bytes` and writes them all. */
void buffer_put(struct buffer *buffer, size_t bytes, const void *data);
/* All bytes to 0. */
void buffer_zero(struct buffer *buffer);

/* Within a step, not blocking, on any queue; `data` has to stay until the event is complete. Waits
 * for `after` first. 0 bytes: a marker, so that both events work all the same. Either may be
 * NULL. */
void buffer_write_begin(struct buffer *buffer, cl_command_queue queue, size_t offset, size_t bytes,
    const void *data, const cl_event *after, cl_event *event);
void buffer_read_begin(const struct buffer *buffer, cl_command_queue queue, size_t offset,
    size_t bytes, void *data, const cl_event *after, cl_event *event);

#endif
