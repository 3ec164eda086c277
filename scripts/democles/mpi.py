"""How several ranks are started: the one place that knows the arguments and the environment of Open
MPI and of MPICH. Ranks may outnumber the cores here, and may run as root, as in a container."""
import functools
import os
import subprocess
import sys

MPIRUN = os.environ.get("DEMOCLES_MPIRUN", "mpirun")
# No binding: the program shares the cores of a node among its ranks by itself.
OPEN_MPI = ["--oversubscribe", "--bind-to", "none"]
OPEN_MPI_ENVIRONMENT = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",  # version 5 spells them PRTE_
    "PRTE_ALLOW_RUN_AS_ROOT": "1",
    "PRTE_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",  # containers forbid it
    "OMPI_MCA_mpi_yield_when_idle": "1",
}


@functools.lru_cache
def is_open_mpi():
    """Else it is MPICH, or one of those that descend from it and share its mpirun."""
    try:
        return (
            "Open MPI"
            in subprocess.run(
                [MPIRUN, "--version"], capture_output=True, text=True, check=False
            ).stdout
        )
    except OSError as error:
        sys.exit(f"there is no {MPIRUN}: {error.strerror}; DEMOCLES_MPIRUN names another")


def command(*arguments):
    """mpirun with these arguments, as "-n", "2", "democles", ..."""
    return [MPIRUN, *(OPEN_MPI if is_open_mpi() else ["-bind-to", "none"]), *arguments]


def environment():
    """What is to be added to the environment of mpirun."""
    return {**OPEN_MPI_ENVIRONMENT, **os.environ} if is_open_mpi() else dict(os.environ)


def rank_variable():
    """In the environment of each rank."""
    return "OMPI_COMM_WORLD_RANK" if is_open_mpi() else "PMI_RANK"


if __name__ == "__main__":
    os.execvpe(MPIRUN, command(*sys.argv[1:]), environment())
