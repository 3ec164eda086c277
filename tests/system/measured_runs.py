#!/usr/bin/python3
"""What a frame and a measure say of contacts, against closed forms; the same bits on any number of
ranks. Own arguments: names of tests."""
import csv
import os

import numpy
import yaml

import parallel_runs
import parallel_scenes
from parallel_runs import frames

COLUMN_STEPS = 600


class Measured(parallel_runs.Case):
    def put(self, scene):
        path = os.path.join(self.dir, "scene.yaml")
        with open(path, "w") as file:
            yaml.safe_dump(scene, file)
        return path

    def test_overlap(self):
        """A column that falls: the largest overlap of each element, found here among all pairs."""
        scene, _ = parallel_scenes.column(parallel_runs.CASES)
        scene["output"] = {"fields": ["overlap", "radius", "id"]}
        alone = None
        for n in (1, 3):
            run = self.good_run(self.put(scene), n, "--steps", str(COLUMN_STEPS))
            frame = frames.Frame(run.frames()[-1])
            order = numpy.argsort(frame.field("id"))
            x, radius, found = (
                frame.points[order],
                frame.field("radius")[order],
                frame.field("overlap")[order],
            )
            distance = numpy.linalg.norm(x[:, None] - x[None, :], axis=2)
            numpy.fill_diagonal(distance, numpy.inf)
            expected = (
                ((radius[:, None] + radius[None, :] - distance) / radius[:, None])
                .max(axis=1)
                .clip(0)
            )
            self.assertLess(
                abs(found - expected).max(), 1e-12
            )  # roundings of places of 0.1 m, in units of 4 mm
            self.assertGreater((found > 0).sum(), 50)
            alone = found.tobytes() if n == 1 else alone
            self.assertEqual(found.tobytes(), alone)

    def rows(self, run, name):
        with open(os.path.join(run.dir, name + ".csv")) as file:
            return numpy.array([[float(v) for v in row] for row in list(csv.reader(file))[1:]])

    def test_torque(self):
        """A sphere on a plate that turns, off its axis.
        It lies at the overlap that bears its weight, so N = m g, and slides at once, since the
        tangential spring has stretched by v dt = 1e-5 m >> mu N/k_t. The force F on the plate acts
        at the contact c, at the end of the sphere's lever: the torque about P is (c - P) x F, and
        about the axis -mu m g d but for the way 1/2 mu g t^2 that the sphere has gone.
        """
        radius, density, k, mu, g, d, rate, dt = 0.01, 2500, 1e5, 0.3, 9.81, 0.1, 5.0, 2e-5
        weight = density * 4 / 3 * numpy.pi * radius**3 * g
        height, about, steps = radius - weight / k, [0.03, -0.02, 0.05], 50
        with open(os.path.join(self.dir, "ball.csv"), "w") as file:
            file.write("x,y,z,radius\n%.17g,0,%.17g,%.17g\n" % (d, height, radius))
        scene = {
            "title": "turntable",
            "method": "particles",
            "time": {"end": steps * dt, "step": dt},
            "gravity": [0, 0, -g],
            "materials": {"ball": {"density": density}, "plate": {"density": density}},
            "contacts": [
                {
                    "between": ["ball", other],
                    "normal": {"law": "linear", "stiffness": k, "damping_ratio": 0},
                    "tangential": {"stiffness_ratio": 0.8, "friction": mu},
                }
                for other in ("ball", "plate")
            ],
            "elements": [{"name": "ball", "material": "ball", "file": "ball.csv"}],
            "walls": [
                {
                    "name": "plate",
                    "material": "plate",
                    "surface": {
                        "rectangle": {"center": [0, 0, 0], "normal": [0, 0, 1], "size": [0.5, 0.5]}
                    },
                    "motion": {"rotation": {"center": [0, 0, 0], "axis": [0, 0, 1], "rate": rate}},
                }
            ],
            "measure": [
                {"name": "force", "every": dt, "wall_force": "plate"},
                {"name": "ball", "every": dt, "probe": {"element": 0}},
                {"name": "axis", "every": dt, "wall_torque": {"wall": "plate"}},
                {"name": "other", "every": dt, "wall_torque": {"wall": "plate", "about": about}},
            ],
        }
        run = self.good_run(self.put(scene), 1)
        force, ball, axis, other = (
            self.rows(run, name)[2:] for name in ("force", "ball", "axis", "other")
        )
        contact = ball[:, 1:4].copy()
        contact[:, 2] = 0
        for torque, point in ((axis, [0, 0, 0]), (other, about)):
            expected = numpy.cross(contact - point, force[:, 1:4])
            self.assertLess(abs(torque[:, 1:4] - expected).max(), 1e-12 * weight)
        self.assertLess(
            abs(numpy.hypot(force[:, 1], force[:, 2]) / (-mu * force[:, 3]) - 1).max(), 1e-12
        )
        gone = (0.5 * mu * g * (steps * dt) ** 2 + rate * d * dt) / d
        self.assertLess(abs(axis[:, 3] / (-mu * weight * d) - 1).max(), gone)
        self.assertLess(abs(axis[:, 2] / (weight * d) - 1).max(), gone)

    def test_torque_on_ranks(self):
        """A column that falls into a trough: the same bits on any number of ranks,
        and of a wall without friction too."""
        scene, _ = parallel_scenes.column(parallel_runs.CASES)
        every = scene["time"]["step"] * 10
        scene["measure"] = [
            {
                "name": "torque",
                "every": every,
                "wall_torque": {"wall": "trough", "about": [0.1, 0.02, 0]},
            }
        ]
        for friction in (True, False):
            alone = None
            if not friction:
                for contact in scene["contacts"]:
                    del contact["tangential"]
            for n in (1, 3):
                run = self.good_run(self.put(scene), n, "--steps", str(COLUMN_STEPS))
                alone = alone or run.series()
                self.assertEqual(run.series(), alone)
                self.assertGreater(abs(self.rows(run, "torque")[-1, 1:]).min(), 1e-9)


if __name__ == "__main__":
    parallel_runs.main(0)
