/* Opening the device that is here, alone and by several ranks; pocl keeps to this rank's share of
 * the cores. */
#include <stdlib.h>
#include <string.h>

#include "../mpi_check.h"
#include "device/device.h"

static void properties(const struct device *dev)
{
    CHECK(dev->name[0] && dev->platform_name[0] && dev->platform_version[0] && dev->driver[0] &&
          dev->version[0] && dev->opencl_c[0]);
    CHECK(dev->global_mem > 0 && dev->max_alloc > 0 && dev->max_alloc <= dev->global_mem);
    CHECK(dev->max_group >= 64 && dev->local_mem >= 1024 && dev->compute_units >= 1 &&
          dev->n_share >= 1);
    CHECK(dev->context && dev->compute && dev->copy && dev->compute != dev->copy &&
          dev->counters.n_alloc == 0);
}

/* Events across the two queues, as an exchange uses them. */
static void queues(struct device *dev)
{
    cl_event first, second;
    check_cl(clEnqueueMarkerWithWaitList(dev->compute, 0, NULL, &first));
    check_cl(clEnqueueMarkerWithWaitList(dev->copy, 1, &first, &second));
    check_cl(clFlush(dev->compute));
    check_cl(clFlush(dev->copy));
    while (!device_event_done(second)) continue;
    CHECK(device_event_done(first));
    check_cl(clReleaseEvent(first));
    check_cl(clReleaseEvent(second));
    device_finish(dev);
}

static void list(const struct device *dev)
{
    char *text = NULL;
    size_t bytes = 0;
    FILE *file = open_memstream(&text, &bytes);
    CHECK(device_list(2, file) >= 1);
    fclose(file);
    CHECK(strstr(text, dev->name) && strstr(text, dev->platform_name) &&
          strstr(text, "rank 0 of a node takes ") && strstr(text, "rank 1 of"));
    CHECK(!strstr(text, "rank 2 of"));
    free(text);
}

int main(int argc, char **argv)
{
    unsetenv("POCL_DEVICES"); /* the choice of the driver is looked at, too */
    struct comm *comm = comm_create(&argc, &argv);
    for (int k = 0; k < 3; k++) {
        bool profile = k == 1;
        struct device *dev = device_open(comm, k == 2 ? ":" : NULL, false, profile);
        CHECK(dev->profile == profile);
        properties(dev);
        queues(dev);
        list(dev);
        if (dev->is_pocl && getenv("POCL_MAX_PTHREAD_COUNT")) {
            CHECK(dev->compute_units <= (cl_uint)atoi(getenv("POCL_MAX_PTHREAD_COUNT")));
            CHECK(dev->n_share == comm->n_node_rank);
            CHECK(dev->at_once == (atoi(getenv("POCL_MAX_PTHREAD_COUNT")) == 1));
        }
        device_free(dev);
    }
    CHECK(strcmp(device_error_name(CL_INVALID_KERNEL_ARGS), "CL_INVALID_KERNEL_ARGS") == 0);
    CHECK(strcmp(device_error_name(-1001), "CL_PLATFORM_NOT_FOUND_KHR") == 0);
    device_free(NULL);
    comm_free(comm);
    return 0;
}
