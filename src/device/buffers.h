/* The buffers of a struct, all created and freed by one table of their names and places. */
#ifndef DEMOCLES_BUFFERS_H
#define DEMOCLES_BUFFERS_H

#include <stddef.h>

#include "buffer.h"

/* A table of these ends with {0}. */
struct buffer_spec {
    const char *name; /* see struct buffer */
    size_t offset;    /* of the buffer in its struct */
};

/* Names them all; base: the struct. */
void buffers_init(struct device *dev, void *base, const struct buffer_spec *spec);
/* The same, each with the smallest memory, so that it can be bound. */
void buffers_create(struct device *dev, void *base, const struct buffer_spec *spec);
void buffers_free(void *base, const struct buffer_spec *spec);

#endif
