"""Runs that are interrupted, for the tests of robustness: started in the background, watched,
signalled at one rank. Own argument: results_tool."""
import glob
import os
import re
import shutil
import signal
import subprocess
import time

import parallel_runs
import scene_parts
from parallel_runs import mpi

SOON = (
    60  # seconds within which a job has to end once somebody wants it to; the machine may be busy
)


def bed(steps=10**7, dt=2e-5, frame_every=200, **more):
    """Elements thrown into a box: runs for as long as nobody stops it."""
    contact = {"normal": scene_parts.LINEAR, "tangential": scene_parts.FRICTION}
    s = scene_parts.scene(
        steps,
        dt,
        contact,
        [scene_parts.block("bed", (0, 0, 0), (0.04, 0.03, 0.03), 0.005, velocity=(0.5, 0, -0.5))],
        [scene_parts.box("trough", (0, 0, 0), (0.04, 0.03, 0.1))],
        **more,
    )
    s["output"] = {"every": frame_every * dt, "fields": ["velocity", "radius", "coordination"]}
    s["measure"] = [{"name": "energy", "every": 100 * dt, "energy": "all"}]
    return s


class Job:
    """A run under way, in a process group of its own."""

    def __init__(self, folder, scene, ranks, *args, name="out", program=None, **more):
        """scene: its path; None: goes on with what is in the folder."""
        self.dir, self.ranks = os.path.join(folder, name), ranks
        self.log = os.path.join(folder, "stderr.txt")
        verb = ("run", scene, "-o", self.dir) if scene else ("resume", self.dir)
        if scene:
            shutil.rmtree(self.dir, True)
        with open(self.log, "w") as err:
            words = parallel_runs.command(ranks, *verb, "--quiet", *args)
            words[words.index(parallel_runs.DEMOCLES)] = program or parallel_runs.DEMOCLES
            self.process = subprocess.Popen(
                words,
                cwd=folder,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=err,
                start_new_session=True,
                **more,
            )

    def pids(self):
        """Rank -> process id."""
        if self.ranks == 1:
            return {0: self.process.pid}
        found, variable = {}, mpi.rank_variable().encode()
        for path in glob.glob("/proc/[0-9]*/environ"):
            try:
                with open(path, "rb") as file:
                    environ = dict(
                        word.split(b"=", 1) for word in file.read().split(b"\0") if b"=" in word
                    )
                pid = int(path.split("/")[2])
                if (
                    self.owns(pid)
                    and os.readlink(f"/proc/{pid}/exe") == parallel_runs.DEMOCLES
                    and variable in environ
                ):
                    found[int(environ[variable])] = pid
            except (OSError, ProcessLookupError):
                continue
        if sorted(found) != list(range(self.ranks)):
            raise AssertionError(f"not all ranks are there: {found}")
        return found

    def frames(self):
        return sorted(glob.glob(os.path.join(self.dir, "frame_*.hdf")))

    def wait_frames(self, n):
        """Until so many frames are there."""
        end = time.monotonic() + parallel_runs.HANG
        while len(self.frames()) < n:
            if self.process.poll() is not None or time.monotonic() > end:
                raise AssertionError(f"no {n} frames: {self.end()} {self.err()}")
            time.sleep(0.02)

    def signal(self, number, rank):
        os.kill(self.pids()[rank], number)

    def end(self):
        """Exit code. A job that does not end is killed and said to hang."""
        try:
            return self.process.wait(SOON)
        except subprocess.TimeoutExpired:
            os.killpg(self.process.pid, signal.SIGKILL)
            self.process.wait()
            return "hangs"

    def owns(self, pid):
        """Whether a process is of this job: in its session, or, since MPICH gives each rank one of
        its own, named by its folder."""
        with open(f"/proc/{pid}/cmdline", "rb") as file:
            return os.getsid(pid) == self.process.pid or os.fsencode(self.dir) in file.read().split(
                b"\0"
            )

    def alive(self):
        """Whether any process of the job is still there."""
        return any(
            self.owns(int(p.split("/")[2]))
            for p in glob.glob("/proc/[0-9]*")
            if os.path.exists(p)
            and int(p.split("/")[2]) != self.process.pid
            and _state(p) not in "ZX"
        )

    def err(self):
        with open(self.log) as file:
            return file.read()

    def errors(self):
        return re.findall(r"^democles: error: .*", self.err(), re.M)


def _state(proc):
    try:
        with open(proc + "/stat") as file:
            return file.read().rsplit(")", 1)[1].split()[0]
    except OSError:
        return "X"


class Case(parallel_runs.Case):
    def put(self, content):
        import yaml

        path = os.path.join(self.dir, "scene.yaml")
        with open(path, "w") as file:
            yaml.safe_dump(content, file)
        return path

    def job(self, scene, ranks, *args, **more):
        job = Job(self.dir, scene, ranks, *args, **more)
        self.addCleanup(
            lambda: job.process.poll() is None and os.killpg(job.process.pid, signal.SIGKILL)
        )
        return job

    def whole(self, folder):
        """All frames of a folder are complete; returns how many there are."""
        paths = sorted(glob.glob(os.path.join(folder, "frame_*.hdf")))
        if paths:
            run = subprocess.run(
                [parallel_runs.OWN[0], "check", *paths],
                capture_output=True,
                text=True,
                timeout=parallel_runs.HANG,
            )
            self.assertEqual((run.returncode, run.stdout), (0, ""), folder)
        return len(paths)

    def leftovers(self, folder):
        return (
            [name for name in os.listdir(folder) if name.endswith(".tmp")]
            if os.path.isdir(folder)
            else []
        )
