/* Exit code 0 where the HDF5 library writes through the MPI that this program is linked with: the
 * MPI_Init that its calls find is ours. */
#define _GNU_SOURCE /* dladdr */
#include <dlfcn.h>
#include <hdf5.h>
#include <mpi.h>

int main(void)
{
    Dl_info hdf5;
    if (!dladdr((void *)H5Pset_fapl_mpio, &hdf5)) return 1;
    /* NULL where HDF5 is linked into the program itself. */
    void *library = dlopen(hdf5.dli_fname, RTLD_LAZY | RTLD_NOLOAD);
    return library && dlsym(library, "MPI_Init") != dlsym(RTLD_DEFAULT, "MPI_Init");
}
