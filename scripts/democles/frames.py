"""What the tools and checks share: frames of a run as arrays with units,
and the resolved scene as numbers."""
import contextlib
import functools
import json
import os
import pathlib
import resource
import signal
import sys

import h5py
import numpy
import yaml


def paths(folder):
    """The frames of a run, in order."""
    return sorted(pathlib.Path(folder).glob("frame_[0-9]*.hdf"))


def shown(folder):
    """Those of `output.every`, without checkpoints, so that a film runs at an even pace; of an
    older run all."""
    series = pathlib.Path(folder) / "frames.hdf.series"
    if not series.exists():
        return paths(folder)
    try:
        names = [entry["name"] for entry in json.loads(series.read_text())["files"]]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise SystemExit(f"{series}: not a list of frames: {error}") from error
    listed = [path for path in paths(folder) if path.name in set(names)]
    return listed or paths(folder)


def scene(folder):
    """The resolved scene; numbers as YAML 1.1 misreads them (1e-05) are still text:
    see `number`."""
    return yaml.safe_load((pathlib.Path(folder) / "resolved.yaml").read_text())


def number(value):
    """A number of the resolved scene (SI, no unit); `never` and `none` are infinite."""
    return float("inf") if value in ("never", "none") else float(value)


# What h5py raises where a file is not what it seems.
NOT_A_FRAME = (
    OSError,
    KeyError,
    ValueError,
    TypeError,
    RuntimeError,
    IndexError,
    AttributeError,
    MemoryError,
)


def _look_at_all(path):
    """Every object and attribute; rows too where they are in pieces."""

    def look(name, item):
        dict(item.attrs)
        if isinstance(item, h5py.Dataset) and item.chunks:
            item[()]

    with h5py.File(path, "r") as file:
        file.visititems(look)


@functools.lru_cache(maxsize=None)
def _survives(path, changed):
    """Whether HDF5 reads the file to its end, tried in a child process, since HDF5 1.10 crashes on
    some damaged files; changed: when, so that a file is looked at once. Returns the signal that
    ended it, or 0.
    """
    sys.stdout.flush()
    sys.stderr.flush()
    child = os.fork()
    if child == 0:
        code = 1
        try:
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            resource.setrlimit(
                resource.RLIMIT_CPU, (60, 60)
            )  # a loop in HDF5; looking takes milliseconds
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
            _look_at_all(path)
            code = 0
        finally:
            os._exit(code)
    status = os.waitpid(child, 0)[1]
    return os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0


@contextlib.contextmanager
def _opened(path):
    """The file of a frame; what is wrong with it ends the tool with a message."""
    try:
        number = _survives(str(path), os.stat(path).st_mtime_ns)
        if number:
            raise OSError(f"damaged, HDF5 fails on it ({signal.Signals(number).name})")
        with h5py.File(path, "r") as file:
            yield file
    except NOT_A_FRAME as error:
        raise SystemExit(f"{path}: not a frame: {error}") from error


HEXAHEDRON = 12  # VTK's number


class Frame:
    """One frame. `points` [n][3] [m]: centres of the elements, or of the cells of a solid; `time`
    [s], `names` of the fields. Of a solid also `corners` and `displacement` of the corners
    [n][8][3] [m], the former at the start; else `corners` is None.
    """

    def __init__(self, path):
        self.path = str(path)
        with _opened(self.path) as file:
            shown = file["VTKHDF"]
            self.points, self.time = shown["Points"][()], float(shown["FieldData/TimeValue"][0])
            self._field, types = _arrays(shown["PointData"]), shown["Types"][:1]
            self._check(self.points.ndim == 2 and self.points.shape[1] == 3, "Points")
            self.corners = None
            if types == [HEXAHEDRON]:
                self.corners, self.displacement = self.points.reshape(-1, 8, 3), self._field[
                    "displacement"
                ].reshape(-1, 8, 3)
                self.points = (self.corners + self.displacement).mean(axis=1)
                self._field = {
                    "displacement": self.displacement.mean(axis=1),
                    **_arrays(shown["CellData"]),
                }
            for name, values in self._field.items():
                self._check(len(values) == len(self.points), name)
        self.names = list(self._field)

    def _check(self, is_good, name):
        if not is_good:
            raise ValueError(f"{name} does not have the shape that frames have")

    def field(self, name):
        """[n] or [n][width]; a field that is not drawn but part of the state is found too."""
        if name in self._field:
            return self._field[name]
        values = state(self.path, f"{self._table()}/{name}")
        if values is None:
            raise SystemExit(f"{self.path}: no field '{name}'; there are: {', '.join(self.names)}")
        return values

    def unit(self, name):
        """m/s, or nothing for a pure number."""
        shown = (
            "VTKHDF/PointData/"
            if self.corners is None or name == "displacement"
            else "VTKHDF/CellData/"
        )
        with _opened(self.path) as file:
            unit = (
                file[(shown if name in self._field else f"democles/{self._table()}/") + name]
                .attrs.get("unit", b"")
                .decode()
            )
        return "" if unit == "1" else unit

    def step(self):
        """Of the run, from its start on."""
        return attribute(self.path, "step")

    def _table(self):
        return "elements" if self.corners is None else "cells"


def _arrays(group):
    return {name: dataset[()] for name, dataset in group.items()}


def state(path, name):
    """A dataset of the state, as `elements/force`; None where there is none."""
    with _opened(path) as file:
        dataset = file.get("democles/" + name)
        return None if dataset is None else dataset[()]


def attribute(path, name):
    """A whole number that belongs to the state, as `step`."""
    with _opened(path) as file:
        return int(file["democles"].attrs[name])
