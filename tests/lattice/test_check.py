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


BLOCK = """method: lattice
time: {{end: 0.01}}
materials: {{m: {{density: 2700, young: 70 GPa, poisson: 0.3}}}}
bodies: [{{name: block, material: m, cell: {cell}, shape: {shape}, angular_velocity: [0, 0, 10]}}]
boundaries: [{loads}]
lattice: {{rotation: small{relax}}}
"""


class Fit(cli.Case):
    """What the cells make of a shape."""

    def warnings(self, shape, cell="13 mm", more=""):
        self.put("scene.yaml", BLOCK.format(shape=shape, cell=cell, loads="", relax=more))
        run = self.call("check", "scene.yaml")
        self.assertEqual((run.code, run.err), (0, []))
        return run.out, [line.strip() for line in run.out.splitlines() if "warning" in line]

    def test_box(self):
        box = "{{box: {{min: [0, 0, 0], max: [{}]}}}}"
        says = (
            "warning: body 'block': its cells measure 0.039 x 0.026 x 0.026 m, its shape "
            "{} m; they hold {} of its volume; a cell of {} fits"
        )
        for size, shape, volume, cells in (
            ("40 mm, 20 mm, 20 mm", "0.04 x 0.02 x 0.02", "1.648", "0.01 m or 0.02 m"),
            ("40.2 mm, 20 mm, 20 mm", "0.0402 x 0.02 x 0.02", "1.64", "0.01 m or 0.02 m"),
            ("37 mm, 20 mm, 20 mm", "0.037 x 0.02 x 0.02", "1.781", "0.003333 m"),
        ):
            self.assertEqual(
                self.warnings(box.format(size))[1], [says.format(shape, volume, cells)]
            )
        self.assertEqual(self.warnings(box.format("39 mm, 26.1 mm, 26 mm"))[1], [])
        self.assertEqual(self.warnings(box.format("40 mm, 20 mm, 20 mm"), "10 mm")[1], [])

    def test_round(self):
        """Cells that the surface cuts fill a sphere however large they are; steps do not."""
        sphere = "{sphere: {center: [0, 0, 0], radius: 0.1}}"
        text, warnings = self.warnings(sphere, "10 mm")
        self.assertRegex(
            text,
            r"\n +(0\.999|1|1\.00)\d* of the volume of its shape; 20 cells along its smallest "
            "extent, 10 along its smallest radius\n",
        )
        self.assertRegex(text, r"\n    \d+ cells that curved surfaces cut, the smallest with 0\.0")
        self.assertEqual(warnings, [])
        self.assertEqual(self.warnings(sphere, "100 mm")[1], [])
        self.assertRegex(
            self.warnings(sphere, "100 mm", ", surface: stepped")[1][0],
            "they hold 1.912 of its volume$",
        )

    def test_run_warns(self):
        shape = "{box: {min: [0, 0, 0], max: [40 mm, 20 mm, 20 mm]}}"
        self.put("scene.yaml", BLOCK.format(shape=shape, cell="13 mm", loads="", relax=""))
        run = self.call("run", "scene.yaml", "-o", "out", "--steps", "2", ranks=2)
        self.assertEqual(run.code, 0)
        self.assertEqual(sum("they hold 1.648 of its volume" in line for line in run.err), 1)


class Floating(cli.Case):
    """Relaxation of what nothing holds; aside a body that is held and loaded, so that kernels are
    compiled once, for both."""

    HELD = ", {name: held, material: m, cell: 10 mm, shape: {box: {min: [2, 0, 0], max: [2.02, "
    HELD += "0.02, 0.02]}}}]"

    def end(self, loads, command="run"):
        shape = "{box: {min: [0, 0, 0], max: [0.1, 0.04, 0.04]}}"
        aside = [
            self.load(1.9, 2.006, "fix: [x, y, z, rx, ry, rz]"),
            self.load(2.019, 3, "force: [1, 0, 0]"),
        ]
        loads = ", ".join([loads, *aside] if loads else aside)
        text = BLOCK.format(shape=shape, cell="10 mm", loads=loads, relax=", relax: {}")
        text = text.replace("10]}]", "10]}" + self.HELD)
        self.put("scene.yaml", text)
        more = ["-o", "out", "--force"] if command == "run" else []
        run = self.call(command, "scene.yaml", *more)
        return run.code, "".join(run.err)

    def load(self, low, high, what):
        box = f"{{min: [{low}, -1, -1], max: [{high}, 1, 1]}}"
        return f"{{where: {{box: {box}}}, {what}}}"

    def test_refused(self):
        right, left = (0.0999, 1), (-1, 0.006)
        pull = self.load(*right, "force: [1000, 0, 0]")
        aside = self.load(*right, "force: [1000, 5, 0]")
        held = self.load(*left, "fix: [x]")
        nothing, partly = "is held by nothing", "is not held against every motion"
        for loads, how, force in (
            (pull, nothing, r"force \(1000, 0, 0\) N, moment \(0, 0, 0\) N m"),
            (aside + ", " + held, partly, r"force \(1000, 5, 0\) N, moment \(0, 0, 0.25\) N m"),
        ):
            for command in ("check", "run"):
                code, text = self.end(loads, command)
                self.assertEqual(code, 3, text)
                self.assertRegex(text, rf"bodies\[0\]: 'block' {how}, and its .*: {force} about")

    def test_too_large_a_load(self):
        """What is infinite is not within a tolerance of the infinite: no state of rest."""
        pull = self.load(0.0999, 1, "force: [0, 1e160, 0]")
        code, text = self.end(pull + ", " + self.load(-1, 0.006, "fix: [x, y, z, rx, ry, rz]"))
        self.assertEqual(code, 5, text)

    def test_balanced(self):
        """Loads that balance; a motion that is held; a spin that carries nothing, of which the
        only warning speaks."""
        right, left = (0.0999, 1), (-1, 0.0001)
        pull = self.load(*right, "force: [1000, 0, 0]")
        for loads in (
            pull + ", " + self.load(*left, "force: [-1000, 0, 0]"),
            pull + ", " + self.load(-1, 0.006, "fix: [x]"),
            "",
        ):
            code, text = self.end(loads)
            self.assertEqual(code, 0, text)
            self.assertRegex(text, r"^democles: warning: [^:]*: its initial velocity [^:]*$")


if __name__ == "__main__":
    cli.main()
