#include "kernel_fixture.h"

struct device *fixture_device(void)
{
    bool need_fp64 = !REAL_IS_FLOAT || !POSITION_IS_FLOAT || WITH_ENERGY;
    struct device *dev = device_open(NULL, NULL, false, false);
    if (need_fp64 && !dev->fp64) {
        printf("%s has no doubles\n", dev->name);
        exit(77);
    }
    if (REAL_IS_FLOAT && !dev->fp32_correct_divide) {
        printf("%s does not round float division correctly\n", dev->name);
        exit(77);
    }
    return dev;
}

struct program *fixture_program(struct device *dev, const struct features *features,
    enum features_program program, const char *const *sources)
{
    char *options = features_options(features, program);
    struct program *built = program_build(dev, NULL, "test", options, sources);
    free(options);
    return built;
}

void fixture_buffer(
    struct device *dev, struct buffer *buffer, const char *name, size_t bytes, const void *data)
{
    buffer_init(buffer, dev, name);
    buffer_reserve(buffer, bytes);
    if (data) buffer_write(buffer, 0, bytes, data);
}

void fixture_bind(struct device *dev, struct launch *launch, struct buffer *buffer,
    const char *name, size_t bytes, const void *data)
{
    fixture_buffer(dev, buffer, name, bytes, data);
    launch_bind_buffer_if(launch, name, buffer);
}

void fixture_same_bits(const char *what, long at, const void *device, const void *host,
    size_t bytes, const char *file, int line)
{
    if (!memcmp(device, host, bytes)) return;
    if (bytes == 4) {
        float a, b;
        memcpy(&a, device, 4);
        memcpy(&b, host, 4);
        print_error("%s of %ld: device %a, host %a\n", what, at, (double)a, (double)b);
    } else {
        double a, b;
        memcpy(&a, device, 8);
        memcpy(&b, host, 8);
        print_error("%s of %ld: device %a, host %a\n", what, at, a, b);
    }
    _fail(file, line);
}
