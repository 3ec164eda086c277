#!/usr/bin/python3
"""The lattice through the program: the same bits on any number of ranks, closed forms, what is
refused. Own arguments: `some` or `all` of the precisions and ranks, names of tests."""
import csv
import math
import os

import numpy
import yaml

import parallel_runs
from parallel_runs import frames

STEEL = {"density": 7900, "young": 210e9, "poisson": 0.28}


def plate(steps, **time):
    """The seed's plate, coarse: held along a part of one edge, a force at a corner, damped."""
    return {
        "title": "plate",
        "method": "lattice",
        "time": {"end": 1, "scheme": "rk4", **time},
        "materials": {"steel": {**STEEL, "damping": {"mass": 120}}},
        "bodies": [
            {
                "name": "plate",
                "material": "steel",
                "cell": 0.02,
                "shape": {"box": {"min": [0, 0, 0], "max": [0.8, 0.6, 0.04]}},
            }
        ],
        "boundaries": [
            {
                "where": {"box": {"min": [0.77, 0.2, -1], "max": [0.81, 0.5, 1]}},
                "fix": ["x", "y", "z", "rx", "ry", "rz"],
            },
            {
                "where": {"box": {"min": [-1, -1, -1], "max": [0.05, 0.05, 1]}},
                "force": [0, 0, -1000],
                "history": {"ramp": 1e-5},
            },
        ],
        "measure": [{"name": "corner", "every": 1e-5, "probe": {"at": [0, 0, 0.02]}}],
        "output": {"every": 0},
    }


def block(scheme):
    """Two materials with a hole, spinning and flying, links that are damped by little."""
    soft = {"density": 1200, "young": 3e9, "poisson": 0.4}
    return {
        "title": "block",
        "method": "lattice",
        "time": {"end": 1, "scheme": scheme},
        "materials": {"steel": STEEL, "soft": soft},
        "bodies": [
            {
                "name": "left",
                "material": "steel",
                "cell": 0.01,
                "shape": {"box": {"min": [0, 0, 0], "max": [0.2, 0.07, 0.05]}},
                "minus": [
                    {"cylinder": {"from": [0.1, 0.035, -1], "to": [0.1, 0.035, 1], "radius": 0.02}}
                ],
                "velocity": [3, -2, 1],
                "angular_velocity": [200, 100, -300],
            },
            {
                "name": "right",
                "material": "soft",
                "cell": 0.01,
                "shape": {"box": {"min": [0.2, 0, 0], "max": [0.33, 0.05, 0.03]}},
                "velocity": [3, -2, 1],
                "angular_velocity": [200, 100, -300],
            },
        ],
        "measure": [{"name": "end", "every": 2e-6, "probe": {"at": [0.33, 0, 0]}}],
        "output": {"every": 0},
    }


def torn(principal=False):
    """cases/notched_bar with coarse cells, its load so fast that it breaks within 300 steps."""
    with open(os.path.join(parallel_runs.CASES, "notched_bar", "scene.yaml")) as file:
        scene = yaml.safe_load(file)
    scene["bodies"][0].update(
        cell=0.002, shape={"box": {"min": [0, 0, 0], "max": [0.12, 0.04, 0.002]}}
    )
    for load in scene["boundaries"]:
        load["where"]["box"]["max"][2] = 0.002
        load["force"] = [math.copysign(500, float(load["force"][0].split()[0])), 0, 0]
        load["history"] = {"ramp": 2.5e-5}
    if principal:
        scene["materials"]["glass"]["strength"]["criterion"] = "principal"
    scene["output"] = {"every": 0, "fields": ["broken"]}
    for measure in scene["measure"]:
        measure["every"] = 1e-6
    return scene


def some():
    """Whether this is the part for scripts/test, not all of it."""
    return parallel_runs.OWN[0] == "some"


class Lattice(parallel_runs.Case):
    def put(self, scene):
        path = os.path.join(self.dir, "scene.yaml")
        with open(path, "w") as file:
            yaml.safe_dump(scene, file)
        return path

    def rows(self, run, name):
        with open(os.path.join(run.dir, name + ".csv")) as file:
            return [[float(v) for v in row] for row in list(csv.reader(file))[1:]]

    def test_ranks(self):
        for name, scene in (
            ("plate", plate(40)),
            ("leapfrog", block("leapfrog")),
            ("pefrl", block("pefrl")),
        ):
            all_ranks = (1, 3) if name == "pefrl" else (1, 2, 3, 4, 8)
            for precision, ranks in (("double", all_ranks), ("single", (1, 3))):
                alone = None
                for n in ranks:
                    with self.subTest(scene=name, precision=precision, ranks=n):
                        run = self.good_run(
                            self.put(scene), n, "--precision", precision, "--steps", "60"
                        )
                        record = run.record()
                        found = [
                            record[key]
                            for key in ("digest", "steps", "dt", "elements", "interactions")
                        ], run.series()
                        alone = alone or found
                        self.assertEqual(found, alone)
                        self.assertEqual(record["plain_steps"]["allocations"], 0)
                        self.assertTrue(n == 1 or record["halo_bytes_per_step"] > 0)

    def test_breakage(self):
        """The same bits, counts and broken links on any number of ranks; frames,
        series and record agree."""
        pairs = (
            ("double", "leapfrog", (1, 3)),  # whose kernels resume_runs.py has too
            ("double", "rk4", (1, 3, 4)),
            ("single", "pefrl", (1, 2)),
        )
        for precision, scheme, ranks in pairs[:1] if some() else pairs:
            alone, scene = None, torn(principal=scheme == "pefrl")
            scene["time"] = {**scene["time"], "scheme": scheme, "step": 1.5e-7}
            for n in ranks:
                with self.subTest(scheme=scheme, ranks=n):
                    run = self.good_run(
                        self.put(scene), n, "--precision", precision, "--steps", "300"
                    )
                    record, frame = run.record(), frames.Frame(run.frames()[-1])
                    order = numpy.argsort(frame.field("id"))
                    links, fate, lost = (
                        frame.field(name)[order] for name in ("links", "fate", "broken")
                    )
                    found = [
                        record["digest"],
                        record["broken"],
                        run.series(),
                        links.tolist(),
                        fate.tolist(),
                        lost.tolist(),
                    ]
                    alone = alone or found
                    self.assertEqual(found, alone)
                    self.assertEqual(record["plain_steps"]["allocations"], 0)
                    modes = [
                        sum(int(((fate >> shift & 7) == mode).sum()) for shift in (0, 3, 6))
                        for mode in (1, 2, 3, 4)
                    ]
                    counted = [
                        record["broken"][name] for name in ("tension", "shear", "bending", "twist")
                    ]
                    self.assertEqual(modes, counted)
                    self.assertEqual(self.rows(run, "broken")[-1][1:], counted)
                    self.assertEqual(int(lost.sum()), 2 * sum(counted))
                    first = frames.Frame(run.frames()[0])
                    whole = first.field("links")[numpy.argsort(first.field("id"))]
                    gone = numpy.array([bin(mask).count("1") for mask in (whole & ~links).tolist()])
                    self.assertEqual(gone.tolist(), lost.tolist())
                    self.assertGreater(sum(counted), 10)

    def test_free_chain_rings(self):
        """A row of cells between two ends that start with opposite velocities: mode k = 1 of the
        free chain, w = 2 sqrt(kn/m) sin(pi/(2 N)), whose velocities at the start, cos(pi (i +
        1/2)/N), are given cell by cell. With z = w dt the phase is off by z^2/24 (leapfrog),
        z^4/120 (rk4) of itself: 5.2e-4, 1.0e-7 after two periods of 200 steps; pefrl by less."""
        n, h, young, density = 8, 0.01, 2e9, 1000
        stiffness, mass = young * h, density * h**3
        w = 2 * math.sqrt(stiffness / mass) * math.sin(math.pi / (2 * n))
        bodies = [
            {
                "name": f"c{i}",
                "material": "m",
                "cell": h,
                "shape": {"box": {"min": [i * h, 0, 0], "max": [(i + 1) * h, h, h]}},
                "velocity": [0.1 * math.cos(math.pi * (i + 0.5) / n), 0, 0],
            }
            for i in range(n)
        ]
        period = 2 * math.pi / w
        for scheme, least in (("leapfrog", 5.3e-4), ("rk4", 1.2e-7), ("pefrl", 2e-9)):
            scene = {
                "title": "chain",
                "method": "lattice",
                "time": {"end": 2 * period, "step": period / 200, "scheme": scheme},
                "materials": {"m": {"density": density, "young": young, "poisson": 0}},
                "bodies": bodies,
                "measure": [{"name": "end", "every": period / 200, "probe": {"at": [0, 0, 0]}}],
                "output": {"every": 0},
            }
            run = self.good_run(self.put(scene), 1)
            amplitude = 0.1 * math.cos(math.pi * 0.5 / n) / w
            rows = self.rows(run, "end")
            worst = max(abs(row[4] - amplitude * math.sin(w * row[0])) for row in rows) / amplitude
            self.assertGreater(len(rows), 390)
            self.assertLess(worst, least, scheme)

    def test_free_flight_and_spin(self):
        """A stiff cube that flies and turns keeps its velocity and axis; frames show hexahedra of
        the right size, wherever it has turned to."""
        spin = numpy.array([300.0, -200.0, 100.0])
        scene = {
            "title": "flight",
            "method": "lattice",
            "time": {"end": 5e-3, "scheme": "leapfrog"},
            "materials": {"steel": STEEL},
            "bodies": [
                {
                    "name": "b",
                    "material": "steel",
                    "cell": 0.01,
                    "shape": {"box": {"min": [0, 0, 0], "max": [0.02, 0.02, 0.02]}},
                    "velocity": [1, 2, 3],
                    "angular_velocity": [float(v) for v in spin],
                }
            ],
            "output": {"every": 0},
        }
        run = self.good_run(self.put(scene), 2)
        first, last = (frames.Frame(path) for path in (run.frames()[0], run.frames()[-1]))
        t = last.time
        self.assertEqual(first.corners.shape, (8, 8, 3))
        self.assertLess(
            numpy.abs((last.points - first.points).mean(axis=0) - t * numpy.array([1, 2, 3])).max(),
            1e-6,
        )
        edges = (last.corners + last.displacement)[:, 1] - (last.corners + last.displacement)[:, 0]
        lengths = numpy.linalg.norm(edges, axis=1)
        self.assertLess(abs(lengths / 0.01 - 1).max(), 2e-3)
        turned = math.acos(numpy.clip(edges[0] @ [1, 0, 0] / lengths[0], -1, 1))
        angle, axis = numpy.linalg.norm(spin) * t, spin / numpy.linalg.norm(spin)
        expected = math.acos(math.cos(angle) + (1 - math.cos(angle)) * axis[0] ** 2)
        self.assertLess(abs(turned - expected), 5e-3)
        self.assertEqual(sorted(last.field("id").tolist()), list(range(8)))

    def test_strained(self):
        """A bar pulled by a quarter: its links along the pull are beyond the range of their law,
        on any ranks; by a twentieth, none is."""
        ends = {
            side: {"box": {"min": [x - 1e-3, -1, -1], "max": [x + 1e-3, 1, 1]}}
            for side, x in ((-1, 5e-3), (1, 75e-3))
        }
        rubber = {"density": 1000, "young": 1e6, "poisson": 0.3, "damping": {"mass": 1000}}
        scene = {
            "title": "pulled",
            "method": "lattice",
            "time": {"end": 0.01},
            "materials": {"rubber": rubber},
            "bodies": [
                {
                    "name": "bar",
                    "material": "rubber",
                    "cell": 0.01,
                    "shape": {"box": {"min": [0, 0, 0], "max": [0.08, 0.02, 0.02]}},
                }
            ],
            "boundaries": [
                {"where": ends[side], "velocity": [side * 0.875, "free", "free"]}
                for side in (-1, 1)
            ],
            "output": {"every": 0},
        }
        for ranks in (3,) if some() else (1, 3):
            run = self.good_run(self.put(scene), ranks)
            self.assertEqual(run.record()["strained_links"], 28)
            with open(os.path.join(run.dir, "log.txt")) as file:
                self.assertEqual(file.read().count("28 links are strained by more than 10 %"), 1)
        scene["time"]["end"] = 2e-3
        self.assertEqual(self.good_run(self.put(scene), 1).record()["strained_links"], 0)

    def test_probes(self):
        """A probe's rotation and stress are those of the frame at the same cell, and have the same
        bits on any number of ranks."""
        fields = ["von_mises", "rotation", "stress"]
        for rotation, turn in (("finite", "wxyz"), ("small", "xyz")):
            if some() and rotation == "small":
                continue
            scene, alone = block("leapfrog"), None
            scene.update(
                lattice={"rotation": rotation}, output={"every": 0, "fields": [*fields, "id"]}
            )
            scene["measure"][0].update(
                every=1e-9, probe={"at": [0.33, 0, 0], "fields": [*fields, "velocity"]}
            )
            for n in (1, 3):
                with self.subTest(rotation=rotation, ranks=n):
                    run = self.good_run(self.put(scene), n, "--steps", "20")
                    with open(os.path.join(run.dir, "end.csv")) as file:
                        titles, *rows = csv.reader(file)
                    self.assertEqual(
                        [title.split()[0] for title in titles[13:]],
                        [
                            "von_mises",
                            *("rotation_" + c for c in turn),
                            *(f"stress_{a}{b}" for a in "xyz" for b in "xyz"),
                        ],
                    )
                    for path, row in zip(run.frames(), (rows[0], rows[-1])):
                        frame, found = frames.Frame(path), numpy.array([float(v) for v in row])
                        cell = numpy.abs(frame.points - [0.325, 0.005, 0.005]).sum(axis=1).argmin()
                        shown = [
                            frame.field("von_mises")[cell],
                            *frame.field("rotation")[cell][: len(turn)],
                            *frame.field("stress")[cell],
                        ]
                        self.assertEqual(found[13:].tolist(), [float(v) for v in shown])
                        self.assertEqual((frame.time, len(found)), (found[0], 13 + 10 + len(turn)))
                    self.assertGreater(abs(found[13:]).min(), 0)
                    alone = alone or run.series()
                    self.assertEqual(run.series(), alone)

    def test_refused(self):
        """A step over the limit ends the run with exit code 5 at once; where it is allowed, as
        soon as the energy cannot be measured or a number is none. No file holds NaN."""
        over = block("leapfrog")  # whose kernels other tests have
        over["time"]["step"] = 1e-5
        run = self.run_scene(self.put(over), 2)
        self.assertEqual(run.code, 5)
        self.assertIn("exceeds the critical time step", run.err)
        over["time"]["allow_unstable"] = True
        run = self.run_scene(self.put(over), 1, "--steps", "2000")
        self.assertEqual(run.code, 5, run.err)
        self.assertIn("are not numbers", run.err)
        self.assertIn("of the critical one", run.err)
        over["measure"] = [{"name": "energy", "every": 2e-5, "energy": "all"}]
        run = self.run_scene(self.put(over), 3, "--steps", "2000")
        self.assertEqual(run.code, 5, run.err)
        self.assertRegex(run.err, r"step \d+, t = \S+ s: the energy is not a number, or too large")
        self.assertNotIn("nan", run.series()["energy.csv"])
        self.assertEqual(run.record()["exit"], 5)


if __name__ == "__main__":
    parallel_runs.main(1)
