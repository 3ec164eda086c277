"""Few bodies, exact answers: what the tests through the program share.
Writes scenes, runs them, reads the state at the end."""
import json
import math
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import numpy  # noqa: E402

from democles import expect, frames  # noqa: E402

DEMOCLES = None


class State:
    """Of all elements at the end of a run, by number: x, v [n][3], w [n][3], radius [n];
    the folder's measures by name."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        last = frames.Frame(frames.paths(folder)[-1])
        order = numpy.argsort(last.field("id"))
        self.x, self.v, self.radius = (
            last.points[order],
            last.field("velocity")[order],
            last.field("radius")[order],
        )
        self.w = last.field("angular_velocity")[order]

    def series(self, name):
        return expect.series(self.folder, name)


class Case(unittest.TestCase):
    """The scene's text comes as dict; JSON is YAML."""

    def setUp(self):
        self.dir = pathlib.Path(tempfile.mkdtemp(prefix="democles_bodies_"))
        self.addCleanup(shutil.rmtree, self.dir, True)

    def spheres(self, name, rows):
        """A CSV of rows (x, v, radius, w), each vector of 3; returns its name."""
        with open(self.dir / name, "w") as file:
            file.write("x,y,z,radius,vx,vy,vz,wx,wy,wz\n")
            for x, v, radius, w in rows:
                file.write(",".join(repr(float(value)) for value in (*x, radius, *v, *w)) + "\n")
        return name

    def brick(self, name, corner, sides):
        """An STL of a box of any direction; sides: its three edges at the corner, right-handed."""
        ends = [
            corner + x * sides[0] + y * sides[1] + z * sides[2]
            for x in (0, 1)
            for y in (0, 1)
            for z in (0, 1)
        ]
        faces = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
        with open(self.dir / name, "w") as file:
            file.write("solid brick\n")
            for face in faces:
                for a, b, c in ((0, 1, 2), (0, 2, 3)):
                    file.write("facet normal 0 0 0\nouter loop\n")
                    for k in (a, b, c):
                        file.write("vertex %.12g %.12g %.12g\n" % tuple(ends[face[k]]))
                    file.write("endloop\nendfacet\n")
            file.write("endsolid brick\n")

    def run_scene(self, scene, out="out"):
        scene = {
            "method": "particles",
            "output": {"fields": ["velocity", "angular_velocity", "radius", "id"]},
            **scene,
        }
        return State(self.run_folder(scene, out))

    def run_folder(self, scene, out="out"):
        (self.dir / "scene.yaml").write_text(json.dumps(scene, indent=1))
        done = subprocess.run(
            [DEMOCLES, "run", "scene.yaml", "-o", out, "--force", "--quiet"],
            cwd=self.dir,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        self.assertEqual(done.returncode, 0, done.stdout)
        return self.dir / out

    def below(self, what, value, bound):
        print(f"{what}: {value:.3g} (bound {bound:.3g})")
        self.assertLess(value, bound, what)


def density_of(mass, radius):
    return mass / (4 / 3 * math.pi * radius**3)


def main():
    global DEMOCLES
    DEMOCLES = str(pathlib.Path(sys.argv.pop(1)).resolve())
    unittest.main(module="__main__")
