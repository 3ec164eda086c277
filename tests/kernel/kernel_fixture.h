/* What the tests of kernels share: a device that can do the precision they were compiled in,
 * programs as the driver builds them, buffers from arrays.
 *
 * A test is compiled with the WITH_ flags and the precision of its kernels: the host's copy of the
 * laws and the features that the driver turns into build options come from the same flags. Numbers
 * on the device are then `real` and `preal` of types.h. */
#ifndef KERNEL_FIXTURE_H
#define KERNEL_FIXTURE_H

#include "../walls/scratch.h"

#include "kernels/particle/element.h"
#include "particle/features.h"
#include "device/launch.h"

/* One element as kernels/particle/element.h has it. */
struct record {
    preal x[3], radius;
    real v[3], inverse_m;
#if WITH_SPIN
    real w[3], material;
#endif
#if WITH_KICK
    float kick[3], no_kick;
#endif
#if WITH_SPIN_KICK
    float spun[3], no_spun;
#endif
};
_Static_assert(sizeof(struct record) == ELEMENT_BYTES, "a record is what element.h says");

/* The default device. Leaves with 77 (skipped) where it has no doubles and the test needs them, or
 * where its floats are not correctly rounded. */
struct device *fixture_device(void);

/* The scene's features that these flags stand for; the same law for pairs and, WITH_WALLS,
 * walls. */
static inline struct features fixture_features(void)
{
#define FIXTURE_FEATURE(member, flag, needed) .member = WITH_##flag,
    struct law_features law = {.any = true, CONTACT_FEATURES(FIXTURE_FEATURE)};
    struct law_features none = {.any = false};
    return (struct features){.real_is_float = REAL_IS_FLOAT,
        .position_is_float = POSITION_IS_FLOAT,
        .spin = WITH_SPIN,
        .sizes = WITH_SIZES,
        .materials = WITH_MATERIALS,
        .wall_table = WITH_TABLE,
        .energy = WITH_ENERGY,
        .kick = WITH_KICK,
        .spin_kick = WITH_SPIN_KICK,
        .orientation = WITH_ORIENTATION,
        .periodic = {WITH_PERIODIC_X, WITH_PERIODIC_Y, WITH_PERIODIC_Z},
        .walls = WITH_WALLS,
        .plane = WITH_PLANE,
        .rectangle = WITH_RECTANGLE,
        .cylinder = WITH_CYLINDER,
        .triangle = WITH_TRIANGLE,
        .joined = WITH_JOINED,
        .moving = WITH_MOVING,
        .pair = law,
        .wall = WITH_WALLS ? law : none};
}

struct program *fixture_program(struct device *dev, const struct features *features,
    enum features_program program, const char *const *sources);

/* A buffer with that content; `data` NULL: as buffer_reserve leaves it. */
void fixture_buffer(
    struct device *dev, struct buffer *buffer, const char *name, size_t bytes, const void *data);
/* The same and bound to the argument of its name. Buffers have to stay where they are. */
void fixture_bind(struct device *dev, struct launch *launch, struct buffer *buffer,
    const char *name, size_t bytes, const void *data);

/* Fails unless both numbers have the same bits. */
#define fixture_same(what, at, device, host)                                                       \
    fixture_same_bits(what, (long)(at), &(device), &(host), sizeof(device), __FILE__, __LINE__)
void fixture_same_bits(const char *what, long at, const void *device, const void *host,
    size_t bytes, const char *file, int line);

#endif
