#!/usr/bin/python3
"""Spheres on meshes that stand for smooth surfaces, through the program: flat floors however cut,
energy in pipes of flat strips, friction that rolls on over the facets. Argument: democles."""
import math

import numpy

import bodies

R, PIPE, DENSITY, G = 5e-3, 0.02, 2500.0, 9.81  # [m], [m], [kg/m3], [m/s2]
MASS = DENSITY * 4 / 3 * math.pi * R**3
HALF = 0.03  # of the pipe's length [m]


def strips(n, slivers):
    """Triangles of a pipe along y of n flat strips around the circle; slivers: each strip is cut
    across at random heights, its diagonals fall either way."""
    random = numpy.random.default_rng(n)
    inner = numpy.sort(random.uniform(-HALF, HALF, 5)) if slivers else []
    heights = numpy.concatenate([[-HALF], inner, [HALF]])
    radius = PIPE / math.cos(math.pi / n)

    def point(k, y):
        angle = 2 * math.pi * (k % n + 0.3) / n
        return (radius * math.cos(angle), y, radius * math.sin(angle))

    triangles = []
    for k in range(n):
        for low, high in zip(heights[:-1], heights[1:]):
            a, b, c, d = point(k, low), point(k + 1, low), point(k + 1, high), point(k, high)
            triangles += [(a, b, c), (a, c, d)] if random.random() < 0.5 else [(a, b, d), (b, c, d)]
    return triangles


def rectangle(x, width):
    return {"rectangle": {"center": [x, 0, 0], "normal": [0, 0, 1], "size": [width, 0.1]}}


class Meshes(bodies.Case):
    def stl(self, name, triangles):
        with open(self.dir / name, "w") as file:
            file.write("solid mesh\n")
            for corners in triangles:
                file.write("facet normal 0 0 0\nouter loop\n")
                for corner in corners:
                    file.write("vertex {!r} {!r} {!r}\n".format(*map(float, corner)))
                file.write("endloop\nendfacet\n")
            file.write("endsolid mesh\n")
        return {"stl": name}

    def scene(self, surfaces, rows, step, end, contact, **more):
        return {
            "time": {"end": end, "step": step},
            "materials": {"m": {"density": DENSITY}},
            "contacts": [{"between": ["m", "m"], **contact}],
            "elements": [{"name": "m", "material": "m", "file": self.spheres("m.csv", rows)}],
            "walls": [
                {"name": f"wall{k}", "material": "m", "surface": surface, **more.get("wall", {})}
                for k, surface in enumerate(surfaces)
            ],
            "gravity": more.get("gravity", [0, 0, 0]),
            "measure": more.get("measure", []),
        }

    def test_flat(self):
        """A floor whose triangles meet in a T, lie over each other, or belong to two walls, and one
        of rectangles side by side, over each other, or on a plane: the impact is that on a plane,
        to rounding."""
        left = [((-0.1, -0.05, 0), (0, -0.05, 0), (0, 0.05, 0))]
        left += [((-0.1, -0.05, 0), (0, 0.05, 0), (-0.1, 0.05, 0))]
        right = [
            ((0, -0.05, 0), (0.1, -0.05, 0), (0.1, 0, 0)),
            ((0, -0.05, 0), (0.1, 0, 0), (0, 0, 0)),
        ]
        right += [
            ((0, 0, 0), (0.1, 0, 0), (0.1, 0.05, 0)),
            ((0, 0, 0), (0.1, 0.05, 0), (0, 0.05, 0)),
        ]
        over = [((-0.02, -0.05, 0), (0.02, -0.05, 0), (-0.02, 0.05, 0))]
        plane = {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}
        floors = {
            "plane": [plane],
            "seam": [self.stl("seam.stl", left + right)],
            "over": [self.stl("over.stl", left + right + over)],
            "walls": [self.stl("left.stl", left), self.stl("right.stl", right)],
            "beside": [rectangle(-0.05, 0.1), rectangle(0.05, 0.1)],
            "overlap": [rectangle(-0.04, 0.1), rectangle(0.04, 0.1)],
            "on a plane": [plane, rectangle(0.05, 0.1)],
        }
        places = [-2e-3, -1e-3, -5e-4, -1e-4, -1e-6, 1e-6, 1e-4, 5e-4, 1e-3]
        contact = {"normal": {"law": "linear", "stiffness": 1e4, "restitution": 0.5}}
        below = [(-1, -1, -1), (1, -1, -1), (0, 1, -1)]
        far = [  # one of each kind out of reach, so that kernels are compiled once for all floors
            {"plane": {"point": [0, 0, -1], "normal": [0, 0, 1]}},
            {"rectangle": {"center": [0, 0, -1], "normal": [0, 0, 1], "size": [1, 1]}},
            self.stl("below.stl", [below]),
        ]
        found = {}
        for name, surfaces in floors.items():
            rows = [
                ((x, 0.01 * k - 0.0403, 1.02 * R), (0, 0, -0.5), R, (0, 0, 0))
                for k, x in enumerate(places)
            ]
            state = self.run_scene(
                self.scene(surfaces + far, rows, 5e-6, 4e-3, contact, gravity=[0, 0, 0])
            )
            found[name] = state.v
        self.below("v_z against restitution", abs(found["plane"][:, 2] - 0.25).max(), 1e-3)
        for name in [name for name in floors if name != "plane"]:
            self.below(name, abs(found[name] - found["plane"]).max(), 1e-9)

    def swing(self, triangles, step, r=R, angles=(50, 37, -44, 61), stiffness=1e4, end=0.1):
        """Largest error of the balance, over the energy, of spheres that swing in a pipe."""
        rows, rho, mass = [], PIPE - r, DENSITY * 4 / 3 * math.pi * r**3
        for k, degrees in enumerate(angles):
            a = math.radians(degrees)
            x = (rho * math.sin(a), 0.0131 * (k - (len(angles) - 1) / 2), -rho * math.cos(a))
            rows.append((x, (0, 0, 0), r, (0, 0, 0)))
        energy = sum(mass * G * (x[2] + rho) for x, *_ in rows)
        state = self.run_scene(
            self.scene(
                [self.stl("pipe.stl", triangles)],
                rows,
                step,
                end,
                {"normal": {"law": "linear", "stiffness": stiffness, "damping_ratio": 0}},
                gravity=[0, 0, -G],
                measure=[{"name": "energy", "every": end / 100, "energy": "all"}],
            )
        )
        return numpy.abs(state.series("energy")["balance"]).max() / energy

    def test_energy(self):
        """Full springs on all faces make 5e-3 and more of it, the more the finer the step."""
        for n, slivers in ((128, True), (512, False)):
            error = [self.swing(strips(n, slivers), step) for step in (4e-5, 1e-5)]
            self.below(f"{n} strips", error[-1], 1e-5)
            self.assertGreater(math.log2(error[0] / error[-1]) / 2, 1.8)

    def test_tight(self):
        """A ball that nearly fills its pipe: valleys rounded as by one of 1.1 radii, wider than the
        pipe, made 1e-3 of it at any step."""
        for n, slivers in ((64, True), (256, False)):
            error = self.swing(strips(n, slivers), 5e-6, 0.975 * PIPE, (50,), 1e5, 0.02)
            self.below(f"{n} strips", error, 2e-5)

    def rolled(self, surface, end):
        """Spheres on the inside of a pipe that turns about its axis, with friction."""
        rows = []
        for k, degrees in enumerate((10, -25, 40)):
            a, rho = math.radians(degrees), PIPE - R
            x = (rho * math.sin(a), 0.0131 * (k - 1), -rho * math.cos(a))
            rows.append((x, (0, 0.02, 0), R, (0, 0, 0)))
        return self.run_scene(
            self.scene(
                [surface],
                rows,
                1e-5,
                end,
                {
                    "normal": {"law": "linear", "stiffness": 1e4, "damping_ratio": 0.1},
                    "tangential": {"stiffness_ratio": 0.8, "damping_ratio": 0, "friction": 0.3},
                },
                gravity=[0, 0, -G],
                wall={"motion": {"rotation": {"center": [0, 0, 0], "axis": [0, 1, 0], "rate": 6}}},
            )
        )

    def test_friction(self):
        """Against the cylinder. A facet meets a sphere that comes at v with the speed
        v pi/n: that much is open, and its way."""
        end, v = 0.15, 0.15
        ends = {"from": [0, -HALF, 0], "to": [0, HALF, 0]}
        exact = self.rolled({"cylinder": {**ends, "radius": PIPE, "inside": True}}, end)
        self.assertGreater(abs(exact.w[:, 1]).min() * R, 0.14)  # they roll
        for n in (64, 512):
            state = self.rolled(self.stl("pipe.stl", strips(n, True)), end)
            kick = v * math.pi / n
            self.below(f"places, {n} strips", abs(state.x - exact.x).max(), kick * end)
            self.below(f"spins, {n} strips", abs(state.w - exact.w).max() * R, kick)


if __name__ == "__main__":
    bodies.main()
