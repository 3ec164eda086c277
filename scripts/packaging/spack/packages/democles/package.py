"""Spack recipe. From a checkout of democles:

    spack repo add scripts/packaging/spack
    spack dev-build democles@develop
"""
from spack.package import *


class Democles(MesonPackage):
    """Discrete elements on clusters, by MPI and OpenCL: particles,
    and solids as lattices that may break."""

    version("develop")

    variant("metis", default=True, description="graph partitions")
    variant("tools", default=True, description="Python tools for pictures, plots and studies")
    variant(
        "pocl",
        default=True,
        description="an OpenCL device on the processor; GPUs bring their own driver",
    )

    depends_on("c", type="build")
    depends_on("meson@1.0:", type="build")
    depends_on("ninja", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("python@3.9:", type="build")
    depends_on("mpi")
    # OMPIO of these corrupts parallel HDF5 files; the program takes ROMIO instead,
    # which has to be there.
    depends_on("openmpi+romio", when="^[virtuals=mpi] openmpi@:4.1.6")
    depends_on("hdf5@1.10:+mpi")
    depends_on("libyaml")
    depends_on("opencl@1.2:")
    depends_on("pocl+icd", when="+pocl", type="run")
    depends_on("metis@5:", when="+metis")
    with when("+tools"):
        depends_on("python@3.9:", type=("build", "run"))
        for module in ("numpy", "h5py", "matplotlib", "pyyaml"):
            depends_on(f"py-{module}", type=("build", "run"))

    def meson_args(self):
        def feature(name):
            return f"-D{name}={'enabled' if self.spec.satisfies('+' + name) else 'disabled'}"

        arguments = [
            "-Dtests=disabled",
            feature("metis"),
            feature("tools"),
            f"-Dhdf5={self.spec['hdf5'].prefix.bin.h5pcc}",
        ]
        if self.spec.satisfies("+tools"):
            arguments.append(f"-Dpython={self.spec['python'].command.path}")
        return arguments
