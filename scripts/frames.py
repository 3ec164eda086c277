"""What the scripts and checks share: frames of a run as arrays with units, and the resolved scene as numbers.

Fields come through VTK's own HDF reader (the same that ParaView has); units, and datasets of the state below /democles, which that reader does not
show, come straight from libhdf5, the library that VTK has loaded already."""
import ctypes
import ctypes.util
import pathlib

import numpy
import yaml
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader


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
    `corners` and `displacement` of the corners [n][8][3] [m], the former at the start; else `corners` is None."""

    def __init__(self, path):
        self.path = str(path)
        reader = vtkHDFReader()
        if not reader.CanReadFile(self.path):
            raise SystemExit(f"{self.path}: not a frame")
        reader.SetFileName(self.path)
        reader.Update()
        grid = reader.GetOutput()
        points, data, time = grid.GetPoints(), grid.GetPointData(), grid.GetFieldData().GetArray("TimeValue")
        if not grid.GetNumberOfPoints():
            self.points = numpy.zeros((0, 3))
        else:
            self.points = vtk_to_numpy(points.GetData())
        self.time = time.GetValue(0) if time else 0.0
        self._field, self.corners = _arrays(data), None
        if grid.GetNumberOfCells() and grid.GetCellType(0) == HEXAHEDRON:
            self.corners, self.displacement = self.points.reshape(-1, 8, 3), self._field["displacement"].reshape(-1, 8, 3)
            self.points = (self.corners + self.displacement).mean(axis=1)
            self._field = {"displacement": self.displacement.mean(axis=1), **_arrays(grid.GetCellData())}
        self.names = list(self._field)

    def field(self, name):
        """[n] or [n][width]; a field that is not drawn but part of the state is found too."""
        if name in self._field:
            return self._field[name]
        values = _dataset(self.path, f"democles/{self._table()}/{name}")
        if values is None:
            raise SystemExit(f"{self.path}: no field '{name}'; there are: {', '.join(self.names)}")
        return values

    def unit(self, name):
        """m/s, or nothing for a pure number."""
        shown = "VTKHDF/PointData/" if self.corners is None or name == "displacement" else "VTKHDF/CellData/"
        place = shown if name in self._field else f"democles/{self._table()}/"
        unit = _attribute(self.path, place + name, "unit").split(b"\0")[0].decode()
        return "" if unit == "1" else unit

    def step(self):
        """Of the run, from its start on."""
        return int.from_bytes(_attribute(self.path, "democles", "step"), "little", signed=True)

    def _table(self):
        return "elements" if self.corners is None else "cells"


def _arrays(data):
    return {data.GetArrayName(k): vtk_to_numpy(data.GetArray(k)) for k in range(data.GetNumberOfArrays())}


def _library():
    """libhdf5 without MPI, with the few functions used here; hid_t is 64 bits since 1.10."""
    name = ctypes.util.find_library("hdf5_serial") or ctypes.util.find_library("hdf5")
    if not name:
        return None
    lib = ctypes.CDLL(name)
    hid, text = ctypes.c_int64, ctypes.c_char_p
    for function, result, arguments in (
            ("H5Eset_auto2", ctypes.c_int, (hid, ctypes.c_void_p, ctypes.c_void_p)), ("H5Fopen", hid, (text, ctypes.c_uint, hid)),
            ("H5Aopen_by_name", hid, (hid, text, text, hid, hid)), ("H5Aget_type", hid, (hid,)), ("H5Tget_size", ctypes.c_size_t, (hid,)),
            ("H5Aread", ctypes.c_int, (hid, hid, ctypes.c_void_p)), ("H5Dopen2", hid, (hid, text, hid)), ("H5Dget_type", hid, (hid,)),
            ("H5Dget_space", hid, (hid,)), ("H5Tget_class", ctypes.c_int, (hid,)), ("H5Sget_simple_extent_ndims", ctypes.c_int, (hid,)),
            ("H5Sget_simple_extent_dims", ctypes.c_int, (hid, ctypes.c_void_p, ctypes.c_void_p)),
            ("H5Dread", ctypes.c_int, (hid, hid, hid, hid, hid, ctypes.c_void_p))):
        getattr(lib, function).restype = result
        getattr(lib, function).argtypes = arguments
    for function in ("H5Fclose", "H5Aclose", "H5Dclose", "H5Tclose", "H5Sclose"):
        getattr(lib, function).argtypes = (hid,)
    lib.H5open()
    lib.H5Eset_auto2(0, None, None)  # what is missing is an answer here, not an error
    return lib


_hdf5 = _library()


def _attribute(path, owner, name):
    """The bytes of an attribute, or none where there is none. Numbers are little-endian."""
    file = _hdf5.H5Fopen(path.encode(), 0, 0) if _hdf5 else -1
    attribute = _hdf5.H5Aopen_by_name(file, owner.encode(), name.encode(), 0, 0) if file >= 0 else -1
    value = b""
    if attribute >= 0:
        kind = _hdf5.H5Aget_type(attribute)
        buffer = ctypes.create_string_buffer(_hdf5.H5Tget_size(kind))
        _hdf5.H5Aread(attribute, kind, buffer)
        value = buffer.raw
        _hdf5.H5Tclose(kind)
        _hdf5.H5Aclose(attribute)
    if file >= 0:
        _hdf5.H5Fclose(file)
    return value


def _dataset(path, name):
    """A dataset of numbers as array, or None where there is none. Stored little-endian, which is read as it lies."""
    file = _hdf5.H5Fopen(path.encode(), 0, 0) if _hdf5 else -1
    dataset = _hdf5.H5Dopen2(file, name.encode(), 0) if file >= 0 else -1
    values = None
    if dataset >= 0:
        kind, space = _hdf5.H5Dget_type(dataset), _hdf5.H5Dget_space(dataset)
        shape = (ctypes.c_uint64 * _hdf5.H5Sget_simple_extent_ndims(space))()
        _hdf5.H5Sget_simple_extent_dims(space, shape, None)
        size = _hdf5.H5Tget_size(kind)
        letter = "f" if _hdf5.H5Tget_class(kind) == 1 else "i" if size > 1 else "u"
        values = numpy.empty(tuple(shape), dtype=f"<{letter}{size}")
        _hdf5.H5Dread(dataset, kind, 0, 0, 0, values.ctypes.data)
        _hdf5.H5Tclose(kind)
        _hdf5.H5Sclose(space)
        _hdf5.H5Dclose(dataset)
    if file >= 0:
        _hdf5.H5Fclose(file)
    return values
