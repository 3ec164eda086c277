#!/usr/bin/python3
"""Order in the time step, through the program: oblique impacts with dashpots, friction and slip,
and restitution. Argument: democles."""
import math
import pathlib
import subprocess

import numpy

import bodies

R, M, SPEED, PHASES = 5e-3, 2e-3, 0.5, 8  # [m], [kg], of approach [m/s], [1]
# Stiff, so that the overlap is 0.3 % of the radius: the tangential dashpot is centred in time for
# lever arms r, not r - delta/2, and that adds an error of first order times delta/r, which shows
# from 400 steps per contact on where delta/r is 3 %.
K, E_STAR = 1e6, 1e9  # [N/m], [Pa]
NORMAL, TANGENT = numpy.array([0.6, 0.48, 0.64]), numpy.array([-0.8, 0.36, 0.48])
IMPACTS = {
    "sticking": (0.1, 0.3, 1),
    "slipping": (2, 0, 1),
    "1:10": (0.1, 0.3, 10),
}  # tangential over normal speed, spin, ratio of radii
TWO_SPHERES = pathlib.Path(__file__).resolve().parents[2] / "cases" / "two_spheres"


def contact_time(law, ratio):
    """Of the elastic impact [s]."""
    m, r = M * ratio**3 / (1 + ratio**3), R * ratio / (1 + ratio)
    depth = (5 * m * SPEED**2 / (16 / 3 * E_STAR * math.sqrt(r))) ** 0.4
    return 2.94328 * depth / SPEED if law == "hertz" else math.pi * math.sqrt(m / K)


def order(coarse, n_coarse, fine, n_fine):
    return math.log(coarse / fine) / math.log(n_fine / n_coarse)


class Oblique(bodies.Case):
    """Sphere i flies at sphere j at rest.
    Every impact is there PHASES times, seen at times shifted by a share of the step, in one run."""

    def pairs(self, law, dt):
        rows = []
        for k, (slant, spin, ratio) in enumerate(IMPACTS.values()):
            for phase in range(PHASES):
                origin = numpy.array([0.3 * phase, 0.3 * k, 0])
                v = SPEED * NORMAL + slant * SPEED * TANGENT
                gap = 0.3 * SPEED * contact_time(law, 1)
                rows.append(
                    (
                        origin - phase / PHASES * dt * v,
                        v,
                        R,
                        spin * SPEED / R * numpy.array([0.3, -0.5, 0.7]),
                    )
                )
                other = spin * SPEED / (R * ratio) * numpy.array([-0.2, 0.4, 0.3])
                rows.append(
                    (origin + (R * (1 + ratio) + gap) * NORMAL, [0, 0, 0], R * ratio, other)
                )
        return rows

    def velocities(self, law, n):
        """v and w r of all [impact][phase][2 spheres * 6] after the impacts,
        with n steps per contact of equal spheres."""
        dt, nu = contact_time(law, 1) / n, 1 / 3
        normal = {"law": "linear", "stiffness": K} if law == "linear" else {"law": "hertz"}
        tangential = (
            {"stiffness_ratio": 0.8} if law == "linear" else {}
        )  # Mindlin's is 0.8 at nu = 1/3
        state = self.run_scene(
            {
                "time": {"end": 2.7 * contact_time(law, 1), "step": dt, "allow_unstable": True},
                "materials": {
                    "m": {
                        "density": bodies.density_of(M, R),
                        "young": 2 * (1 - nu**2) * E_STAR,
                        "poisson": nu,
                    }
                },
                "contacts": [
                    {
                        "between": ["m", "m"],
                        "normal": {**normal, "damping_ratio": 0.1},
                        "tangential": {**tangential, "damping_ratio": 0.1, "friction": 0.3},
                    }
                ],
                "elements": [
                    {
                        "name": "m",
                        "material": "m",
                        "file": self.spheres("m.csv", self.pairs(law, dt)),
                    }
                ],
            }
        )
        both = numpy.concatenate([state.v, state.w * state.radius[:, None]], axis=1)
        return both.reshape(len(IMPACTS), PHASES, 12)

    def check(self, law, least_order):
        """Bounds of the error at 50, 100, 400 steps per contact [m/s]: what a consistent scheme
        reaches (half-step normal, part of the first step); the usual scheme has 6e-3, 3e-3, 8e-4,
        and 5e-2 at 50 for 1:10."""
        bounds = {
            "sticking": (4.5e-4, 1.3e-4, 7.8e-6),
            "slipping": (4.5e-4, 1.3e-4, 7.8e-6),
            "1:10": (8e-3, 2e-3, 1.3e-4),
        }
        counts = (50, 100, 400)
        reference = self.velocities(law, 16 * counts[-1])
        errors = [numpy.abs(self.velocities(law, n) - reference[:, :1]).max(axis=2) for n in counts]
        for k, name in enumerate(IMPACTS):
            for n, error, bound in zip(counts, errors, bounds[name]):
                self.below(
                    f"{law}, {name}, {n} steps per contact: worst error of a velocity [m/s]",
                    error[k].max(),
                    bound,
                )
            reached = order(errors[0][k].mean(), counts[0], errors[-1][k].mean(), counts[-1])
            print(f"{law}, {name}: order {reached:.2f}")
            self.assertGreater(reached, least_order)

    def test_linear(self):
        self.check("linear", 1.7)

    def test_hertz(self):
        """Mindlin's stiffness starts with an infinite slope, and the dashpot like the fourth root
        of the overlap: between 1.5 and 2."""
        self.check("hertz", 1.4)


class Restitution(bodies.Case):
    """The case two_spheres with larger steps."""

    def errors(self, step):
        """By law, root mean square over the pairings and over steps up to 12 % larger:
        the phase of the touch differs."""
        out, errors = self.dir / "out", {"linear": [], "hertz": []}
        for factor in (1, 1.03, 1.07, 1.12):
            subprocess.run(
                [
                    bodies.DEMOCLES,
                    "run",
                    str(TWO_SPHERES / "scene.yaml"),
                    "-o",
                    str(out),
                    "--force",
                    "--quiet",
                    "--set",
                    f"time.step={factor * step}",
                ],
                check=True,
                stdin=subprocess.DEVNULL,
            )
            for name, e in bodies.expect.expected(TWO_SPHERES / "check")["restitution"].items():
                right = bodies.expect.series(out, name + "_right")["v_x"]
                errors[name.split("_")[0]].append(right[-1] / -right[0] - e)
        return {law: math.sqrt(numpy.mean(numpy.square(e))) for law, e in errors.items()}

    def test_order(self):
        """Hertz: the dashpot starts like the fourth root of the overlap; what the onset weight
        leaves of that is of order 1.25 in the end."""
        coarse, fine = self.errors(8e-6), self.errors(5e-7)
        self.below(
            "linear, some 1,600 steps per contact: error of restitution", fine["linear"], 1e-6
        )
        self.below("hertz, some 2,200 steps per contact: error of restitution", fine["hertz"], 1e-4)
        for law, least in (("linear", 1.8), ("hertz", 1.2)):
            reached = order(coarse[law], 1, fine[law], 16)
            print(f"{law}: restitution converges with order {reached:.2f}")
            self.assertGreater(reached, least)


if __name__ == "__main__":
    bodies.main()
