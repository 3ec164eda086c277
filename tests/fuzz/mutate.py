#!/usr/bin/python3
"""mutate.py DEMOCLES CHECK_MANY [SEED [N_MANY N_CHECK N_RUN]]: scenes of the cases and of the
tests with changes that nobody would make, drawn by the seed: N_MANY are checked by check_many,
N_CHECK by the program, N_RUN run for two steps. Each has to end with an exit code of the program
and, if that is not 0, with a message; none crashes, hangs, or touches a file of the user's.

Prints how many ended with which code; what should not have been is kept in ./mutated/."""
import collections
import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
ODD = "0 -1 1 3 1e-300 1e300 -1e308 1e15 1e-9 2147483648 9223372036854775808 nan .inf 0x10".split()
ODD += [
    "~",
    "[]",
    "{}",
    "''",
    '"',
    "*a",
    "&a",
    "!!str",
    "---",
    ": ",
    "- ",
    "#",
    "\0",
    "\t",
    "é",
    "\r",
]
UNITS = "mm m cm s ms Hz kg/m3 g/cm3 N/m Pa GPa deg rpm J".split()
GOOD = {"check": {0, 3, 5, 6}, "run": {0, 3, 4, 5, 6, 75}}  # interface.md
BAD = ("Sanitizer", "runtime error", "Traceback", "Assertion", "Signal:")
LIMIT = 120  # [s] of one call; the machine may be busy
MEMORY = 12 << 30  # [byte] of addresses, most of them of libraries
ENVIRONMENT = {**os.environ, "ASAN_OPTIONS": "detect_leaks=0:hard_rss_limit_mb=4096"}


def bases():
    paths = [*ROOT.glob("cases/*/scene.yaml"), *ROOT.glob("tests/scene/*.yaml")]
    return [path.read_text() for path in sorted(paths)]


def one_change(text, chance, texts, words):
    """The text with one more change."""
    kind, lines = chance.randrange(7), text.split("\n")
    at = chance.randrange(len(lines))
    if kind <= 1:  # a number
        found = list(re.finditer(r"(?<![\w.])-?\d[\d.]*(?:e-?\d+)?", text))
        if found:
            match = chance.choice(found)
            return text[: match.start()] + chance.choice(ODD) + text[match.end() :]
    if kind == 2:  # a word
        found = list(re.finditer(r"[A-Za-z_/]\w*", text))
        if found:
            match = chance.choice(found)
            word = chance.choice(chance.choice((words, UNITS, ODD)))
            return text[: match.start()] + word + text[match.end() :]
    if kind == 3:  # lines of another scene
        other = chance.choice(texts).split("\n")
        begin = chance.randrange(len(other))
        lines[at:at] = other[begin : begin + chance.randrange(1, 5)]
    elif kind == 4:  # a line twice, somewhere else, or not at all
        line = lines.pop(at)
        for _ in range(chance.randrange(3)):
            lines.insert(chance.randrange(len(lines) + 1), line)
    elif kind == 5:  # less or more indented
        lines[at] = lines[at][2:] if chance.random() < 0.5 else "  " + lines[at]
    else:  # characters
        place = chance.randrange(len(text) + 1)
        return text[:place] + chance.choice(ODD) + text[place + chance.randrange(3) :]
    return "\n".join(lines)


def mutated(chance, texts, words):
    text = chance.choice(texts)
    for _ in range(chance.choice((1, 1, 1, 2, 3, 8))):
        text = one_change(text, chance, texts, words)
    return text.encode("utf-8", "replace")


class Folder:
    """Where scenes lie, beside the files that they name; nothing else may change there."""

    def __init__(self):
        self.path = pathlib.Path(tempfile.mkdtemp(prefix="democles_mutate_"))
        for path in [*ROOT.glob("cases/*/*.stl"), *ROOT.glob("cases/*/*.csv")]:
            shutil.copy(path, self.path)
        self.scene, self.out = self.path / "scene.yaml", self.path / "out"
        self.files = self.listed()

    def listed(self):
        return {path.name: path.stat().st_mtime_ns for path in self.path.iterdir()}

    def put(self, data):
        self.scene.write_bytes(data)
        shutil.rmtree(self.out, True)
        self.out.mkdir()
        (self.out / "mine.txt").write_text("mine")

    def lost(self, data):
        """What a call has done that it should not have."""
        files = {k: v for k, v in self.listed().items() if k in self.files}
        if files != self.files or set(self.listed()) - set(self.files) != {"scene.yaml", "out"}:
            return "files beside the scene"
        if self.scene.read_bytes() != data or (self.out / "mine.txt").read_text() != "mine":
            return "the scene, or a file in DIR"
        return None


class Many:
    """check_many, which answers one scene after the other."""

    def __init__(self, program, folder):
        self.out = folder.path.with_suffix(".txt")
        self.child = subprocess.Popen(
            [program, self.out],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=ENVIRONMENT,
        )

    def __call__(self, scene):
        print(scene, file=self.child.stdin, flush=True)
        code = int(self.child.stdout.readline() or -1)
        return code, self.out.read_text(errors="replace")


def call(*words):
    """Exit code, or "hangs", and what was printed, of one call of the program."""
    try:
        run = subprocess.run(
            words,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            stdin=subprocess.DEVNULL,
            timeout=LIMIT,
            env=ENVIRONMENT,
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY)),
        )
    except subprocess.TimeoutExpired:
        return "hangs", ""
    return run.returncode, run.stderr.decode(errors="replace")


def main():
    program, many_program, *rest = sys.argv[1:]
    seed, *numbers = [int(word) for word in rest] or [1]
    texts, folder, wrong = bases(), Folder(), 0
    words = sorted(set(re.findall(r"[A-Za-z_]\w+", "\n".join(texts))))
    many, counts = Many(many_program, folder), collections.Counter()
    ways = {
        "many": many,
        "check": lambda scene: call(program, "check", scene),
        "run": lambda scene: call(
            program, "run", scene, "-o", folder.out, "--steps", "2", "--max-time", "20s", "--quiet"
        ),
    }
    for (way, act), n in zip(ways.items(), numbers or (1000, 50, 5)):
        for k in range(n):
            chance = random.Random(f"{seed} {way} {k}")
            data = mutated(chance, texts, words)
            folder.put(data)
            code, text = act(folder.scene)
            counts[way, code] += 1
            why = (
                (code not in GOOD["run" if way == "run" else "check"] and "exit code")
                or (code not in (0, 75) and not text.strip() and "no message")
                or next((word for word in BAD if word in text), None)
                or folder.lost(data)
            )
            if why:
                wrong += 1
                os.makedirs("mutated", exist_ok=True)
                name = pathlib.Path("mutated", f"{seed}_{way}_{k}.yaml")
                name.write_bytes(data)
                print(f"{name}: {why}: {code}: {text[-2000:]}", flush=True)
    many.child.stdin.close()
    many.child.wait()
    shutil.rmtree(folder.path, True)
    many.out.unlink(missing_ok=True)
    for (way, code), n in sorted(counts.items(), key=str):
        print(f"{way}: {n} ended with {code}")
    sys.exit(1 if wrong else 0)


main()
