"""Shared by the studies of runs on many ranks: starting a run, reading its record,
writing tables."""
import csv
import fcntl
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys

from democles import mpi, places

PARTS = (
    "compute",
    "exchange",
    "wait",
    "regroup",
)  # of the loop's time; they do not overlap here: exchange is without wait

PATIENCE = 30  # [s] for a run that is asked to end

# Published speed-up and efficiency [%] of a reference solver,
# on the scenes that cases/ repeats (base: one processor).
REFERENCE_SOURCE = (
    "report on VEDO and Iris (National Taiwan University), tables of cases A and B, "
    "geometric and graph partitioning"
)
REFERENCE = {
    "v_funnel": {
        "geometric": {4: (3.76, 94.09), 8: (6.59, 82.33), 16: (9.16, 57.24)},
        "graph": {4: (3.77, 94.14), 8: (6.10, 76.24), 16: (7.66, 47.91)},
    },
    "l_box": {
        "geometric": {4: (3.60, 90.09), 8: (6.24, 78.05), 16: (8.25, 51.55)},
        "graph": {4: (3.39, 84.73), 8: (5.73, 71.61), 16: (6.76, 42.27)},
    },
}


def cores():
    """Number of cores that this process may use."""
    return len(os.sched_getaffinity(0))


def numbers(text):
    """Turns "1,2,4" into [1, 2, 4]."""
    return [int(word) for word in text.split(",")]


def run(program, scene, folder, ranks, *args):
    """Runs, replacing what is in the folder; a scene that is a folder of results is resumed from
    its latest frame. Returns exit code and stderr."""
    # a core for each rank: else one rank alone would have them all, and two could not be faster
    env = {"POCL_MAX_PTHREAD_COUNT": "1", "POCL_MAX_COMPUTE_UNITS": "1", **mpi.environment()}
    command = [str(program), "run", str(scene), "-o", str(folder), "--force"]
    if scene.is_dir():
        take_up(scene, folder)
        command = [str(program), "resume", str(folder)]
    command += ["--quiet", *args]
    if ranks > 1:
        command = mpi.command("-n", str(ranks), *command)
    child = subprocess.Popen(
        command,
        env=env,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        err = child.communicate()[1]
        return child.returncode, err
    finally:
        end(child)


def end(child):
    """Ends what still runs: asked first, since a launcher that is killed leaves its ranks."""
    if child.poll() is None:
        child.terminate()
        try:
            child.communicate(timeout=PATIENCE)
        except subprocess.TimeoutExpired:
            child.kill()
            child.communicate()


def end_by_signals():
    """SIGTERM and SIGINT leave with 128 + their number, by way of what cleans up."""

    def leave(number, _):
        for each in (signal.SIGTERM, signal.SIGINT):  # cleaning up is not interrupted
            signal.signal(each, signal.SIG_IGN)
        sys.exit(128 + number)

    signal.signal(signal.SIGTERM, leave)
    signal.signal(signal.SIGINT, leave)


def refuse(tool, text):
    """Leaves with the code of wrong usage."""
    print(f"{tool}: {text}", file=sys.stderr)
    sys.exit(2)


def take_folder(tool, folder, scene, is_own):
    """Locks a folder of results, which belongs to one study at a time and, unless the user has
    named it (is_own), to one scene. Returns the open file: the lock lasts as long as it does."""
    folder.mkdir(parents=True, exist_ok=True)
    file = open(folder / "study.lock", "a+")
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        refuse(tool, f"another study is writing into {folder}")
    file.seek(0)
    before, now = file.read().strip(), str(scene.resolve())
    if before not in ("", now) and not is_own:
        refuse(tool, f"{folder} has the results of {before}: --out names another folder")
    file.truncate(0)
    file.write(now + "\n")
    file.flush()
    return file


def take_up(results, folder):
    """Makes a new folder with the files from which a run resumes."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for path in [
        *results.glob("*.yaml"),
        *results.glob("*.csv"),
        max(results.glob("frame_[0-9]*.hdf")),
    ]:
        shutil.copy(path, folder)


class Record:
    """run.json of a folder, or the file itself; or its content."""

    def __init__(self, given):
        if not isinstance(given, dict):
            path = pathlib.Path(given)
            given = json.loads((path / "run.json" if path.is_dir() else path).read_text())
        self.raw = given
        self.ranks, self.elements = given["ranks"], given["elements"]
        self.steps = given["steps"] - given.get("resumed", {}).get(
            "step", 0
        )  # that the times are of
        self.loop, self.digest = given["wall_s"]["loop"], given["digest"]

    def of(self, *keys, default=None):
        """A value deep in the record."""
        value = self.raw
        for key in keys:
            if not isinstance(value, dict) or key not in value:
                return default
            value = value[key]
        return value

    def per_step(self, part):
        """Mean over ranks of a timer [s]; exchange without wait."""
        timers = self.raw["timers"]
        seconds = timers[part]["mean"] - (timers["wait"]["mean"] if part == "exchange" else 0)
        return seconds / max(self.steps, 1)

    def shares(self):
        """Of the loop's time [%], means over ranks."""
        loop = self.raw["timers"]["loop"]["mean"]
        return (
            [100 * self.per_step(part) * self.steps / loop for part in PARTS]
            if loop > 0
            else [0.0] * len(PARTS)
        )

    def imbalance(self):
        """U, mean over the run."""
        return self.of("imbalance", "mean", default=0.0)

    def cut(self):
        """Interactions that a border cuts; None: this version does not say."""
        return self.of("partition", "cut")


def find_scene(tool, word):
    """Path and name of a scene: of a case, a file, or a folder of results."""
    path = places.CASES / word / "scene.yaml" if "/" not in word else pathlib.Path(word)
    if "/" not in word and not path.is_file():
        path = pathlib.Path(word)
    if any(path.glob("frame_[0-9]*.hdf")):
        return path, path.resolve().name
    if not path.is_file():
        sys.exit(f"{tool}: there is no {path}")
    return path, path.resolve().parent.name if path.name == "scene.yaml" else path.stem


def table(titles, rows, notes=()):
    """Text in markdown. Cells: text, numbers, or None for what is not known."""

    def shown(cell):
        return (
            ""
            if cell is None
            else cell
            if isinstance(cell, str)
            else f"{cell:.4g}"
            if isinstance(cell, float)
            else str(cell)
        )

    lines = ["| " + " | ".join(titles) + " |", "|" + "---|" * len(titles)]
    lines += ["| " + " | ".join(map(shown, row)) + " |" for row in rows]
    return "\n".join(lines + [""] + list(notes)) + "\n"


def write_table(path, titles, rows, notes=()):
    """path.md and path.csv; prints the former."""
    text = table(titles, rows, notes)
    path.with_suffix(".md").write_text(text)
    with open(path.with_suffix(".csv"), "w", newline="") as file:
        csv.writer(file).writerows(
            [titles, *([None if c is None else c for c in row] for row in rows)]
        )
    print(text, end="")
