#include "contact_store.h"

struct contact_layout contact_layout(struct device *dev, const struct program *program)
{
    struct contact_layout layout;
    struct buffer out;
    cl_int value[3];
    struct launch *launch = launch_create(program, "layout");
    buffer_init(&out, dev, "layout");
    buffer_reserve(&out, sizeof value);
    launch_bind_buffer(launch, "out", &out);
    launch_run(launch, 1);
    buffer_read(&out, 0, sizeof value, value);
    layout.history = value[0];
    layout.result = value[1];
    layout.remembers = value[2] != 0;
    launch_free(launch);
    buffer_free(&out);
    return layout;
}

void contact_arrivals_init(struct device *dev, struct contact_arrivals *a, const char *name)
{
    struct buffer *all[] = {&a->begin, &a->key, &a->state, &a->history};
    for (int i = 0; i < 4; i++) {
        buffer_init(all[i], dev, name);
        buffer_reserve(all[i], 64);
    }
}

void contact_arrivals_free(struct contact_arrivals *a)
{
    struct buffer *all[] = {&a->begin, &a->key, &a->state, &a->history};
    for (int i = 0; i < 4; i++) buffer_free(all[i]);
}
