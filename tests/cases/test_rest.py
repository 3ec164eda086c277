#!/usr/bin/python3
"""What shall not change does not: columns at rest stay, and a cloud of colliding spheres keeps its
momentum. Argument: democles."""
import math

import numpy

import bodies

R, RHO, G = 5e-3, 2500, 9.81
M = RHO * 4 / 3 * math.pi * R**3
K, E, NU = 1e5, 1e8, 0.25


def column(n, overlap, y):
    """Rows of n spheres on the plane z = 0; overlap(weight, is_floor) [m]."""
    z, rows = 0.0, []
    for c in range(n):
        z += R * (1 if c == 0 else 2) - overlap((n - c) * M * G, c == 0)
        rows.append(([0, y, z], [0, 0, 0], R, [0, 0, 0]))
    return rows


def hertz(force, is_floor):
    """Overlap [m]; the floor is 1e9 times as stiff."""
    pair = 4 / 3 * E / (2 * (1 - NU**2)) * math.sqrt(R / 2)
    floor = 4 / 3 / ((1 - NU**2) / E * (1 + 1e-9)) * math.sqrt(R)
    return (force / (floor if is_floor else pair)) ** (2 / 3)


class Rest(bodies.Case):
    def columns(self, n, z, steps, dt):
        """n spheres on each other, linear and Hertz, in equilibrium by closed form.
        Start and end."""
        rows = {"a": column(n, lambda force, is_floor: force / K, 0), "b": column(n, hertz, 0.03)}
        laws = {
            "a": {
                "normal": {"law": "linear", "stiffness": K, "damping_ratio": z},
                "tangential": {"stiffness_ratio": 0.8, "friction": 0.3},
            },
            "b": {"normal": {"law": "hertz", "damping_ratio": z}, "tangential": {"friction": 0.3}},
        }
        state = self.run_scene(
            {
                "time": {"end": steps * dt, "step": dt},
                "gravity": [0, 0, -G],
                "materials": {
                    "a": {"density": RHO, "young": E, "poisson": NU},
                    "b": {"density": RHO, "young": E, "poisson": NU},
                    "floor": {"density": RHO, "young": 1e9 * E, "poisson": NU},
                },
                "contacts": [
                    {"between": pairing, **laws[law]}
                    for pairing, law in (
                        (["a", "a"], "a"),
                        (["a", "floor"], "a"),
                        (["b", "b"], "b"),
                        (["b", "floor"], "b"),
                        (["a", "b"], "a"),
                    )
                ],
                "elements": [
                    {
                        "name": name,
                        "material": name,
                        "file": self.spheres(name + ".csv", rows[name]),
                    }
                    for name in rows
                ],
                "walls": [
                    {
                        "name": "floor",
                        "material": "floor",
                        "surface": {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}},
                    }
                ],
            }
        )
        return numpy.array([x for name in rows for x, _, _, _ in rows[name]]), state

    def test_columns_stay(self):
        """Elastic. Rounding of a place (1.4e-17 m at 0.1 m) is all that disturbs them."""
        start, state = self.columns(10, 0, 20000, 1e-5)
        self.below("largest displacement [m]", numpy.abs(state.x - start).max(), 1e-14)
        self.below("largest speed [m/s]", numpy.abs(state.v).max(), 1e-11)
        self.below("largest spin [rad/s]", numpy.abs(state.w).max(), 1e-11)

    def test_columns_come_to_rest(self):
        """Damped. Dashpots have no part in a load at rest, so overlaps are those of the closed
        form, and nothing creeps. An overlap of 3e-7 m has the rounding of places (7e-18 m) in it.
        """
        n, z, dt = 5, 0.3, 1e-5
        start, state = self.columns(n, z, 50000, dt)
        weight = numpy.arange(n, 0, -1) * M * G
        linear = 2 * R - numpy.diff(state.x[:n, 2])
        error = linear / (weight[1:] / K) - 1
        self.below("linear: largest relative error of an overlap", numpy.abs(error).max(), 1e-9)
        self.below("largest speed [m/s]", numpy.abs(state.v).max(), 1e-11)
        self.below(
            "largest sideways displacement [m]", numpy.abs(state.x - start)[:, :2].max(), 1e-14
        )

    def test_momentum(self):
        """300 spheres of many sizes fly at each other: dashpots, friction, rolling
        resistance. No walls, no gravity."""
        random, rows = numpy.random.default_rng(5), []
        for k in range(300):
            x = 0.0125 * numpy.array([k % 7, k // 7 % 7, k // 49]) + random.uniform(-1e-4, 1e-4, 3)
            v = -10 * (x - 0.0375) + random.uniform(-0.5, 0.5, 3) + numpy.array([0.3, 0.2, -0.1])
            rows.append((x, v, random.uniform(2e-3, 6e-3), random.uniform(-50, 50, 3)))
        state = self.run_scene(
            {
                "time": {"end": 0.03, "step": 1e-5},
                "materials": {"m": {"density": RHO}},
                "contacts": [
                    {
                        "between": ["m", "m"],
                        "normal": {"law": "linear", "stiffness": 1e4, "damping_ratio": 0.1},
                        "tangential": {
                            "stiffness_ratio": 0.8,
                            "friction": 0.4,
                            "damping_ratio": 0.1,
                        },
                        "rolling": {"model": "epsd", "friction": 0.1, "damping_ratio": 0.2},
                    }
                ],
                "elements": [{"name": "m", "material": "m", "file": self.spheres("m.csv", rows)}],
                "measure": [{"name": "momentum", "every": 1e-4, "momentum": "all"}],
            }
        )
        mass = RHO * 4 / 3 * math.pi * numpy.array([r for _, _, r, _ in rows]) ** 3
        x, v = (numpy.array([row[k] for row in rows]) for k in (0, 1))
        momentum = state.series("momentum")
        for names, scale in (
            (("p_x", "p_y", "p_z"), (mass * numpy.linalg.norm(v, axis=1)).sum()),
            (("l_x", "l_y", "l_z"), (mass * numpy.linalg.norm(numpy.cross(x, v), axis=1)).sum()),
        ):
            change = max(
                float(numpy.abs(momentum[name] - momentum[name][0]).max()) for name in names
            )
            self.below(f"change of {names[0][0]} over the sum of sizes", change / scale, 1e-14)
        self.assertGreater(numpy.abs(state.v - v).max(), 0.1)  # they did collide


if __name__ == "__main__":
    bodies.main()
