#!/usr/bin/python3
"""What `check` says of the plate (numbers from its keys), on one rank and on two, and that its
resolved text says the same."""
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "system"))
import cli  # noqa: E402

PLATE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "scene", "plate.yaml")


class Plate(cli.Case):
    def said(self, *change, ranks=1):
        run = self.call(
            "check", PLATE, *(word for key in change for word in ("--set", key)), ranks=ranks
        )
        self.assertEqual((run.code, run.err), (0, []))
        return run.out

    def limit(self, text):
        return float(text.split("    critical time step ")[1].split()[0])

    def test_numbers(self):
        text = self.said()
        # 160 x 160 x 2 cells; a link is missing at each upper face of the body
        self.assertIn(f"\ncells: 51200, links: {2 * 159 * 160 * 2 + 160 * 160}\n", text)
        # 80 x 2 cells of the last column; 4 x 4 x 2 at the corner
        self.assertIn(
            "\nboundaries: 2; cells that are constrained or prescribed: 160; "
            "cells that are loaded or prescribed: 32, with distinct sets of loads: 8\n",
            text,
        )
        self.assertIn(f" {7900 * 0.8 * 0.8 * 0.01:.4g} kg", text)
        limit = 2 * math.sqrt(2) / math.sqrt(28 * 210e9 / (2 * 1.28) / 7900) * 5e-3
        self.assertAlmostEqual(self.limit(text) / limit, 1, 3)
        self.assertIn(f"time: 0.01 s in {math.ceil(0.01 / (0.8 * limit))} steps", text)
        self.assertIn(
            "\nfeatures in: turn volume twist_apart mass_damping fix loads rk energy\n", text
        )
        self.assertEqual(self.said(ranks=2), text)

    def test_damping_of_links(self):
        # far above critical: dt <= 2.785/(w (zeta + sqrt(zeta^2 - 1))), zeta = eta w/2
        eta, w = 8e-5, math.sqrt(28 * 210e9 / (2 * 1.28) / 7900) / 5e-3
        zeta = eta * w / 2
        text = self.said(f"materials.steel.damping={{link: {eta}}}")
        self.assertAlmostEqual(
            self.limit(text) / (2.785 / (w * (zeta + math.sqrt(zeta**2 - 1)))), 1, 3
        )
        self.assertIn("link_damping", text.split("features in:")[1].split("features out:")[0])

    def test_step_over_the_limit(self):
        self.assertIn("the time step exceeds it: a run is refused\n", self.said("time.step=1e-6"))

    def test_resolved(self):
        run = self.call("check", PLATE, "--resolved")
        self.put("resolved.yaml", run.out)
        again = self.call("check", "resolved.yaml", "--resolved")
        self.assertEqual((again.code, again.out), (0, run.out))

    def test_nothing_selected(self):
        run = self.call("check", PLATE, "--set", "boundaries[1].where.box.max=[-0.5 mm, 0, 0]")
        self.assertEqual((run.code, run.out), (3, ""))
        self.assertEqual(run.err, [f"{PLATE}:22:5: boundaries[1].where: nothing is in this region"])


if __name__ == "__main__":
    cli.main()
