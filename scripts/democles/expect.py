"""What the checks of the cases share: time series and record of a run, and a verdict that says each
number with its bound.

A check is called with the folder of results, prints one line per number, and exits with 1 if one of
them is out of its bounds."""
import csv
import json
import pathlib
import sys

import numpy
import yaml


def series(folder, name):
    """Columns of DIR/NAME.csv by their names, units left out."""
    path = pathlib.Path(folder) / (name + ".csv")
    if not path.is_file():
        sys.exit(f"there is no {path}")
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    values = numpy.array([[float(v) for v in row] for row in rows[1:]]).reshape(
        len(rows) - 1, len(rows[0])
    )
    return {title.split(" [")[0]: values[:, k] for k, title in enumerate(rows[0])}


def record(folder):
    path = pathlib.Path(folder) / "run.json"
    if not path.is_file():
        sys.exit(f"there is no {path}: the run did not end")
    return json.loads(path.read_text())


def scene(folder):
    """The resolved scene. Numbers that YAML 1.1 misreads (1e-05) are text: float() them."""
    return yaml.safe_load((pathlib.Path(folder) / "resolved.yaml").read_text())


def leaves(node, path=""):
    """(key as --set takes it, value) of everything in a scene."""
    if isinstance(node, dict):
        for key, value in node.items():
            yield from leaves(value, f"{path}.{key}" if path else str(key))
    elif isinstance(node, list) and any(isinstance(item, (dict, list)) for item in node):
        for k, item in enumerate(node):
            name = item.get("name") if isinstance(item, dict) else None
            yield from leaves(item, f"{path}.{name}" if name else f"{path}[{k}]")
    else:
        yield path, node


def named(items, name):
    """The one of a list in the scene that has this name."""
    return next(item for item in items if item["name"] == name)


def rayleigh_speed(young, nu, density):
    """Of surface waves [m/s], by Viktorov's approximation: 0.5 % for 0 <= nu <= 0.5."""
    return numpy.sqrt(young / (2 * (1 + nu) * density)) * (0.862 + 1.14 * nu) / (1 + nu)


def fastest(times, places, window):
    """Highest mean speed [m/s] over a time `window` [s] of what is at places [m] at times [s]."""
    starts = [(t, x) for t, x in zip(times, places) if t + window <= times[-1]]
    return max((numpy.interp(t + window, times, places) - x) / window for t, x in starts)


def expected(script):
    """expected.json beside the check."""
    return json.loads((pathlib.Path(script).resolve().parent / "expected.json").read_text())


class Verdict:
    def __init__(self):
        self.n_wrong = 0

    def say(self, good, text):
        print(("  good   " if good else "  WRONG  ") + text)
        self.n_wrong += not good

    def near(self, name, value, right, relative=0.0, absolute=0.0):
        """|value - right| <= relative |right| + absolute."""
        bound = relative * abs(right) + absolute
        self.say(
            abs(value - right) <= bound,
            f"{name}: {value:.9g}, expected {right:.9g} +- {bound:.3g} "
            f"(off by {value - right:.3g})",
        )

    def between(self, name, value, low, high):
        self.say(
            low <= value <= high, f"{name}: {value:.9g}, expected between {low:.9g} and {high:.9g}"
        )

    def end(self):
        if self.n_wrong:
            sys.exit(f"{self.n_wrong} numbers are not as expected")


def folder():
    """The argument of a check."""
    if len(sys.argv) != 2:
        sys.exit(f"usage: {sys.argv[0]} DIR, the folder of results")
    return pathlib.Path(sys.argv[1])
