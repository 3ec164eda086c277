#include "buffers.h"

static struct buffer *member(void *base, const struct buffer_spec *spec)
{
    return (struct buffer *)(void *)((char *)base + spec->offset);
}

void buffers_init(struct device *dev, void *base, const struct buffer_spec *spec)
{
    for (; spec->name; spec++) buffer_init(member(base, spec), dev, spec->name);
}

void buffers_create(struct device *dev, void *base, const struct buffer_spec *spec)
{
    buffers_init(dev, base, spec);
    for (; spec->name; spec++) buffer_reserve(member(base, spec), 0);
}

void buffers_free(void *base, const struct buffer_spec *spec)
{
    for (; spec->name; spec++) buffer_free(member(base, spec));
}
