#!/usr/bin/python3
"""Dashpots: no part in a load at rest, second order in a bed. Argument: democles."""
import math

import numpy

import bodies

R, RHO, G = 5e-3, 2500, 9.81
M = RHO * 4 / 3 * math.pi * R**3
K = 1e4  # [N/m]
OMEGA = math.sqrt(K / M)  # of a sphere at a wall [rad/s]


def plane(name, point, normal):
    return {
        "name": name,
        "material": "wall",
        "surface": {"plane": {"point": point, "normal": normal}},
    }


class Rest(bodies.Case):
    def scene(self, kinds, gravity, walls, end, step):
        """kinds: {name: (parts of the contact with the wall and of its own, rows of spheres)}."""
        pairings = [[a, b] for a in kinds for b in (*kinds, "wall") if b == "wall" or a <= b]
        return self.run_scene(
            {
                "time": {"end": end, "step": step},
                "gravity": gravity,
                "materials": {name: {"density": RHO} for name in (*kinds, "wall")},
                "contacts": [{"between": pairing, **kinds[pairing[0]][0]} for pairing in pairings],
                "elements": [
                    {"name": name, "material": name, "file": self.spheres(name + ".csv", rows)}
                    for name, (_, rows) in kinds.items()
                ],
                "walls": walls,
            }
        )

    def test_hanging_chain(self):
        """Ten spheres hang on bonds from a ceiling: the gap above sphere k of n is (n - k) weights
        over the stiffness. Bonds form at the touch, so they start there, fall and come to rest."""
        n = 10
        law = {
            "normal": {"law": "linear", "stiffness": K, "damping_ratio": 1},
            "binding": {"force": 3 * n * M * G},
        }
        rows = [([0, 0, 1e-10 * (k + 1) - R * (2 * k + 1)], [0] * 3, R, [0] * 3) for k in range(n)]
        walls = [plane("ceiling", [0, 0, 0], [0, 0, -1])]
        state = self.scene({"s": (law, rows)}, [0, 0, -G], walls, 1, 1e-5)
        gap = numpy.append(-R, state.x[:-1, 2] - 2 * R) - state.x[:, 2]
        exact = numpy.arange(n, 0, -1) * M * G / K
        self.below("largest error of a gap, relative", numpy.abs(gap / exact - 1).max(), 1e-9)
        self.below("largest speed [m/s]", numpy.abs(state.v).max(), 1e-11)

    def test_bond_holds_its_force(self):
        """A sphere with more than critical damping sinks into its bond without overshoot: a weight
        of (1 - 1e-6) F_b hangs, (1 + 1e-6) F_b falls."""
        kinds = {}
        for k, share in enumerate((1 - 1e-6, 1 + 1e-6)):
            law = {
                "normal": {"law": "linear", "stiffness": K, "damping_ratio": 2},
                "binding": {"force": M * G / share},
            }
            kinds["ab"[k]] = (law, [([0.1 * k, 0, 1e-10 - R], [0] * 3, R, [0] * 3)])
        walls = [plane("ceiling", [0, 0, 0], [0, 0, -1])]
        state = self.scene(kinds, [0, 0, -G], walls, 0.1, 1e-5)
        depth = -R - state.x[:, 2]
        self.below("held: error of the depth, relative", abs(depth[0] / (M * G / K) - 1), 1e-6)
        self.assertGreater(depth[1], 3 * M * G / K)

    def test_friction_holds_to_the_limit(self):
        """Spheres pressed between two plates with a sideways load of 0.999 and 1.001 of what the
        two contacts can hold, at damping of a third and all of the critical."""
        depth, load = 1e-5, 0.6 * K * 1e-5
        kinds = {}
        for k, (share, z_t) in enumerate(((0.999, 0.3), (0.999, 1), (1.001, 0.3), (1.001, 1))):
            law = {
                "normal": {"law": "linear", "stiffness": K, "damping_ratio": 0.1},
                "tangential": {
                    "stiffness_ratio": 0.8,
                    "friction": load / (2 * K * depth) / share,
                    "damping_ratio": z_t,
                },
            }
            kinds["abcd"[k]] = (law, [([0, 0.1 * k, R - depth], [0] * 3, R, [0] * 3)])
        walls = [
            plane("floor", [0, 0, 0], [0, 0, 1]),
            plane("lid", [0, 0, 2 * (R - depth)], [0, 0, -1]),
        ]
        state = self.scene(kinds, [load / M, 0, 0], walls, 0.5, 2e-5)
        print("speeds [m/s]:", state.v[:, 0])
        self.below("0.999: largest speed [m/s]", numpy.abs(state.v[:2, 0]).max(), 1e-11)
        free = 0.001 / 1.001 * load / M * 0.5  # the load that is left, all the time [m/s]
        self.assertGreater(state.v[2:, 0].min(), 0.9 * free)

    def test_rolling_resistance_holds_to_the_limit(self):
        """A sphere on a slope, whose tangent is 0.999 and 1.001 of mu_r R/(R - overlap)."""
        mu_r, step, end = 0.1, 2e-5, 1.5
        for share in (0.999, 1.001):
            depth = M * G / K
            slope = math.atan(share * mu_r * R / (R - depth))
            depth *= math.cos(slope)
            law = {
                "normal": {"law": "linear", "stiffness": K, "damping_ratio": 0.3},
                "tangential": {"stiffness_ratio": 0.8, "friction": 0.5, "damping_ratio": 0.3},
                "rolling": {"model": "epsd", "friction": mu_r, "damping_ratio": 2},
            }
            rows = [([0, 0, R - depth], [0] * 3, R, [0] * 3)]
            gravity = [G * math.sin(slope), 0, -G * math.cos(slope)]
            walls = [plane("floor", [0, 0, 0], [0, 0, 1])]
            state = self.scene({"s": (law, rows)}, gravity, walls, end, step)
            speed = abs(float(state.v[0, 0]))
            print(f"{share} of the limit: {speed:.3g} m/s")
            if share < 1:
                self.assertLess(speed, 1e-10)
            else:
                free = 5 / 7 * 0.001 / 1.001 * G * math.sin(slope) * end
                self.assertGreater(speed, 0.8 * free)


class Bed(bodies.Case):
    """A bed of 200 spheres of sizes within 10 % in a box, stirred. Medians over the spheres: a few
    that meet at a grazing angle, or not, would rule a mean."""

    END, STEPS = 4e-3, (3.2e-5, 1.6e-5, 8e-6, 4e-6, 2e-6)

    def bed(self, rows, z, friction, step, end):
        wall = [[0, 0, 0], [0.025, 0, 0], [0, 0.025, 0]]
        law = {
            "normal": {"law": "linear", "stiffness": 1e3, "damping_ratio": z},
            "tangential": {"stiffness_ratio": 0.8, "friction": friction, "damping_ratio": z},
        }
        return self.run_scene(
            {
                "time": {"end": end, "step": step},
                "gravity": [0, 0, -G],
                "materials": {"s": {"density": RHO}, "wall": {"density": RHO}},
                "contacts": [
                    {"between": ["s", "s"], **law},
                    {"between": ["s", "wall"], **law},
                ],
                "elements": [{"name": "s", "material": "s", "file": self.spheres("s.csv", rows)}],
                "walls": [
                    plane("floor", wall[0], [0, 0, 1]),
                    plane("left", wall[0], [1, 0, 0]),
                    plane("right", wall[1], [-1, 0, 0]),
                    plane("front", wall[0], [0, 1, 0]),
                    plane("back", wall[2], [0, -1, 0]),
                ],
            }
        )

    def start(self, z):
        """Spheres that have come down, with new velocities."""
        random, rows = numpy.random.default_rng(3), []
        for k in range(200):
            x = 2.6e-3 + 4.9e-3 * numpy.array([k % 5, k // 5 % 5, k // 25])
            x[:2] += random.uniform(0, 1e-4, 2)
            rows.append((x, [0] * 3, random.uniform(2.25e-3, 2.5e-3), [0] * 3))
        state = self.bed(rows, z, 0.3, 2e-5, 0.08)
        return [
            (x, v + random.uniform(-0.05, 0.05, 3), r, random.uniform(-20, 20, 3))
            for x, v, r in zip(state.x, state.v, state.radius)
        ]

    def order(self, z, friction):
        rows = self.start(z)
        reference = self.bed(rows, z, friction, self.STEPS[-1] / 8, self.END).x
        errors = []
        for step in self.STEPS:
            x = self.bed(rows, z, friction, step, self.END).x
            errors.append(float(numpy.median(numpy.linalg.norm(x - reference, axis=1))))
        reached = math.log2(errors[0] / errors[-1]) / (len(errors) - 1)
        print(f"z = {z}, mu = {friction}: median errors of a place", [f"{e:.2e}" for e in errors])
        print(f"order {reached:.2f} over {len(errors) - 1} halvings")
        return reached

    def test_without_friction(self):
        for z in (0.1, 0.4):
            self.assertGreater(self.order(z, 0), 1.9)

    def test_with_friction(self):
        for z in (0.1, 0.4):
            self.assertGreater(self.order(z, 0.3), 1.9)


if __name__ == "__main__":
    bodies.main()
