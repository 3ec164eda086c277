#!/usr/bin/python3
"""The cases of the lattice on many ranks, briefly, and the way to rest: the same bits, and what
happens where there is none. Own arguments: names of tests."""
import os

import parallel_runs

TURNING = [
    "--set",
    "bodies.plate.velocity=[3, -2, 1]",
    "--set",
    "bodies.plate.angular_velocity=[2, 5, -3]",
]


class Cases(parallel_runs.Case):
    def path(self, name):
        return os.path.join(parallel_runs.CASES, name, "scene.yaml")

    def same(self, name, all_ranks, *args):
        """What must not depend on ranks, of a run on each number of them."""
        alone = None
        for ranks in all_ranks:
            with self.subTest(case=name, ranks=ranks):
                run = self.good_run(self.path(name), ranks, *args)
                record = run.record()
                found = {
                    key: record.get(key)
                    for key in ("digest", "steps", "dt", "energy", "momentum", "rest")
                }, run.series()
                self.assertEqual(record["ranks"], ranks)
                self.assertTrue(ranks == 1 or record["halo_bytes_per_step"] > 0)
                alone = alone or found
                self.assertEqual(found, alone)
        return record

    def test_plate(self):
        """All of the plate moves at once, so that every border has something to carry."""
        record = self.same(
            "plate", (1, 2, 3, 4, 8), "--steps", "16", "--set", "output.every=0", *TURNING
        )
        self.assertEqual((record["scheme"], record["elements"]), ("rk4", 51200))

    def test_spinning_block(self):
        record = self.same(
            "spinning_block", (1, 2, 3, 4, 8), "--steps", "300", "--set", "output.every=0"
        )
        self.assertEqual((record["scheme"], record["features"]["turn"]), ("leapfrog", 1))

    def test_rest(self):
        rest = self.same("patch", (1, 3), "--set", "lattice.relax.tolerance=1e-9")["rest"]
        self.assertTrue(rest["reached"])
        self.assertLess(rest["left"], 1e-9)

    def test_no_rest(self):
        """Too early an end, or something that is led for ever: exit code 5,
        with the last frame and the record."""
        for args in (
            ("time.end=0.1ms",),
            ("time.end=0.3ms", "boundaries[0]={where: all, velocity: [free, free, 1]}"),
        ):
            run = self.run_scene(
                self.path("patch"), 2, *(word for arg in args for word in ("--set", arg))
            )
            self.assertEqual(run.code, 5, run.err)
            self.assertEqual(run.err.count("no static equilibrium by time.end"), 1, run.err)
            record = run.record()
            self.assertEqual(
                (record["exit"], record["rest"]["reached"], len(run.frames())), (5, False, 2)
            )
        stopped = self.good_run(self.path("patch"), 1, "--steps", "50").record()
        self.assertFalse(stopped["rest"]["reached"])

    def test_only_leapfrog_goes_there(self):
        run = self.run_scene(self.path("patch"), 1, "--set", "time.scheme=rk4")
        self.assertEqual(run.code, 3, run.err)
        self.assertIn("time.scheme: lattice.relax supports leapfrog only", run.err)


if __name__ == "__main__":
    parallel_runs.main(0)
