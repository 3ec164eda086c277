/* Many ranks build the same program and launch it the first time at once, with an empty kernel
 * cache: the race of pocl before 6.0. Argument: kernels' folder. */
#include <stdlib.h>
#include <string.h>

#include "../mpi_check.h"
#include "device/launch.h"

static const char *const sources[] = {"scale.cl", NULL};

int main(int argc, char **argv)
{
    char folder[] = "/tmp/democles_cold_XXXXXX", command[64];
    struct comm *comm = comm_create(&argc, &argv);
    CHECK(argc == 2);
    setenv("DEMOCLES_KERNELS", argv[1], 1);
    if (comm->rank == 0) CHECK(mkdtemp(folder));
    comm_bcast(comm, folder, sizeof folder, 0);
    setenv("POCL_CACHE_DIR", folder, 1);

    struct device *dev = device_open(comm, NULL, false, false);
    for (int k = 0; k < 4; k++) {
        char options[64];
        snprintf(
            options, sizeof options, "-DWITH_SHIFT=%d -DREAL_IS_FLOAT=1 -DVARIANT=%d", k % 2, k);
        struct program *program = program_build(dev, comm, "cold", options, sources);
        struct launch *launch = launch_create(program, "count");
        struct buffer seen;
        int32_t value[256];
        buffer_init(&seen, dev, "seen");
        buffer_reserve(&seen, sizeof value);
        buffer_zero(&seen);
        launch_bind_buffer(launch, "seen", &seen);
        comm_barrier(comm); /* all first launches together */
        launch_run(launch, 256);
        buffer_read(&seen, 0, sizeof value, value);
        for (int i = 0; i < 256; i++) CHECK(value[i] == 1);
        launch_free(launch);
        buffer_free(&seen);
        program_free(program);
    }
    device_free(dev);
    comm_barrier(comm);
    snprintf(command, sizeof command, "rm -rf %s", folder);
    if (comm->rank == 0) CHECK(system(command) == 0);
    comm_free(comm);
    return 0;
}
