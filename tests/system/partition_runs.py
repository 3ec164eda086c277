#!/usr/bin/python3
"""Who owns what is a choice that changes no bit: methods of partition, periods of repartition,
shares that follow measured speed. Own arguments: names of tests."""
import itertools
import os
import re
import shutil
import subprocess

import yaml

import lattice_runs
import parallel_runs

METHODS = ("geometric", "interactions", "graph")


def keys(**partition):
    return [
        arg for key, value in partition.items() for arg in ("--set", f"partition.{key}={value}")
    ]


class Partition(parallel_runs.Case):
    def found(self, run):
        record = run.record()
        frame = parallel_runs.frames.Frame(run.frames()[-1])
        touching = (
            sorted(zip(frame.field("id"), frame.field("coordination")))
            if "coordination" in frame.names
            else None
        )
        same = [
            record[key]
            for key in (
                "digest",
                "steps",
                "dt_limit",
                "elements_removed",
                "rebuilds",
                "energy",
                "momentum",
            )
        ]
        return same, run.series(), run.contacts(), touching

    def work(self, record):
        return sum(rank["work"] for rank in record["partition"]["ranks"])

    def check_same(self, scene, alone, ranks, *args, **partition):
        """Runs, compares with one rank, returns the record."""
        with self.subTest(scene=scene, ranks=ranks, **partition):
            run = self.good_run(scene, ranks, *args, *keys(threshold=0, **partition))
            self.assertEqual(self.found(run), alone)
            record = run.record()
            self.assertEqual(record["partition"]["method"], partition["method"])
            self.assertEqual(record["plain_steps"]["allocations"], 0)
            self.assertEqual(
                sum(rank["elements"] for rank in record["partition"]["ranks"]),
                record["elements"] - record["elements_removed"],
            )
            return record

    def test_particles(self):
        """A column that collapses, with friction and bonds. Each method, each period and each
        number of ranks once."""
        self.deal((m, m) for m in range(3))

    def test_particles_all(self):
        """Each method with each period, each of both with each number of ranks."""
        self.deal(itertools.product(range(3), range(3)))

    def deal(self, pairs):
        """pairs: of numbers of methods and periods."""
        scene, dealt, periods = self.scene("column"), {}, (0, 37, "auto")
        alone = self.found(self.good_run(scene, 1))
        for m, e in pairs:
            method, every, ranks = METHODS[m], periods[e], 2 + (m + e) % 3
            record = self.check_same(scene, alone, ranks, method=method, every=every)
            dealt[every] = dealt.get(every, 0) + record["repartitions"]
            self.assertGreater(record["partition"]["cut"], 0)
            self.assertTrue(
                1
                <= record["partition"]["neighbours"]["mean"]
                <= record["partition"]["neighbours"]["max"]
                < ranks
            )
            if every == 37:
                self.assertGreater(record["migrations"], 0)
        self.assertEqual(dealt[0], 0)
        self.assertGreater(dealt[37], 10)
        self.assertGreater(dealt["auto"], 0)  # the first is made as soon as it would save anything

    def test_periodic(self):
        """Parts that are not boxes, across faces that repeat; elements of many sizes; some that
        leave; more ranks than elements."""
        for name, ranks in (("gas_xy", 4), ("hertz", 3), ("leaving", 3), ("three", 5)):
            scene = self.scene(name)
            alone = self.found(self.good_run(scene, 1))
            self.check_same(scene, alone, ranks, method="graph", every=10)

    def test_assigned(self):
        """Pairs of two ranks computed on one of them: friction, bonds, rolling, sizes, periodic
        faces, elements that leave. All ranks together compute what one does alone."""
        self.assigned(
            ("column", (("geometric", 2, 0), ("graph", 3, 37))),
            ("leaving", (("interactions", 3, 37),)),
        )

    def test_assigned_all(self):
        self.assigned(
            ("column", (("interactions", 8, "auto"),)),
            ("hertz", (("graph", 4, 37),)),
            ("leaving", (("geometric", 3, 37),)),
            ("gas_xy", (("graph", 3, 37),)),
        )

    def assigned(self, *scenes):
        """scenes: (name, ((method, ranks, period), ...)), ..."""
        fields = ("--set", "output.fields=[coordination]")
        for name, runs in scenes:
            scene = self.scene(name)
            run = self.good_run(scene, 1, *fields)
            alone, work = self.found(run), self.work(run.record())
            for method, ranks, every in runs:
                record = self.check_same(
                    scene, alone, ranks, *fields, method=method, every=every, boundary="assigned"
                )
                self.assertEqual(record["partition"]["boundary"], "assigned")
                self.assertEqual(self.work(record), work)
                self.assertGreater(record["partition"]["cut"], 0)

    def test_record(self):
        """The balance over time, with --profile: a line for each build of lists after the first."""
        run = self.good_run(self.scene("column"), 3, "--profile", *keys(every=37, threshold=0))
        record = run.record()
        with open(os.path.join(run.dir, "run.balance.csv")) as file:
            header, *lines = [line.strip().split(",") for line in file]
        self.assertEqual(
            header,
            ["time [s]", "imbalance [1]", "work [1]", "cut [1]", "repartitions [1]", "moved [1]"],
        )
        self.assertEqual(len(lines), record["rebuilds"])
        self.assertEqual(int(lines[-1][4]), record["repartitions"])
        self.assertLessEqual(max(float(line[1]) for line in lines), record["imbalance"]["max"])

    def test_threshold(self):
        """Elements are dealt out until the lists that steps go on with are shared out evenly
        enough, not those of before."""
        worst = {}
        for every in (0, 1):
            run = self.good_run(
                self.scene("column"), 3, "--profile", *keys(every=every, threshold=0.04)
            )
            with open(os.path.join(run.dir, "run.balance.csv")) as file:
                worst[every] = max(float(line.split(",")[1]) for line in list(file)[1:])
            self.assertGreaterEqual(run.record()["imbalance"]["max"], worst[every])
        self.assertGreater(worst[0], 0.2)
        self.assertLessEqual(worst[1], 0.04)

    def unlike_run(self, scene, before, after, *args):
        """Two ranks, with words of their own before the program
        and after all others. Returns the record."""
        folder = os.path.join(self.dir, "unlike")
        part = [
            [
                "-n",
                "1",
                *before[r],
                parallel_runs.DEMOCLES,
                "run",
                scene,
                "-o",
                folder,
                "--force",
                "--quiet",
                *args,
                *after[r],
            ]
            for r in range(2)
        ]
        run = subprocess.run(
            [parallel_runs.MPIRUN, *part[0], ":", *part[1]],
            cwd=self.dir,
            capture_output=True,
            text=True,
            timeout=parallel_runs.HANG,
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        return parallel_runs.Run(folder, 0, "").record()

    def slow_kernels(self):
        """Kernels that take longer and do the same."""
        folder = os.path.join(self.dir, "slow")
        shutil.copytree(os.path.join(os.path.dirname(parallel_runs.CASES), "kernels"), folder)
        path, begin = (
            os.path.join(folder, "particle", "gather.cl"),
            "    real4 f = (real4)(0), t = (real4)(0);\n",
        )
        with open(path) as file:
            text = file.read()
        self.assertEqual(text.count(begin), 1)
        waste = (
            "    real waste = (real)e;\n    for (int k = 0; k < 4000; k++) waste = waste * "
            "(real)0.999 + (real)1.5;\n"
            "    if (waste < 0) f.s0 = waste;\n"
        )
        with open(path, "w") as file:
            file.write(text.replace(begin, begin + waste))
        return folder

    def test_unlike(self):
        """Two ranks, one on a device that takes several times as long, here by kernels with a
        delay: its share becomes the smaller one, whatever rank it is, and the bits stay."""
        scene, slow = self.scene("column"), self.slow_kernels()
        alone = self.good_run(scene, 1).record()["digest"]
        for method, rank in (("geometric", 0), ("graph", 1)):
            with self.subTest(method=method, slow=rank):
                env = [["env", f"DEMOCLES_KERNELS={slow}"] if r == rank else [] for r in range(2)]
                record = self.unlike_run(
                    scene,
                    env,
                    [[], []],
                    *keys(method=method, weights="measured", every=37, threshold=0),
                )
                ranks = record["partition"]["ranks"]
                self.assertEqual(record["digest"], alone)
                self.assertLess(ranks[rank]["share"], 0.4)
                self.assertLess(ranks[rank]["work"], 0.8 * ranks[1 - rank]["work"])

    def test_implementations(self):
        """One rank on pocl, one on Mesa's rusticl, which has no double precision: the bits of
        either alone, and the slower one gets less to do."""
        os.environ["RUSTICL_ENABLE"] = "llvmpipe"
        name = ["(?:pthread|basic|cpu)", "llvmpipe"]  # pocl's drivers, with and without threads
        listed = subprocess.run(
            [parallel_runs.DEMOCLES, "devices"], capture_output=True, text=True, check=True
        ).stdout
        index = [re.search(rf"^(\d+:\d+)\s+{kind}", listed, re.M) for kind in name]
        if not all(index):
            self.skipTest("there are no two implementations of OpenCL, pocl and rusticl")
        device = [["--device", found[1]] for found in index]
        column = self.scene("column")
        refused = self.run_scene(column, 1, "--precision", "single", *device[1])
        self.assertEqual(refused.code, 4)
        self.assertIn("a measure of energy needs double precision", refused.err)
        with open(column) as file:
            content = yaml.safe_load(file)
        content.pop("measure", None)  # energies are summed in double precision
        scene = os.path.join(self.dir, "bare.yaml")
        with open(scene, "w") as file:
            yaml.safe_dump(content, file)
        steps = ["--precision", "single", "--steps", "150"]
        digests = {self.good_run(scene, 1, *steps, *which).record()["digest"] for which in device}
        record = self.unlike_run(
            scene, [[], []], device, *steps, *keys(weights="measured", every=37, threshold=0)
        )
        self.assertEqual(digests, {record["digest"]})
        with open(os.path.join(self.dir, "unlike", "log.txt")) as file:
            log = file.read()
        for part, kind in zip(record["devices"], name):
            self.assertRegex(part["name"], kind)
            self.assertRegex(log, rf"(?m)^1 rank on {kind}")
        ranks = record["partition"]["ranks"]
        self.assertLess(ranks[1]["work"], ranks[0]["work"])

    def test_lattice(self):
        self.deal_cells(("interactions", 3, "interactions"), ("graph", 3, "measured"))

    def test_lattice_all(self):
        self.deal_cells(
            ("geometric", 2, "measured"),
            ("graph", 4, "interactions"),
        )

    def deal_cells(self, *runs):
        scene = os.path.join(self.dir, "lattice.yaml")
        with open(scene, "w") as file:
            yaml.safe_dump(lattice_runs.block("leapfrog"), file)
        alone = self.good_run(scene, 1, "--steps", "60").record()["digest"]
        for method, ranks, weights in runs:
            with self.subTest(method=method, ranks=ranks, weights=weights):
                record = self.good_run(
                    scene, ranks, "--steps", "60", *keys(method=method, weights=weights)
                ).record()
                self.assertEqual(record["digest"], alone)
                self.assertGreater(record["partition"]["cut"], 0)
                self.assertEqual(
                    sum(rank["elements"] for rank in record["partition"]["ranks"]),
                    record["elements"],
                )
                if weights == "interactions":
                    self.assertLess(record["imbalance"]["max"], 0.1)


if __name__ == "__main__":
    parallel_runs.main(0)
