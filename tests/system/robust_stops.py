#!/usr/bin/python3
"""Requests to stop, and violent ends. Own argument: results_tool."""
import os
import signal
import time

import parallel_runs
import robust_jobs


class Asked(robust_jobs.Case):
    """All ranks agree, write a frame together, exit 75;
    what they leave is a run of just as many steps."""

    def stopped(self, ranks, ask, *args):
        scene = self.put(robust_jobs.bed())
        job = self.job(scene, ranks, *args)
        job.wait_frames(2)
        ask(job)
        self.assertEqual(job.end(), 75, job.err())
        run = parallel_runs.Run(job.dir, 75, job.err())
        self.assertEqual(job.errors(), [])
        record = run.record()
        self.assertEqual((record["exit"], record["ranks"]), (75, ranks))
        self.assertGreater(record["steps"], 0)
        self.assertEqual(self.leftovers(job.dir), [])
        self.whole(job.dir)
        last = parallel_runs.frames.Frame(run.frames()[-1])
        self.assertAlmostEqual(last.time, record["time_end"], 12)
        again = self.good_run(scene, 1, "--steps", str(record["steps"]), name="again")
        self.assertEqual(again.record()["digest"], record["digest"])

    def test_signal_at_one_rank(self):
        for ranks, rank, number in (
            (1, 0, signal.SIGINT),
            (3, 2, signal.SIGTERM),
            (3, 0, signal.SIGUSR1),
        ):
            with self.subTest(ranks=ranks, rank=rank, signal=number):
                self.stopped(ranks, lambda job: job.signal(number, rank))

    def test_stop_file(self):
        self.stopped(3, lambda job: open(os.path.join(job.dir, "stop"), "w").close())

    def test_max_time(self):
        began = time.monotonic()
        self.stopped(3, lambda job: None, "--max-time", "3s")
        self.assertGreater(time.monotonic() - began, 3)


class Killed(robust_jobs.Case):
    """Whatever dies: the job is over within seconds, and what has the name of a frame is one."""

    def ended(self, ranks, kill, delay):
        job = self.job(self.put(robust_jobs.bed(frame_every=5)), ranks)
        job.wait_frames(3)
        time.sleep(delay)
        kill(job)
        self.assertNotIn(job.end(), (0, "hangs"), job.err())
        end = time.monotonic() + robust_jobs.SOON
        while job.alive() and time.monotonic() < end:
            time.sleep(0.05)
        self.assertFalse(job.alive(), "processes are left")
        self.assertGreaterEqual(self.whole(job.dir), 3)
        for name in ("scene.yaml", "resolved.yaml", "log.txt"):
            self.assertIn(name, os.listdir(job.dir))

    def test_one_rank_is_killed(self):
        for ranks, rank, delay in ((1, 0, 0.0), (3, 1, 0.013)):
            with self.subTest(ranks=ranks, rank=rank):
                self.ended(ranks, lambda job: job.signal(signal.SIGKILL, rank), delay)

    def test_mpirun_is_terminated(self):
        self.ended(3, lambda job: job.process.terminate(), 0.07)


if __name__ == "__main__":
    parallel_runs.main(1)
