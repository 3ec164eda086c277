#!/usr/bin/python3
"""Damaged and crafted frames: a run that goes on says which cannot be used, takes the one before or
ends with code 6, and never crashes; nor do the Python tools. Own arguments: results_tool, the
tests, or nothing: some of each kind. DEMOCLES_SEED changes what is random."""
import os
import random
import resource
import shutil
import subprocess
import sys

import frame_craft
import lattice_runs
import parallel_runs
import robust_jobs

LIMIT = 120  # seconds for one run


def torn():
    """A bar that breaks, with its account of energy."""
    scene = lattice_runs.torn()
    scene["output"] = {"every": 2e-5}
    return scene


class Case(robust_jobs.Case):
    def setUp(self):
        super().setUp()
        self.random = random.Random(os.environ.get("DEMOCLES_SEED", "7"))
        self.done = {"refused": 0, "taken": 0, "stopped": 0}

    def tearDown(self):
        print(f"{self.id()}: {self.done}", file=sys.stderr)

    def whole(self, content, steps, *args):
        """A folder with frames, the newest last,
        and the digest of a step that none of them is of."""
        self.args = ["--steps", str(steps)]
        run = self.good_run(self.put(content), 1, *args, *self.args, name="whole")
        self.digest, self.frame = run.record()["digest"], run.frames()[-1]
        self.number = int(self.frame.stem.split("_")[1])
        self.keep = os.path.join(self.dir, "keep")
        shutil.copytree(run.dir, self.keep)
        self.frame.unlink()
        with open(os.path.join(self.keep, self.frame.name), "rb") as file:
            self.data = file.read()
        return run

    def folder(self, files):
        """The frames but the newest, and then these, as if they were newer."""
        out = os.path.join(self.dir, "out")
        shutil.rmtree(out, True)
        shutil.copytree(os.path.join(self.dir, "whole"), out)
        paths = [os.path.join(out, f"frame_{self.number + k:06}.hdf") for k in range(len(files))]
        for path, data in zip(paths, files):
            with open(path, "wb") as file:
                file.write(data)
        return out, paths

    def resume(self, out, ranks=1):
        return subprocess.run(
            parallel_runs.command(ranks, "resume", out, "--quiet", *self.args),
            capture_output=True,
            text=True,
            errors="replace",
            timeout=LIMIT,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CORE, (0, 0)),
        )

    def is_told(self, run, what):
        """Neither a crash nor silence."""
        for word in (
            "Sanitizer",
            "runtime error",
            "Signal",
            "signal: ",
            "Assertion",
            "rank 0 on node",
        ):
            self.assertNotIn(word, run.stderr.replace("(signal", ""), what)
        self.assertIn(run.returncode, (0, 6), f"{what}: {run.stderr}")
        if run.returncode == 6:
            self.assertEqual(run.stderr.count("democles: error: "), 1, f"{what}: {run.stderr}")
        return run.returncode

    def use(self, files, names, must_refuse):
        """Resumes from the newest of these until all have been met.
        What is used must give the digest."""
        while files:
            out, _ = self.folder(files)
            run = self.resume(out)
            code, n = self.is_told(run, names[-1]), run.stderr.count("cannot be used")
            self.done["refused"] += n - (code == 6)
            if code == 6:
                self.assertFalse(must_refuse, f"{names[len(files) - n]}: {run.stderr}")
            if code == 0:
                record = parallel_runs.Run(out, 0, "").record()
                self.assertEqual(record["digest"], self.digest, names[len(files) - n - 1])
            if n < len(files):
                self.done["taken"] += 1
                self.assertFalse(must_refuse, f"{names[len(files) - n - 1]}: {run.stderr}")
            del files[max(0, len(files) - n - (code == 0)) :]

    def tools(self, paths):
        """The Python tools read, or say what is wrong, each file."""
        code = (
            "import sys\nfrom democles import frames\n"
            "for path in sys.argv[1:]:\n"
            "    try:\n"
            "        frame = frames.Frame(path); frame.step(); frame.unit('velocity')\n"
            "    except SystemExit as error:\n"
            "        assert path in str(error), error\n"
            "print('end')\n"
        )
        environment = {
            **os.environ,
            "PYTHONPATH": os.path.dirname(os.path.dirname(parallel_runs.frames.__file__)),
        }
        run = subprocess.run(
            ["/usr/bin/python3", "-c", code, *paths],
            capture_output=True,
            text=True,
            env=environment,
        )
        self.assertEqual((run.returncode, run.stdout), (0, "end\n"), run.stderr)


class Damaged(Case):
    """Random bytes of a frame that are others."""

    def damaged(self, n):
        files, names = [], []
        heaps = [
            k for k in range(len(self.data)) if self.data.startswith((b"FHDB", b"FRHP", b"BTHD"), k)
        ]
        for _ in range(n):
            data = bytearray(self.data)
            for _ in range(self.random.choice((1, 1, 1, 2, 8))):
                # half of them where HDF5 keeps its lists of links
                at = self.random.randrange(len(data))
                if heaps and self.random.random() < 0.5:
                    at = min(self.random.choice(heaps) + self.random.randrange(600), len(data) - 1)
                data[at] ^= self.random.randrange(1, 256)
            if self.random.random() < 0.05:
                del data[self.random.randrange(len(data)) :]
            files.append(bytes(data))
            names.append(f"damage {len(files)}")
        return files, names

    def check(self, n, at_once):
        self.whole(robust_jobs.bed(frame_every=120), 260)
        for begin in range(0, n, at_once):
            files, names = self.damaged(min(at_once, n - begin))
            self.tools(self.folder(files)[1])
            self.use(files, names, False)

    def test_some(self):
        self.check(30, 30)

    def test_two_thousand(self):
        self.check(2000, 100)


class Crafted(Case):
    def crafted(self, crafts):
        """The newest frame, changed in each of these ways."""
        files = []
        for change in crafts.values():
            path = os.path.join(self.dir, "crafted.hdf")
            with open(path, "wb") as file:
                file.write(self.data)
            frame_craft.craft(path, change)
            with open(path, "rb") as file:
                files.append(file.read())
        return files

    def structure(self, crafts):
        files = self.crafted(crafts)
        self.tools(self.folder(files)[1])
        self.use(files, list(crafts), True)
        self.assertEqual(self.done["refused"], len(crafts))

    def contents(self, crafts, ranks=(1,)):
        for name, data in zip(crafts, self.crafted(crafts)):
            for n in ranks:
                out, paths = self.folder([data])
                run = self.resume(out, n)
                code = self.is_told(run, name)
                self.assertIn(self.frame.name, run.stderr, name)
                self.assertTrue(
                    "cannot be" in run.stderr or "missing" in run.stderr, f"{name}: {run.stderr}"
                )
                self.done["stopped" if code == 6 else "refused"] += 1
                os.remove(paths[0])
        run = self.resume(out)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(parallel_runs.Run(out, 0, "").record()["digest"], self.digest)

    def some(self, crafts, *names):
        return {name: crafts[name] for name in names}

    def particles(self):
        scene = robust_jobs.bed(frame_every=120)
        scene["contacts"][0]["rolling"] = {"model": "epsd", "friction": 0.1, "damping_ratio": 0.3}
        self.whole(scene, 260)

    def lattice(self):
        self.whole(torn(), 280)

    def test_some_structure(self):
        self.particles()
        self.structure(frame_craft.STRUCTURE)

    def test_some_particles(self):
        self.particles()
        self.contents(
            self.some(
                frame_craft.PARTICLES,
                "democles/elements/id = 1000000000",
                "democles/elements/reference = nan",
                "democles/pairs/partner = -1",
                "twice the same",
            )
        )

    def test_some_lattice(self):
        self.lattice()
        self.contents(
            self.some(
                frame_craft.LATTICE,
                "democles/cells/id = -1",
                "links of a corner",
                "fate of all modes",
                "democles/cells/released too short",
            )
        )

    def odd(self, n):
        """Numbers may be what they like where nothing hangs on them: the run goes on, or ends."""
        for k in range(n):
            data = self.crafted({"odd": frame_craft.odd(self.random)})
            run = self.resume(self.folder(data)[0])
            self.assertIn(run.returncode, (0, 3, 4, 5, 6), f"{k}: {run.stderr}")
            self.done["taken" if run.returncode == 0 else "stopped"] += 1

    def test_odd_particles(self):
        self.particles()
        self.odd(100)

    def test_odd_lattice(self):
        self.lattice()
        self.odd(100)

    def test_all_particles(self):
        self.particles()
        self.contents(frame_craft.PARTICLES, (1, 3))

    def test_all_lattice(self):
        self.lattice()
        self.structure(frame_craft.STRUCTURE)
        self.contents(frame_craft.LATTICE, (1, 3))


if __name__ == "__main__":
    parallel_runs.main(1)
