#!/usr/bin/python3
"""The plate of cases/branching, turned against its grid. Arguments: democles, and CLASS.test."""
import math

import numpy

import bodies
from democles import expect, frames

YOUNG, NU, DENSITY, ENERGY, PULL = 32e9, 0.2, 2450.0, 3.0, 1e6
LENGTH, HALF, NOTCH = 0.1, 0.02, 0.05


class Branching(bodies.Case):
    """A notched plate of glass whose long edges are pulled from t = 0 on: the crack branches to
    either side, and stays below 0.6 of Rayleigh's speed (cases/branching/README.md), wherever the
    grid lies. The plate is a mesh, its notch a thin cylinder."""

    def branches(self, degrees, h):
        """The plate at these degrees to its grid: highest speed over 10 us over Rayleigh's, and how
        far each of the two sides has a branch [mm]."""
        turn = numpy.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees)), 0])
        across = numpy.array([-turn[1], turn[0], 0])
        middle = numpy.array([0, 0, h / 2])
        sides = [LENGTH * turn, 2 * HALF * across, numpy.array([0, 0, h])]
        self.brick("plate.stl", -HALF * across, sides)
        boundaries = []
        for side in (-1, 1):
            ends = [side * HALF * across + x * turn + middle for x in (0, LENGTH)]
            edge = {"from": ends[0].tolist(), "to": ends[1].tolist(), "radius": h}
            force = (side * PULL * LENGTH * h * across).tolist()
            boundaries.append({"where": {"cylinder": edge}, "force": force})
        ends = [x * turn + middle for x in (-h, NOTCH)]
        notch = {"from": ends[0].tolist(), "to": ends[1].tolist(), "radius": 0.5 * h}
        folder = self.run_folder(
            {
                "method": "lattice",
                "time": {"end": 80e-6},
                "materials": {
                    "glass": {
                        "density": DENSITY,
                        "young": YOUNG,
                        "poisson": NU,
                        "strength": {
                            "energy": ENERGY,
                            "plane": "stress",
                            "criterion": "principal",
                            "path": "drawn",
                        },
                    }
                },
                "bodies": [
                    {
                        "name": "plate",
                        "material": "glass",
                        "cell": h,
                        "shape": {"stl": "plate.stl"},
                        "cracks": [{"cylinder": notch}],
                    }
                ],
                "boundaries": boundaries,
                "lattice": {"rotation": "small"},
                "output": {"every": 2e-6, "fields": ["displacement", "broken"]},
            }
        )
        times, tips = [], []
        for path in frames.paths(folder):
            frame = frames.Frame(path)
            place = frame.corners.mean(axis=1) - frame.field("displacement")
            lost = frame.field("broken") > 0
            x, y = place[lost] @ turn, place[lost] @ across
            times.append(frame.time)
            tips.append(x.max(initial=NOTCH))
        share = expect.fastest(times, tips, 10e-6) / expect.rayleigh_speed(YOUNG, NU, DENSITY)
        ends = [numpy.ptp(x[k]) * 1e3 if k.any() else 0 for k in (y > 5e-3, y < -5e-3)]
        print(
            f"at {degrees} degrees, cells of {h * 1e3} mm: {share:.2f} of Rayleigh's speed, "
            f"branches of {ends[0]:.0f} and {ends[1]:.0f} mm beyond 5 mm off the middle"
        )
        return share, ends

    def test_long(self):
        share, ends = self.branches(30, 5e-4)
        self.below("speed over Rayleigh's", share, 0.6)
        self.assertGreater(min(ends), 5, "length of the shorter branch [mm]")


if __name__ == "__main__":
    bodies.main()
