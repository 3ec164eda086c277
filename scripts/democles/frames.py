"""What the tools and checks share: frames of a run as arrays with units, and the resolved scene as numbers."""
import pathlib

import h5py
import numpy
import yaml


def paths(folder):
    """The frames of a run, in order."""
    return sorted(pathlib.Path(folder).glob("frame_[0-9]*.hdf"))


def scene(folder):
    """The resolved scene; numbers as YAML 1.1 misreads them (1e-05) are still text: see `number`."""
    return yaml.safe_load((pathlib.Path(folder) / "resolved.yaml").read_text())


def number(value):
    """A number of the resolved scene (SI, no unit); `never` and `none` are infinite."""
    return float("inf") if value in ("never", "none") else float(value)


HEXAHEDRON = 12  # VTK's number


class Frame:
    """One frame. `points` [n][3] [m]: centres of the elements, or of the cells of a solid; `time` [s], `names` of the fields. Of a solid also
    `corners` and `displacement` of the corners [n][8][3] [m], the former at the start; else `corners` is None.
    """

    def __init__(self, path):
        self.path = str(path)
        try:
            with h5py.File(self.path, "r") as file:
                shown = file["VTKHDF"]
                self.points, self.time = shown["Points"][()], float(shown["FieldData/TimeValue"][0])
                self._field, types = _arrays(shown["PointData"]), shown["Types"][:1]
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
        except (OSError, KeyError) as error:
            raise SystemExit(f"{self.path}: not a frame: {error}") from error
        self.names = list(self._field)

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
        with h5py.File(self.path, "r") as file:
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
    with h5py.File(path, "r") as file:
        dataset = file.get("democles/" + name)
        return None if dataset is None else dataset[()]


def attribute(path, name):
    """A whole number that belongs to the state, as `step`."""
    with h5py.File(path, "r") as file:
        return int(file["democles"].attrs[name])
