/* All OpenCL devices of this process and the order in which they are dealt out. Private to
 * device*.c. */
#ifndef DEMOCLES_DEVICE_FIND_H
#define DEMOCLES_DEVICE_FIND_H

#include "device.h"

struct device_entry {
    struct device info;               /* platform, id and properties; no context, no queues */
    int platform_index, device_index; /* as `democles devices` prints and --device takes them */
    const char *unusable;             /* why it cannot be used; NULL: it can */
    char bus[32];                     /* PCI address, empty where the driver does not tell */
};

/* Everything there is, usable or not, platform after platform. The array is freed by the caller.
 * `code` is what clGetPlatformIDs said. */
int device_find(struct device_entry **entry, cl_int *code);

/* Indices into entry of the devices that node-local ranks 0, 1, ... take in turn, into order
 * [n_entry]: usable ones that match `choice` (see device_open), the best kind alone, with fp64
 * alone if needed and there; a GPU that shows under two drivers once. Sorted by PCI address and
 * names, because drivers may list in another order in another process. */
int device_deal(
    const struct device_entry *entry, int n_entry, const char *choice, bool need_fp64, int *order);

/* One line: index, platform, name, kind, fp64. */
void device_print_short(const struct device_entry *entry, FILE *file);
const char *device_kind(const struct device *dev);

#endif
