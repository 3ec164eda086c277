#!/usr/bin/python3
"""Signals at any moment, the set-up above all: of those that ask to stop, a frame and exit code 75,
or the end of a program that has not begun yet; of one that kills, whole frames. The run that goes
on, once or more often, is the one that was never stopped. Own arguments: results_tool, the tests.
DEMOCLES_SEED changes what is random."""
import os
import random
import signal
import sys
import time

import lattice_runs
import parallel_runs
import resume_runs
import robust_jobs

STEPS = 300
SIGNALS = (signal.SIGUSR1, signal.SIGINT, signal.SIGTERM)


class Stopped(resume_runs.Case):
    def setUp(self):
        super().setUp()
        self.counts = {"stopped": 0, "complete": 0, "not begun": 0, "killed": 0}
        self.particles()

    def tearDown(self):
        print(f"{self.id()}: {self.counts}", file=sys.stderr)

    def particles(self):
        self.use(robust_jobs.bed(frame_every=100))

    def lattice(self):
        """A bar that breaks."""
        scene = lattice_runs.torn()
        scene["output"] = {"every": 2e-5}
        self.use(scene)

    def use(self, scene):
        self.path = self.put(scene)
        whole = self.good_run(self.path, 1, "--steps", str(STEPS), name="whole")
        self.digest = whole.record()["digest"]

    def goes_on(self, folder, ranks=1):
        """From the newest frame, or from the start where none was written."""
        if self.whole(folder):
            run = self.resume(folder, ranks, "--steps", str(STEPS))
        else:
            args = ("--steps", str(STEPS), "--force")
            run = self.good_run(self.path, ranks, *args, name=os.path.basename(folder))
        self.assertEqual(run.record()["digest"], self.digest)
        self.assertEqual(self.leftovers(folder), [])

    def stop(self, number, ranks, delay=None, place=None, again=False):
        """After some seconds, or when the folder has this file. again: a run that goes on. Returns
        the folder, or None where there is none yet."""
        what = f"{signal.Signals(number).name} on {ranks} after {delay} s, {place}, again: {again}"
        scene = None if again else self.path
        job = self.job(scene, ranks, "--steps", str(STEPS), name="stopped")
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
        self.assertEqual(job.errors(), [], what)
        if not os.path.exists(job.dir) or (again and code not in (0, 75)):
            self.assertIn(code, (-number, 128 + number, 1, 75), f"{what}: {job.err()}")
            self.counts["not begun"] += 1
        elif number == signal.SIGKILL and code != 0:
            self.assertIn(code, (-signal.SIGKILL, 128 + signal.SIGKILL), f"{what}: {job.err()}")
            self.counts["killed"] += 1
        else:
            self.assertIn(code, (0, 75), f"{what}: {job.err()}")
            self.assertEqual(
                [name for name in os.listdir(job.dir) if name.endswith((".cl", ".tmp"))], [], what
            )
            self.counts["stopped" if code == 75 else "complete"] += 1
        return job.dir if os.path.exists(job.dir) else None

    def stop_often(self, n):
        """Any moment of set-up, loop and output, on one rank and two; of a run that goes on too."""
        chance = random.Random(os.environ.get("DEMOCLES_SEED", "7"))
        places = (None, None, "log.txt", "resolved.yaml", "frame_000000.hdf", "frame_000001.hdf")
        for _ in range(n):
            signals = (*SIGNALS, signal.SIGKILL)
            ranks = chance.choice((1, 1, 2))
            folder = self.stop(
                chance.choice(signals), ranks, chance.random(), chance.choice(places)
            )
            if folder and self.whole(folder) and chance.random() < 0.4:
                self.stop(chance.choice(signals), ranks, 2 * chance.random(), again=True)
            if folder:
                self.goes_on(folder, chance.choice((1, 1, 2)))
        self.assertGreater(self.counts["stopped"] + self.counts["killed"], n // 3)

    def test_set_up(self):
        """Each of the signals, while kernels are built: the log is there, no frame yet."""
        for number, delay in zip(SIGNALS, (0.05, 0.15, 0.0)):
            self.goes_on(self.stop(number, 1, delay, "log.txt"))
        self.assertEqual(self.counts["stopped"], 3)

    def test_hundred(self):
        self.stop_often(100)

    def test_hundred_lattice(self):
        self.lattice()
        self.stop_often(100)


if __name__ == "__main__":
    parallel_runs.main(1)
