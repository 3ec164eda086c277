#!/usr/bin/python3
"""Small scenes in oclgrind, a simulated device that reports data races, reads of what was never
written, accesses out of bounds, and wrong calls of the API: it says nothing, and the bits are those
of the processor. Own arguments: the library oclgrind_memory, the folder of kernels, the tests."""
import os
import pathlib
import shutil
import subprocess
import sys

import yaml

import parallel_runs

HANG = 1100  # [s]; a thousand times slower than a processor
# Its compiler's optimiser makes instructions that it does not know (llvm.usub.sat, shuffles with
# undefined lanes), and so does forced inlining.
OPTIONS = [
    "--data-races",
    "--uninitialized",
    "--check-api",
    "--build-options",
    "-cl-opt-disable -Dalways_inline=unused",
]
# Faults that change no value: (file, text, with a fault, what is reported, in which kernel).
FAULTS = [
    (
        "cells.cl",
        "atomic_inc(&count[cell]);",
        "count[cell]++;",
        "data race at global memory",
        "cell_count",
    ),
    (
        "rows.cl",
        "if (!fill) {",
        "if (!fill) { begin[e + 1000000] = 0;",
        "Invalid write of size 4 at global memory",
        "rows",
    ),
    (
        "scan.cl",
        "int here = block[k];",
        "int here = block[k] + 0 * data[n];",
        "Uninitialized value written to global memory",
        "scan_blocks",
    ),
]

LATTICE = {
    "title": "glued",
    "method": "lattice",
    "time": {"end": 1, "scheme": "leapfrog"},
    "gravity": [0, 0, -9.81],
    "materials": {
        "steel": {
            "density": 7900,
            "young": 210e9,
            "poisson": 0.28,
            "damping": {"mass": 120, "link": 1e-8},
        },
        "glue": {
            "density": 1200,
            "young": 3e9,
            "poisson": 0.4,
            "strength": {"tension": 1, "shear": 1, "criterion": "sum"},
        },
    },
    "bodies": [
        {
            "name": "left",
            "material": "steel",
            "cell": 0.01,
            "shape": {"box": {"min": [0, 0, 0], "max": [0.06, 0.02, 0.02]}},
            "angular_velocity": [200, 100, -300],
        },
        {
            "name": "right",
            "material": "glue",
            "cell": 0.01,
            "shape": {"box": {"min": [0.06, 0, 0], "max": [0.1, 0.02, 0.02]}},
            "velocity": [3, -2, 1],
        },
    ],
    "boundaries": [
        {"where": {"box": {"min": [0, 0, 0], "max": [0.01, 0.02, 0.02]}}, "fix": ["x", "ry"]},
        {
            "where": {"box": {"min": [0.02, 0.02, 0], "max": [0.06, 0.02, 0.02]}},
            "pressure": 1e5,
            "history": {"ramp": 1e-6},
        },
    ],
    "measure": [
        {"name": "energy", "every": 1, "energy": "all"},
        {"name": "broken", "every": 1, "broken": "all"},
    ],
    "output": {"every": 0, "fields": ["von_mises", "broken"]},
}


class Oclgrind(parallel_runs.Case):
    def simulate(self, scene, ranks, *args, kernels=None):
        """What was reported, and the run."""
        memory, out = os.path.abspath(parallel_runs.OWN[0]), os.path.join(self.dir, "simulated")
        preload = [
            "sh",
            "-c",
            'LD_PRELOAD="$0:$LD_PRELOAD" exec "$@"',
            memory,
        ]  # before the libraries that oclgrind preloads itself
        command = [parallel_runs.MPIRUN] if ranks > 1 else []
        for rank in range(ranks):
            command += (
                [":"] * (rank > 0)
                + ["-n", "1"] * (ranks > 1)
                + ["oclgrind", *OPTIONS, "--log", os.path.join(self.dir, f"reports_{rank}.txt")]
            )
            command += [*preload, parallel_runs.DEMOCLES, "run", scene, "-o", out, "--quiet", *args]
        env = {
            **os.environ,
            "DEMOCLES_POISON": "1",
            **({"DEMOCLES_KERNELS": kernels} if kernels else {}),
        }
        run = subprocess.run(
            command,
            cwd=self.dir,
            env=env,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
            timeout=HANG,
        )
        reports = ""
        for path in sorted(pathlib.Path(self.dir).glob("reports_*.txt")):
            reports += path.read_text()
        return reports, parallel_runs.Run(out, run.returncode, run.stderr)

    def is_clean(self, scene, ranks, *args):
        alone = self.good_run(scene, 1, *args).record()
        reports, run = self.simulate(scene, ranks, *args)
        self.assertEqual((run.code, reports[:4000]), (0, ""), run.err)
        self.assertNotRegex(run.err, "(?i)oclgrind")
        record = run.record()
        self.assertEqual(
            [device["name"] for device in record["devices"]], ["Oclgrind Simulator"] * ranks
        )
        self.assertEqual(
            (record["digest"], record["rebuilds"]), (alone["digest"], alone["rebuilds"])
        )
        return record

    def rebuilt(self, name, ranks, *args, rebuilds=2):
        record = self.is_clean(self.scene(name), ranks, *args)
        self.assertEqual(record["rebuilds"], rebuilds)
        if ranks > 1:
            self.assertGreater(record["migrations"], 0)

    def test_few(self):
        self.rebuilt("few", 1, "--steps", "2", rebuilds=1)

    def test_few_on_two_ranks(self):
        self.rebuilt("few", 2)

    def test_mixed_on_two_ranks(self):
        """Pairs between them computed on one of them."""
        self.rebuilt("mixed", 2, "--set", "partition.boundary=assigned")

    def test_long_rows(self):
        """Elements so fast that all of them may meet:
        rows that are searched twice and sorted by heap."""
        record = self.is_clean(
            self.scene("apart"),
            1,
            "--steps",
            "2",
            "--precision",
            "single",
            "--set",
            "elements.there.velocity=[8, 0, 0]",
        )
        self.assertGreater(2 * record["interactions"] / record["elements"], 48)

    def test_lattice_on_two_ranks(self):
        """Every feature of the lattice but Runge-Kutta, and links that break at once:
        of the glue, and where it meets steel."""
        path = os.path.join(self.dir, "lattice.yaml")
        with open(path, "w") as file:
            yaml.safe_dump(LATTICE, file)
        record = self.is_clean(path, 2, "--steps", "3")
        self.assertGreater(
            record["broken"]["tension"] + record["broken"]["shear"] + record["broken"]["bending"],
            10,
        )
        self.assertEqual(
            [name for name, value in record["features"].items() if not value], ["rk", "nystrom"]
        )

    def test_lattice_by_runge_kutta(self):
        path = os.path.join(self.dir, "lattice.yaml")
        with open(path, "w") as file:
            yaml.safe_dump({**LATTICE, "time": {**LATTICE["time"], "scheme": "rk4"}}, file)
        record = self.is_clean(path, 1, "--steps", "3")
        self.assertGreater(
            record["broken"]["tension"] + record["broken"]["shear"] + record["broken"]["bending"],
            10,
        )

    def test_faults_are_found(self):
        kernels = os.path.join(self.dir, "kernels")
        shutil.copytree(parallel_runs.OWN[1], kernels)
        for name, text, fault, _, _ in FAULTS:
            (path,) = pathlib.Path(kernels).glob(f"*/{name}")
            source = path.read_text()
            self.assertIn(text, source)
            path.write_text(source.replace(text, fault))
        reports, run = self.simulate(self.scene("few"), 1, "--steps", "1", kernels=kernels)
        for _, _, _, message, kernel in FAULTS:
            self.assertRegex(reports, message + r".*\n.*Kernel: " + kernel, run.err)


if __name__ == "__main__":
    if not shutil.which("oclgrind"):
        print("oclgrind is not installed")
        sys.exit(77)
    parallel_runs.main(2)
