#!/usr/bin/python3
"""mpirun for tests, with what the MPI in use needs (scripts/democles/mpi.py), and the same streams
and exit code.

Open MPI 4.1.4's mpirun now and then dies of SIGSEGV in a thread of its own (libpmix over libevent
in its backtrace) while it ends a job that aborts. That says nothing of the program under test, so
such a job is run once more. A rank that crashes is no such case: mpirun then exits with 139. Nor
does it when LeakSanitizer, which stops all threads of a process that ends, crashes because they are
ending too: it says so."""
import pathlib
import signal
import subprocess
import sys
import tempfile

sys.path.insert(1, str(pathlib.Path(__file__).resolve().parents[1] / "scripts"))
from democles import mpi  # noqa: E402

TRIES = 3
LEAKS_CRASHED = b"LeakSanitizer has encountered a fatal error"
FORWARDED = (signal.SIGINT, signal.SIGTERM, signal.SIGUSR1, signal.SIGUSR2)


def attempt(kept):
    """Return code of mpirun, and whether it counts. kept: (stream of ours, file in its place or
    None for the stream itself)."""
    child = subprocess.Popen(
        mpi.command(*sys.argv[1:]), env=mpi.environment(), stdout=kept[0][1], stderr=kept[1][1]
    )
    for number in FORWARDED:
        signal.signal(number, lambda got, _frame: child.send_signal(got))
    code, err = child.wait(), kept[1][1]
    if err:
        err.seek(0)
    return code, code != -signal.SIGSEGV and not (err and LEAKS_CRASHED in err.read())


def main():
    for left in reversed(range(TRIES)):
        kept = [
            (stream, None if stream.isatty() else tempfile.TemporaryFile())
            for stream in (sys.stdout, sys.stderr)
        ]
        code, counts = attempt(kept)
        if counts or left == 0:
            break
    for stream, file in kept:
        if file:
            file.seek(0)
            stream.buffer.write(file.read())
    sys.exit(code if code >= 0 else 128 - code)


main()
