/* Tests of the lattice on a device: its opening and closing, and the device that they share. */
#ifndef DEVICE_TESTS_H
#define DEVICE_TESTS_H

#include "device/device.h"

static struct comm *comm;
static struct device *dev;

static int device_tests_end(int failed)
{
    device_free(dev);
    comm_free(comm);
    return failed;
}

/* Exit code of all `tests`, an array (cmocka counts it); 77, skipped, where the device has no
 * doubles. */
#define DEVICE_TESTS(tests)                                                                        \
    (comm = comm_create(NULL, NULL), dev = device_open(comm, NULL, true, false),                   \
        device_tests_end(dev->fp64 ? cmocka_run_group_tests(tests, NULL, NULL) : 77))

#endif
