"""Runs of the program and what they leave, for the tests of parallel runs.
Arguments of each test: democles, mpirun, the folder of cases, own ones."""
import glob
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

import parallel_scenes

sys.path.insert(1, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "scripts"))
from democles import frames, mpi  # noqa: E402

HANG = 240  # seconds after which a run counts as hanging: minutes, for the machine may be busy
DEMOCLES, MPIRUN, CASES, OWN = None, None, None, []


def command(ranks, *args):
    """One rank runs without mpirun."""
    return [*([MPIRUN, "-n", str(ranks)] if ranks > 1 else []), DEMOCLES, *args]


class Run:
    """A finished run: `code`, `err` (text), and what it left in `dir`."""

    def __init__(self, folder, code, err):
        self.dir, self.code, self.err = folder, code, err

    def record(self):
        with open(os.path.join(self.dir, "run.json")) as file:
            return json.load(file)

    def series(self):
        """Name -> text of each measure."""
        found = {}
        for path in glob.glob(os.path.join(self.dir, "*.csv")):
            with open(path) as file:
                found[os.path.basename(path)] = file.read()
        return found

    def frames(self):
        return frames.paths(self.dir)

    def contacts(self):
        """(kind, element, partner) -> state and history of all contacts in the last frame."""
        frame, found = frames.Frame(self.frames()[-1]), {}
        for kind, partner in (("pairs", "partner"), ("wall_contacts", "primitive")):
            columns = {
                name: frames.state(frame.path, f"{kind}/{name}")
                for name in ("id", partner, "state", "history")
            }
            if columns["id"] is None or not len(columns["id"]):
                continue
            rest = [c for c in (columns["state"], columns["history"]) if c is not None]
            for k, key in enumerate(zip(columns["id"].tolist(), columns[partner].tolist())):
                found[kind, *key] = b"".join(c[k].tobytes() for c in rest)
        return found


class Case(unittest.TestCase):
    maxDiff = None

    def setUp(self):
        self.dir = tempfile.mkdtemp(prefix="democles_parallel_")
        self.addCleanup(shutil.rmtree, self.dir, True)

    def scene(self, name):
        return parallel_scenes.put(name, self.dir, CASES)

    def run_scene(self, scene, ranks, *args, name="out", env=None, **more):
        """Runs to its end; a run that hangs fails the test."""
        out = os.path.join(self.dir, name)
        shutil.rmtree(out, True)
        run = subprocess.run(
            command(ranks, "run", scene, "-o", out, "--quiet", *args),
            cwd=self.dir,
            env={**os.environ, **(env or {})},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            timeout=HANG,
            **more,
        )
        return Run(out, run.returncode, run.stderr)

    def good_run(self, scene, ranks, *args, **more):
        run = self.run_scene(scene, ranks, *args, **more)
        self.assertEqual(run.code, 0, run.err)
        self.assertRegex(run.record()["digest"] or "", r"\A[0-9a-f]{16}\Z")
        return run


def main(own=None):
    """own: how many arguments the test has itself; more are names of the tests to run."""
    global DEMOCLES, MPIRUN, CASES, OWN
    DEMOCLES, MPIRUN, CASES, *OWN = sys.argv[1:]
    DEMOCLES, CASES = os.path.abspath(DEMOCLES), os.path.abspath(CASES)
    unittest.main(argv=sys.argv[:1] + (OWN[own:] if own is not None else []), module="__main__")
