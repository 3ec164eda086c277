"""Walls of a resolved scene as surfaces to draw: plane, rectangle, box, cylinder, STL, at their
pose of a time, while they are there."""
import math

import numpy
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkFiltersCore import vtkCleanPolyData
from vtkmodules.vtkIOGeometry import vtkSTLReader

from democles.frames import number

CYLINDER_SIDES = 96


def vector(values):
    return numpy.array([number(v) for v in values])


def unit(v):
    return v / numpy.linalg.norm(v)


def polygons(points, faces):
    """Surface of faces, lists of indices into points [n][3]."""
    data, at, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    at.SetData(numpy_to_vtk(numpy.ascontiguousarray(points, float), deep=True))
    for face in faces:
        cells.InsertNextCell(len(face), face)
    data.SetPoints(at)
    data.SetPolys(cells)
    return data


def rectangle_axes(normal):
    """In-plane axes as src/shape/walls.h has them: leave out the coordinate axis nearest to the
    normal, project the first of the other two."""
    size = numpy.abs(normal)
    left_out = max((2, 1, 0), key=lambda a: size[a])  # z before y before x where equal
    first, second = [a for a in range(3) if a != left_out]
    u = unit(numpy.eye(3)[first] - normal[first] * normal)
    v = numpy.cross(normal, u)
    return u, v if v[second] > 0 else -v


def plane(surface, low, high):
    """The part of the plane within the box low..high, which is what a picture can show of it: the
    big square, cut at the six sides."""
    point, normal = vector(surface["point"]), unit(vector(surface["normal"]))
    u, v = rectangle_axes(normal)
    middle, reach = (low + high) / 2, numpy.linalg.norm(high - low)
    middle = middle - numpy.dot(middle - point, normal) * normal
    corners = [middle + reach * (a * u + b * v) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    for axis in range(3):
        for sign, bound in ((1, high[axis]), (-1, -low[axis])):
            corners = cut(corners, axis, sign, bound)
    return polygons(corners, [range(len(corners))]) if len(corners) > 2 else None


def cut(corners, axis, sign, bound):
    """The part of a polygon where sign x[axis] <= bound (Sutherland and Hodgman)."""
    kept = []
    for a, b in zip(corners, corners[1:] + corners[:1]):
        outside_a, outside_b = sign * a[axis] - bound, sign * b[axis] - bound
        if outside_a <= 0:
            kept.append(a)
        if outside_a * outside_b < 0:
            kept.append(a + (b - a) * outside_a / (outside_a - outside_b))
    return kept


def rectangle(surface):
    centre, normal = vector(surface["center"]), unit(vector(surface["normal"]))
    (u, v), (a, b) = rectangle_axes(normal), vector(surface["size"]) / 2
    return polygons(
        [centre + i * a * u + j * b * v for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1))],
        [range(4)],
    )


def box(surface):
    low, high = vector(surface["min"]), vector(surface["max"])
    corners = [[(low, high)[k >> a & 1][a] for a in range(3)] for k in range(8)]
    return polygons(
        corners,
        [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)],
    )


def cylinder(surface):
    start, end, radius = vector(surface["from"]), vector(surface["to"]), number(surface["radius"])
    u, v = rectangle_axes(unit(end - start))
    angle = 2 * math.pi * numpy.arange(CYLINDER_SIDES) / CYLINDER_SIDES
    ring = radius * (numpy.outer(numpy.cos(angle), u) + numpy.outer(numpy.sin(angle), v))
    n = CYLINDER_SIDES
    return polygons(
        numpy.vstack((start + ring, end + ring)),
        [(k, (k + 1) % n, n + (k + 1) % n, n + k) for k in range(n)],
    )


def stl(surface):
    reader, clean = vtkSTLReader(), vtkCleanPolyData()
    reader.SetFileName(str(surface["stl"]))
    clean.SetInputConnection(reader.GetOutputPort())
    clean.Update()
    data, scale = clean.GetOutput(), number(surface.get("scale", 1))
    if not data.GetNumberOfCells():
        return None
    for k in range(data.GetNumberOfPoints()):
        data.GetPoints().SetPoint(k, [scale * c for c in data.GetPoint(k)])
    return data


def surface_of(wall, low, high):
    """The wall at its place of time 0, or None where nothing of it can be drawn.
    low, high: the box to which a plane is cut."""
    surface = wall["surface"]
    if "plane" in surface:
        return plane(surface["plane"], low, high)
    for kind, make in (("rectangle", rectangle), ("box", box), ("cylinder", cylinder)):
        if kind in surface:
            return make(surface[kind])
    return stl(surface) if "stl" in surface else None


def vertices(wall):
    """Points [n][3] that span a wall that has an end, at time 0; None for planes."""
    if "plane" in wall["surface"]:
        return None
    data = surface_of(wall, None, None)
    return None if data is None else vtk_to_numpy(data.GetPoints().GetData()).astype(float)


def is_there(wall, time):
    """Between appear_at and remove_at; a billionth forgives the rounding of step times dt."""
    motion = wall.get("motion") or {}
    late = time + 1e-9 * max(time, 1e-6)
    return number(motion.get("appear_at", 0)) <= late < number(motion.get("remove_at", "never"))


def pose(wall, time):
    """4x4 matrix from the wall's frame to its place at a time:
    as place_at of src/shape/walls_pose.c."""
    motion = wall.get("motion") or {}
    shift = time * vector(motion.get("velocity", (0, 0, 0)))
    swing, turn = motion.get("oscillation"), motion.get("rotation")
    if swing:
        phase = 2 * math.pi * number(swing["frequency"]) * time + number(swing.get("phase", 0))
        shift = shift + math.sin(phase) * vector(swing["amplitude"])
    rotation, centre = numpy.eye(3), numpy.zeros(3)
    if turn:
        a, angle, centre = (
            unit(vector(turn["axis"])),
            number(turn["rate"]) * time,
            vector(turn["center"]),
        )
        cross = numpy.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])
        rotation = numpy.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross
    return rotation, centre + shift - rotation @ centre


def matrix(rotation, translation):
    m = vtkMatrix4x4()
    for i in range(3):
        for j in range(3):
            m.SetElement(i, j, rotation[i][j])
        m.SetElement(i, 3, translation[i])
    return m
