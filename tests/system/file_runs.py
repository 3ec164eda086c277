#!/usr/bin/python3
"""Files of results: how many there are, whose they are, and what becomes of a user's own."""
import glob
import os

import cli

SCENE = """title: two balls over a floor
method: particles
time: {end: 1e-3, step: 1e-5}
gravity: [0, 0, -9.81]
materials: {a: {density: 2500}}
contacts:
  - between: [a, a]
    normal: {law: linear, stiffness: 1e4, damping_ratio: 0.1}
    tangential: {stiffness_ratio: 0.5, friction: 0.3}
walls: [{name: f, material: a, surface: {plane: {point: [0, 0, 0], normal: [0, 0, 1]}}}]
elements: [{name: e, material: a, file: e.csv}]
output: {every: 5e-4}
measure: [{name: m, energy: all, every: 1e-4}]
"""
LATTICE = """method: lattice
time: {end: 1e-4, step: 1e-6}
materials: {a: {density: 2500, young: 1e9, poisson: 0.2}}
bodies: [{name: b, material: a, cell: 0.01, shape: {box: {min: [0, 0, 0], max: [0.03, 0.03, 0.03]}}}]
output: {every: 5e-5}
measure: [{name: m, energy: all, every: 1e-5}]
"""


class Files(cli.Case):
    def setUp(self):
        super().setUp()
        self.put("s.yaml", SCENE)
        self.put("e.csv", "x,y,z,radius\n0,0,0.1,0.05\n0.1,0.1,0.3,0.05\n")

    def text(self, name):
        with open(os.path.join(self.dir, name)) as file:
            return file.read()

    def names(self, folder, pattern="*"):
        return sorted(map(os.path.basename, glob.glob(os.path.join(self.dir, folder, pattern))))

    def good(self, *args, **more):
        run = self.call(*args, "--quiet", **more)
        self.assertEqual((run.code, run.err), (0, []))


class Often(Files):
    """Periods that are longer than any run, and shorter than any step."""

    def test_never(self):
        self.put("l.yaml", LATTICE)
        for scene in ("s.yaml", "l.yaml"):
            for k, (every, ranks) in enumerate((("1e300", 1), ("1e14", 3))):
                change = (
                    f"output={{every: {every}, checkpoint_every: 1e200}}",
                    "measure.m.every=" + every,
                )
                sets = [word for key in change for word in ("--set", key)]
                said = self.call("check", scene, *sets)
                self.assertIn(", 2 in all\n", said.out)
                folder = f"{scene}.{k}"
                self.good("run", scene, "-o", folder, *sets, ranks=ranks)
                self.assertEqual(
                    self.names(folder, "frame_*"), ["frame_000000.hdf", "frame_000001.hdf"]
                )
                self.assertEqual(len(self.text(folder + "/m.csv").splitlines()), 2)

    def test_always(self):
        """No more than one in a step."""
        sets = ["--set", "output.every=1e-300", "--set", "measure.m.every=1e-300", "--steps", "4"]
        self.good("run", "s.yaml", "-o", "d", *sets)
        self.assertEqual(len(self.names("d", "frame_*")), 5)
        self.assertEqual(len(self.text("d/m.csv").splitlines()), 6)


if __name__ == "__main__":
    cli.main(2)
