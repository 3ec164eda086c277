#!/usr/bin/python3
"""Who owns what is a choice that changes no bit: methods of partition, periods of repartition, shares that follow measured speed. Own arguments:
names of tests."""
import itertools
import os
import shutil
import subprocess

import yaml

import lattice_runs
import parallel_runs

METHODS = ("geometric", "interactions", "graph")


def keys(**partition):
    return [arg for key, value in partition.items() for arg in ("--set", f"partition.{key}={value}")]


class Partition(parallel_runs.Case):
    def found(self, run):
        record = run.record()
        return [record[key] for key in ("digest", "steps", "elements_left", "rebuilds", "energy", "momentum")], run.series(), run.contacts()

    def check_same(self, scene, alone, ranks, **partition):
        """Runs, compares with one rank, returns the record."""
        with self.subTest(scene=scene, ranks=ranks, **partition):
            run = self.good_run(scene, ranks, *keys(threshold=0, **partition))
            self.assertEqual(self.found(run), alone)
            record = run.record()
            self.assertEqual(record["partition"]["method"], partition["method"])
            self.assertEqual(record["plain_steps"]["allocations"], 0)
            self.assertEqual(sum(rank["elements"] for rank in record["partition"]["ranks"]), record["elements"] - record["elements_left"])
            return record

    def test_particles(self):
        """A column that collapses, with friction and bonds. Each method with each period, each of both with each number of ranks."""
        scene, dealt = self.scene("column"), {}
        alone = self.found(self.good_run(scene, 1))
        for (m, method), (e, every) in itertools.product(enumerate(METHODS), enumerate((0, 37, "auto"))):
            ranks = 2 + (m + e) % 3
            record = self.check_same(scene, alone, ranks, method=method, every=every)
            dealt[every] = dealt.get(every, 0) + record["repartitions"]
            self.assertGreater(record["partition"]["cut"], 0)
            self.assertTrue(1 <= record["partition"]["neighbours"]["mean"] <= record["partition"]["neighbours"]["max"] < ranks)
            if every == 37:
                self.assertGreater(record["migrations"], 0)
        self.assertEqual(dealt[0], 0)
        self.assertGreater(dealt[37], 10)
        self.assertGreater(dealt["auto"], 0)  # the first is made as soon as it would save anything

    def test_periodic(self):
        """Parts that are not boxes, across faces that repeat; elements of many sizes; some that leave; more ranks than elements."""
        for name, ranks in (("gas_xy", 4), ("hertz", 3), ("leaving", 3), ("three", 5)):
            scene = self.scene(name)
            alone = self.found(self.good_run(scene, 1))
            self.check_same(scene, alone, ranks, method="graph", every=10)

    def slow_kernels(self):
        """Kernels that take longer and do the same."""
        folder = os.path.join(self.dir, "slow")
        shutil.copytree(os.path.join(os.path.dirname(parallel_runs.CASES), "kernels"), folder)
        path, begin = os.path.join(folder, "gather.cl"), "    real4 f = (real4)(0), t = (real4)(0);\n"
        with open(path) as file:
            text = file.read()
        self.assertEqual(text.count(begin), 1)
        waste = ("    real waste = (real)e;\n    for (int k = 0; k < 4000; k++) waste = waste * (real)0.999 + (real)1.5;\n"
                 "    if (waste < 0) f.s0 = waste;\n")
        with open(path, "w") as file:
            file.write(text.replace(begin, begin + waste))
        return folder

    def test_unlike(self):
        """Two ranks, one on a device that takes several times as long, here by kernels with a delay: its share becomes the smaller one, whatever
        rank it is, and the bits stay."""
        scene, slow = self.scene("column"), self.slow_kernels()
        alone = self.good_run(scene, 1).record()["digest"]
        for method, rank in (("geometric", 0), ("graph", 1)):
            args = ["run", scene, "-o", os.path.join(self.dir, "unlike"), "--force", "--quiet",
                    *keys(method=method, weights="measured", every=37, threshold=0)]
            part = [["-n", "1", *(["env", f"DEMOCLES_KERNELS={slow}"] if r == rank else []), parallel_runs.DEMOCLES, *args] for r in range(2)]
            with self.subTest(method=method, slow=rank):
                run = subprocess.run([parallel_runs.MPIRUN, *parallel_runs.MPIRUN_ARGS, *part[0], ":", *part[1]], cwd=self.dir,
                                     capture_output=True, text=True, timeout=parallel_runs.HANG)
                self.assertEqual(run.returncode, 0, run.stderr)
                record = parallel_runs.Run(args[3], 0, "").record()
                ranks = record["partition"]["ranks"]
                self.assertEqual(record["digest"], alone)
                self.assertLess(ranks[rank]["share"], 0.4)
                self.assertLess(ranks[rank]["work"], 0.8 * ranks[1 - rank]["work"])

    def test_lattice(self):
        scene = os.path.join(self.dir, "lattice.yaml")
        with open(scene, "w") as file:
            yaml.safe_dump(lattice_runs.block("leapfrog"), file)
        alone = self.good_run(scene, 1, "--steps", "60").record()["digest"]
        for method, ranks, weights in (("geometric", 2, "measured"), ("interactions", 3, "interactions"), ("graph", 2, "interactions"),
                                       ("graph", 4, "interactions"), ("graph", 3, "measured")):
            with self.subTest(method=method, ranks=ranks, weights=weights):
                record = self.good_run(scene, ranks, "--steps", "60", *keys(method=method, weights=weights)).record()
                self.assertEqual(record["digest"], alone)
                self.assertGreater(record["partition"]["cut"], 0)
                self.assertEqual(sum(rank["elements"] for rank in record["partition"]["ranks"]), record["elements"])
                if weights == "interactions":
                    self.assertLess(record["imbalance"]["max"], 0.1)


if __name__ == "__main__":
    parallel_runs.main(0)
