"""The runs of a study of accuracy: settings, their product, and a folder of runs that are kept.

A run's folder is named by a hash of all that its result depends on: the scene with its defaults and
settings, the files that it reads, ranks, device and the program's version."""
import argparse
import hashlib
import itertools
import json
import pathlib
import re
import shutil
import statistics
import subprocess
import sys

import yaml

from democles import expect, study

OWN = ("ranks", "device")  # of the command line, not of the scene
# Exit codes that are a result: the scene or a setting is refused, no device can do it, unstable.
FAILS = {2: "refused", 3: "refused", 4: "no device", 5: "failed"}
# Those that belong to the setting whenever it runs. A device may come back, and 2 is also a folder
# into which another run writes: the next study tries these again.
REMEMBERED = (3, 5)
# Runs that are short or slow are timed more than once: the first may have waited for kernels.
SHORT, SHORT_REPEATS = 10, 3  # [s]
PRECISIONS = ("single", "mixed", "double")  # from the coarsest
FOURTH_ORDER = ("rk4", "rkn4", "pefrl", "vefrl")


def split(text):
    """At the commas outside of brackets."""
    parts, depth = [""], 0
    for letter in text:
        depth += (letter in "[{") - (letter in "]}")
        if letter == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts]


def fixed(text):
    """KEY=VALUE"""
    key, equals, value = text.partition("=")
    if not equals or not key or not value:
        raise argparse.ArgumentTypeError(f"'{text}' is not KEY=VALUE")
    return key, value


def whole(text, least):
    """A whole number from this one on."""
    if not re.fullmatch("[0-9]{1,6}", text) or int(text) < least:
        raise argparse.ArgumentTypeError(f"'{text}' is no whole number from {least} on")
    return int(text)


def check_ranks(key, value):
    """The one value that is read here and not by the program."""
    if "ranks" in key.split(","):
        try:
            whole(value, 1)
        except argparse.ArgumentTypeError as error:
            raise argparse.ArgumentTypeError(f"ranks={value}: {error}") from None


def setting(text):
    """KEY=VALUE of a run"""
    key, value = fixed(text)
    check_ranks(key, value)
    return key, value


def vary(text):
    """KEY[,KEY]=V1,V2 -> (keys as given, values, each once)"""
    key, values = fixed(text)
    values = list(dict.fromkeys(split(values)))
    if "" in values:
        raise argparse.ArgumentTypeError(f"'{text}' has a value that is empty")
    for value in values:
        check_ranks(key, value)
    return key, values


def settings(text):
    """KEY=VALUE,KEY=VALUE"""
    return dict(setting(part) for part in split(text))


def short(keys):
    """The first of several."""
    return keys.split(",")[0] + ",..." * ("," in keys)


class Run:
    """A setting and what has come of it."""

    def __init__(self, setting, role="run"):
        self.setting, self.role = setting, role  # role: run, reference, start
        self.label = " ".join(f"{short(k)}={value}" for k, value in setting.items()) or "as given"
        self.folders, self.records, self.reason, self.key = [], [], None, None

    @property
    def is_done(self):
        return bool(self.records)

    @property
    def record(self):
        return self.records[0]

    @property
    def seconds(self):
        """Time of all steps, median of the repeats [s]."""
        return statistics.median(r["wall_s"]["loop"] for r in self.records)

    @property
    def doubts(self):
        """Why its results are not to be relied upon, in words: what it says of itself, and a last
        step that goes far beyond the end. Empty where nothing is known against it."""
        trust = self.record.get("trust", {})
        found = [
            name.replace("_", " ") + (f" {trust[name]:.3g}" if trust.get(name) is not None else "")
            for name in trust.get("outside", [])
        ]
        end, dt = self.end(), self.record["dt"]
        if end is not None and dt > end * (1 + 1e-9):
            found.append(f"step of {dt:g} s longer than the run")
        elif end is not None and abs(self.record["time_end"] - end) > dt * (1 + 1e-9):
            found.append(f"stopped at {self.record['time_end']:g} s of {end:g} s")
        return found

    def end(self):
        """The scene's [s]; None: it has none."""
        value = expect.scene(self.folders[0]).get("time", {}).get("end")
        return None if value is None else float(value)

    @property
    def pace(self):
        """Time of an element's force evaluation [s]."""
        return self.seconds / max(self.record["force_evaluations"] * self.record["elements"], 1)

    def size(self, key):
        """What the key says of how fine the run is: smaller is finer; None: not a number."""
        if key in ("time.step", "time.safety"):
            return self.record["dt"]
        if key not in self.setting:
            return None
        resolved = dict(expect.leaves(expect.scene(self.folders[0])))  # without units
        try:
            return float(resolved[key.split(",")[0]])
        except (KeyError, ValueError):
            return None

    def fineness(self):
        """Sorts the finest first: smallest cells, highest order, smallest step, most digits."""
        cells = [self.size(key) or 0 for key in self.setting if key.split(",")[0].endswith(".cell")]
        return (
            *cells,
            self.record["scheme"] not in FOURTH_ORDER,
            self.record["dt"],
            -PRECISIONS.index(self.record["precision"]),
        )


class Plan:
    def __init__(self, runs, reference, starts, graded):
        self.runs, self.reference, self.starts = runs, reference, starts
        self.graded = graded  # the key whose order is looked for, or None

    def group(self, run):
        """The runs that differ from this one in the graded key alone, the coarsest first."""
        rest = [(k, v) for k, v in run.setting.items() if k != self.graded]
        like = [
            r
            for r in self.runs
            if r.is_done and [(k, v) for k, v in r.setting.items() if k != self.graded] == rest
        ]
        return sorted(like, key=lambda r: -(r.size(self.graded) or 0))

    def leave_out_same(self):
        """Settings that are another one in other words, as 1e-5 and 10e-6."""
        seen = {run.key or id(run): run for run in reversed(self.runs)}
        self.runs = [run for run in self.runs if seen[run.key or id(run)] is run]

    def groups(self):
        """All groups, each once."""
        seen = {id(g[0]): g for g in (self.group(r) for r in self.runs if r.is_done)}
        return list(seen.values())


class Runner:
    """Runs settings of a scene, each once, below a folder."""

    def __init__(self, program, scene, folder, common):
        self.program, self.scene, self.folder = program, scene, folder
        self.common = {**common, "output.every": "0", "output.checkpoint_every": "0"}
        try:
            self.version = subprocess.run(
                [program, "--version"], capture_output=True, text=True, check=True
            ).stdout.strip()
        except (OSError, subprocess.CalledProcessError) as error:
            study.refuse("accuracy", f"cannot run {program} ({error}); --program names another")
        if "dirty" in self.version or "unknown" in self.version:  # no commit has this program
            content = pathlib.Path(shutil.which(program)).read_bytes()
            self.version += " " + hashlib.sha256(content).hexdigest()[:12]

    def arguments(self, setting):
        """--set of all keys of the scene."""
        return [
            word
            for keys, value in {**self.common, **setting}.items()
            for key in keys.split(",")
            if key not in OWN
            for word in ("--set", f"{key}={value}")
        ]

    def resolved(self, setting):
        """Text of the scene with all defaults, or None and why the program refuses it."""
        done = subprocess.run(
            [self.program, "check", str(self.scene), "--resolved", *self.arguments(setting)],
            capture_output=True,
            text=True,
            check=False,
        )
        return (done.stdout, "") if done.returncode == 0 else (None, reason(done.stderr))

    def find(self, run):
        """Gives the run its key and folder, or the reason why it is refused."""
        text, why = self.resolved(run.setting)
        if text is None:
            run.reason = "refused: " + why
            return
        ranks = self.own(run.setting, "ranks", "1")
        parts = [self.version, ranks, self.own(run.setting, "device", ""), text]
        parts += [hashlib.sha256(path.read_bytes()).hexdigest() for path in self.inputs(text)]
        run.key = hashlib.sha256("\0".join(parts).encode()).hexdigest()[:16]

    def own(self, setting, key, fallback):
        """A value that is not the scene's."""
        return {**self.common, **setting}.get(key, fallback)

    def inputs(self, text):
        """The files that a scene names."""
        words = (
            value for _, value in expect.leaves(yaml.safe_load(text)) if isinstance(value, str)
        )
        paths = (self.scene.parent / word for word in words if len(word) < 1000)
        return [path for path in paths if path.is_file()]

    def take(self, run, repeat):
        """What is there of this repeat; returns whether it needs no run."""
        failed, folder = self.folder / run.key / "failed.txt", self.folder / run.key / str(repeat)
        if failed.is_file():
            run.reason = failed.read_text().strip()
            return True
        record = folder / "run.json"
        if record.is_file():
            content = json.loads(record.read_text())
            if content["exit"] == 0:
                run.folders.append(folder)
                run.records.append(content)
                return True
        return False

    def start(self, run, repeat):
        folder = self.folder / run.key / str(repeat)
        ranks, device = self.own(run.setting, "ranks", "1"), self.own(run.setting, "device", "")
        args = [*self.arguments(run.setting), *(["--device", device] if device else [])]
        print(f"accuracy: {run.role} {run.label}", file=sys.stderr, flush=True)
        code, err = study.run(self.program, self.scene, folder, int(ranks), *args)
        if code in FAILS:
            text = f"{FAILS[code]}: {reason(err)}\n"
            folder.parent.mkdir(parents=True, exist_ok=True)
            if code in REMEMBERED:
                (folder.parent / "failed.txt").write_text(text)
            run.reason = text.strip()
        elif code:
            sys.exit(f"accuracy: {run.label}: exit code {code}\n{err}")

    @staticmethod
    def is_in_doubt(run, everyone):
        """Whether its time is short, or that of a run that has waited for kernels."""
        least = min(other.pace for other in everyone if other.is_done)
        return run.seconds <= SHORT or run.pace > 2 * least

    def run_all(self, plan, repeats, has_reference):
        """Round by round, so that a machine that slows down slows all of them."""
        everyone = [*plan.runs, *([plan.reference] if plan.reference else []), *plan.starts]
        for run in everyone:
            self.find(run)
        plan.leave_out_same()
        if len(plan.runs) == 1 and not plan.reference and not has_reference:
            study.refuse(
                "accuracy",
                f"{plan.runs[0].label} alone has nothing to be compared with: --vary needs another "
                "value, or --reference a setting",
            )
        everyone = [run for run in everyone if run.role != "run" or run in plan.runs]
        for repeat in range(repeats or SHORT_REPEATS):
            for run in everyone:
                if run.reason or (repeat > 0 and run.role == "start"):
                    continue
                if repeat > 0 and not repeats and not self.is_in_doubt(run, everyone):
                    continue
                if not self.take(run, repeat):
                    self.start(run, repeat)
                    self.take(run, repeat)


def reason(text):
    """The first line of what a failed run says."""
    lines = [line for line in text.splitlines() if line.strip() and ": warning: " not in line]
    first = lines[0].strip() if lines else "no message"
    first = first.removeprefix("democles: error: ")
    return re.sub(r"^\S*/(?=[^/\s]+:\d)", "", first)  # the scene's name is enough


def starts_of(options, runner, runs):
    """Runs of one setting that differ in their random numbers."""
    if options.starts <= 0:
        return []
    at = runs[min(1, len(runs) - 1)].setting if options.starts_at is None else options.starts_at
    text, why = runner.resolved(at)
    if text is None:
        sys.exit(f"accuracy: --starts-at: {why}")
    found = dict(expect.leaves(yaml.safe_load(text)))
    keys = options.starts_key or [k for k in found if k.split(".")[-1] == "seed"]
    if not keys:
        sys.exit("accuracy: the scene has no random start (no key `seed`); --starts-key names one")
    unknown = [key for key in keys if key not in found]
    if unknown:
        sys.exit(f"accuracy: --starts-key: the scene has no key {unknown[0]}")
    first = Run(at, "start")
    more = [
        Run({**at, **{key: str(int(found[key]) + 100 + k) for key in keys}}, "start")
        for k in range(options.starts)
    ]
    return [first, *more]


def plan(options, runner):
    keys = [key for key, _ in options.vary]
    runs = [
        Run(dict(zip(keys, values)))
        for values in itertools.product(*(values for _, values in options.vary))
    ]
    graded = [
        key
        for key in keys
        if key in ("time.step", "time.safety") or key.split(",")[0].endswith(".cell")
    ]
    reference = None
    if not options.reference_file and options.reference not in ("finest", "richardson"):
        try:
            reference = Run(settings(options.reference), "reference")
        except argparse.ArgumentTypeError as error:
            study.refuse("accuracy", f"--reference: {error}")
    starts = starts_of(options, runner, runs)
    return Plan(runs, reference, starts, graded[0] if graded else None)
