"""The program as a user calls it: what the tests of the command line share."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

DEMOCLES, MPIRUN = None, None


def own_lines(err):
    """What is neither a notice of mpirun, which stands between lines of dashes, nor its log, nor
    about another test that compiles the same kernels."""
    foreign = re.compile(r"\[\S+:\d+\] .*ORTE_ERROR_LOG|democles: warning: waits for process \d+")
    lines, notice = [], False
    for line in err.splitlines():
        if line == 74 * "-":
            notice = not notice
        elif line and not notice and not foreign.match(line):
            lines.append(line)
    return lines


class Result:
    def __init__(self, run):
        self.code, self.out, self.err = run.returncode, run.stdout, own_lines(run.stderr)


def launch(parts, cwd=None, env=None, stdout=subprocess.PIPE):
    """parts: [(ranks, arguments)]; one part with one rank runs without mpirun.
    No result within a minute is a hang."""
    command = [] if parts[0][0] == 1 and len(parts) == 1 else [MPIRUN]
    for k, (ranks, args) in enumerate(parts):
        command += [":"] * (k > 0) + (["-n", str(ranks)] if command else []) + [DEMOCLES, *args]
    return Result(
        subprocess.run(
            command,
            cwd=cwd,
            env={**os.environ, **(env or {})},
            stdin=subprocess.DEVNULL,
            stdout=stdout,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
        )
    )


class Case(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self.dir = tempfile.mkdtemp(prefix="democles_cli_")
        self.addCleanup(shutil.rmtree, self.dir, True)

    def put(self, name, text):
        with open(os.path.join(self.dir, name), "w") as file:
            file.write(text)

    def call(self, *args, ranks=1, **more):
        return launch([(ranks, args)], cwd=self.dir, **more)


def main(first=1):
    """Arguments from the first on: democles, mpirun; before them: the class of tests, else all."""
    global DEMOCLES, MPIRUN
    DEMOCLES, MPIRUN = os.path.abspath(sys.argv[first]), sys.argv[first + 1]
    unittest.main(argv=sys.argv[:first], module="__main__")
