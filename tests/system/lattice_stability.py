#!/usr/bin/python3
"""A struck block at 0.99 of the time step's limit stays bounded, and at 1.05 of it blows up with
exit code 5 and a message that names the step: each scheme, and those that take damping of links
with both dampings too. Arguments of parallel_runs.py."""
import math
import os

import yaml

import parallel_runs

# Long enough for what grows by a third per step or more to leave the range of doubles, from
# rounding on; shocks excite all frequencies.
STEPS = 4000
EDGE, CELLS = 0.01, 16
# [s] 0.1 and 2 of the critical ratio at the highest frequency. For rk4 the limit is exact above 1,
# and a safe bound below (lattice_limit.c).
ETA = {"leapfrog": 1e-7, "rk4": 2e-6}
DAMPING = {
    "leapfrog": ("none", "mass", "link"),
    "rk4": ("none", "mass", "link"),
    "rkn4": ("none",),
    "pefrl": ("none",),
    "vefrl": ("none",),
}


def block(scheme, damping):
    """Two halves of a cube that fly at each other."""
    half, side = CELLS // 2 * EDGE, CELLS * EDGE
    material = {"density": 2700, "young": 70e9, "poisson": 0.3}
    if damping != "none":
        material["damping"] = {damping: 100.0 if damping == "mass" else ETA[scheme]}
    bodies = [
        {
            "name": name,
            "material": "m",
            "cell": EDGE,
            "velocity": [v, 0.3 * v, 0],
            "shape": {"box": {"min": [x, 0, 0], "max": [x + half, side, side]}},
        }
        for name, x, v in (("left", 0, 1), ("right", half, -1))
    ]
    return {
        "title": "struck block",
        "method": "lattice",
        "time": {"end": 1, "scheme": scheme},
        "materials": {"m": material},
        "bodies": bodies,
        "lattice": {"rotation": "small"},
        "output": {"every": 0},
        "measure": [{"name": "energy", "every": 1, "energy": "all"}],
    }


class Stability(parallel_runs.Case):
    def at(self, scene, limit, share):
        scene["time"].update(step=share * limit, allow_unstable=share > 1)
        scene["measure"][0]["every"] = STEPS * share * limit
        path = os.path.join(self.dir, "scene.yaml")
        with open(path, "w") as file:
            yaml.safe_dump(scene, file)
        return self.run_scene(path, 1, "--steps", str(STEPS))

    def test_all(self):
        for scheme, kinds in DAMPING.items():
            for damping in kinds:
                with self.subTest(scheme=scheme, damping=damping):
                    scene = block(scheme, damping)
                    limit = 1e-9
                    limit = self.at(scene, limit, 0.5).record()["dt_limit"]
                    calm = self.at(scene, limit, 0.99)
                    self.assertEqual(calm.code, 0, calm.err)
                    line = calm.series()["energy.csv"].splitlines()
                    kinetic = [float(row.split(",")[1]) for row in (line[1], line[-1])]
                    self.assertTrue(
                        math.isfinite(kinetic[1]) and 0 <= kinetic[1] < kinetic[0], kinetic
                    )
                    wild = self.at(scene, limit, 1.05)
                    self.assertEqual(wild.code, 5, wild.err)
                    self.assertRegex(
                        wild.err,
                        r"are not numbers; the time step \S+ s is 1\.05 of the critical one",
                    )


if __name__ == "__main__":
    parallel_runs.main()
