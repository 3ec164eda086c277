"""One view of elements or a solid, and walls by VTK, without any text: parallel projection, so that
all panels and frames have one scale."""
import numpy
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401 (chooses OpenGL)
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLookupTable, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkFeatureEdges
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)
from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLSphereMapper

from democles import render_walls

WALL, EDGE = (0.45, 0.52, 0.60), (0.25, 0.30, 0.36)


def corners_of(low, high):
    return numpy.array([[(low, high)[k >> a & 1][a] for a in range(3)] for k in range(8)], float)


def view_axes(low, high, gravity, towards=None):
    """Right, up and back (to the eye) of the picture, unit vectors.
    Up is against gravity; the eye looks along the thinnest extent, a little from the side and from
    above, so that it is seen to be a body."""
    gravity = numpy.array([float(g) for g in gravity or (0, 0, 0)])
    up = (
        -gravity / numpy.linalg.norm(gravity)
        if numpy.linalg.norm(gravity) > 0
        else numpy.array([0.0, 0.0, 1.0])
    )
    if towards is None:
        thin = int(numpy.argmin(high - low))
        back = numpy.eye(3)[thin] * (
            -1 if thin == 1 else 1
        )  # from -y the x axis points to the right
        if (
            abs(back @ up) > 0.9
        ):  # thin in the direction of gravity: from the side, turned, well above
            along, across = (a for a in range(3) if a != thin)
            if (high - low)[across] > 1.25 * (high - low)[along]:
                along, across = across, along
            back = (
                numpy.eye(3)[across] * (-1 if across == 1 else 1)
                - 0.45 * numpy.eye(3)[along]
                + 0.75 * up
            )
        else:
            back = back + 0.32 * numpy.cross(up, back) + 0.22 * up
    else:
        back = numpy.array(towards, float)
    back /= numpy.linalg.norm(back)
    if abs(back @ up) > 0.999:
        up = numpy.eye(3)[1] if abs(back[1]) < 0.9 else numpy.eye(3)[0]
    right = numpy.cross(up, back)
    right /= numpy.linalg.norm(right)
    return right, numpy.cross(back, right), back


def single_points(n):
    """n cells of one point each: what has no cells is not drawn."""
    cells = vtkCellArray()
    begin, ids = (
        numpy_to_vtkIdTypeArray(numpy.arange(m, dtype=numpy.int64), deep=True) for m in (n + 1, n)
    )
    cells.SetData(begin, ids)
    return cells


FACES = (
    (0, 3, 2, 1),
    (4, 5, 6, 7),
    (0, 1, 5, 4),
    (1, 2, 6, 5),
    (2, 3, 7, 6),
    (3, 0, 4, 7),
)  # of a hexahedron, corners in VTK's order


def faces_of(n):
    """The six faces of n hexahedra with eight points each."""
    ids = (
        8 * numpy.arange(n, dtype=numpy.int64)[:, None, None] + numpy.array(FACES, numpy.int64)
    ).reshape(-1)
    cells = vtkCellArray()
    cells.SetData(
        *(
            numpy_to_vtkIdTypeArray(a, deep=True)
            for a in (numpy.arange(0, len(ids) + 1, 4, dtype=numpy.int64), ids)
        )
    )
    return cells


class View:
    """draw() gives [height][width][3] bytes.
    `sharpness` times as many pixels are drawn and averaged. warp: factor on a solid's
    displacements."""

    def __init__(self, panel, sharpness, axes, box, pixels_per_metre, walls, colours, warp=1.0):
        self.panel, self.sharpness, self.warp = panel, sharpness, warp
        self.renderer, self.window = vtkRenderer(), vtkRenderWindow()
        self.renderer.SetBackground(1, 1, 1)
        self.renderer.UseFXAAOn()
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(panel[0] * sharpness, panel[1] * sharpness)
        self.window.AddRenderer(self.renderer)
        self.add_elements(colours)
        self.walls = [(wall, self.add_wall(wall, *box)) for wall in walls]
        self.look(axes, box, pixels_per_metre)
        self.grab = vtkWindowToImageFilter()
        self.grab.SetInput(self.window)
        self.grab.ReadFrontBufferOff()

    def add_elements(self, colours):
        table = vtkLookupTable()
        table.SetNumberOfTableValues(len(colours))
        for k, colour in enumerate(colours):
            table.SetTableValue(k, *colour)
        spheres = vtkOpenGLSphereMapper()
        spheres.SetScaleArray("radius")
        self.elements, self.solid = (
            self.add_body(mapper, table) for mapper in (spheres, vtkPolyDataMapper())
        )

    def add_body(self, mapper, table):
        """(data, mapper, actor) of what has colours."""
        data, actor = vtkPolyData(), vtkActor()
        mapper.SetInputData(data)
        mapper.SetLookupTable(table)
        mapper.SetUseLookupTableScalarRange(0)
        actor.SetMapper(mapper)
        look = actor.GetProperty()
        look.SetAmbient(0.3)
        look.SetDiffuse(0.8)
        look.SetSpecular(0.12)
        look.SetSpecularPower(25)
        self.renderer.AddActor(actor)
        return data, mapper, actor

    def add_wall(self, wall, low, high):
        """Glass, and its edges; both move together. Nothing for what cannot be drawn."""
        surface = render_walls.surface_of(wall, low, high)
        if surface is None:
            return []
        edges = vtkFeatureEdges()
        edges.SetInputData(surface)
        edges.SetFeatureAngle(25)
        edges.ManifoldEdgesOff()
        edges.NonManifoldEdgesOff()
        edges.ColoringOff()
        actors = []
        for k in range(2):
            mapper, actor = vtkPolyDataMapper(), vtkActor()
            mapper.SetInputData(surface) if k == 0 else mapper.SetInputConnection(
                edges.GetOutputPort()
            )
            mapper.ScalarVisibilityOff()
            actor.SetMapper(mapper)
            look = actor.GetProperty()
            look.SetColor(*(WALL, EDGE)[k])
            look.SetOpacity((0.16, 1.0)[k])
            look.SetLighting(False)
            look.SetLineWidth(1.2 * self.sharpness)
            self.renderer.AddActor(actor)
            actors.append(actor)
        return actors

    def look(self, axes, box, pixels_per_metre):
        right, up, back = axes
        corners = corners_of(*box)
        seen = numpy.array([corners @ right, corners @ up, corners @ back])
        middle = (seen.min(axis=1) + seen.max(axis=1)) / 2
        focus = middle[0] * right + middle[1] * up + middle[2] * back
        depth = numpy.ptp(seen[2]) + 1e-12
        camera = self.renderer.GetActiveCamera()
        camera.ParallelProjectionOn()
        camera.SetFocalPoint(*focus)
        camera.SetPosition(*(focus + 2 * depth * back))
        camera.SetViewUp(*up)
        camera.SetParallelScale(self.panel[1] / pixels_per_metre / 2)
        camera.SetClippingRange(0.5 * depth, 3.5 * depth)

    def place(self, body, at, cells, arrays, ends):
        """Gives a body its points, cells and arrays (by name; the last one colours)."""
        data, mapper, actor = body
        points = vtkPoints()
        points.SetData(numpy_to_vtk(numpy.ascontiguousarray(at, numpy.float32), deep=True))
        data.Initialize()
        data.SetPoints(points)
        data.SetVerts(cells) if data is self.elements[0] else data.SetPolys(cells)
        fields = data.GetPointData() if data is self.elements[0] else data.GetCellData()
        for name, array in arrays:
            values = numpy_to_vtk(numpy.ascontiguousarray(array, numpy.float32), deep=True)
            values.SetName(name)
            fields.AddArray(values)
            fields.SetActiveScalars(name)
        mapper.SetScalarRange(*ends)

    def draw(self, frame, values, ends):
        n, is_solid = len(frame.points), frame.corners is not None
        self.elements[2].SetVisibility(n > 0 and not is_solid)
        self.solid[2].SetVisibility(is_solid)
        if is_solid:
            at = (frame.corners + self.warp * frame.displacement).reshape(-1, 3)
            self.place(
                self.solid, at, faces_of(n), [("colour", numpy.repeat(values, len(FACES)))], ends
            )
        elif n:
            self.place(
                self.elements,
                frame.points,
                single_points(n),
                [("radius", frame.field("radius")), ("colour", values)],
                ends,
            )
        for wall, actors in self.walls:
            for actor in actors:
                actor.SetVisibility(render_walls.is_there(wall, frame.time))
                actor.SetUserMatrix(render_walls.matrix(*render_walls.pose(wall, frame.time)))
        self.window.Render()
        self.grab.Modified()
        self.grab.Update()
        image = self.grab.GetOutput()
        width, height, _ = image.GetDimensions()
        pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1)[
            ::-1, :, :3
        ]
        s = self.sharpness
        if s == 1:
            return pixels
        return (
            pixels.reshape(height // s, s, width // s, s, 3).mean(axis=(1, 3)).astype(numpy.uint8)
        )
