#!/usr/bin/python3
"""scripts/render.py and scripts/plot.py: walls where and when they are, spheres of their size and
colour, pictures and films of a run.

Argument: results_tool. Called by meson."""
import math
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SCRIPTS = pathlib.Path(__file__).resolve().parent.parent.parent / "scripts"
TOOL = sys.argv.pop(1)
sys.path.insert(0, str(SCRIPTS))
import numpy  # noqa: E402
from matplotlib import pyplot  # noqa: E402

from democles import display, frames, plot, render_picture, render_view, render_walls  # noqa: E402

SCENE = """title: "three spheres"
gravity: [0, 0, -9.81]
walls:
  - name: floor
    surface: {plane: {point: [0, 0, 0.52], normal: [0, 0, 1]}}
"""


class Walls(unittest.TestCase):
    """Geometry alone."""

    def test_rectangle_axes(self):
        for normal, u, v in (
            ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
            ((-1, 0, 0), (0, 1, 0), (0, 0, 1)),
            ((0, 1, 0), (1, 0, 0), (0, 0, 1)),
            ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
            ((0, 0, 1), (1, 0, 0), (0, 1, 0)),
            ((0, 0, -1), (1, 0, 0), (0, 1, 0)),
        ):
            found = render_walls.rectangle_axes(numpy.array(normal, float))
            numpy.testing.assert_allclose(found, (u, v), atol=1e-15)

    def test_plane_is_cut_to_the_box(self):
        low, high = numpy.array([0.0, 0, 0]), numpy.array([2.0, 3, 4])
        flat = render_walls.plane({"point": [9, 9, "1e0"], "normal": [0, 0, 2]}, low, high)
        self.assertEqual(flat.GetBounds(), (0, 2, 0, 3, 1, 1))
        slope = render_walls.plane({"point": [1, 1.5, 2], "normal": [-2, 0, 1]}, low, high)
        corners = numpy.array([slope.GetPoint(k) for k in range(slope.GetNumberOfPoints())])
        numpy.testing.assert_allclose(corners[:, 2], 2 * corners[:, 0], atol=1e-12)
        numpy.testing.assert_allclose(
            (corners.min(axis=0), corners.max(axis=0)), (low, high), atol=1e-12
        )
        self.assertIsNone(render_walls.plane({"point": [0, 0, 5], "normal": [0, 0, 1]}, low, high))

    def test_pose(self):
        wall = {
            "motion": {
                "velocity": [1, 0, 0],
                "rotation": {"center": [1, 0, 0], "axis": [0, 0, 3], "rate": math.pi / 4},
                "oscillation": {"amplitude": [0, 0, 0.5], "frequency": 0.125},
            }
        }
        rotation, translation = render_walls.pose(
            wall, 2.0
        )  # a quarter turn, two metres, a quarter period
        numpy.testing.assert_allclose(rotation @ (2, 0, 0) + translation, (3, 1, 0.5), atol=1e-12)
        numpy.testing.assert_allclose(rotation @ (1, 0, 7) + translation, (3, 0, 7.5), atol=1e-12)
        rotation, translation = render_walls.pose({}, 2.0)
        numpy.testing.assert_allclose(rotation @ (1, 2, 3) + translation, (1, 2, 3))

    def test_is_there_from_appear_at_until_remove_at(self):
        wall = {"motion": {"appear_at": 0.1, "remove_at": "3e-1"}}
        times = (0, 0.0999, 10000 * 1e-5, 0.2, 0.29999, 30000 * 1e-5, 1)
        self.assertEqual(
            [render_walls.is_there(wall, t) for t in times],
            [False, False, True, True, True, False, False],
        )
        self.assertTrue(
            render_walls.is_there({"motion": {"appear_at": 0, "remove_at": "never"}}, 1e9)
        )

    def test_cylinder_and_box(self):
        self.assertEqual(
            render_walls.box({"min": [0, 1, 2], "max": [3, 4, 5]}).GetBounds(), (0, 3, 1, 4, 2, 5)
        )
        surface = {"from": [0, 0, 1], "to": [0, 0, 3], "radius": 0.5}
        self.assertAlmostEqual(
            numpy.linalg.norm(
                render_walls.vertices({"surface": {"cylinder": surface}})[:, :2], axis=1
            ).max(),
            0.5,
            6,
        )
        tube = render_walls.cylinder(surface)
        at = numpy.array([tube.GetPoint(k) for k in range(tube.GetNumberOfPoints())])
        numpy.testing.assert_allclose(numpy.hypot(at[:, 0], at[:, 1]), 0.5)
        self.assertEqual(sorted(set(at[:, 2])), [1, 3])


class Made:
    """A frame out of nothing."""

    corners = None  # no solid

    def __init__(self, points, radius, time=0.0):
        self.points, self.radius, self.time = (
            numpy.array(points, float),
            numpy.array(radius, float),
            time,
        )

    def field(self, name):
        return {"radius": self.radius}[name]


def view(walls=()):
    low, high = -numpy.ones(3), numpy.ones(3)
    axes = render_view.view_axes(low, high, (0, 0, -1), (0, -1, 0))  # along y: x to the right, z up
    colours = numpy.array([[1, 0, 0, 1], [0, 0, 1, 1]], float)
    return render_view.View((200, 200), 2, axes, (low, high), 90.0, walls, colours)


class Drawing(unittest.TestCase):
    def test_sphere_has_its_size_and_place(self):
        image = view().draw(Made([[0.5, 0, -0.25]], [0.4]), numpy.zeros(1), (0, 1)).astype(int)
        rows, columns = numpy.nonzero(image.min(axis=2) < 250)
        self.assertAlmostEqual(len(rows), math.pi * (0.4 * 90) ** 2, delta=0.04 * math.pi * 36**2)
        self.assertAlmostEqual(columns.mean(), 100 + 0.5 * 90, delta=1)
        self.assertAlmostEqual(rows.mean(), 100 + 0.25 * 90, delta=1)

    def test_colour_follows_the_value(self):
        image = (
            view()
            .draw(Made([[-0.5, 0, 0], [0.5, 0, 0]], [0.4, 0.4]), numpy.array([0.0, 1.0]), (0, 1))
            .astype(int)
        )
        left, right = image[100, 55], image[100, 145]
        self.assertGreater(left[0], left[2] + 100)
        self.assertGreater(right[2], right[0] + 100)

    def test_prefix_suits_the_largest_value(self):
        for unit, high, expected in (
            ("Pa", 8e7, (1e6, "M")),
            ("m/s", 0.13, (1, "")),
            ("m", 2e-3, (1e-3, "m")),
            ("N", 7e-5, (1e-6, "\u00b5")),
            ("kg", 1e-6, (1, "")),
            ("", 1e6, (1, "")),
        ):
            colours = render_picture.Colours.__new__(render_picture.Colours)
            colours.low, colours.high, colours.unit = 0.0, high, unit
            self.assertEqual(colours.prefix(), expected, unit)

    def test_nearer_sphere_hides(self):
        image = (
            view()
            .draw(Made([[0, 0.5, 0], [0, -0.5, 0]], [0.4, 0.4]), numpy.array([0.0, 1.0]), (0, 1))
            .astype(int)
        )
        self.assertGreater(image[100, 100, 2], image[100, 100, 0] + 100)

    def test_wall_comes_moves_and_goes(self):
        wall = {
            "name": "plate",
            "surface": {
                "rectangle": {"center": [0, 0, 0], "normal": [0, 1, 0], "size": [0.5, 0.5]}
            },
            "motion": {"velocity": [0.5, 0, 0], "appear_at": 0, "remove_at": 1.5},
        }
        seen = view([wall])
        columns = []
        for time in (0.0, 1.0, 2.0):
            image = seen.draw(Made(numpy.zeros((0, 3)), [], time), numpy.zeros(0), (0, 1)).astype(
                int
            )
            columns.append(numpy.nonzero(image.min(axis=2) < 250)[1])
        self.assertAlmostEqual(columns[0].mean(), 100, delta=1.5)
        self.assertAlmostEqual(columns[1].mean(), 100 + 0.5 * 90, delta=1.5)
        self.assertEqual(len(columns[2]), 0)

    def test_thin_things_are_seen_from_their_broad_side(self):
        for thin in (0, 1):
            high = numpy.ones(3)
            high[thin] = 0.1
            right, up, back = render_view.view_axes(numpy.zeros(3), high, (0, 0, -9.81))
            self.assertGreater(abs(back[thin]), 0.9)
            self.assertGreater(up[2], 0.9)
            self.assertGreater(
                right[1 - thin], 0.9
            )  # from -y or from +x: the other axis points to the right

    def test_flat_things_are_seen_from_above_a_corner(self):
        """The longer side points to the right, the corner of lowest x and y,
        or of largest x and lowest y, to the eye."""
        for size, along, nearest in (((1, 1, 0.1), 0, (-1, -1)), ((1, 2, 0.1), 1, (1, -1))):
            right, up, back = render_view.view_axes(numpy.zeros(3), numpy.array(size), None)
            self.assertGreater(right[along], 0.9)
            self.assertGreater(up[2], 0.7)
            self.assertTrue(all(b * n > 0.3 for b, n in zip(back, nearest)))


class Solid:
    """A cube of edge 1 whose corners are displaced along x by so much."""

    def __init__(self, by):
        self.corners = render_view.corners_of(numpy.zeros(3), numpy.ones(3))[None]
        self.displacement = by * numpy.array([1, 0, 0]) * numpy.ones((1, 8, 1))


class Warp(unittest.TestCase):
    def test_small_displacements_are_magnified_large_ones_are_not_made_smaller(self):
        for by, factor in ((1e-3, 50), (0.03, 2), (0.09, 1), (5, 1)):
            self.assertEqual(render_picture.magnification([Solid(by)]), factor)
        self.assertEqual(render_picture.magnification([Made([[0, 0, 0]], [1])]), 1)


class Folder(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.dir = pathlib.Path(tempfile.mkdtemp(prefix="democles_pictures_"))
        subprocess.run([TOOL, "frame", cls.dir], check=True)
        shutil.copy(cls.dir / "frame_000007.hdf", cls.dir / "frame_000011.hdf")
        (cls.dir / "resolved.yaml").write_text(SCENE)

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.dir)

    def render(self, *arguments, env=None):
        return subprocess.run(
            [SCRIPTS / "render.py", self.dir, *arguments],
            capture_output=True,
            text=True,
            timeout=120,
            env=env,
        )

    def test_frame(self):
        frame = frames.Frame(self.dir / "frame_000007.hdf")
        self.assertEqual(
            (frame.unit("velocity"), frame.unit("coordination"), frame.time), ("m/s", "", 0.042)
        )
        self.assertEqual(frame.field("displacement").shape, (3, 3))  # of the state, not drawn
        self.assertEqual(frame.unit("displacement"), "m")
        self.assertEqual(frame.field("displacement")[2][1], 2 * 2 - 0.7)

    def test_picture_without_display(self):
        env = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
        run = self.render("--size", "640x480", env=env)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(run.stdout.strip(), str(self.dir / "overview.png"))
        image = pyplot.imread(self.dir / "overview.png")[:, :, :3]
        self.assertEqual(image.shape, (480, 640, 3))
        coloured = numpy.ptp(image, axis=2) > 0.2
        for half in (
            coloured[:380, :320],
            coloured[:380, 320:],
        ):  # two frames, two panels; the colour bar lies below
            self.assertGreater(half.sum(), 100)

    def test_film(self):
        run = self.render(
            "--film", "--size", "320x240", "-o", self.dir / "f.mp4", "--field", "coordination"
        )
        self.assertEqual(run.returncode, 0, run.stderr)
        probe = [
            "ffprobe",
            "-v",
            "error",
            "-count_frames",
            "-show_entries",
            "stream=width,height,nb_read_frames",
            "-of",
            "csv=p=0",
        ]
        probe.append(self.dir / "f.mp4")
        self.assertEqual(
            subprocess.run(probe, capture_output=True, text=True, check=True).stdout.strip(),
            "320,240,2",
        )

    def test_mistakes_are_named(self):
        for arguments, says in (
            (("--frame", "3"), "last is frame_000011.hdf"),
            (("--field", "colour"), "no field 'colour'"),
            (("--frame", "last", "--field", "nothing"), "there are:"),
        ):
            run = self.render(*arguments)
            self.assertEqual(run.returncode, 1)
            self.assertIn(says, run.stderr)
            self.assertNotIn("Traceback", run.stderr)

    def test_options_that_are_no_numbers(self):
        for option, value in (
            ("--frame", "x"),
            ("--range", "1"),
            ("--range", "2,1"),
            ("--size", "10"),
            ("--size", "0x0"),
            ("--view", "0,0,0"),
            ("--view", "1,0,nan"),
            ("--fps", "-1"),
        ):
            run = subprocess.run(
                [SCRIPTS / "render.py", self.dir, f"{option}={value}"],
                capture_output=True,
                text=True,
            )
            self.assertEqual((run.returncode, run.stdout), (2, ""))
            self.assertIn(f"error: argument {option}: '{value}': expected ", run.stderr)

    def test_plots(self):
        subprocess.run([TOOL, "record", self.dir], check=True, capture_output=True)
        (self.dir / "notes.csv").write_text("of the user,x\n1,2\n")
        run = subprocess.run(
            [SCRIPTS / "plot.py", self.dir], capture_output=True, text=True, timeout=60
        )
        self.assertEqual(
            (run.returncode, run.stdout.split()), (0, [str(self.dir / "outflow.png")]), run.stderr
        )
        self.assertGreater(numpy.ptp(pyplot.imread(self.dir / "outflow.png")), 0.5)

    def test_file_that_cannot_be_written(self):
        """One line that names the file, no traceback; /proc lets nobody make a file."""
        other = self.dir / "other"
        other.mkdir()
        (other / "m.csv").write_text("time [s],a [J]\n0,1\n1,2\n")
        (other / "m.png").symlink_to("/proc/nowhere.png")
        for script, arguments in (
            ("plot.py", [other]),
            ("render.py", [self.dir, "-o", "/proc/nowhere.png"]),
        ):
            run = subprocess.run([SCRIPTS / script, *arguments], capture_output=True, text=True)
            self.assertEqual((run.returncode, run.stdout), (1, ""), run.stderr)
            self.assertEqual(len(run.stderr.splitlines()), 1, run.stderr)
            self.assertIn(".png: No such file or directory", run.stderr)
        shutil.rmtree(other)

    def test_series_that_a_crash_cut_short(self):
        (self.dir / "cut.csv").write_text('time [s],a [J],"b, c [1]"\n0,1,2\n1,2,3\n2,3')
        titles, values = plot.read(self.dir / "cut.csv")
        self.assertEqual(titles, [("time", "s"), ("a", "J"), ("b, c", "1")])
        self.assertEqual(values.tolist(), [[0, 1, 2], [1, 2, 3]])
        (self.dir / "cut.csv").unlink()


if __name__ == "__main__":
    missing = display.ensure()
    if missing:
        sys.exit(missing)
    unittest.main(verbosity=2)
