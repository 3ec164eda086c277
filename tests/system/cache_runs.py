#!/usr/bin/python3
"""The folder of pocl's kernels: one that cannot be written, a name that is empty, and locks in it
that other jobs hold. Own argument: results_tool."""
import glob
import os
import subprocess
import time

import parallel_runs
import robust_jobs

HOLD = """
import fcntl, sys
files = [open(path, "r+") for path in sys.argv[1:]]
for file in files:
    fcntl.lockf(file, fcntl.LOCK_EX)
print("held", flush=True)
sys.stdin.read()
"""


class Cache(robust_jobs.Case):
    def hold(self, paths):
        """Another process that has all of these locks, until its input ends."""
        holder = subprocess.Popen(
            ["/usr/bin/python3", "-c", HOLD, *paths],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        self.addCleanup(holder.wait)
        self.addCleanup(holder.stdin.close)
        self.addCleanup(holder.stdout.close)
        self.assertEqual(holder.stdout.readline(), "held\n")
        return holder

    def devices(self, **env):
        return subprocess.run(
            [parallel_runs.DEMOCLES, "devices"],
            env={**os.environ, **env},
            capture_output=True,
            text=True,
            timeout=parallel_runs.HANG,
        )

    def test_names(self):
        """Empty: as if it were not set. Named and impossible: said so."""
        for env in ({"POCL_CACHE_DIR": ""}, {"POCL_DEVICES": ""}):
            run = self.devices(XDG_CACHE_HOME=self.dir, **env)
            self.assertEqual((run.returncode, run.stderr), (0, ""), env)
        run = self.devices(POCL_DEVICES="nonsense")
        self.assertEqual(run.returncode, 4)
        self.assertIn("POCL_DEVICES is 'nonsense'", run.stderr + run.stdout)
        file = os.path.join(self.dir, "file")
        open(file, "w").close()
        for folder in ("/proc/k", file):
            run = self.devices(POCL_CACHE_DIR=folder)
            self.assertEqual(run.returncode, 4)
            self.assertRegex(
                run.stderr, f"pocl cannot write its kernels into '{folder}' .*; set POCL_CACHE_DIR"
            )

    def test_home_and_locks(self):
        """Without a home that can be written kernels are in the temporary folder. What has been
        compiled needs no lock; who waits for one says for whom."""
        scene = self.put(robust_jobs.bed())
        env = {"HOME": "/proc", "POCL_CACHE_DIR": "", "XDG_CACHE_HOME": "", "TMPDIR": self.dir}
        run = self.good_run(scene, 1, "--steps", "2", env=env)
        cache = os.path.join(self.dir, f"democles-pocl-{os.geteuid()}")
        self.assertRegex(
            run.err, f"\\Ademocles: warning: pocl keeps its kernels in '{cache}', since"
        )
        env = {"POCL_CACHE_DIR": cache}
        locks = glob.glob(os.path.join(cache, "democles", "*"))
        self.assertGreater(len(locks), 10)

        holder = self.hold(locks)
        warm = self.good_run(scene, 1, "--steps", "2", env=env, name="warm")
        self.assertNotIn("waits", warm.err)
        self.assertEqual(warm.record()["digest"], run.record()["digest"])

        for path in locks:
            os.truncate(path, 0)
        job = self.job(scene, 1, "--steps", "2", env={**os.environ, **env}, name="waits")
        says = (
            f"waits for process {holder.pid}, which compiles the same kernels and holds '{cache}/"
        )
        end = time.monotonic() + robust_jobs.SOON
        while says not in job.err() and time.monotonic() < end and job.process.poll() is None:
            time.sleep(0.05)
        holder.stdin.close()
        self.assertEqual(job.end(), 0, job.err())
        self.assertEqual(job.err().count(says), 1, job.err())


if __name__ == "__main__":
    parallel_runs.main(1)
