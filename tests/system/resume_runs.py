#!/usr/bin/python3
"""A run that goes on from a frame is the run that was never interrupted, to the bit: state,
contacts, broken links, measures, energies; on any ranks. Own arguments: results_tool, the tests."""
import os
import re
import subprocess

import h5py
import numpy
import yaml

import lattice_runs
import parallel_runs
import parallel_scenes
import robust_jobs
from parallel_runs import frames

# Tables of the state: what names a row, and all columns, of which a scene may lack some.
TABLES = {
    "elements": (
        ("id",),
        (
            "position",
            "velocity",
            "angular_velocity",
            "orientation",
            "force",
            "torque",
            "reference",
            "reach",
        ),
    ),
    "pairs": (("id", "partner"), ("state", "history", "ledger")),
    "wall_contacts": (("id", "primitive"), ("state", "history", "ledger")),
    "cells": (
        ("id",),
        (
            "displacement",
            "rotation",
            "velocity",
            "angular_velocity",
            "links",
            "fate",
            "velocity_before",
            "angular_velocity_before",
            "ledger",
            "fresh",
            "released",
        ),
    ),
    "measures": ((), ("left",)),
    "energy": ((), ("sum",)),
    "energy_start": ((), ("start",)),
    "totals": ((), ("number",)),
}
SAME = """digest steps time_end dt dt_limit elements elements_removed interactions rebuilds energy
    momentum broken rest""".split()


def state(path):
    """table/column -> bytes, in an order that no rank has a part in."""
    found = {}
    for table, (keys, columns) in TABLES.items():
        key = [frames.state(path, f"{table}/{name}") for name in keys]
        order = numpy.lexsort(key[::-1]) if key and key[0] is not None else slice(None)
        for name in keys + columns:
            values = frames.state(path, f"{table}/{name}")
            if values is not None:
                found[f"{table}/{name}"] = values[order].tobytes()
    return found


class Case(robust_jobs.Case):
    def resume(self, folder, ranks, *args, code=0, env=None):
        words = parallel_runs.command(ranks, "resume", folder, "--quiet", *args)
        run = subprocess.run(
            words,
            cwd="/",
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            timeout=parallel_runs.HANG,
            env={**os.environ, **(env or {})},
        )
        self.assertEqual(run.returncode, code, run.stderr)
        return parallel_runs.Run(folder, run.returncode, run.stderr)

    def same(self, whole, run):
        """Everything that a run leaves, but for frames in between and what is of a process."""
        a, b = whole.record(), run.record()
        self.assertEqual({key: b.get(key) for key in SAME}, {key: a.get(key) for key in SAME})
        self.assertEqual(run.series(), whole.series())
        expected, found = state(whole.frames()[-1]), state(run.frames()[-1])
        self.assertEqual(sorted(found), sorted(expected))
        for name, value in expected.items():
            self.assertEqual(found[name], value, name)
        return expected

    def parts(self, scene, stops, end, ranks, *args):
        """Up to the first stop, to each other, to the end; each part on the next ranks."""
        run = self.good_run(scene, ranks[0], *args, "--steps", str(stops[0]), name="parts")
        for begin, to, n in zip(stops, [*stops[1:], end], ranks[1:]):
            run = self.resume(run.dir, n, "--steps", str(to))
            self.assertEqual(run.record()["resumed"]["step"], begin)
            self.assertNotIn("cannot be used", run.err)
        return run


class Particles(Case):
    """Stops somewhere; and right before a build of the lists, which ranks do not know yet."""

    def check(self, name, precision, stop, ranks, columns, boundary="both"):
        with self.subTest(scene=name, precision=precision):
            scene, args = self.scene(name), (
                "--precision",
                precision,
                "--set",
                f"partition.boundary={boundary}",
            )
            whole = self.good_run(scene, ranks[0], *args, name="whole")
            record, built_at = whole.record(), frames.attribute(whole.frames()[-1], "built_at")
            self.assertGreater(built_at - 1, stop)
            found = self.same(
                whole, self.parts(scene, (stop, built_at - 1), record["steps"], ranks[1:], *args)
            )
            for column in columns:
                self.assertTrue(any(found[column]), column)
            return record

    def test_laws(self):
        self.check("column", "double", 150, (1, 1, 3, 2), ("pairs/history", "wall_contacts/ledger"))
        self.check(
            "hertz",
            "double",
            133,
            (2, 3, 2, 1),
            ("pairs/history", "wall_contacts/history"),
            "assigned",
        )

    def test_places(self):
        self.check("shear", "mixed", 255, (1, 1, 3, 2), ("pairs/history",))
        self.check("moving", "double", 222, (1, 3, 1, 2), ("wall_contacts/history",))
        self.check("gas_xyz", "single", 301, (3, 1, 2, 3), ("elements/orientation",))
        record = self.check("leaving", "double", 400, (1, 3, 2, 1), ("energy/sum", "measures/left"))
        self.assertGreater(record["elements_removed"], 10)


class Lattice(Case):
    def put(self, content):
        folder = os.path.join(self.dir, "scenes")
        os.makedirs(folder, exist_ok=True)
        path = os.path.join(folder, content["title"] + ".yaml")
        with open(path, "w") as file:
            yaml.safe_dump(content, file)
        return path

    def check(self, content, precision, steps, stops, ranks, **time):
        content["time"].update(time)
        if not any("energy" in m for m in content["measure"]):
            content["measure"].append(
                {"name": "energy", "every": content["measure"][0]["every"] * 3, "energy": "all"}
            )
        with self.subTest(scene=content["title"], precision=precision, **time):
            scene = self.put(content)
            whole = self.good_run(
                scene, ranks[0], "--precision", precision, "--steps", str(steps), name="whole"
            )
            return whole, self.same(
                whole, self.parts(scene, stops, steps, ranks[1:], "--precision", precision)
            )

    def test_schemes(self):
        self.check(lattice_runs.plate(1), "double", 40, (13, 26), (1, 1, 3, 2))
        self.check(lattice_runs.block("pefrl"), "mixed", 40, (11,), (2, 3, 1))

    def breaks(self, precision, scheme):
        whole, found = self.check(
            lattice_runs.torn(principal=precision == "single"),
            precision,
            300,
            (190, 240),
            (1, 1, 3, 2),
            scheme=scheme,
            step=1.5e-7,
        )
        self.assertGreater(sum(whole.record()["broken"].values()), 10)
        self.assertTrue(any(found["cells/released"]))

    def test_breakage(self):
        self.breaks("double", "leapfrog")

    def test_breakage_rkn4(self):
        self.breaks("single", "rkn4")

    def test_damped_links(self):
        """Their forces are those of the velocities before the kick that ends a step."""
        content = lattice_runs.block("leapfrog")
        content["materials"] = {
            name: {**material, "damping": {"link": 2e-8}}
            for name, material in content["materials"].items()
        }
        content["lattice"] = {"rotation": "small"}
        self.check(content, "double", 40, (17,), (1, 2, 3))

    def test_rest(self):
        """Stops between the two halves of a look, and right after it."""
        scene = os.path.join(parallel_runs.CASES, "patch", "scene.yaml")
        whole = self.good_run(scene, 1, name="whole")
        self.same(whole, self.parts(scene, (199, 200), whole.record()["steps"], (3, 1, 2)))


class Killed(Case):
    def test_killed(self):
        """kill -9 in mid-run: measures have lines beyond the last frame, or half of one."""
        content = robust_jobs.bed(frame_every=60)
        content["output"]["checkpoint_every"] = 40 * 2e-5
        content["measure"].append({"name": "often", "every": 3 * 2e-5, "momentum": "all"})
        job = self.job(self.put(content), 3)
        job.wait_frames(5)
        job.signal(9, 1)
        self.assertNotIn(job.end(), (0, "hangs"))
        with open(os.path.join(job.dir, "often.csv"), "a") as file:
            file.write("1e6,0,0,0,0,0,0\n1e6,0,0")
        steps = [round(frames.Frame(path).time / 2e-5) for path in job.frames()]
        self.assertEqual(steps[:5], [0, 40, 60, 80, 120])
        end = str(steps[-1] + 100)
        whole = self.good_run(self.put(content), 1, "--steps", end, name="whole")
        run = self.resume(job.dir, 2, "--steps", end)
        self.assertEqual(run.record()["resumed"]["step"], steps[-1])
        self.same(whole, run)
        self.assertEqual(
            [frames.Frame(path).time for path in run.frames()],
            [frames.Frame(path).time for path in whole.frames()],
        )
        done = self.resume(job.dir, 1, "--steps", end)  # with nothing left to do
        self.assertEqual(done.record()["digest"], whole.record()["digest"])


class Wrong(Case):
    def setUp(self):
        super().setUp()
        self.whole_run = self.good_run(
            self.put(robust_jobs.bed(frame_every=20)), 1, "--steps", "50"
        )
        self.end = self.whole_run.record()["digest"]

    def refused(self, says, *args, code=3, folder=None, ranks=(1,)):
        """Said once for all ranks; the results stay."""
        before = sorted(os.listdir(self.whole_run.dir))
        for n in ranks:
            run = self.resume(folder or self.whole_run.dir, n, *args, code=code)
            self.assertEqual(len(re.findall(says, run.err)), 1, run.err)
        self.assertEqual(sorted(os.listdir(self.whole_run.dir)), before)

    def test_damage(self):
        """A damaged newest frame is named and the one before is used: the end is the same."""
        with open(self.whole_run.frames()[-1], "rb") as file:
            data = file.read()
        half = len(data) // 2
        at = data.index(b"angular_velocity")
        for ranks, damaged in (
            (1, data[:half]),
            (3, data[:half] + bytes([data[half] ^ 1]) + data[half + 1 :]),
            (1, data[:at] + b"angular_velocitx" + data[at + 16 :]),
        ):
            with self.subTest(ranks=ranks):
                with open(self.whole_run.frames()[-1], "wb") as file:
                    file.write(damaged)
                run = self.resume(self.whole_run.dir, ranks, "--steps", "50")
                self.assertRegex(
                    run.err,
                    r"\Ademocles: warning: '\S*frame_000003.hdf' cannot be used: .*; trying the "
                    r"frame before it\n",
                )
                self.assertEqual(run.err.count("cannot be used"), 1)
                self.assertEqual(
                    (run.record()["digest"], run.record()["resumed"]["step"]), (self.end, 40)
                )

    def test_none_is_whole(self):
        for path in self.whole_run.frames():
            with open(path, "r+b") as file:
                file.truncate(1000)
        self.refused("no frame in '\\S+' can be used", ranks=(1, 3))

    def test_versions(self):
        """Another version of the format, a dataset less: no damage that a checksum finds."""

        def less(state):
            del state["elements/torque"]

        def other_version(state):
            state.attrs["format_version"] = 99

        newest = self.whole_run.frames()[-1]
        for change, says in (
            (less, r"it has \d+ of \d+ datasets"),
            (other_version, "its format version is 99, this program's"),
        ):
            with h5py.File(newest, "r+") as file:
                change(file["democles"])
            run = self.resume(self.whole_run.dir, 1, "--steps", "50")
            self.assertRegex(run.err, "frame_000003.hdf' cannot be used: " + says)
            self.assertEqual(run.record()["digest"], self.end)

    def test_other_frames(self):
        """None there; made from other input."""
        self.refused("'\\S*nowhere': No such file", folder="/nowhere")
        empty = os.path.join(self.dir, "empty")
        os.mkdir(empty)
        self.refused("contains no frame", folder=empty)
        csv, content = os.path.join(self.dir, "few.csv"), robust_jobs.bed(frame_every=20)
        content["elements"] = [{"name": "few", "material": "glass", "file": "few.csv"}]
        for radius in ("0.002", "0.0021"):
            with open(csv, "w") as file:
                file.write(f"x,y,z,radius\n0.01,0.01,0.01,0.002\n0.02,0.02,0.02,{radius}\n")
            if radius == "0.002":
                self.good_run(self.put(content), 1, "--steps", "20", name="few")
        self.refused("a file that it reads", folder=os.path.join(self.dir, "few"), ranks=(1, 3))
        os.remove(csv)
        self.refused("few.csv", folder=os.path.join(self.dir, "few"))

    def test_what_cannot_change(self):
        for key in (
            "time.step=1e-6",
            "gravity=[0, 0, 1]",
            "method=lattice",
            "elements[0].velocity=[0, 0, 0]",
            "precision=single",
            "time={end: 1}",
        ):
            self.refused("cannot change", "--set", key)
        self.refused("unknown key", "--set", "output.evry=1", ranks=(3,))
        self.refused(
            "step 50, after step 49, with which the run shall end", "--steps", "49", code=2
        )
        self.refused("step 50", "--set", "time.end=2e-4")
        self.refused(
            "energy.csv' has other columns",
            "--set",
            "measure[0]={name: energy, every: 1e-4, momentum: all}",
        )
        self.refused(
            "orientation cannot be added to a restarted run", "--set", "output.fields=[orientation]"
        )

    def test_what_can_change(self):
        """More measures, other frames, another end, where files are; the bits stay."""
        run = self.resume(
            self.whole_run.dir,
            3,
            "--steps",
            "70",
            "--set",
            "output={every: 0.1, fields: [id]}",
            "--set",
            "partition.every=7",
            "--set",
            "measure=[{name: energy, every: 2e-3, energy: all}, {name: probe, every: 2e-4, probe: "
            "{element: 3}}]",
        )
        self.assertIn("probe.csv' is empty", run.err)
        self.assertEqual(len(run.series()["probe.csv"].splitlines()), 3)
        self.assertEqual(frames.scene(run.dir)["partition"]["every"], 7)
        whole = self.good_run(
            self.put(robust_jobs.bed(frame_every=20)), 1, "--steps", "70", name="longer"
        )
        self.assertEqual(
            (run.record()["digest"], run.record()["energy"]),
            (whole.record()["digest"], whole.record()["energy"]),
        )

    def test_another_run(self):
        """Two runs never write into one folder; what a file asked to stop can go on."""
        scene = self.put(robust_jobs.bed(frame_every=20))
        job = self.job(scene, 1, name="busy")
        job.wait_frames(2)
        self.refused("another run is still writing into", folder=job.dir, code=2)
        with open(os.path.join(job.dir, "stop"), "w"):
            pass
        self.assertEqual(job.end(), 75, job.err())
        n = parallel_runs.Run(job.dir, 75, "").record()["steps"]
        self.assertEqual(self.resume(job.dir, 1, "--steps", str(n + 4)).record()["steps"], n + 4)
        self.assertNotIn("stop", os.listdir(job.dir))


if __name__ == "__main__":
    parallel_runs.main(1)
