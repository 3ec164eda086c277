#!/usr/bin/python3
"""Requests to stop at any moment, the set-up above all: a frame and exit code 75, or the end of a
program that has not begun yet; the run that goes on is the one that was never stopped. Own
arguments: results_tool, the tests. DEMOCLES_SEED changes what is random."""
import os
import random
import signal
import sys
import time

import parallel_runs
import resume_runs
import robust_jobs

STEPS = 300
SIGNALS = (signal.SIGUSR1, signal.SIGINT, signal.SIGTERM)


class Stopped(resume_runs.Case):
    def setUp(self):
        super().setUp()
        self.path = self.put(robust_jobs.bed(frame_every=100))
        self.digest = self.good_run(self.path, 1, "--steps", str(STEPS)).record()["digest"]
        self.counts = {"stopped": 0, "complete": 0, "not begun": 0}

    def tearDown(self):
        print(f"{self.id()}: {self.counts}", file=sys.stderr)

    def goes_on(self, folder, ranks=1):
        run = self.resume(folder, ranks, "--steps", str(STEPS))
        self.assertEqual(run.record()["digest"], self.digest)

    def stop(self, number, ranks, delay=None, place=None):
        """After some seconds, or when the folder has this file."""
        what = f"{signal.Signals(number).name} on {ranks} after {delay} s, {place}"
        job = self.job(self.path, ranks, "--steps", str(STEPS), name="stopped")
        if place:
            path, end = os.path.join(job.dir, place), time.monotonic() + robust_jobs.SOON
            while not os.path.exists(path) and time.monotonic() < end:
                time.sleep(0.001)
        time.sleep(delay or 0)
        while job.process.poll() is None:
            try:
                job.signal(number, random.randrange(ranks))
                break
            except (AssertionError, ProcessLookupError):  # ranks that are not there yet
                time.sleep(0.01)
        code = job.end()
        if not os.path.exists(job.dir):
            self.counts["not begun"] += 1
            return
        self.assertIn(code, (0, 75), f"{what}: {job.err()}")
        self.assertEqual(job.errors(), [], what)
        self.assertEqual(
            [name for name in os.listdir(job.dir) if name.endswith((".cl", ".tmp"))], [], what
        )
        self.counts["stopped" if code == 75 else "complete"] += 1
        self.whole(job.dir)
        self.goes_on(job.dir)

    def test_set_up(self):
        """Each of the signals, while kernels are built: the log is there, no frame yet."""
        for number, delay in zip(SIGNALS, (0.05, 0.15, 0.0)):
            self.stop(number, 1, delay, "log.txt")
        self.assertEqual(self.counts, {"stopped": 3, "complete": 0, "not begun": 0})

    def test_hundred(self):
        """Any moment of set-up, loop and output, on one rank and two; of a run that goes on too."""
        chance = random.Random(os.environ.get("DEMOCLES_SEED", "7"))
        for k in range(100):
            place = chance.choice((None, None, "log.txt", "resolved.yaml", "frame_000000.hdf"))
            self.stop(chance.choice(SIGNALS), chance.choice((1, 1, 2)), chance.random(), place)
        self.assertGreater(self.counts["stopped"], 30)


if __name__ == "__main__":
    parallel_runs.main(1)
