#!/usr/bin/python3
"""Adhesion by JKR: what parting costs two spheres,
and how slowly they meet to stick. Argument: democles."""
import math

import bodies

R, M, YOUNG, POISSON, WORK = 2e-3, 8e-5, 20e6, 0.3, 0.1  # [m], [kg], [Pa], [1], [J/m2]
M_STAR, R_STAR, E_STAR = M / 2, R / 2, YOUNG / (2 * (1 - POISSON**2))
LENGTH = (2 * math.pi * WORK * math.sqrt(R_STAR) / E_STAR) ** (2 / 3)
# energy at the end of the contact over that at the touch, in closed form
# (kernels/contact/law_normal.h)
COST = 4 / 3 * E_STAR * math.sqrt(R_STAR) * LENGTH**2.5 * (0.0375 * 4 ** (-1 / 3) + 0.225)
SPEED = math.sqrt(2 * COST / M_STAR)  # slower spheres stick [m/s]
GAP = 1e-6  # at the start [m]


class Adhesion(bodies.Case):
    def test_parting(self):
        """0.99 SPEED sticks; faster spheres leave with (v^2 - SPEED^2)^(1/2),
        the first order of the step in it below 1e-3."""
        factors = (0.99, 1.5, 2, 3)
        rows = []
        for k, factor in enumerate(factors):
            for side in (-1, 1):
                rows.append(
                    (
                        [side * (R + GAP / 2), 0.02 * k, 0],
                        [-side * factor * SPEED / 2, 0, 0],
                        R,
                        [0, 0, 0],
                    )
                )
        state = self.run_scene(
            {
                "time": {"end": 4e-3, "step": 1e-6},
                "materials": {
                    "a": {"density": bodies.density_of(M, R), "young": YOUNG, "poisson": POISSON}
                },
                "contacts": [
                    {
                        "between": ["a", "a"],
                        "normal": {"law": "hertz", "damping_ratio": 0},
                        "adhesion": {"model": "jkr", "work_of_adhesion": WORK},
                    }
                ],
                "elements": [{"name": "a", "material": "a", "file": self.spheres("a.csv", rows)}],
            }
        )
        for k, factor in enumerate(factors):
            gap = state.x[2 * k + 1, 0] - state.x[2 * k, 0] - 2 * R
            leaving = (state.v[2 * k + 1, 0] - state.v[2 * k, 0]) / SPEED
            print(
                f"{factor} of the speed that sticks: gap {gap:.3g} m, "
                f"leaving at {leaving:.6g} of it"
            )
            self.assertEqual(gap < LENGTH, factor < 1)
            if factor > 1:
                self.assertAlmostEqual(leaving / math.sqrt(factor**2 - 1), 1, delta=1e-3)


if __name__ == "__main__":
    bodies.main()
