#!/usr/bin/python3
"""Scenes with every feature, for a few steps on one rank and on three: the same bits, and not a
word on stderr but warnings; nor after a request to stop. Short, so that sanitizers run them too.
Own arguments: results_tool, the tests."""
import os
import signal

import cli
import parallel_runs
import robust_jobs

# Where nobody looks for leaks: while pocl compiles, for a sanitizer that notes who allocates takes
# a minute for each kernel; and on several ranks, where LeakSanitizer now and then crashes because
# it stops threads, of MPI and pocl, that are ending.
NO_LEAKS = {"ASAN_OPTIONS": "detect_leaks=0"}


class Short(robust_jobs.Case):
    def is_quiet(self, err):
        self.assertEqual(
            [line for line in cli.own_lines(err) if not line.startswith("democles: warning: ")], []
        )

    def runs(self, name, steps):
        scene = self.scene(name)
        first = self.good_run(scene, 1, "--steps", str(steps), name="first", env=NO_LEAKS)
        self.assertGreater(first.record()["rebuilds"], 0)
        for ranks in (1, 3):
            with self.subTest(ranks=ranks):
                run = self.good_run(
                    scene, ranks, "--steps", str(steps), env=NO_LEAKS if ranks > 1 else None
                )
                self.is_quiet(run.err)
                self.assertEqual(run.record()["digest"], first.record()["digest"])
        return first

    def test_few(self):
        run = self.runs("few", 8)
        for wall in ("floor", "rod", "sheet"):
            contacts = [
                line.split(",")[-1] for line in run.series()[wall + ".csv"].splitlines()[1:]
            ]
            self.assertNotEqual(set(contacts), {"0"}, wall)

    def test_mixed(self):
        record = self.runs("mixed", 8).record()
        self.assertEqual(
            (record["elements_removed"], record["elements_left"]), (1, 1)
        )  # one name, and that of 0.1
        for term, value in record["energy"]["end"].items():
            self.assertNotEqual(value, 0, term)

    def test_shear(self):
        self.runs("shear", 70)

    def test_stop(self):
        scene = self.put(robust_jobs.bed(frame_every=20))
        self.good_run(scene, 1, "--steps", "2", env=NO_LEAKS)
        for ranks, rank in ((1, 0), (3, 2)):
            with self.subTest(ranks=ranks):
                job = self.job(scene, ranks, env={**os.environ, **NO_LEAKS})
                job.wait_frames(2)
                job.signal(signal.SIGTERM, rank)
                self.assertEqual(job.end(), 75, job.err())
                self.assertEqual(job.errors(), [])
                self.assertNotIn("Sanitizer", job.err())  # mpirun has its own notice of such an end


if __name__ == "__main__":
    parallel_runs.main(1)
